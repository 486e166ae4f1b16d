//! The documentation says what the program does: its commands run, its options exist.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::*;
use serde_json::Value;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// A part of a page: prose, or a fenced block with its language.
enum Part {
    Prose(String),
    Block(String, Vec<String>),
}

fn parts(text: &str) -> Vec<Part> {
    let mut parts = vec![Part::Prose(String::new())];
    for line in text.lines() {
        let fence = line.strip_prefix("```");
        match (parts.last_mut().unwrap(), fence) {
            (Part::Prose(_), Some(language)) => parts.push(Part::Block(language.to_owned(), Vec::new())),
            (Part::Prose(prose), None) => *prose += &format!("{line}\n"),
            (Part::Block(..), Some(_)) => parts.push(Part::Prose(String::new())),
            (Part::Block(_, lines), None) => lines.push(line.to_owned()),
        }
    }
    parts
}

fn joined(parts: &[Part]) -> String {
    let text = |part: &Part| match part {
        Part::Prose(prose) => prose.clone(),
        Part::Block(language, lines) => {
            let lines: String = lines.iter().map(|line| format!("{line}\n")).collect();
            format!("```{language}\n{lines}```\n")
        }
    };
    parts.iter().map(text).collect()
}

/// The words of a line without numbers, which depend a little on the processor; none of a row of numbers.
fn words(line: &str) -> Vec<&str> {
    let is_word = |word: &str| word.trim_matches(|c| "(),%".contains(c)).parse::<f64>().is_err();
    let words = line.split_whitespace();
    match words.clone().next() {
        Some(first) if is_word(first) => words.filter(|word| is_word(word)).collect(),
        _ => Vec::new(),
    }
}

/// What a block that shows `lines` should show of what was printed: the same count of lines before and
/// after three dots, or everything.
fn shown(lines: &[String], printed: &[&str]) -> Vec<String> {
    let Some(dots) = lines.iter().position(|line| line.trim() == "...") else {
        return printed.iter().map(|line| (*line).to_owned()).collect();
    };
    let tail = lines.len() - dots - 1;
    assert!(printed.len() >= dots + tail, "{printed:?}");
    let ends = [&printed[..dots], &[&lines[dots]], &printed[printed.len() - tail..]];
    ends.concat().iter().map(|line| (*line).to_owned()).collect()
}

/// Runs the `sh` blocks of a page in order, and compares what they print with the `text` block that follows.
/// Python is run where it has NumPy; where it has not, commands that take the files it would have saved are left out too. With UPDATE_DOCS=1 in the environment, the page is written anew.
fn follow(page: &str) {
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink(root().join("fixtures"), folder.path().join("fixtures")).unwrap();
    let program = Path::new(env!("CARGO_BIN_EXE_mser3d")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap_or_default());
    let run = |program: &str, arguments: &[&str]| {
        let mut command = Command::new(program);
        let output = command.args(arguments).current_dir(&folder).env("PATH", &path).output().unwrap();
        assert!(output.status.success(), "{page}: {arguments:?}: {}", text(&output.stderr));
        text(&output.stdout).to_owned()
    };
    let numpy = Command::new("python3").args(["-c", "import numpy"]).output();
    let numpy = numpy.is_ok_and(|output| output.status.success());
    let old = fs::read_to_string(root().join(page)).unwrap();
    let mut parts = parts(&old);
    let (mut printed, mut commands) = (None, 0);
    let mut missing: Vec<String> = Vec::new();
    for part in &mut parts {
        let Part::Block(language, lines) = part else { continue };
        match language.as_str() {
            "sh" => {
                // Cargo is what runs this test.
                let lines = lines.iter().filter(|line| !line.starts_with("cargo "));
                let lines: Vec<&str> = lines.map(String::as_str).collect();
                commands += lines.len();
                if lines.iter().any(|line| missing.iter().any(|file| line.contains(file))) {
                    println!("skipped: {lines:?}, since Python has no NumPy");
                    printed = None;
                    continue;
                }
                printed = Some(run("sh", &["-e", "-c", &lines.join("\n")]));
            }
            "python" if !numpy => {
                let saved =
                    lines.iter().filter_map(|line| line.strip_prefix("np.save(\"")?.split('"').next());
                missing.extend(saved.map(str::to_owned));
                printed = None;
            }
            "python" => printed = Some(run("python3", &["-c", &lines.join("\n")])),
            "text" => {
                let Some(printed) = printed.take() else { continue };
                let now = shown(lines, &printed.lines().collect::<Vec<_>>());
                if std::env::var_os("UPDATE_DOCS").is_some() {
                    *lines = now;
                    continue;
                }
                let same =
                    lines.len() == now.len() && lines.iter().zip(&now).all(|(a, b)| words(a) == words(b));
                assert!(same, "{page} shows {lines:#?}, printed is {now:#?}; UPDATE_DOCS=1 renews it");
            }
            // What is shown next is not of what ran.
            _ => printed = None,
        }
    }
    assert!(commands > 1, "{page} has no commands");
    let new = joined(&parts);
    match std::env::var_os("UPDATE_DOCS") {
        Some(_) => fs::write(root().join(page), new).unwrap(),
        None => assert_eq!(new, old, "pages are taken apart and put together without loss"),
    }
}

#[test]
fn the_tutorial_can_be_followed() {
    follow("docs/tutorial.md");
}

#[test]
fn the_page_on_weights_can_be_followed() {
    follow("docs/weights.md");
}

#[test]
fn the_page_on_batches_can_be_followed() {
    follow("docs/batch.md");
}

#[test]
fn the_page_on_motion_can_be_followed_and_has_all_options() {
    follow("docs/track.md");
    let page = fs::read_to_string(root().join("docs/track.md")).unwrap();
    let (track, detect) = (options("track"), options("detect"));
    let own = track.iter().filter(|(name, default)| detect.get(*name) != Some(default));
    for (name, default) in own {
        let row = page.lines().find(|line| line.starts_with(&format!("| `{name}` |")));
        let row = row.unwrap_or_else(|| panic!("{name} is not in docs/track.md"));
        if let Some(default) = default {
            assert_eq!(row.split('|').nth(2).map(str::trim), Some(&default[..]), "{name}");
        }
    }
}

/// What it shows of shapes that are not in the repository is not run.
#[test]
fn the_gallery_can_be_followed() {
    follow("docs/gallery.md");
}

#[test]
fn the_page_on_left_and_right_can_be_followed() {
    follow("docs/sides.md");
}

#[test]
fn the_readme_and_the_answers_can_be_followed() {
    follow("README.md");
    follow("docs/faq.md");
}

/// Long options and the defaults that their help tells.
fn options(command: &str) -> BTreeMap<String, Option<String>> {
    let help = mser3d([command, "-h"]);
    let mut entries: Vec<String> = Vec::new();
    for line in text(&help.stdout).lines().skip_while(|line| *line != "Options:") {
        let line = line.trim();
        match line.starts_with('-') {
            true => entries.push(line.to_owned()),
            // The rest of a description; or a heading, which does no harm.
            false => entries.iter_mut().last().into_iter().for_each(|entry| *entry += &format!(" {line}")),
        }
    }
    let option = |entry: &String| {
        let name = entry.split([' ', '.', ',']).find(|word| word.starts_with("--")).unwrap();
        let default = entry.split("[default: ").nth(1).map(|rest| rest.split(']').next().unwrap().to_owned());
        (name.to_owned(), default)
    };
    entries.iter().map(option).filter(|(name, _)| !["--help", "--version"].contains(&name.as_str())).collect()
}

#[test]
fn every_parameter_is_documented_with_its_default() {
    let page = fs::read_to_string(root().join("docs/parameters.md")).unwrap();
    let mut documented = BTreeMap::new();
    for line in page.lines().filter(|line| line.starts_with("| `--")) {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        assert_eq!(cells.len(), 7, "{line}");
        documented.insert(cells[1].trim_matches('`').to_owned(), cells[3].to_owned());
    }
    let options = options("detect");
    assert!(options.len() > 30);
    assert_eq!(documented.keys().collect::<Vec<_>>(), options.keys().collect::<Vec<_>>());
    for (name, default) in options {
        let said = &documented[&name];
        match default {
            Some(default) => assert_eq!(*said, default, "{name}"),
            None => assert!(["none", "off", "required"].contains(&said.as_str()), "{name} has no default"),
        }
    }
}

#[test]
fn every_field_and_array_of_a_result_is_documented() {
    let page = fs::read_to_string(root().join("docs/formats.md")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (result, matches) = (folder.path().join("result"), folder.path().join("matches"));
    let options = "--voxels 1500 --eigenpairs 20 --parts auto --quiet";
    let record = regions(&fixtures().join("human.glb"), &result, options);
    let keys = |value: &Value| value.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    let mut names = keys(&record);
    for part in ["voxelization", "spectrum", "run"] {
        names.extend(keys(&record[part]));
    }
    names.extend(keys(&record["regions"][0]));
    names.extend(keys(&record["trees"][0]));
    names.extend(keys(&record["parts"][0]));
    names.extend(keys(&record["parameters"]["parts"]));
    let arrays = mser3d_fileio::read_npz(&result.join("features.npz")).unwrap();
    names.extend(arrays.into_keys().filter(|name| !name.starts_with("tree") || name.starts_with("tree0")));
    let [match_, result, output] = ["match".as_ref(), result.as_os_str(), "-o".as_ref()];
    assert!(mser3d([match_, result, result, output, matches.as_os_str()]).status.success());
    let csv = fs::read_to_string(matches.join("matches.csv")).unwrap();
    names.extend(csv.lines().next().unwrap().split(',').map(str::to_owned));
    let moving = folder.path().join("moving");
    let figure = fixtures().join("human.glb");
    let track = ["track".as_ref(), figure.as_os_str(), "-o".as_ref(), moving.as_os_str()];
    let options = "--animation poses --frames 2 --voxels 1500 --quiet".split(' ').map(std::ffi::OsStr::new);
    assert!(mser3d(track.into_iter().chain(options)).status.success());
    let tracks = json(&moving.join("tracks.json"));
    names.extend(keys(&tracks));
    names.extend(["parameters", "frames"].iter().flat_map(|part| match &tracks[part] {
        Value::Array(list) => keys(&list[0]),
        part => keys(part),
    }));
    names.extend(keys(&tracks["tracks"][0]));
    names.extend(keys(&tracks["tracks"][0]["sightings"][0]));
    let csv = fs::read_to_string(moving.join("tracks.csv")).unwrap();
    names.extend(csv.lines().next().unwrap().split(',').map(str::to_owned));
    assert!(names.len() > 90);
    for name in names {
        assert!(page.contains(&format!("`{name}`")), "{name}");
    }
}

/// All pages of the repository.
fn pages() -> Vec<PathBuf> {
    let files = |folder: PathBuf| fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let crates = files(root().join("crates"));
    let folders =
        ["", "docs", "docs/results", "fixtures", "experiments", "xtask", "tests"].map(|f| root().join(f));
    let mut pages: Vec<PathBuf> = folders.into_iter().chain(crates).flat_map(files).collect();
    pages.retain(|path| path.extension().is_some_and(|e| e == "md"));
    pages.sort();
    pages
}

/// A page without its blocks of code.
fn prose(page: &Path) -> String {
    let text = fs::read_to_string(page).unwrap();
    let prose = parts(&text).into_iter().filter_map(|part| match part {
        Part::Prose(prose) => Some(prose),
        Part::Block(..) => None,
    });
    prose.collect()
}

/// What a link to each heading of a page ends in, as GitHub makes it.
fn anchors(page: &Path) -> Vec<String> {
    let headings = prose(page);
    let headings = headings.lines().filter_map(|line| line.strip_prefix('#'));
    let anchor = |heading: &str| -> String {
        let kept = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = kept.chars().filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    headings.map(anchor).collect()
}

#[test]
fn links_between_pages_lead_somewhere() {
    let (mut links, mut to_headings) = (0, 0);
    for page in pages() {
        for target in prose(&page).split("](").skip(1).map(|rest| rest.split(')').next().unwrap()) {
            if target.contains("://") {
                continue;
            }
            let (file, heading) = target.split_once('#').unwrap_or((target, ""));
            let there = if file.is_empty() { page.clone() } else { page.parent().unwrap().join(file) };
            assert!(there.exists(), "{} links to {target}, which is not there", page.display());
            links += 1;
            if !heading.is_empty() {
                let known = anchors(&there);
                assert!(
                    known.iter().any(|a| a == heading),
                    "{} links to {target}: {known:?}",
                    page.display()
                );
                to_headings += 1;
            }
        }
    }
    assert!(links > 100 && to_headings > 10, "{links} links, {to_headings} to headings");
}

//! `match`, `batch` and `query`, and the cache of spectra.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::common::*;
use serde_json::Value;

/// Few voxels, and nothing to say about that.
const SMALL: &str = "--voxels 1500 --eigenpairs 20 --quiet";

/// `batch` with options separated by spaces.
fn batch_command(inputs: &[PathBuf], collection: &Path, options: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
    command.arg("batch").args(inputs).arg("-o").arg(collection).args(options.split_whitespace());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// As [`batch_command`], of a run in which all shapes succeed: the summary.
fn batch(inputs: &[PathBuf], collection: &Path, options: &str) -> Value {
    let output = batch_command(inputs, collection, options).arg("--json").output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Five poses of one figure.
fn poses() -> Vec<PathBuf> {
    ["rest", "walk", "kick", "sit", "wave"].map(|pose| fixtures().join(format!("human_{pose}.off"))).into()
}

/// Every file below a folder but for locks; `regions.json` without times.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(&next).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() {
                folders.push(path);
            } else if !name.starts_with(".lock") {
                let mut bytes = fs::read(&path).unwrap();
                if name == "regions.json" {
                    let mut record: Value = serde_json::from_slice(&bytes).unwrap();
                    record.as_object_mut().unwrap().remove("run").unwrap();
                    bytes = record.to_string().into_bytes();
                }
                // Which has the checksum of these times.
                if name == "checksums.json" {
                    let mut sums: Value = serde_json::from_slice(&bytes).unwrap();
                    sums["files"].as_object_mut().unwrap().remove("regions.json");
                    bytes = sums.to_string().into_bytes();
                }
                files.insert(path.strip_prefix(folder).unwrap().to_owned(), bytes);
            }
        }
    }
    files
}

fn assert_same(a: &Path, b: &Path) {
    let (a, b) = (contents(a), contents(b));
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    for (path, bytes) in &a {
        assert!(bytes == &b[path], "{} differs", path.display());
    }
}

#[test]
fn a_batch_killed_at_any_moment_ends_as_if_undisturbed() {
    let folder = tempfile::tempdir().unwrap();
    let undisturbed = folder.path().join("undisturbed");
    let start = Instant::now();
    assert_eq!(batch(&poses(), &undisturbed, SMALL)["computed"], 5);
    let duration = start.elapsed();
    let mut found_unfinished = 0;
    for moment in 0..10u32 {
        let collection = folder.path().join(format!("killed-{moment}"));
        let mut child = batch_command(&poses(), &collection, SMALL).spawn().unwrap();
        std::thread::sleep(duration * moment / 10);
        child.kill().unwrap();
        child.wait().unwrap();
        found_unfinished += usize::from(!collection.join("shapes.parquet").exists());
        let summary = batch(&poses(), &collection, SMALL);
        assert_eq!(summary["computed"].as_u64().unwrap() + summary["kept"].as_u64().unwrap(), 5);
        assert_same(&collection, &undisturbed);
    }
    assert!(found_unfinished > 0, "no kill came in time");
}

#[test]
fn a_second_run_keeps_what_is_there_and_redoes_what_changed() {
    let folder = tempfile::tempdir().unwrap();
    let (shapes, collection) = (folder.path().join("shapes"), folder.path().join("collection"));
    fs::create_dir(&shapes).unwrap();
    for pose in poses().iter().take(3) {
        fs::copy(pose, shapes.join(pose.file_name().unwrap())).unwrap();
    }
    let inputs = [shapes.clone()];
    let counts = |summary: &Value| [&summary["computed"], &summary["kept"]].map(|n| n.as_u64().unwrap());
    assert_eq!(counts(&batch(&inputs, &collection, SMALL)), [3, 0]);
    let before = contents(&collection);
    assert_eq!(counts(&batch(&inputs, &collection, SMALL)), [0, 3]);
    assert_eq!(contents(&collection), before);
    // Another input, a result that is gone, other parameters.
    fs::copy(&poses()[3], shapes.join("human_walk.off")).unwrap();
    assert_eq!(counts(&batch(&inputs, &collection, SMALL)), [1, 2]);
    fs::remove_file(collection.join("human_rest/regions.json")).unwrap();
    fs::remove_dir_all(collection.join("human_rest")).unwrap();
    assert_eq!(counts(&batch(&inputs, &collection, SMALL)), [1, 2]);
    assert_eq!(counts(&batch(&inputs, &collection, "--voxels 1400 --eigenpairs 20")), [3, 0]);
}

#[test]
fn a_bad_shape_is_recorded_and_the_rest_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let collection = folder.path().join("collection");
    let bad = folder.path().join("bad.off");
    fs::write(&bad, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n").unwrap();
    let inputs = [poses()[0].clone(), bad.clone()];
    let output = batch_command(&inputs, &collection, SMALL).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("1 of 2 shapes failed"), "{}", text(&output.stderr));
    let failures = json(&collection.join("failures.json"));
    assert_eq!((failures.as_array().unwrap().len(), &failures[0]["name"]), (1, &"bad".into()));
    assert!(failures[0]["error"].as_str().unwrap().contains("bad.off:5"), "{failures}");
    assert!(collection.join("human_rest/regions.json").exists());
    // Once it is corrected, nothing of the failure remains.
    fs::copy(&poses()[1], &bad).unwrap();
    let summary = batch(&inputs, &collection, SMALL);
    assert_eq!((&summary["computed"], &summary["kept"]), (&1.into(), &1.into()));
    assert_eq!(json(&collection.join("failures.json")), Value::Array(Vec::new()));
    assert!(!collection.join("bad/failure.json").exists());
}

#[test]
fn shards_and_a_merge_make_the_same_collection() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, sharded) = (folder.path().join("whole"), folder.path().join("sharded"));
    let options = format!("{SMALL} --reference first --workers 1");
    batch(&poses(), &whole, &options);
    for shard in ["2/3", "1/3", "3/3"] {
        batch(&poses(), &sharded, &format!("{SMALL} --reference first --shard {shard}"));
        assert!(!sharded.join("shapes.parquet").exists());
    }
    let query = [Path::new("query"), &sharded, Path::new("human_rest")];
    assert_fails(&mser3d(query), 1, &["not finished", "--merge"]);
    let merged = batch(&[], &sharded, "--merge");
    assert_eq!((&merged["tables"]["shapes"], &merged["tables"]["failures"]), (&5.into(), &0.into()));
    assert_same(&sharded, &whole);
    // All poses got the scale of the first.
    let pitch =
        |name: &str| json(&whole.join(name).join("regions.json"))["parameters"]["voxelize"]["pitch"].clone();
    assert!(pitch("human_walk")["size"].is_number() && pitch("human_walk") == pitch("human_kick"));
}

#[test]
fn frames_of_an_animation_are_shapes() {
    let folder = tempfile::tempdir().unwrap();
    let figure = [fixtures().join("human.glb")];
    let summary = batch(&figure, folder.path(), &format!("{SMALL} --animation 0 --fps 1"));
    let shapes = summary["tables"]["shapes"].as_u64().unwrap();
    assert!(shapes > 1 && summary["computed"] == shapes, "{summary}");
    let last = json(&folder.path().join(format!("human-0-{:04}/regions.json", shapes - 1)));
    assert!(last["input"]["time"].as_f64().unwrap() > 0.0);
    let output = batch_command(&figure, folder.path(), "--animation dance --fps 1").output().unwrap();
    assert_fails(&output, 1, &["no animation \"dance\": it has 0"]);
}

#[test]
fn a_cached_spectrum_changes_nothing_and_a_broken_one_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let cached = format!("{SMALL} --cache {}", path("cache").display());
    regions(&poses()[0], &path("plain"), SMALL);
    for name in ["stored", "taken"] {
        regions(&poses()[0], &path(name), &cached);
        assert_same(&path(name), &path("plain"));
    }
    let spectra: Vec<_> = fs::read_dir(path("cache")).unwrap().map(|e| e.unwrap().path()).collect();
    assert_eq!(spectra.len(), 1);
    let whole = fs::read(&spectra[0]).unwrap();
    fs::write(&spectra[0], &whole[..whole.len() / 3]).unwrap();
    let output = detect(&poses()[0], &path("mended"), &cached);
    assert!(output.status.success() && text(&output.stderr).contains("computed again"));
    assert_same(&path("mended"), &path("plain"));
    assert_eq!(fs::read(&spectra[0]).unwrap(), whole);
}

#[test]
fn regions_of_two_poses_match_up_to_symmetry() {
    let folder = tempfile::tempdir().unwrap();
    let collection = folder.path().join("poses");
    batch(&poses()[..2], &collection, "--voxels 6000 --eigenpairs 60 --reference first");
    let [rest, walk] = ["rest", "walk"].map(|pose| collection.join(format!("human_{pose}")));
    let symmetry = fixtures().join("human_symmetry.txt");
    let matched = |options: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
        command.arg("match").args([&rest, &walk]).arg("--same-vertices").arg("--symmetry").arg(&symmetry);
        command.args(options).output().unwrap()
    };
    let output = matched(&["--json", "--html", "-o", folder.path().join("matches").to_str().unwrap()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    let matches = result["result"]["matches"].as_array().unwrap();
    let precision = &result["result"]["precision"];
    assert!(precision["precision"].as_f64().unwrap() >= 0.9, "{precision}");
    assert!(matches.len() >= 10, "{precision}");
    let record: Value =
        serde_json::from_str(&fs::read_to_string(rest.join("regions.json")).unwrap()).unwrap();
    let twin = |region: &Value| region["twin"].as_u64().map(|twin| twin as usize);
    let regions = record["regions"].as_array().unwrap();
    let pairs: Vec<[usize; 2]> =
        regions.iter().enumerate().filter_map(|(id, region)| Some([id, twin(region)?])).collect();
    assert!(pairs.len() >= 4, "limbs come in pairs: {pairs:?}");
    assert!(pairs.iter().all(|&[id, other]| twin(&regions[other]) == Some(id)), "{pairs:?}");
    assert_ne!(record["bodies"][0]["sidedness"]["kind"], "no-twins");
    // Without sides, left and right look alike.
    let plain = folder.path().join("plain");
    let options = "--voxels 6000 --eigenpairs 60 --reference first --descriptor sized-si-hks";
    batch(&poses()[..2], &plain, options);
    let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
    let both = [plain.join("human_rest"), plain.join("human_walk")];
    let result: Value =
        serde_json::from_slice(&command.arg("match").args(&both).arg("--json").output().unwrap().stdout)
            .unwrap();
    assert!(
        result["result"]["matches"].as_array().unwrap().iter().any(|m| m["symmetric_partner"].is_number())
    );
    let page = fs::read_to_string(folder.path().join("matches/matches.html")).unwrap();
    assert!(page.contains("<title>Parts and regions of human_walk matched to human_rest</title>"));
    let csv = fs::read_to_string(folder.path().join("matches/matches.csv")).unwrap();
    assert_eq!(csv.lines().count(), matches.len() + 1);
    assert!(fs::read(folder.path().join("matches/matches.png")).unwrap().starts_with(b"\x89PNG"));
    assert_eq!(fs::read(folder.path().join("matches/matches.json")).unwrap(), output.stdout);
    assert_fails(&matched(&["--min-overlap", "1.5"]), 2, &["threshold is 1.5", "at most 1"]);
    // One to one, no partner is taken twice.
    let output = matched(&["--json", "--rule", "one-to-one"]);
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    let matches = result["result"]["matches"].as_array().unwrap();
    let partners: std::collections::HashSet<u64> =
        matches.iter().map(|m| m["partner"].as_u64().unwrap()).collect();
    assert_eq!(partners.len(), matches.len());

    let query = |more: &[&str]| -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
        command.arg("query").arg(&collection).args(more).output().unwrap()
    };
    let closest = |more: &[&str]| -> Value {
        let output = query(more);
        assert!(output.status.success(), "{}", text(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let found = closest(&["human_rest", "-k", "3", "--json"]);
    for region in found["regions"].as_array().unwrap() {
        let closest = region["closest"].as_array().unwrap();
        assert!(closest.len() == 3 && closest.iter().all(|hit| hit["shape"] == "human_walk"));
    }
    let itself = closest(&["human_rest", "-k", "1", "--region", "2", "--include-itself", "--json"]);
    let hit = &itself["regions"][0]["closest"][0];
    assert_eq!(
        (&hit["shape"], &hit["region"], &hit["distance"]),
        (&"human_rest".into(), &2.into(), &0.0.into())
    );
    let page = folder.path().join("query.html");
    closest(&["human_rest", "-k", "2", "--json", "--html", page.to_str().unwrap()]);
    let page = fs::read_to_string(page).unwrap();
    let regions = found["regions"].as_array().unwrap().len();
    assert_eq!(page.matches("<img ").count(), 3 * regions);
    assert!(page.len() < 10_000_000 && page.contains("human_walk, region ") && !page.contains("http:"));
    assert_fails(&query(&["human_rest", "--region", "99"]), 2, &["--region 99", "numbered from 0"]);
}

#[test]
fn a_mirror_image_is_matched_to_the_other_side_unless_that_is_allowed() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let galloping = fixtures().join("quadruped_gallop.off");
    let file = fs::read_to_string(&galloping).unwrap();
    let vertices: usize = file.lines().nth(1).unwrap().split_whitespace().next().unwrap().parse().unwrap();
    let mirrored = |(number, line): (usize, &str)| {
        let words: Vec<&str> = line.split_whitespace().collect();
        match (number, &words[..]) {
            (0 | 1, _) => line.to_owned(),
            (n, [x, y, z]) if n < vertices + 2 => format!("{} {y} {z}", -x.parse::<f64>().unwrap()),
            (_, [three, a, b, c]) => format!("{three} {a} {c} {b}"),
            _ => panic!("{line}"),
        }
    };
    let image: Vec<String> = file.lines().enumerate().map(mirrored).collect();
    fs::write(path("image.off"), image.join("\n")).unwrap();
    let options = "--voxels 6000 --eigenpairs 60 --reliability 0 --quiet";
    regions(&galloping, &path("a"), options);
    regions(&path("image.off"), &path("b"), options);
    let matched = |more: &[&str]| -> Value {
        let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
        command.arg("match").args([path("a"), path("b")]).args(["--same-vertices", "--json"]).args(more);
        serde_json::from_slice(&command.output().unwrap().stdout).unwrap()
    };
    let record: Value =
        serde_json::from_str(&fs::read_to_string(path("a").join("regions.json")).unwrap()).unwrap();
    assert_eq!(record["bodies"][0]["sidedness"]["kind"], "sided");
    // The image has the same regions with the same numbers, but what was left is right.
    let strict = matched(&[]);
    assert_eq!(strict["result"]["mirrored"], false);
    let count = record["regions"].as_array().unwrap().len();
    let side =
        |region: &Value| record["regions"][region.as_u64().unwrap() as usize]["side"].as_f64().unwrap();
    let mut swapped = 0;
    for m in strict["result"]["matches"].as_array().unwrap() {
        let (own, of_partner) = (side(&m["region"]), side(&m["partner"]));
        assert!(
            m["symmetric_partner"].is_null() && (own.abs() < 1.0 || own * of_partner < -0.5),
            "{own} {of_partner} {m}"
        );
        swapped += usize::from(own.abs() == 1.0);
    }
    assert!(swapped >= 8, "{swapped} of {count}");
    let allowed = matched(&["--allow-mirror"]);
    assert_eq!(allowed["result"]["mirrored"], true);
    assert_eq!(allowed["result"]["precision"]["right"], count);
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    regions(&poses()[0], &path("a"), SMALL);
    regions(&poses()[0], &path("b"), "--voxels 1500 --eigenpairs 25 --quiet");
    regions(&poses()[0], &path("none"), &format!("{SMALL} --min-volume 0.7 --max-volume 0.71"));
    fs::create_dir(path("empty")).unwrap();
    let run = |command: &str, a: &str, b: &str| {
        mser3d([command.as_ref(), path(a).as_os_str(), path(b).as_os_str()])
    };
    assert_fails(&run("match", "a", "b"), 1, &["--eigenpairs 20 against 25", "detect one of them again"]);
    assert_fails(&run("match", "a", "none"), 1, &["none: this shape has no regions"]);
    assert_fails(&run("match", "a", "empty"), 1, &["empty: ", "no regions.json", "mser3d detect"]);
    assert_fails(&run("query", "a", "b"), 1, &["result of one shape, no collection"]);
    assert_fails(&run("query", "empty", "a"), 1, &["no collection", "mser3d batch"]);
    // As another version would have written it.
    fs::remove_file(path("b").join("checksums.json")).unwrap();
    let regions = path("b").join("regions.json");
    let record = fs::read_to_string(&regions).unwrap();
    fs::write(&regions, record.replacen("\"format\": 4", "\"format\": 77", 1)).unwrap();
    assert_fails(&run("match", "a", "b"), 1, &["format 77", "detect` again"]);
    let output = batch_command(&[path("empty")], &path("c"), "").output().unwrap();
    assert_fails(&output, 1, &["no meshes and no volumes in this folder"]);
    for shard in ["0/2", "3/2", "two"] {
        let output = batch_command(&poses(), &path("c"), &format!("--shard {shard}")).output().unwrap();
        assert_fails(&output, 2, &["shard", "I from 1 to N"]);
    }
    assert!(!path("c").exists());
    let output = batch_command(&[], &path("empty"), "--merge").output().unwrap();
    assert_fails(&output, 1, &["no results in this folder"]);
}

#[test]
fn two_batches_do_not_write_to_one_collection() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = batch_command(&poses(), folder.path(), "--voxels 20000 --eigenpairs 60").spawn().unwrap();
    // It has the collection once it begins a result.
    let begun = || {
        let mut entries = fs::read_dir(folder.path()).unwrap();
        entries.any(|e| e.unwrap().file_name().to_string_lossy().ends_with(".partial"))
    };
    let start = Instant::now();
    while !begun() {
        assert!(start.elapsed() < Duration::from_secs(60) && first.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(1));
    }
    let second = batch_command(&poses(), folder.path(), SMALL).output().unwrap();
    first.kill().unwrap();
    first.wait().unwrap();
    assert_fails(&second, 1, &["another batch is writing"]);
}

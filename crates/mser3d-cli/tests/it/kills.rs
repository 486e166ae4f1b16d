//! Every command is stopped by signals at moments all over its run: it ends within a second, with the right code, and what was there
//! before is there still, or the new in its place; nothing else.
//!
//! `MSER3D_KILLS=20` has each command killed twenty times, by SIGKILL too, and prints what came of it:
//! `MSER3D_KILLS=20 cargo test --release -p mser3d-cli --test it kills -- --nocapture`.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::io::{Read, Write};
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::common::{detect, fixtures, mser3d, text};

const SMALL: &str = "--voxels 2000 --eigenpairs 20 --quiet";

/// How each file of a folder looks, by its path in it.
type Snapshot = BTreeMap<String, Vec<u8>>;

fn snapshot(folder: &Path) -> Snapshot {
    fn add(root: &Path, folder: &Path, files: &mut Snapshot) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(root).unwrap().to_string_lossy().into_owned();
            if path.is_dir() {
                files.insert(format!("{name}/"), Vec::new());
                add(root, &path, files);
            } else if !path.file_name().unwrap().to_string_lossy().starts_with(".lock") {
                files.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    let mut files = Snapshot::new();
    add(folder, folder, &mut files);
    files
}

/// Files that differ from run to run, by the times in them; those of a frame are coloured when all are there.
fn varies(name: &str) -> bool {
    let (folder, last) = name.rsplit_once('/').unwrap_or(("", name));
    ["regions.json", "msv.json", "checksums.json"].contains(&last)
        || folder.starts_with("human-poses") && last == "surface.ply"
}

/// Made of all results of a collection: they go before the first result changes.
fn is_table(name: &str) -> bool {
    name.ends_with(".parquet")
        || ["failures.json", "tracks.json", "tracks.csv", "checksums.json"].contains(&name)
}

/// What is wrong with what a killed run left, if anything.
fn fault(before: &Snapshot, complete: &Snapshot, after: &Snapshot, hard: bool) -> Option<String> {
    let hidden = |name: &String| name.split('/').any(|part| part.starts_with('.'));
    if let Some(left) = after.keys().find(|name| !hard && hidden(name)) {
        return Some(format!("left behind: {left}"));
    }
    let folder = |name: &str| name.rsplit_once('/').map_or("", |(folder, _)| folder).to_owned();
    let mut folders: Vec<String> =
        after.keys().chain(before.keys()).filter(|n| !hidden(n)).map(|n| folder(n)).collect();
    folders.sort();
    folders.dedup();
    for of in folders {
        let files = |all: &Snapshot| -> Snapshot {
            let own = all.iter().filter(|(name, _)| folder(name) == of && !hidden(name));
            let own = own
                .map(|(name, bytes)| (name.clone(), if varies(name) { Vec::new() } else { bytes.clone() }));
            own.filter(|(name, _)| !name.ends_with('/') && !is_table(name)).collect()
        };
        let (old, new, found) = (files(before), files(complete), files(after));
        let record =
            |all: &Snapshot| all.keys().any(|n| n.ends_with("regions.json") || n.ends_with("msv.json"));
        // A record says that the other files belong to it. Whoever is killed without a word may have taken it away.
        let unsaid = hard && record(&old) && !record(&found);
        if found != old && found != new && !unsaid {
            let names = |all: &Snapshot| all.keys().cloned().collect::<Vec<_>>();
            return Some(format!("{of:?}: neither old nor new: {:?} of {:?}", names(&found), names(&new)));
        }
    }
    let broken = after.iter().find(|(name, bytes)| {
        let json = name.ends_with(".json") && serde_json::from_slice::<serde_json::Value>(bytes).is_err();
        let table = name.ends_with(".parquet") && !(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
        !hidden(name) && (json || table)
    });
    broken.map(|(name, _)| format!("half a file: {name}"))
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

fn send(signal: &str, child: &Child) {
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
}

/// Whether the tests run where Ctrl-C is ignored, as in scripts with `&`: then what they start ignores it too.
fn ignores(signal: u32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    u64::from_str_radix(mask.unwrap_or("0").trim(), 16).unwrap() >> (signal - 1) & 1 == 1
}

/// Seconds in which a process ended that was told to, and its code; killed and reported if it takes too long.
fn end(mut child: Child) -> (f64, Option<i32>, String) {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            let seconds = start.elapsed().as_secs_f64();
            let mut said = String::new();
            child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
            // As shells report it.
            let code = status.code().or(status.signal().map(|signal| 128 + signal));
            return (seconds, code, said);
        }
        if start.elapsed() > Duration::from_secs(120) {
            child.kill().unwrap();
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Kills a command again and again. `before` makes what is in the folder of its outputs, `arguments` takes that folder.
fn survives(command: &str, before: impl Fn(&Path), arguments: impl Fn(&Path) -> Vec<OsString>) {
    let root = tempfile::tempdir().unwrap();
    let path = |name: &str| root.path().join(name);
    fs::create_dir(path("before")).unwrap();
    before(&path("before"));
    let start = |out: &Path| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_mser3d"));
        program
            .arg(command)
            .args(arguments(out))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    };
    copy(&path("before"), &path("complete"));
    let began = Instant::now();
    let (_, code, said) = end(start(&path("complete")));
    let seconds = began.elapsed().as_secs_f64();
    assert_eq!(code, Some(0), "{command}: {said}");
    let (old, new) = (snapshot(&path("before")), snapshot(&path("complete")));
    let wanted = std::env::var("MSER3D_KILLS").ok().map(|text| text.parse::<usize>().unwrap());
    let signals: &[(&str, i32)] = match wanted {
        None => &[("-INT", 130), ("-TERM", 143)],
        Some(_) => &[("-INT", 130), ("-TERM", 143), ("-KILL", 0)],
    };
    let signals: Vec<_> = signals.iter().filter(|(name, _)| *name != "-INT" || !ignores(2)).collect();
    if ignores(2) {
        eprintln!("skipped: SIGINT is ignored where the tests run");
    }
    let kills = wanted.unwrap_or(10);
    let words =
        |said: &str| said.lines().last().is_some_and(|line| line.starts_with("mser3d: interrupted; "));
    let (mut slowest, mut late, mut interrupted, mut faults) = (0.0f64, 0, 0, Vec::new());
    for kill in 0..kills {
        let out = path(&format!("kill{kill}"));
        copy(&path("before"), &out);
        let (signal, expected) = signals[kill % signals.len()];
        // All over the run, in another order than the signals.
        let moment = (kill as f64 * 0.618_034 + 0.1).fract() * seconds;
        let child = start(&out);
        std::thread::sleep(Duration::from_secs_f64(moment));
        send(signal, &child);
        let (took, code, said) = end(child);
        let hard = *signal == "-KILL";
        let when = format!("{command}, {signal} after {moment:.3} s of {seconds:.3}");
        if !hard {
            slowest = slowest.max(took);
            late += usize::from(took > 1.0);
            match code {
                Some(0) => {}
                code if code == Some(*expected) && words(&said) => interrupted += 1,
                // Before it had begun to listen.
                code if code == Some(*expected) && said.is_empty() && moment < 0.2 => {}
                code => faults.push(format!("{when}: ends with {code:?}: {said}")),
            }
        }
        faults.extend(fault(&old, &new, &snapshot(&out), hard).map(|fault| format!("{when}: {fault}")));
        fs::remove_dir_all(out).unwrap();
    }
    println!(
        "{command}: {kills} kills, {interrupted} interrupted, slowest {slowest:.2} s, {} faults",
        faults.len()
    );
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    // Machines on which much else runs are late now and then.
    assert!(
        late <= kills / 5 && slowest < 5.0,
        "{command}: {late} of {kills} took more than a second, one {slowest} s"
    );
}

/// Results of two poses, and a collection of them.
fn results() -> &'static TempDir {
    static RESULTS: OnceLock<TempDir> = OnceLock::new();
    RESULTS.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        for name in ["human_rest", "human_kick"] {
            let output = detect(&fixtures().join(format!("{name}.off")), &folder.path().join(name), SMALL);
            assert!(output.status.success(), "{}", text(&output.stderr));
        }
        batch(&folder.path().join("all"), SMALL);
        folder
    })
}

fn poses() -> [PathBuf; 2] {
    ["human_rest.off", "human_kick.off"].map(|name| fixtures().join(name))
}

fn batch(out: &Path, options: &str) {
    let words = options.split_whitespace().map(OsString::from);
    let inputs = poses().map(OsString::from);
    let all = ["batch".into()].into_iter().chain(inputs).chain(["-o".into(), out.into()]).chain(words);
    let output = mser3d(all);
    assert!(output.status.success(), "{}", text(&output.stderr));
}

/// Words, in which `@` is the folder, and what comes in angle brackets is in the folder of results.
fn words(line: &str, out: &Path) -> Vec<OsString> {
    let word = |word: &str| match word.strip_prefix('<') {
        Some(name) => results().path().join(name).into(),
        None if word.starts_with('@') => out.join(word[1..].trim_start_matches('/')).into(),
        None if word.starts_with('%') => fixtures().join(&word[1..]).into(),
        None => OsString::from(word),
    };
    line.split_whitespace().map(word).collect()
}

/// The same command with other parameters has been through.
fn through(line: &'static str) -> impl Fn(&Path) {
    move |out| {
        let output = mser3d(words(line, out));
        assert!(output.status.success(), "{line}: {}", text(&output.stderr));
    }
}

/// A grey-value volume of noise.
fn noise(out: &Path) {
    let header = "{'descr': '|u1', 'fortran_order': False, 'shape': (64, 64, 64), }";
    let mut bytes = b"\x93NUMPY\x01\0\x76\0".to_vec();
    bytes.extend(format!("{header:<117}\n").bytes());
    let mut state = 7u32;
    bytes.extend((0..64 * 64 * 64).map(|_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    }));
    fs::write(out, bytes).unwrap();
}

#[test]
fn detect_survives_kills() {
    let line = "%human_rest.off -o @r --voxels 30000 --eigenpairs 60";
    survives("detect", through("detect %human_rest.off -o @r --voxels 2000 --eigenpairs 20 -q"), |out| {
        words(line, out)
    });
}

#[test]
fn batch_survives_kills() {
    let line = "%human_rest.off %human_kick.off -o @ --voxels 12000 --eigenpairs 40";
    survives("batch", |out| batch(out, SMALL), |out| words(line, out));
}

#[test]
fn track_survives_kills() {
    let line = "%human.glb --animation poses --frames 3 -o @ --voxels 6000 --eigenpairs 30 --glb";
    survives(
        "track",
        through("track %human.glb --animation poses --frames 3 -o @ --voxels 2000 --eigenpairs 20 -q"),
        |out| words(line, out),
    );
}

#[test]
fn voxelize_survives_kills() {
    let line = "%human_rest.off -o @m.nii.gz --voxels 3000000";
    survives("voxelize", through("voxelize %human_rest.off -o @m.nii.gz --voxels 1000"), |out| {
        words(line, out)
    });
}

#[test]
fn msv_survives_kills() {
    let before = |out: &Path| {
        noise(&out.join("noise.npy"));
        through("msv @noise.npy -o @r --max-area 0.4")(out);
    };
    survives("msv", before, |out| words("@noise.npy -o @r", out));
}

#[test]
fn inspect_survives_kills() {
    survives("inspect", |out| noise(&out.join("noise.npy")), |out| words("@noise.npy", out));
}

#[test]
fn pictures_and_pages_survive_kills() {
    survives("render", through("render <human_rest -o @r.png --height 100"), |out| {
        words("<human_rest -o @r.png --height 1000", out)
    });
    survives("view", through("view <human_rest -o @v.html --up z"), |out| {
        words("<human_rest -o @v.html", out)
    });
}

#[test]
fn export_match_and_query_survive_kills() {
    survives("export", through("export <human_rest -o @r.glb --parts"), |out| {
        words("<human_rest -o @r.glb", out)
    });
    survives("match", through("match <human_kick <human_rest -o @m"), |out| {
        words("<human_rest <human_kick -o @m --html", out)
    });
    survives("query", through("query <all <human_kick --html @q.html"), |out| {
        words("<all <human_rest --html @q.html", out)
    });
}

/// A command that waits for standard input, which does not come.
fn waiting() -> Child {
    let mut program = Command::new(env!("CARGO_BIN_EXE_mser3d"));
    let pipes =
        program.args(["inspect", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = pipes.spawn().unwrap();
    // Long enough to be listening.
    std::thread::sleep(Duration::from_millis(300));
    child
}

#[test]
fn a_command_that_waits_for_ever_ends_within_a_second() {
    let child = waiting();
    send("-TERM", &child);
    let (took, code, said) = end(child);
    assert!(took < 2.0 && code == Some(143) && said.contains("interrupted"), "{took} {code:?} {said}");
}

#[test]
fn a_second_signal_ends_it_at_once() {
    let mut quickest = f64::INFINITY;
    for _ in 0..3 {
        let child = waiting();
        send("-TERM", &child);
        std::thread::sleep(Duration::from_millis(60));
        send("-TERM", &child);
        let (took, code, _) = end(child);
        assert_eq!(code, Some(143));
        quickest = quickest.min(took);
    }
    assert!(quickest < 0.3, "{quickest}");
}

#[test]
fn under_nohup_a_closed_terminal_is_ignored() {
    let mut program = Command::new("sh");
    program.args(["-c", "trap '' HUP; exec \"$0\" inspect -", env!("CARGO_BIN_EXE_mser3d")]);
    let pipes = program.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = pipes.spawn().unwrap();
    std::thread::sleep(Duration::from_millis(400));
    send("-HUP", &child);
    std::thread::sleep(Duration::from_millis(900));
    assert!(child.try_wait().unwrap().is_none());
    let mesh = fs::read(fixtures().join("human_rest.off")).unwrap();
    child.stdin.take().unwrap().write_all(&mesh).unwrap();
    assert_eq!(end(child).1, Some(0));
    let child = waiting();
    send("-HUP", &child);
    let (_, code, said) = end(child);
    assert!(code == Some(129) && said.contains("interrupted"), "{code:?} {said}");
}

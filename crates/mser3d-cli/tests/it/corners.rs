//! Odd corners: inputs that are no files, names that command terminals, numbers at the ends of their ranges, little stack.

use std::ffi::OsStr;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::common::*;

const SMALL: &str = "--voxels 1500 --eigenpairs 20 --quiet";

fn program(arguments: &[impl AsRef<OsStr>]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
    command.args(arguments).stdin(Stdio::null());
    command
}

/// Runs a command that must not take for ever, with this on standard input.
fn ends(mut command: Command, input: &[u8]) -> Output {
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // What is refused may not be read.
    let _ = child.stdin.take().unwrap().write_all(input);
    let id = child.id().to_string();
    let (done, waiting) = std::sync::mpsc::channel::<()>();
    let watch = std::thread::spawn(move || {
        let late = waiting.recv_timeout(Duration::from_secs(60)).is_err();
        late && Command::new("kill").args(["-KILL", &id]).status().is_ok()
    });
    let output = child.wait_with_output().unwrap();
    let _ = done.send(());
    assert!(!watch.join().unwrap(), "it does not end");
    output
}

fn pipe(path: &Path) -> PathBuf {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
    path.to_owned()
}

#[test]
fn what_is_no_file_is_no_input() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    pipe(&path("p.off"));
    pipe(&path("p.nii"));
    fs::create_dir(path("d.off")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", path("z.ply")).unwrap();
    let out = path("out");
    for (name, why) in
        [("p.off", "a pipe"), ("p.nii", "a pipe"), ("d.off", "a folder"), ("z.ply", "a device")]
    {
        for command in ["detect", "inspect", "voxelize"] {
            let mut command = program(&[command.as_ref(), path(name).as_os_str()]);
            if name != "d.off" {
                command.current_dir(folder.path());
            }
            let output = ends(command, b"");
            assert_fails(&output, 1, &[name, "cannot be read", why]);
        }
    }
    assert_fails(&ends(program(&["msv".as_ref(), path("p.nii").as_os_str()]), b""), 1, &["p.nii", "a pipe"]);
    // Beside others it is a failure of its own; in a folder it is passed over.
    fs::copy(fixtures().join("human_rest.off"), path("a.off")).unwrap();
    let words = |inputs: &[&str]| -> Vec<PathBuf> {
        let inputs = inputs.iter().map(|name| path(name));
        ["batch".into()]
            .into_iter()
            .chain(inputs)
            .chain(["-o".into(), out.clone()])
            .chain(SMALL.split(' ').map(PathBuf::from))
            .collect()
    };
    let output = ends(program(&words(&["a.off", "p.off", "z.ply"])), b"");
    assert_eq!(output.status.code(), Some(1));
    let said = text(&output.stderr);
    assert!(
        said.contains("2 of 3 shapes failed") && said.contains("a pipe") && said.contains("a device"),
        "{said}"
    );
    assert!(out.join("a/regions.json").is_file());
    fs::remove_dir_all(&out).unwrap();
    let output = ends(program(&words(&["."])), b"");
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(json(&out.join("failures.json")), serde_json::json!([]));
}

#[test]
fn a_pipe_in_the_place_of_a_kept_file_does_not_hold_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let (cache, mesh) = (folder.path().join("cache"), fixtures().join("human_rest.off"));
    let run = |out: &str| {
        let options = SMALL.replace(" --quiet", "");
        let mut command = program(&["detect".as_ref(), mesh.as_os_str()]);
        command.arg("-o").arg(folder.path().join(out)).arg("--cache").arg(&cache).args(options.split(' '));
        ends(command, b"")
    };
    assert!(run("first").status.success());
    let kept = fs::read_dir(&cache).unwrap().next().unwrap().unwrap().path();
    fs::remove_file(&kept).unwrap();
    pipe(&kept);
    let output = run("second");
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("it is a pipe and no file"), "{}", text(&output.stderr));
    let arrays = |out: &str| fs::read(folder.path().join(out).join("features.npz")).unwrap();
    assert_eq!(arrays("first"), arrays("second"));
    // A record of a result, and a table of a collection.
    let record = folder.path().join("first/regions.json");
    fs::remove_file(&record).unwrap();
    pipe(&record);
    let first = folder.path().join("first");
    assert_fails(&ends(program(&["view".as_ref(), first.as_os_str()]), b""), 1, &["regions.json", "a pipe"]);
    pipe(&folder.path().join("regions.parquet"));
    let query =
        program(&["query".as_ref(), folder.path().as_os_str(), folder.path().join("second").as_os_str()]);
    assert_fails(&ends(query, b""), 1, &["regions.parquet", "a pipe"]);
}

#[test]
fn standard_input_is_an_input() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let mesh = fs::read(fixtures().join("human_rest.off")).unwrap();
    let run = |line: &str, input: &[u8]| {
        let mut command = program(&line.split(' ').collect::<Vec<_>>());
        command.current_dir(folder.path());
        ends(command, input)
    };
    let succeeds = |line: &str, input: &[u8]| {
        let output = run(line, input);
        assert!(output.status.success(), "{line}: {}", text(&output.stderr));
        text(&output.stdout).to_owned()
    };
    // What the contents tell needs no format; the results are those of the file.
    succeeds(&format!("detect - {SMALL}"), &mesh);
    regions(&fixtures().join("human_rest.off"), &path("file"), SMALL);
    let arrays = |out: &str| fs::read(path(out).join("features.npz")).unwrap();
    assert_eq!(arrays("stdin"), arrays("file"));
    let (own, of_file) = (json(&path("stdin/regions.json")), json(&path("file/regions.json")));
    assert_eq!(own["input"]["path"], "/dev/stdin");
    assert_eq!(own["input"]["sha256"], of_file["input"]["sha256"]);
    succeeds(&format!("detect /dev/stdin --format off -o again {SMALL}"), &mesh);
    assert_eq!(arrays("again"), arrays("file"));
    let told: serde_json::Value = serde_json::from_str(&succeeds("inspect - --json", &mesh)).unwrap();
    assert_eq!(told["format"], "OFF");
    // An animation is found in it too.
    let figure = fs::read(fixtures().join("human.glb")).unwrap();
    let told: serde_json::Value = serde_json::from_str(&succeeds("inspect - --json", &figure)).unwrap();
    assert_eq!(told["animations"][0]["name"], "poses");

    // Volumes: a mask of every kind that is written.
    let of_mask = SMALL.replace("--voxels 1500 ", "");
    for (number, name, format) in [(0, "m.nii.gz", "nifti"), (1, "m.nii", "nifti"), (2, "m.npy", "npy")] {
        succeeds(&format!("voxelize - --voxels 1500 -o {name}"), &mesh);
        let mask = fs::read(path(name)).unwrap();
        succeeds(&format!("detect - --format {format} -o of_{number} {of_mask}"), &mask);
        regions(&path(name), &path(&format!("file_{number}")), &of_mask);
        assert_eq!(arrays(&format!("of_{number}")), arrays(&format!("file_{number}")));
        assert!(succeeds(&format!("inspect - --format {format}"), &mask).contains("1 piece"));
        succeeds(&format!("msv - --format {format} -o msv_{number} --max-area 0.9"), &mask);
        // A page has no grey values then, and says so at once (nor regions, of a mask).
        let output = run(&format!("view msv_{number}"), b"");
        assert!(text(&output.stderr).contains("came from standard input"), "{}", text(&output.stderr));
        // Each label of it, which is read more than once.
        succeeds(&format!("detect - --format {format} --label all -o all_{number} {of_mask}"), &mask);
        assert!(path(&format!("all_{number}/stdin-001/regions.json")).is_file());
    }
    // A file may be named otherwise.
    fs::write(path("mesh.data"), &mesh).unwrap();
    succeeds("voxelize mesh.data --format off --voxels 1000", b"");
    assert!(path("mesh.nii.gz").is_file());

    assert_fails(
        &run("inspect - --format ply", &mesh),
        1,
        &["/dev/stdin", "contents are off", "--format off"],
    );
    assert_fails(&run("detect -", b"what is this?"), 1, &["--format", "obj, ", "nifti"]);
    assert_fails(&run("msv -", b""), 2, &["--format"]);
    assert_fails(&run("msv - --format off", &mesh), 2, &["a volume is one of"]);
    assert_fails(&run("detect - --format fbx", &mesh), 2, &["invalid value 'fbx'", "nifti"]);
    assert_fails(&run("inspect - --format off", b""), 1, &["/dev/stdin: the file is empty"]);
}

#[test]
fn names_do_not_command_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    // Red, a new title, a line that looks like one of ours, and writing that turns round.
    let name = "a\u{1b}[31m\u{1b}]0;t\u{7}\nmser3d: all is well\u{202e}\u{9b}.off";
    let mesh = folder.path().join(name);
    let good = fs::read(fixtures().join("human_rest.off")).unwrap();
    let out = folder.path().join("out\u{1b}[2J");
    let told = |command: Command, code: i32| {
        let output = ends(command, b"");
        assert_eq!(output.status.code(), Some(code), "{}", text(&output.stderr));
        for stream in [text(&output.stdout), text(&output.stderr)] {
            let commands = |c: char| c.is_control() && c != '\n' || ('\u{202a}'..='\u{202e}').contains(&c);
            assert!(!stream.contains(commands), "{stream:?}");
            assert!(!stream.lines().any(|line| line.starts_with("mser3d: all is well")), "{stream}");
        }
        format!("{}{}", text(&output.stdout), text(&output.stderr))
    };
    let with = |words: &[&OsStr], more: &str| {
        let mut command = program(words);
        command.args(more.split(' ').filter(|word| !word.is_empty()));
        command
    };
    let (detect, mesh_word, dash_o, out_word) =
        (OsStr::new("detect"), mesh.as_os_str(), OsStr::new("-o"), out.as_os_str());
    assert!(told(with(&[detect, mesh_word], ""), 1).contains("a\\u001b[31m\\u001b]0;t\\u0007\n"));
    fs::write(&mesh, "OFF\n1 1 \u{1b}[31m\n").unwrap();
    told(with(&["inspect".as_ref(), mesh_word], ""), 1);
    fs::write(&mesh, good).unwrap();
    let options = "--voxels 1500 --eigenpairs 20";
    assert!(told(with(&[detect, mesh_word, dash_o, out_word], options), 0).contains("out\\u001b[2J"));
    told(with(&[detect, mesh_word, dash_o, out_word], &format!("{options} -v")), 0);
    told(with(&["inspect".as_ref(), mesh_word], ""), 0);
    told(with(&["view".as_ref(), out_word], ""), 0);
    let collection = folder.path().join("all\u{1b}[2J");
    let batch = with(&["batch".as_ref(), mesh_word, dash_o, collection.as_os_str()], options);
    assert!(told(batch, 0).contains("a_[31m"));
    told(with(&["query".as_ref(), collection.as_os_str(), out_word], ""), 0);
    // What is damaged is named too.
    let verify = || with(&["verify".as_ref(), out_word], "");
    told(verify(), 0);
    fs::write(out.join("surface.ply"), "no mesh").unwrap();
    assert!(told(verify(), 1).contains("out\\u001b[2J"));
    // JSON says the same as ever.
    let output = ends(with(&["inspect".as_ref(), mesh_word], "--json"), b"");
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(told["path"], mesh.to_str().unwrap());
    // What the argument parser repeats.
    let output = ends(with(&[detect, mesh_word], "--voxels \u{1b}[31m"), b"");
    assert!(output.status.code() == Some(2) && !output.stderr.contains(&0x1b), "{}", text(&output.stderr));
}

#[test]
fn threads_beyond_all_use_cost_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, out) = (fixtures().join("human_rest.off"), |n: &str| folder.path().join(n));
    let start = Instant::now();
    let few = detect(&mesh, &out("few"), "--voxels 3000 --threads 2");
    let one = start.elapsed();
    let many = detect(&mesh, &out("many"), "--voxels 3000 --threads 1000");
    let other = start.elapsed() - one;
    assert!(few.status.success() && many.status.success());
    let said = text(&many.stderr);
    assert!(said.contains("--threads 1000: ") && said.contains("threads are used"), "{said}");
    assert!(!text(&few.stderr).contains("threads"));
    let arrays = |n: &str| fs::read(out(n).join("features.npz")).unwrap();
    assert_eq!(arrays("few"), arrays("many"));
    assert!(other < 5 * one + Duration::from_secs(2), "{one:?} {other:?}");
    let mut command = program(&["detect".as_ref(), mesh.as_os_str(), "-o".as_ref(), out("env").as_os_str()]);
    let output = command.args(["--voxels", "3000"]).env("RAYON_NUM_THREADS", "1000").output().unwrap();
    assert!(text(&output.stderr).contains("RAYON_NUM_THREADS=1000: "), "{}", text(&output.stderr));
    assert_fails(&detect(&mesh, &out("none"), "--threads 0"), 2, &["--threads 0", "at least 1"]);
}

#[test]
fn little_stack_is_enough() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).into_os_string();
    let mesh = fixtures().join("human_rest.off").into_os_string();
    let run = |arguments: &[&OsStr]| {
        let mut shell = Command::new("sh");
        shell.args(["-c", "ulimit -s 64; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_mser3d")]).args(arguments);
        // The workers' stacks too.
        let output = ends(shell, b"");
        assert!(output.status.success(), "{arguments:?}: {:?} {}", output.status, text(&output.stderr));
    };
    let word = OsStr::new;
    run(&[word("inspect"), &mesh]);
    run(&[word("voxelize"), &mesh, word("-o"), &path("m.npy")]);
    run(&[word("detect"), &mesh, word("-o"), &path("a"), word("--voxels"), word("5000"), word("-q")]);
    run(&[word("batch"), &mesh, word("-o"), &path("all"), word("--voxels"), word("5000")]);
    run(&[word("render"), &path("a")]);
    run(&[word("view"), &path("a")]);
    run(&[word("match"), &path("a"), &path("a")]);
    run(&[word("query"), &path("all"), &path("a")]);
    run(&[word("--help")]);
}

#[test]
fn numbers_at_the_ends_of_their_ranges_are_told_as_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, out) = (fixtures().join("human_rest.off"), folder.path().join("out"));
    let fails = |options: &str, words: &[&str]| {
        let output = detect(&mesh, &out, &format!("-q {options}"));
        let said = text(&output.stderr);
        assert!([1, 2].contains(&output.status.code().unwrap()), "{options}: {said}");
        for word in words {
            assert!(said.contains(word), "{options}: {word:?} is not in: {said}");
        }
        for word in ["inf ", "inf;", "NaN", " 0 MB", "000000000000", "0.0000 "] {
            assert!(!said.contains(word), "{options}: {word:?} is in: {said}");
        }
        said.to_owned()
    };
    fails(
        "--pitch 1e-300",
        &["a pitch of 1e-300 needs a box of more than 10^308 voxels", "pitch of at least"],
    );
    fails("--pitch 5e-324", &["a pitch of 5e-324", "pitch of at least"]);
    fails("--pitch 1e300", &["at pitch 1e300"]);
    fails("--resolution 18446744073709551615", &["a pitch of 9.488937413593136e-20", "pitch of at least"]);
    fails("--reliability 18446744073709551615", &["reliability.deformations", "at most 10000"]);
    let said =
        fails("--pitch 1e-6 --max-box-voxels 2", &["needs a box of 7.4", "limit of 2; raise max_box_voxels"]);
    assert!(!said.contains("pitch of at least"), "{said}");
    // What is advised does.
    for limit in [100u64, 10_000, 1_000_000] {
        let said = fails(&format!("--pitch 1e-7 --max-box-voxels {limit}"), &["pitch of at least"]);
        let advice = said.split("at least ").nth(1).unwrap().split(' ').next().unwrap();
        let output = detect(
            &mesh,
            &out,
            &format!("-q --pitch {advice} --max-box-voxels {limit} --eigenpairs 20 --reliability 0"),
        );
        assert!(!text(&output.stderr).contains("needs a box"), "{advice}: {}", text(&output.stderr));
    }
    // A limit of less than a megabyte is told as it is.
    let said = fails("--voxels 3000 --memory-limit 1", &["more than the limit of 1 MB"]);
    assert!(said.contains(" MB that the program holds, more"), "{said}");
    // A tiny body: what would resolve it better is no 0.0000.
    let tiny = folder.path().join("tiny.off");
    fs::write(&tiny, box_off([0.0; 3], [1e-7, 1e-8, 1e-7])).unwrap();
    let output = mser3d([
        "voxelize".as_ref(),
        tiny.as_os_str(),
        "--pitch".as_ref(),
        "1e-8".as_ref(),
        "-o".as_ref(),
        folder.path().join("t.npy").as_os_str(),
    ]);
    assert!(text(&output.stderr).contains("a pitch of 5.0000e-9 "), "{}", text(&output.stderr));
}

#[test]
fn a_query_for_more_than_there_is_gives_all() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, all) = (fixtures().join("human_rest.off"), folder.path().join("all"));
    let mut batch = program(&["batch".as_ref(), mesh.as_os_str(), "-o".as_ref(), all.as_os_str()]);
    assert!(batch.args(SMALL.split(' ')).status().unwrap().success());
    for k in ["10000000000000", "18446744073709551615"] {
        let query = [
            "query".as_ref(),
            all.as_os_str(),
            "human_rest".as_ref(),
            "--include-itself".as_ref(),
            "--json".as_ref(),
        ];
        let output = program(&query).args(["-k", k]).output().unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let searched = found["searched"].as_u64().unwrap();
        let regions = found["regions"].as_array().unwrap();
        assert!(
            searched > 3
                && regions.iter().all(|hits| hits["closest"].as_array().unwrap().len() as u64 == searched)
        );
    }
}

//! What the system may do to a run: odd names, full disks, signals.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::common::*;

const SMALL: &str = "--voxels 1500 --eigenpairs 20 --quiet";

#[test]
fn names_need_not_be_unicode() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &[u8]| folder.path().join(OsStr::from_bytes(name));
    let mesh = path(b"\xff.off");
    // Some file systems take no such names.
    if fs::copy(fixtures().join("human_rest.off"), &mesh).is_err() {
        return;
    }
    let result = path(b"\xfe");
    regions(&mesh, &result, SMALL);
    let succeeds = |arguments: &[&OsStr]| {
        let output = mser3d(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    };
    let (result, collection, matches) = (result.as_os_str(), path(b"\xfd"), path(b"\xfc"));
    let word = OsStr::new;
    succeeds(&[word("inspect"), mesh.as_os_str(), word("--json")]);
    succeeds(&[word("view"), result]);
    succeeds(&[word("render"), result, word("-o"), path(b"\xfb.png").as_os_str()]);
    succeeds(&[word("match"), result, result, word("-o"), matches.as_os_str(), word("--json")]);
    let mut batch = vec![word("batch"), mesh.as_os_str(), word("-o"), collection.as_os_str()];
    batch.extend(SMALL.split(' ').map(word));
    succeeds(&batch);
    succeeds(&[word("query"), collection.as_os_str(), result]);
    // A shape that fails is recorded under such a name too.
    fs::write(&mesh, "OFF").unwrap();
    let failed = mser3d(&batch);
    assert!(text(&failed.stderr).contains("1 of 1 shapes failed"), "{}", text(&failed.stderr));
}

#[test]
fn a_full_disk_is_an_error() {
    let Ok(full) = File::options().write(true).open("/dev/full") else { return };
    let mesh = fixtures().join("human_rest.off");
    for arguments in
        [vec!["inspect".as_ref(), mesh.as_os_str()], vec!["completions".as_ref(), "zsh".as_ref()]]
    {
        let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
        let output = command.args(arguments).stdout(full.try_clone().unwrap()).output().unwrap();
        assert_fails(&output, 1, &["standard output"]);
    }
}

#[test]
fn an_interrupted_run_leaves_nothing() {
    if ignores(2) {
        return eprintln!("skipped: SIGINT is ignored where the tests run");
    }
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("a/b");
    let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
    command.arg("detect").arg(fixtures().join("human_rest.off")).arg("-o").arg(&out);
    // Far more than it will come to.
    command.args(["--voxels", "1000000"]).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    while !out.exists() {
        assert!(child.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(1));
    }
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    assert_fails(
        &child.wait_with_output().unwrap(),
        130,
        &["interrupted", "nothing is left half written", "again"],
    );
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
}

#[test]
fn a_file_is_no_result() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    for path in [file.as_path(), Path::new("/nowhere")] {
        assert_fails(&mser3d(["view".as_ref(), path.as_os_str()]), 1, &["no regions.json", "mser3d detect"]);
    }
}

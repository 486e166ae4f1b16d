//! What surrounds the commands: completions, manual pages, the version and the log.

use std::fs;
use std::process::{Command, Output};

use crate::common::*;

const COMMANDS: [&str; 7] = ["detect", "inspect", "render", "view", "match", "batch", "query"];

#[test]
fn every_shell_learns_every_command() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let output = mser3d(["completions", shell]);
        assert!(output.status.success() && output.stderr.is_empty());
        let script = text(&output.stdout);
        for word in COMMANDS.into_iter().chain(["reference-measure"]) {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    assert_fails(&mser3d(["completions", "dos"]), 2, &["dos", "bash", "zsh"]);
}

#[test]
fn bash_completes_commands_options_and_values() {
    // Where there is a bash.
    if Command::new("bash").arg("--version").output().is_err() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("completions");
    fs::write(&script, mser3d(["completions", "bash"]).stdout).unwrap();
    let complete = |words: &str| {
        let last = words.split(' ').count() - 1;
        let program = format!(
            "source '{}'; COMP_WORDS=({words}); COMP_CWORD={last}; _mser3d mser3d \"${{COMP_WORDS[-1]}}\" \
             \"${{COMP_WORDS[-2]}}\"; echo \"${{COMPREPLY[@]}}\"",
            script.display()
        );
        let output = Command::new("bash").args(["--norc", "-c", &program]).output().unwrap();
        text(&output.stdout).trim().to_owned()
    };
    assert_eq!(complete("mser3d ins"), "inspect");
    assert_eq!(complete("mser3d detect --eigen"), "--eigenpairs");
    assert_eq!(complete("mser3d detect --weight com"), "commute");
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("share/man1");
    let output = mser3d(["man".as_ref(), "-o".as_ref(), pages.as_os_str()]);
    assert!(output.status.success() && output.stdout.is_empty(), "{}", text(&output.stderr));
    let page = |name: &str| fs::read_to_string(pages.join(name)).unwrap();
    for command in COMMANDS {
        assert!(page(&format!("mser3d-{command}.1")).contains(".SH SYNOPSIS"), "{command}");
        assert!(page("mser3d.1").contains(&format!("mser3d\\-{command}(1)")), "{command}");
    }
    assert!(page("mser3d-detect.1").contains("\\-\\-time\\-scale"));
}

#[test]
fn the_version_is_one_line_or_tells_the_build() {
    let first = format!("mser3d {}\n", env!("CARGO_PKG_VERSION"));
    assert_eq!(text(&mser3d(["-V"]).stdout), first);
    assert_eq!(text(&mser3d(["detect", "-V"]).stdout), first.replace(' ', "-detect "));
    let output = mser3d(["--version"]);
    let long = text(&output.stdout);
    assert!(long.starts_with(&first), "{long}");
    for (name, words) in
        [("commit", ""), ("target", "-"), ("profile", "e"), ("compiler", "rustc 1."), ("SIMD", "")]
    {
        let line = long.lines().find(|line| line.starts_with(name));
        let value = line.and_then(|line| line.strip_prefix(name)).unwrap_or_default().trim();
        assert!(!value.is_empty() && value.contains(words), "{name} in {long}");
    }
}

fn logged(flags: &[&str], environment: &str) -> Output {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
    command.args(flags).arg("detect").arg(fixtures().join("human_rest.off")).arg("-o").arg(folder.path());
    command.args(["--voxels", "1500", "--eigenpairs", "20", "--quiet"]).env("RUST_LOG", environment);
    command.output().unwrap()
}

#[test]
fn the_log_is_silent_until_asked() {
    let log = |flags: &[&str], environment: &str| {
        let output = logged(flags, environment);
        assert!(output.status.success() && output.stdout.is_empty());
        text(&output.stderr).to_owned()
    };
    assert_eq!(log(&[], ""), "");
    let stages = log(&["-v"], "");
    for words in ["vertices=3756", "voxelized voxels=", "eigenpairs=20 solver=", "found regions"] {
        assert!(stages.contains(words), "{words} is not in {stages}");
    }
    assert!(!stages.contains("component tree"));
    assert!(log(&["-vv"], "").contains("component tree"));
    assert!(log(&[], "debug").contains("component tree"));
    let some = log(&[], "mser3d::regions=debug");
    assert!(some.contains("component tree") && !some.contains("voxelized"), "{some}");
    assert_fails(&logged(&[], "mser3d=loud"), 2, &["RUST_LOG=mser3d=loud", "RUST_LOG=info"]);
}

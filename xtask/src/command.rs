//! Running other programs, never longer than a given time.

use std::ffi::OsStr;
use std::io::{Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Enough for what is done at once.
pub const MINUTE: Duration = Duration::from_secs(60);

/// Runs a command without input and gives what it printed.
///
/// # Errors
/// What it printed on both streams when it failed; that it was stopped after `limit`; why it did not start.
pub fn output(command: &mut Command, limit: Duration) -> Result<String, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    // Into files, since nobody reads a pipe while waiting.
    let file = || tempfile::tempfile().map_err(|e| format!("a file for the output of {name}: {e}"));
    let share = |file: &std::fs::File| file.try_clone().map(Stdio::from).map_err(|e| format!("{name}: {e}"));
    let (mut out, mut err) = (file()?, file()?);
    command.stdin(Stdio::null()).stdout(share(&out)?).stderr(share(&err)?);
    let status = wait(command, limit)?;
    let mut text = String::new();
    for file in [&mut out, &mut err].into_iter().take(if status.success() { 1 } else { 2 }) {
        let mut bytes = Vec::new();
        file.rewind().and_then(|()| file.read_to_end(&mut bytes)).map_err(|e| format!("{name}: {e}"))?;
        text.push_str(&String::from_utf8_lossy(&bytes));
    }
    if status.success() { Ok(text) } else { Err(format!("{name}: {status}: {}", text.trim())) }
}

fn wait(command: &mut Command, limit: Duration) -> Result<ExitStatus, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let mut child = command.spawn().map_err(|e| format!("{name}: {e}"))?;
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait().map_err(|e| format!("{name}: {e}"))? {
            return Ok(status);
        }
        if start.elapsed() > limit {
            let _ = child.kill();
            let _ = child.wait();
            return Err(format!("{name}: stopped, for it took longer than {limit:?}"));
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Whether a program is there and does what it is asked to.
pub fn runs(program: &str, arguments: &[&str]) -> bool {
    let mut command = Command::new(program);
    command.args(arguments).env("DEBIAN_FRONTEND", "noninteractive");
    output(&mut command, Duration::from_secs(600)).is_ok()
}

/// Runs the command `mser3d` of this workspace, as a user would, and says so.
pub fn mser3d<A: AsRef<OsStr>>(arguments: &[A]) -> Result<(), String> {
    let words: Vec<_> = arguments.iter().map(|a| a.as_ref().to_string_lossy()).collect();
    println!("mser3d {}", words.join(" "));
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../Cargo.toml");
    let mut command = Command::new(cargo);
    command.args(["run", "--quiet", "--release", "--bin", "mser3d", "--manifest-path"]).arg(root).arg("--");
    output(command.args(arguments), Duration::from_secs(1800)).map(drop)
}

/// Builds the command `mser3d` of this workspace; where it is.
pub fn program() -> Result<PathBuf, String> {
    mser3d(&["--version"])?;
    Ok(release().join(format!("mser3d{}", std::env::consts::EXE_SUFFIX)))
}

/// Where release builds of this workspace are.
fn release() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    target.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../target")).join("release")
}

/// Builds an example of one of this workspace's crates; where its program is.
pub fn example(package: &str, name: &str) -> Result<PathBuf, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut command = Command::new(cargo);
    command.args(["build", "--quiet", "--release", "--package", package, "--example", name]);
    output(command.arg("--manifest-path").arg(root.join("Cargo.toml")), Duration::from_secs(1800))?;
    Ok(release().join("examples").join(format!("{name}{}", std::env::consts::EXE_SUFFIX)))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn shell(script: &str, limit: Duration) -> Result<String, String> {
        output(Command::new("sh").args(["-c", script]), limit)
    }

    #[test]
    fn output_and_failures_are_told() {
        assert_eq!(shell("echo a; echo b >&2", MINUTE).unwrap(), "a\n");
        let error = shell("echo a; echo b >&2; exit 3", MINUTE).unwrap_err();
        assert!(error.starts_with("sh: exit status: 3: a\nb"), "{error}");
        assert!(output(&mut Command::new("no-such-program"), MINUTE).is_err());
    }

    #[test]
    fn what_takes_too_long_is_stopped() {
        let error = shell("sleep 60", Duration::from_millis(50)).unwrap_err();
        assert!(error.contains("longer than 50ms"), "{error}");
    }
}

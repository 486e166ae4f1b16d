//! Tells the program which sources, compiler and profile it was built from, for `mser3d --version`.
//!
//! Without git, or in a package from a registry, the commit is the one the package was made from, or unknown.

use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    let tell = |name: &str, value: &str| println!("cargo::rustc-env=MSER3D_{name}={value}");
    let variable = |name: &str| std::env::var(name).unwrap_or_default();
    let manifest = PathBuf::from(variable("CARGO_MANIFEST_DIR"));
    println!("cargo::rerun-if-changed=build.rs");
    tell("COMMIT", &checkout(&manifest).or_else(|| package(&manifest)).unwrap_or_default());
    tell("TARGET", &variable("TARGET"));
    tell("PROFILE", &variable("PROFILE"));
    tell("RUSTC", &output(&variable("RUSTC"), &["--version"], &manifest).unwrap_or_default());
}

/// The commit of the workspace's own checkout, marked when tracked sources differ from it.
fn checkout(manifest: &Path) -> Option<String> {
    let workspace = manifest.parent()?.parent()?;
    let git = |arguments: &[&str]| output("git", arguments, workspace);
    // A copy inside of somebody else's repository has nothing to do with its commits.
    let top = PathBuf::from(git(&["rev-parse", "--show-toplevel"])?);
    if top.canonicalize().ok()? != workspace.canonicalize().ok()? {
        return None;
    }
    let commit = git(&["rev-parse", "--short=10", "HEAD"])?;
    // The log of HEAD grows with each commit and checkout.
    let log = workspace.join(git(&["rev-parse", "--git-path", "logs/HEAD"])?);
    let crates = std::fs::read_dir(workspace.join("crates")).ok()?.flatten();
    let sources = crates.map(|entry| entry.path().join("src"));
    for path in sources.chain([log, workspace.join("Cargo.lock")]).filter(|path| path.exists()) {
        println!("cargo::rerun-if-changed={}", path.display());
    }
    let changes = git(&["status", "--porcelain", "--untracked-files=no", "--", "crates", "Cargo.lock"])?;
    Some(if changes.is_empty() { commit } else { commit + ", with changes" })
}

/// The commit that cargo notes in the packages it makes.
fn package(manifest: &Path) -> Option<String> {
    let note = std::fs::read_to_string(manifest.join(".cargo_vcs_info.json")).ok()?;
    let (_, rest) = note.split_once("\"sha1\"")?;
    let commit: String = rest.chars().skip_while(|c| !c.is_ascii_hexdigit()).take(10).collect();
    commit.chars().all(|c| c.is_ascii_hexdigit()).then_some(commit)
}

/// What a program prints, if it runs and succeeds.
fn output(program: &str, arguments: &[&str], folder: &Path) -> Option<String> {
    let output = Command::new(program).args(arguments).current_dir(folder).output().ok()?;
    let text = String::from_utf8(output.stdout).ok().filter(|_| output.status.success())?;
    Some(text.trim().to_owned())
}

//! `cargo xtask package`: the crates as crates.io would get them, compiled, and one of them used by a fresh project.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use flate2::read::GzDecoder;

/// What `cargo xtask package` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// Package what is not committed too
    #[arg(long)]
    allow_dirty: bool,
}

/// The crate that the fresh project depends on, and runs the example of.
const PICKED: &str = "mser3d-comptree";

/// Packages all crates that are published, and checks that they compile from their packages and that one alone serves.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize()?;
    let target = workspace.join("target/packaged");
    let packages = target.join("package");
    if packages.exists() {
        fs::remove_dir_all(&packages)?;
    }
    let mut package = Command::new(env!("CARGO"));
    package.current_dir(&workspace).args(["package", "--workspace", "--locked", "--quiet", "--no-verify"]);
    package.arg("--target-dir").arg(&target);
    for kept in ["xtask", "mser3d-experiments", "mser3d-tests"] {
        package.args(["--exclude", kept]);
    }
    if arguments.allow_dirty {
        package.arg("--allow-dirty");
    }
    succeeds(&mut package)?;
    let folder = tempfile::tempdir()?;
    let all = folder.path().join("all");
    let crates = unpack(&packages, &all)?;

    write_workspace(&all, &crates, &workspace)?;
    let mut check = Command::new(env!("CARGO"));
    check.current_dir(&all).args(["check", "--workspace", "--quiet"]);
    // With the workspace's profiles, what it has compiled of other people's crates serves here too.
    succeeds(check.env("CARGO_TARGET_DIR", workspace.join("target")))?;
    let names: Vec<_> = crates.iter().map(|c| c.name.as_str()).collect();
    println!("packaged, and compiled from their packages: {}", names.join(", "));

    let project = folder.path().join("fresh");
    let picked = crates.iter().find(|c| c.name == PICKED).ok_or("the picked crate was not packaged")?;
    write_project(&project, &crates, picked, &workspace)?;
    let mut build = Command::new(env!("CARGO"));
    build.current_dir(&project).args(["run", "--quiet"]).env("CARGO_TARGET_DIR", target.join("fresh"));
    succeeds(&mut build)?;
    println!("a fresh project that depends on {PICKED} alone builds and runs the example of its README");
    Ok(())
}

/// A crate, unpacked.
struct Unpacked {
    name: String,
    version: String,
    folder: PathBuf,
}

/// Unpacks every `NAME-VERSION.crate` of a folder.
fn unpack(packages: &Path, into: &Path) -> Result<Vec<Unpacked>, Box<dyn Error>> {
    let version = env!("CARGO_PKG_VERSION");
    let mut crates = Vec::new();
    for entry in fs::read_dir(packages)? {
        let path = entry?.path();
        let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let Some(name) = file.strip_suffix(&format!("-{version}.crate")) else { continue };
        tar::Archive::new(GzDecoder::new(fs::File::open(&path)?)).unpack(into)?;
        let folder = into.join(format!("{name}-{version}"));
        for needed in ["README.md", "LICENSE-MIT", "LICENSE-APACHE"] {
            if !folder.join(needed).is_file() {
                return Err(format!("{name}: its package has no {needed}").into());
            }
        }
        crates.push(Unpacked { name: name.to_owned(), version: version.to_owned(), folder });
    }
    crates.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(crates)
}

/// Makes a workspace of the unpacked crates, with the versions and the profiles of everything else.
fn write_workspace(folder: &Path, crates: &[Unpacked], workspace: &Path) -> Result<(), Box<dyn Error>> {
    let manifest = fs::read_to_string(workspace.join("Cargo.toml"))?;
    let profiles = manifest.find("[profile.").map_or("", |at| &manifest[at..]);
    let members = "[workspace]\nresolver = \"3\"\nmembers = [\"*\"]\n\n";
    fs::write(folder.join("Cargo.toml"), format!("{members}{}\n{profiles}", patches(crates)))?;
    fs::copy(workspace.join("Cargo.lock"), folder.join("Cargo.lock"))?;
    Ok(())
}

/// What makes cargo take the unpacked crates for those of crates.io.
fn patches(crates: &[Unpacked]) -> String {
    let lines = crates.iter().map(|c| format!("{} = {{ path = {:?} }}\n", c.name, c.folder));
    format!("[patch.crates-io]\n{}", lines.collect::<String>())
}

/// A project that knows the crates by version alone, as if they came from crates.io.
fn write_project(
    project: &Path,
    crates: &[Unpacked],
    picked: &Unpacked,
    workspace: &Path,
) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(project.join("src"))?;
    let manifest = format!(
        "[package]\nname = \"fresh\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n[dependencies]\n{} = \"{}\"\n\n{}",
        picked.name,
        picked.version,
        patches(crates)
    );
    fs::write(project.join("Cargo.toml"), manifest)?;
    // The versions that everything else was tested with.
    fs::copy(workspace.join("Cargo.lock"), project.join("Cargo.lock"))?;
    let readme = fs::read_to_string(picked.folder.join("README.md"))?;
    let example = readme.split("```rust\n").nth(1).and_then(|rest| rest.split("```").next());
    let example = example.ok_or("its README has no example")?;
    let lines = example.lines().map(|line| line.strip_prefix("# ").unwrap_or(line));
    let body: String = lines.map(|line| format!("    {line}\n")).collect();
    fs::write(
        project.join("src/main.rs"),
        format!(
            "fn main() -> Result<(), Box<dyn std::error::Error>> {{\n{body}    .map_err(Into::into)\n}}\n"
        ),
    )?;
    Ok(())
}

fn succeeds(command: &mut Command) -> Result<(), Box<dyn Error>> {
    let status = command.status()?;
    if status.success() { Ok(()) } else { Err(format!("{command:?} failed: {status}").into()) }
}

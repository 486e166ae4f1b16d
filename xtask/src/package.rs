//! `cargo xtask package`: the crates as crates.io would get them, built, and one of them used by a fresh project.

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

/// Packages all crates that are published, which builds each from its package, and checks that one alone serves.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize()?;
    let target = workspace.join("target/packaged");
    let mut package = Command::new(env!("CARGO"));
    package.current_dir(&workspace).args(["package", "--workspace", "--locked", "--quiet", "--target-dir"]);
    package.arg(&target).args([
        "--exclude",
        "xtask",
        "--exclude",
        "mser3d-experiments",
        "--exclude",
        "mser3d-tests",
    ]);
    // Nobody looks into these builds with a debugger.
    package.env("CARGO_PROFILE_DEV_DEBUG", "0");
    if arguments.allow_dirty {
        package.arg("--allow-dirty");
    }
    forget_older_packages(&target)?;
    succeeds(&mut package)?;
    let folder = tempfile::tempdir()?;
    let crates = unpack(&target.join("package"), folder.path())?;
    println!("packaged and built: {}", crates.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", "));

    let project = folder.path().join("fresh");
    let picked = crates.iter().find(|c| c.name == PICKED).ok_or("the picked crate was not packaged")?;
    write_project(&project, &crates, picked, &workspace)?;
    let mut build = Command::new(env!("CARGO"));
    build.current_dir(&project).args(["run", "--quiet"]).env("CARGO_TARGET_DIR", target.join("fresh"));
    succeeds(&mut build)?;
    println!("a fresh project that depends on {PICKED} alone builds and runs the example of its README");
    Ok(())
}

/// Removes what cargo unpacked and built of our crates when they were packaged before. It would take these in place of new
/// ones of the same version. (What crates.io has is unpacked elsewhere.)
fn forget_older_packages(target: &Path) -> Result<(), Box<dyn Error>> {
    for built in fs::read_dir(target.join("debug/.fingerprint")).into_iter().flatten() {
        let built = built?;
        if built.file_name().to_string_lossy().starts_with("mser3d") {
            fs::remove_dir_all(built.path())?;
        }
    }
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".cargo")));
    let Ok(registries) = fs::read_dir(home.unwrap_or_default().join("registry/src")) else { return Ok(()) };
    for registry in registries {
        let registry = registry?;
        // A registry in a folder has no host before the dash.
        if !registry.file_name().to_string_lossy().starts_with('-') {
            continue;
        }
        for package in fs::read_dir(registry.path())? {
            let package = package?;
            let name = package.file_name().to_string_lossy().into_owned();
            if name.starts_with("mser3d") && name.ends_with(&format!("-{}", env!("CARGO_PKG_VERSION"))) {
                fs::remove_dir_all(package.path())?;
            }
        }
    }
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

/// A project that knows the crates by version alone, as if they came from crates.io.
fn write_project(
    project: &Path,
    crates: &[Unpacked],
    picked: &Unpacked,
    workspace: &Path,
) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(project.join("src"))?;
    let mut manifest = format!(
        "[package]\nname = \"fresh\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n[dependencies]\n{} = \"{}\"\n\n\
         [patch.crates-io]\n",
        picked.name, picked.version
    );
    for c in crates {
        manifest += &format!("{} = {{ path = {:?} }}\n", c.name, c.folder);
    }
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

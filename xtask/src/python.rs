//! `cargo xtask python`: the Python package, from a fresh virtual environment to its tests, and its wheel to the checks of
//! those who publish.
//!
//! Packages come from PyPI. Where Python, its venv or PyPI is missing, this is skipped, and said so.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use crate::command::{MINUTE, output};

/// Optimizing all crates takes minutes on a small machine.
const BUILD: Duration = Duration::from_secs(3600);
/// Installing packages, or running all tests.
const WHILE: Duration = Duration::from_secs(1200);

/// What `cargo xtask python` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// Fail when Python or a package is missing, instead of skipping
    #[arg(long)]
    require: bool,
}

/// Builds, installs, tests and checks the package.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize()?;
    let package = workspace.join("crates/mser3d-py");
    let folder = workspace.join("target/python");
    let python = match environment(&folder.join("venv")) {
        Ok(python) => python,
        Err(why) if arguments.require => return Err(why.into()),
        Err(why) => {
            println!("skipped: {why}");
            return Ok(());
        }
    };
    // What the workspace has compiled serves here too.
    let target = workspace.join("target");
    let manifest = package.join("Cargo.toml");
    let mut format = cargo("fmt", &manifest);
    output(format.arg("--check"), MINUTE)?;
    let mut lint = cargo("clippy", &manifest);
    lint.args(["--locked", "--quiet", "--target-dir"]).arg(&target).args(["--", "-D", "warnings"]);
    output(&mut lint, BUILD)?;

    let start = Instant::now();
    let mut install = pip(&python, &["install", "--quiet"]);
    install.arg(format!("{}[test]", package.display()));
    install.env("CARGO_TARGET_DIR", &target);
    output(&mut install, BUILD)?;
    println!("installed from the checkout in {:.0} s", start.elapsed().as_secs_f64());

    // Whatever of these can be had: tests that need one say that they are skipped.
    let peers = "higra robust_laplacian trimesh rtree meshio scikit-learn tqdm hypothesis dask[dataframe] distributed \
                 nbclient ipykernel lapy pyfmaps polyscope";
    for peer in peers.split_whitespace() {
        let mut install = pip(&python, &["install", "--quiet", "--only-binary", ":all:", peer]);
        if output(&mut install, WHILE).is_err() {
            println!("without {peer}, which cannot be installed");
        }
    }
    let start = Instant::now();
    let mut tests = Command::new(&python);
    tests.args(["-m", "pytest", "-q", "-rs"]).arg(&package).current_dir(&folder);
    print!("{}", output(&mut tests, WHILE)?);
    println!("tested in {:.0} s", start.elapsed().as_secs_f64());

    let wheels = folder.join("wheels");
    let _ = std::fs::remove_dir_all(&wheels);
    let mut wheel = pip(&python, &["wheel", "--quiet", "--no-deps", "--wheel-dir"]);
    wheel.arg(&wheels).arg(&package).env("CARGO_TARGET_DIR", &target);
    output(&mut wheel, BUILD)?;
    let built = std::fs::read_dir(&wheels)?.next().ok_or("no wheel was built")??.path();
    let name = built.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if !name.contains("-abi3-") {
        return Err(format!("{name} is for one version of Python only").into());
    }
    for (tool, words) in [("twine", &["check", "--strict"][..]), ("abi3audit", &["--strict"][..])] {
        let mut install = pip(&python, &["install", "--quiet", tool]);
        match output(&mut install, WHILE) {
            Err(why) if arguments.require => return Err(why.into()),
            Err(_) => println!("skipped: {tool} cannot be installed"),
            Ok(_) => {
                let mut check = Command::new(&python);
                check.arg("-m").arg(tool).args(words).arg(&built);
                output(&mut check, WHILE)?;
                println!("{tool} finds nothing wrong with {name}");
            }
        }
    }
    Ok(())
}

/// A fresh virtual environment with pip.
fn environment(folder: &Path) -> Result<PathBuf, String> {
    let host = if cfg!(windows) { "python" } else { "python3" };
    let mut make = Command::new(host);
    make.args(["-m", "venv", "--clear"]).arg(folder);
    output(&mut make, Duration::from_secs(120))
        .map_err(|e| format!("there is no Python with venv and pip: {e}"))?;
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let mut install = pip(&python, &["install", "--quiet", "--timeout", "15", "--retries", "1", "numpy"]);
    output(&mut install, WHILE).map_err(|e| format!("PyPI cannot be reached: {e}"))?;
    Ok(python)
}

/// A command of cargo on the package, which is a workspace of its own.
fn cargo(command: &str, manifest: &Path) -> Command {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.arg(command).arg("--manifest-path").arg(manifest);
    cargo
}

fn pip(python: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(python);
    command.args(["-m", "pip", "--disable-pip-version-check", "--no-input"]).args(words);
    command
}

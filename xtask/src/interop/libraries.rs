use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::command::{MINUTE, output};

/// Where the pinned versions and the checks are.
pub const TOOLS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/interop");

/// Installing one package, the largest of which has 120 MB.
const INSTALL: Duration = Duration::from_secs(400);

/// The libraries that could be had, and why not the others.
pub struct Libraries {
    python: Result<PathBuf, String>,
    /// By package: why it is missing, if it is.
    packages: BTreeMap<String, Result<(), String>>,
    node: Result<PathBuf, String>,
}

impl Libraries {
    /// Makes a virtual environment and a `node_modules` in a folder, or takes those from the last time.
    pub fn set_up(folder: &Path) -> Result<Self, String> {
        let python = virtual_environment(&folder.join("venv"));
        let mut packages = BTreeMap::new();
        if let Ok(python) = &python {
            for requirement in read("requirements.txt")?.split_whitespace() {
                let name = requirement.split("==").next().unwrap_or(requirement);
                packages.insert(name.to_owned(), install(python, requirement));
            }
        }
        Ok(Self { python, packages, node: node_modules(&folder.join("node")) })
    }

    /// A Python with these packages, or what is missing.
    pub fn python(&self, packages: &[&str]) -> Result<&Path, String> {
        let python = self.python.as_ref().map_err(String::clone)?;
        for name in packages {
            match self.packages.get(*name) {
                Some(Ok(())) => {}
                Some(Err(reason)) => return Err(format!("{name} cannot be installed: {reason}")),
                None => return Err(format!("{name} is not in requirements.txt")),
            }
        }
        Ok(python)
    }

    /// Node in the folder of its modules, or what is missing.
    pub fn node(&self) -> Result<Command, String> {
        let folder = self.node.as_ref().map_err(String::clone)?;
        let mut command = Command::new("node");
        command.current_dir(folder);
        Ok(command)
    }
}

fn virtual_environment(folder: &Path) -> Result<PathBuf, String> {
    let place = if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" };
    let python = folder.join(place);
    let works = |python: &Path| output(Command::new(python).args(["-m", "pip", "--version"]), MINUTE).is_ok();
    if works(&python) {
        return Ok(python);
    }
    let host = if cfg!(windows) { "python" } else { "python3" };
    let made =
        output(Command::new(host).args(["-m", "venv", "--clear"]).arg(folder), Duration::from_secs(120));
    made.map_err(|e| brief(&format!("no Python with venv and pip: {e}")))?;
    if works(&python) { Ok(python) } else { Err("the new virtual environment has no pip".into()) }
}

/// Installs one package in its pinned version, unless it is there. What it depends on is pinned too.
fn install(python: &Path, requirement: &str) -> Result<(), String> {
    let mut command = Command::new(python);
    command.args([
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "--no-input",
        "--no-deps",
    ]);
    command.args(["--only-binary", ":all:", "--timeout", "15", "--retries", "1", requirement]);
    output(&mut command, INSTALL).map(drop).map_err(|e| brief(&e))
}

fn node_modules(folder: &Path) -> Result<PathBuf, String> {
    output(Command::new("node").arg("--version"), MINUTE).map_err(|e| brief(&e))?;
    let at = |e: std::io::Error| format!("{}: {e}", folder.display());
    std::fs::create_dir_all(folder).map_err(at)?;
    std::fs::write(folder.join("package.json"), read("package.json")?).map_err(at)?;
    let npm = if cfg!(windows) { "npm.cmd" } else { "npm" };
    let mut command = Command::new(npm);
    command.args(["install", "--no-audit", "--no-fund", "--no-package-lock", "--ignore-scripts"]);
    command.args(["--fetch-retries=1", "--fetch-timeout=15000"]).current_dir(folder);
    output(&mut command, INSTALL).map_err(|e| brief(&e))?;
    Ok(folder.to_owned())
}

fn read(name: &str) -> Result<String, String> {
    let path = Path::new(TOOLS).join(name);
    std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))
}

/// Package managers explain at length; the first line that speaks of an error is enough here.
fn brief(text: &str) -> String {
    let speaks = |line: &&str| line.to_ascii_lowercase().contains("error");
    text.lines().find(speaks).or_else(|| text.lines().next()).unwrap_or_default().trim().to_owned()
}

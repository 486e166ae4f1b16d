//! The released program, and the shapes it is run on.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::resources::{Usage, of_process};
use crate::pose_sets::in_repository;

/// Sets of poses and persons, and the rest pose of each.
pub const SETS: [(&str, &str); 3] = [
    ("human", "fixtures/human_rest.off"),
    ("makehuman", "../shared/data/makehuman/00_rest.off"),
    ("people", "../shared/data/people/man_rest.off"),
];

/// The program `mser3d` of this workspace, built as it is released.
pub struct Program(PathBuf);

impl Program {
    pub fn build() -> Result<Self, Box<dyn Error>> {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut command = Command::new(cargo);
        command.args(["build", "--quiet", "--release", "--package", "mser3d-cli", "--manifest-path"]);
        if !command.arg(in_repository("Cargo.toml")).status()?.success() {
            return Err("mser3d could not be built".into());
        }
        // Beside this program: both are release builds of one workspace.
        let name = format!("mser3d{}", std::env::consts::EXE_SUFFIX);
        Ok(Self(std::env::current_exe()?.with_file_name(name)))
    }

    /// Runs one of its commands into a new folder.
    pub fn run(
        &self,
        command: &str,
        input: &Path,
        output: &Path,
        options: &[&str],
    ) -> Result<Usage, Box<dyn Error>> {
        if output.exists() {
            fs::remove_dir_all(output)?;
        }
        let mut process = Command::new(&self.0);
        of_process(process.arg(command).arg(input).arg("-o").arg(output).arg("--quiet").args(options))
    }
}

/// The rest pose of a body by its name, where it is here.
pub fn body(name: &str) -> Option<PathBuf> {
    let (_, path) = SETS.into_iter().find(|set| set.0 == name)?;
    Some(in_repository(path)).filter(|path| path.exists())
}

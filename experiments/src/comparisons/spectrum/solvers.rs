//! Our solvers and the peers: which are here, and how each is run in a process of its own.

use std::error::Error;
use std::path::Path;
use std::process::Command;

use super::cases::{Case, Shape};
use crate::comparisons::python::{Python, PythonArguments};
use mser3d::shape::Choice;
use mser3d::spectral::Eigensolver;

/// Who solves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solver {
    Ours(Eigensolver),
    Spectra,
    ScipyCholmod,
    ScipySuperLu,
    Lapy,
}

/// Where the peers are installed.
pub struct Peers {
    python: Python,
    versions: Vec<(Solver, String)>,
}

impl Solver {
    /// As the tables call it.
    pub fn label(self) -> &'static str {
        match self {
            Self::Ours(Eigensolver::Auto) => "mser3d",
            Self::Ours(Eigensolver::Filter) => "mser3d filter",
            Self::Ours(Eigensolver::ShiftInvert) => "mser3d shift-invert",
            Self::Ours(Eigensolver::Multigrid) => "mser3d multigrid",
            Self::Spectra => "Spectra + CHOLMOD",
            Self::ScipyCholmod => "SciPy + CHOLMOD",
            Self::ScipySuperLu => "SciPy + SuperLU",
            Self::Lapy => "LaPy",
        }
    }

    /// How to get it.
    pub fn advice(self) -> &'static str {
        match self {
            Self::Ours(_) => "",
            Self::Spectra => {
                "apt-get install g++ libspectra-dev libeigen3-dev libsuitesparse-dev libopenblas-dev"
            }
            Self::ScipyCholmod => {
                "apt-get install libsuitesparse-dev libopenblas-dev; pip install scipy 'scikit-sparse<0.5'"
            }
            Self::ScipySuperLu => "pip install scipy",
            Self::Lapy => "pip install lapy cholespy",
        }
    }

    /// The solvers worth running on a case: ours first, and the oracle next.
    pub fn of(case: &Case) -> Vec<Self> {
        let surface = matches!(case.shape, Shape::Surface(..));
        let size = case.size();
        let mut solvers = match &case.shape {
            _ if case.is_for_completeness() => {
                return vec![
                    Self::Ours(Eigensolver::Filter),
                    Self::Ours(Eigensolver::ShiftInvert),
                    Self::ScipyCholmod,
                ];
            }
            Shape::Body(..) if size <= 100_000 => {
                vec![Self::Ours(Eigensolver::Auto), Self::Ours(Eigensolver::ShiftInvert)]
            }
            // What is chosen above six million voxels, and what is chosen below.
            Shape::Body(..) if size > 500_000 => {
                vec![Self::Ours(Eigensolver::Multigrid), Self::Ours(Eigensolver::Filter)]
            }
            _ => vec![Self::Ours(Eigensolver::Auto)],
        };
        // A factorization of a solid of a million voxels takes 7 GB.
        if size <= 500_000 {
            solvers.extend([Self::ScipyCholmod, Self::Spectra]);
        }
        if size <= 100_000 {
            solvers.push(Self::ScipySuperLu);
        }
        if surface {
            solvers.push(Self::Lapy);
        }
        solvers
    }
}

/// Debian's packages that Spectra and scikit-sparse are compiled with.
const LIBRARIES: [&str; 5] =
    ["g++", "libspectra-dev", "libeigen3-dev", "libsuitesparse-dev", "libopenblas-dev"];

impl Peers {
    /// Looks for the peers, and installs them first if asked to.
    pub fn find(arguments: &PythonArguments) -> Result<Self, Box<dyn Error>> {
        let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers");
        let packages: &[&[&str]] = &[
            &["numpy"],
            &["scipy"],
            &["lapy"],
            &["cholespy"],
            // The newest needs SuiteSparse 7; the one before takes what the system has.
            &["scikit-sparse", "scikit-sparse<0.5"],
        ];
        arguments.install_libraries(&LIBRARIES);
        let python = Python::find(arguments, packages)?;
        let mut versions = Vec::new();
        if let Some(version) = compile_spectra(&sources.join("spectra.cpp"), &python.folder.join("spectra")) {
            versions.push((Solver::Spectra, version));
        }
        let probe = python.probe("spectrum.py");
        for solver in [Solver::ScipyCholmod, Solver::ScipySuperLu, Solver::Lapy] {
            if let Some(version) = probe[python_name(solver)].as_str() {
                versions.push((solver, version.to_string()));
            }
        }
        Ok(Self { python, versions })
    }

    /// Whether a solver can run.
    pub fn has(&self, solver: Solver) -> bool {
        matches!(solver, Solver::Ours(_)) || self.versions.iter().any(|(s, _)| *s == solver)
    }

    /// Versions of those that are here, one a line.
    pub fn versions(&self) -> Vec<String> {
        self.versions.iter().map(|(solver, version)| format!("{}: {version}", solver.label())).collect()
    }

    /// What is not here and how to get it.
    pub fn missing(&self) -> Vec<String> {
        [Solver::Spectra, Solver::ScipyCholmod, Solver::ScipySuperLu, Solver::Lapy]
            .into_iter()
            .filter(|&solver| !self.has(solver))
            .map(|solver| format!("no {} (to get it: {})", solver.label(), solver.advice()))
            .collect()
    }

    /// Where problems and solutions are written.
    pub fn folder(&self) -> &Path {
        &self.python.folder
    }

    /// The command that solves a case; a peer writes its solution to `solution`.
    pub fn command(
        &self,
        solver: Solver,
        case: &Case,
        problem: &Path,
        solution: &Path,
    ) -> Result<Command, Box<dyn Error>> {
        let numbers = [case.eigenpairs.to_string(), case.tolerance.to_string()];
        let mut command = match solver {
            Solver::Ours(solver) => return our_command(solver, case),
            Solver::Spectra => Command::new(self.python.folder.join("spectra")),
            _ => {
                let mut command = self.python.script("spectrum.py");
                command.arg(python_name(solver));
                command
            }
        };
        command.arg(problem).args(numbers).arg(solution);
        Ok(command)
    }
}

/// The command that solves a case by a solver of ours and prints the answer.
pub fn our_command(solver: Eigensolver, case: &Case) -> Result<Command, Box<dyn Error>> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(["bench", "spectrum", "--child", &case.name, solver.name()]);
    Ok(command)
}

fn python_name(solver: Solver) -> &'static str {
    match solver {
        Solver::ScipySuperLu => "scipy-superlu",
        Solver::Lapy => "lapy",
        _ => "scipy-cholmod",
    }
}

/// Compiles the Spectra peer, and says which versions of its headers were found.
fn compile_spectra(source: &Path, program: &Path) -> Option<String> {
    let folders = ["-I/usr/include/eigen3", "-I/usr/include/suitesparse"];
    let compiled = Command::new("g++")
        .args(["-O3", "-march=native", "-std=c++17"])
        .args(folders)
        .arg(source)
        .arg("-o")
        .arg(program)
        .arg("-lcholmod")
        .output();
    compiled.ok().filter(|output| output.status.success())?;
    let versions = r#"
        #include <Spectra/Util/Version.h>
        #include <Eigen/Core>
        #include <cholmod.h>
        SPECTRA_MAJOR_VERSION SPECTRA_MINOR_VERSION SPECTRA_PATCH_VERSION
        EIGEN_WORLD_VERSION EIGEN_MAJOR_VERSION EIGEN_MINOR_VERSION
        CHOLMOD_MAIN_VERSION CHOLMOD_SUB_VERSION CHOLMOD_SUBSUB_VERSION
    "#;
    let file = program.with_extension("versions.cpp");
    std::fs::write(&file, versions).ok()?;
    let output = Command::new("g++").args(["-E", "-P"]).args(folders).arg(&file).output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout);
    let mut lines: Vec<Vec<&str>> =
        text.lines().rev().take(3).map(|line| line.split_whitespace().collect()).collect();
    lines.reverse();
    let dotted: Vec<String> = lines.iter().map(|numbers| numbers.join(".")).collect();
    let [spectra, eigen, cholmod] = dotted.as_slice() else { return None };
    Some(format!("Spectra {spectra}, Eigen {eigen}, CHOLMOD {cholmod}"))
}

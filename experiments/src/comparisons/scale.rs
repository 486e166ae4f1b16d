//! `cargo xtask bench scale`: the whole program at two numbers of voxels. The finer run has to find the coarser one's regions again.

mod again;

use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use mser3d_results::Record;

use super::program::{Program, body};
use super::resources::{Usage, processor};
use again::Regions;

/// What `cargo xtask bench scale` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// Bodies by name: human, makehuman, people
    #[arg(long, value_delimiter = ',', default_values_t = ["human".to_string(), "makehuman".to_string()])]
    bodies: Vec<String>,
    /// Voxels of the coarse run and of the fine one
    #[arg(long, value_delimiter = ',', default_values_t = [1_000_000, 10_000_000])]
    voxels: Vec<usize>,
    /// The program's --memory-limit, MB
    #[arg(long)]
    memory_limit: Option<u64>,
    /// Folder for scale.md [default: docs/results]
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Eigenpairs, and their tolerance.
const EIGENPAIRS: usize = 30;
const TOLERANCE: f64 = 1e-4;
/// Overlap from which on a region is found again.
const FOUND: f64 = 0.9;

/// What two runs took, and what the second found again.
pub struct Scale {
    /// What each took. The peak is that of the run up to its results.
    pub usage: [Usage; 2],
    /// The solver that each took.
    pub solvers: [String; 2],
    /// Best overlap of each region of the coarse run.
    pub overlaps: Vec<f64>,
}

impl Scale {
    /// Runs the program twice and compares.
    pub fn measure(
        program: &Program,
        mesh: &Path,
        voxels: [usize; 2],
        memory_limit: Option<u64>,
    ) -> Result<Self, Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        let [eigenpairs, tolerance] = [EIGENPAIRS.to_string(), TOLERANCE.to_string()];
        let limit = memory_limit.map(|limit| limit.to_string());
        let run = |number: usize| -> Result<(Usage, Record, Regions), Box<dyn Error>> {
            let output = folder.path().join(number.to_string());
            let size = voxels[number].to_string();
            let mut options = vec!["--eigenpairs", &eigenpairs, "--tolerance", &tolerance, "--voxels", &size];
            if let Some(limit) = &limit {
                options.extend(["--memory-limit", limit]);
            }
            let usage = program.run("detect", mesh, &output, &options)?;
            let (record, regions) = (Record::load(&output)?, Regions::load(&output)?);
            // The results of a hundred million voxels are 22 GB.
            std::fs::remove_dir_all(&output)?;
            let peak = record.run.peak_memory_bytes.map_or(f64::NAN, |bytes| bytes as f64);
            Ok((Usage { peak, ..usage }, record, regions))
        };
        let (coarse, of_coarse, coarser) = run(0)?;
        let (fine, of_fine, finer) = run(1)?;
        let solvers = [of_coarse, of_fine].map(|record| record.bodies[0].spectrum.report.solver.to_string());
        Ok(Self { usage: [coarse, fine], solvers, overlaps: coarser.found_again(&finer)? })
    }

    /// What was found again, in words.
    pub fn found(&self) -> String {
        let found = self.overlaps.iter().filter(|&&overlap| overlap >= FOUND).count();
        let least = self.overlaps.iter().copied().fold(1.0, f64::min);
        format!("{found} of {} regions found again at {FOUND}, least overlap {least:.3}", self.overlaps.len())
    }
}

/// Runs the bodies, and prints and writes the table.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let program = Program::build()?;
    let &[coarse, fine] = &arguments.voxels[..] else { return Err("give two numbers of voxels".into()) };
    let limit = arguments.memory_limit;
    let given = limit.map_or(String::new(), |limit| format!(" --memory-limit {limit}"));
    let mut page = format!(
        "# The same shape in more voxels\n\n\
         Made by `cargo xtask bench scale --voxels {coarse},{fine}{given}`: `mser3d detect` with {EIGENPAIRS} eigenpairs of a residual \
         of {TOLERANCE:e}, from the mesh to all files, a process of its own. A region of the coarse run is found again if one of \
         the fine run overlaps it by {FOUND}, as intersection over union of volumes.\n\nMachine: {}.\n\n\
         | body | voxels | eigenpairs by | CPU s | wall s | peak MB | regions of the coarse run |\n|---|---|---|---|---|---|---|\n",
        processor()
    );
    for name in &arguments.bodies {
        let Some(mesh) = body(name) else {
            println!("{name}: its mesh is not here");
            continue;
        };
        let scale = Scale::measure(&program, &mesh, [coarse, fine], limit)?;
        let found = [String::new(), scale.found()];
        for (at, voxels) in [coarse, fine].into_iter().enumerate() {
            let Usage { cpu, wall, peak } = scale.usage[at];
            let line = format!(
                "| {name} | {voxels} | {} | {cpu:.1} | {wall:.1} | {:.0} | {} |",
                scale.solvers[at],
                peak / 1e6,
                found[at]
            );
            println!("{line}");
            writeln!(page, "{line}")?;
        }
    }
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/results");
    std::fs::write(arguments.output.as_deref().unwrap_or(&default).join("scale.md"), page)?;
    Ok(())
}

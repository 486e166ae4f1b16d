//! `cargo xtask bench scale`: the whole program on the same shape in more and more voxels, what its stages take, and whether each
//! run finds the regions of the one before again.

mod again;

use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use mser3d::Stage;
use mser3d::shape::Choice;
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
    /// Voxels of each run
    #[arg(long, value_delimiter = ',', default_values_t = [45_000, 1_000_000, 10_000_000])]
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
/// The stages of a run that measures no reliability.
const STAGES: [Stage; 5] =
    [Stage::Voxelize, Stage::Spectrum, Stage::Regions, Stage::Descriptors, Stage::Parts];

/// What a run took, and what it found.
pub struct Run {
    /// About how many voxels.
    pub voxels: usize,
    /// What it took. The peak is that of the run up to its results.
    pub usage: Usage,
    /// Who solved for the eigenpairs.
    pub solver: String,
    /// Wall seconds of each of the stages.
    pub stages: [f64; STAGES.len()],
    /// Best overlap of each region of the run before; none for the first.
    pub overlaps: Vec<f64>,
}

impl Run {
    /// Runs the program at one number of voxels after the other, and compares each run with the one before.
    pub fn measure_all(
        program: &Program,
        mesh: &Path,
        voxels: &[usize],
        memory_limit: Option<u64>,
    ) -> Result<Vec<Self>, Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        let output = folder.path().join("found");
        let [eigenpairs, tolerance] = [EIGENPAIRS.to_string(), TOLERANCE.to_string()];
        let limit = memory_limit.map(|limit| limit.to_string());
        let (mut runs, mut before): (Vec<Self>, Option<Regions>) = (Vec::new(), None);
        for &voxels in voxels {
            let size = voxels.to_string();
            let mut options = vec!["--eigenpairs", &eigenpairs, "--tolerance", &tolerance, "--voxels", &size];
            if let Some(limit) = &limit {
                options.extend(["--memory-limit", limit]);
            }
            let usage = program.run("detect", mesh, &output, &options)?;
            let (record, regions) = (Record::load(&output)?, Regions::load(&output)?);
            // The results of a hundred million voxels are 22 GB.
            std::fs::remove_dir_all(&output)?;
            let peak = record.run.peak_memory_bytes.map_or(f64::NAN, |bytes| bytes as f64);
            let seconds = |stage: Stage| -> f64 {
                record.run.stages.iter().filter(|told| told.stage == stage).map(|told| told.seconds).sum()
            };
            runs.push(Self {
                voxels,
                usage: Usage { peak, ..usage },
                solver: record.bodies[0].spectrum.report.solver.to_string(),
                stages: STAGES.map(seconds),
                overlaps: before.map_or(Ok(Vec::new()), |before| before.found_again(&regions))?,
            });
            before = Some(regions);
        }
        Ok(runs)
    }

    /// What was found again, in words; nothing for the first run.
    pub fn found(&self) -> String {
        if self.overlaps.is_empty() {
            return String::new();
        }
        let found = self.overlaps.iter().filter(|&&overlap| overlap >= FOUND).count();
        let least = self.overlaps.iter().copied().fold(1.0, f64::min);
        format!("{found} of {} regions found again at {FOUND}, least overlap {least:.3}", self.overlaps.len())
    }
}

/// Runs the bodies, and prints and writes the tables.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let program = Program::build()?;
    let limit = arguments.memory_limit;
    let voxels: Vec<String> = arguments.voxels.iter().map(usize::to_string).collect();
    let given = limit.map_or(String::new(), |limit| format!(" --memory-limit {limit}"));
    let mut page = format!(
        "# The same shape in more voxels\n\n\
         Made by `cargo xtask bench scale --voxels {}{given}`: `mser3d detect` with {EIGENPAIRS} eigenpairs of a residual \
         of {TOLERANCE:e}, from the mesh to all files, a process of its own. A region of the run before is found again if one of \
         the next run overlaps it by {FOUND}, as intersection over union of volumes.\n\nMachine: {}.\n\n\
         | body | voxels | eigenpairs by | CPU s | wall s | peak MB | regions of the run before |\n|---|---|---|---|---|---|---|\n",
        voxels.join(","),
        processor()
    );
    let mut stages = String::from(
        "\n## Where the time goes\n\n\
         Wall seconds of the stages; the rest is starting, reading the mesh and writing the files.\n\n| body | voxels |",
    );
    STAGES.iter().try_for_each(|stage| write!(stages, " {} |", stage.name()))?;
    writeln!(stages, " rest |\n|{}", "---|".repeat(STAGES.len() + 3))?;
    for name in &arguments.bodies {
        let Some(mesh) = body(name) else {
            println!("{name}: its mesh is not here");
            continue;
        };
        for run in Run::measure_all(&program, &mesh, &arguments.voxels, limit)? {
            let Usage { cpu, wall, peak } = run.usage;
            let line = format!(
                "| {name} | {} | {} | {cpu:.1} | {wall:.1} | {:.0} | {} |",
                run.voxels,
                run.solver,
                peak / 1e6,
                run.found()
            );
            println!("{line}");
            writeln!(page, "{line}")?;
            write!(stages, "| {name} | {} |", run.voxels)?;
            run.stages.iter().try_for_each(|seconds| write!(stages, " {seconds:.2} |"))?;
            writeln!(stages, " {:.2} |", wall - run.stages.iter().sum::<f64>())?;
        }
    }
    print!("{stages}");
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/results");
    std::fs::write(arguments.output.as_deref().unwrap_or(&default).join("scale.md"), page + &stages)?;
    Ok(())
}

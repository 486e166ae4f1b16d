//! `cargo xtask shrec11`: scores detectors and descriptors on SHREC'10 or SHREC'11, or on a synthetic
//! benchmark in the same layout.
//!
//! benchmark -> detections (a text per shape and detector) -> scores -> tables and curves. What is
//! there already is not made again, so a run that was stopped goes on where it was.

mod curves;
mod detectors;
mod run;
mod synthesize;
mod tables;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use mser3d_shrec11::Benchmark;

/// What `cargo xtask shrec11` can be told.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("source").required(true).args(["data", "synthesize"]))]
pub struct Arguments {
    /// Folder of the benchmark: NNNN.CLASS.STRENGTH.off and corr/
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Make a benchmark from this closed mesh instead
    #[arg(long, value_name = "MESH")]
    synthesize: Option<PathBuf>,
    /// Poses of the mesh for the isometry class, up to five, from the weakest
    #[arg(long, value_name = "MESH", num_args = 1.., requires = "synthesize")]
    poses: Vec<PathBuf>,
    /// Left-right symmetry of the mesh: line i holds the number of vertex i's mirror vertex
    #[arg(long, value_name = "FILE", requires = "synthesize")]
    symmetry: Option<PathBuf>,
    /// Seed of the random transforms
    #[arg(long, default_value_t = 1, requires = "synthesize")]
    seed: u64,
    /// Only these classes
    #[arg(long, value_name = "CLASS", num_args = 1..)]
    classes: Vec<String>,
    /// Voxels of a null shape; its transforms get the same pitch
    #[arg(long, default_value_t = 45_000)]
    voxels: usize,
    /// Eigenpairs of each solid and surface
    #[arg(long, default_value_t = 100)]
    eigenpairs: usize,
    /// Folders of .regions files by other detectors, which are scored too
    #[arg(long, value_name = "DIR", num_args = 1..)]
    detections: Vec<PathBuf>,
    /// Folder for the results; remove its `detections` to detect again
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

/// Runs the evaluation.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&arguments.output).map_err(|e| format!("{}: {e}", arguments.output.display()))?;
    same_settings(arguments)?;
    let folder = match &arguments.data {
        Some(folder) => folder.clone(),
        None => synthesize::benchmark(arguments)?,
    };
    let benchmark = Benchmark::open(&folder)?;
    if arguments.classes.is_empty() {
        benchmark.missing().iter().for_each(|problem| eprintln!("warning: {problem}"));
    }
    run::detect(arguments, &benchmark)?;
    let scores = run::score(arguments, &benchmark)?;
    write(&arguments.output.join("regions.csv"), &tables::regions_csv(&scores))?;
    write(&arguments.output.join("shapes.csv"), &tables::shapes_csv(&scores))?;
    let summary = tables::summary(&scores);
    write(&arguments.output.join("summary.md"), &summary)?;
    for (name, drawing) in curves::all(&scores) {
        write(&arguments.output.join(name), &drawing)?;
    }
    print!("{summary}");
    Ok(())
}

/// Refuses to mix results of different settings in one folder.
fn same_settings(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let show =
        |paths: &[PathBuf]| paths.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(" ");
    let benchmark = match (&arguments.data, &arguments.synthesize) {
        (Some(folder), _) => format!("data {}", folder.display()),
        (None, mesh) => format!(
            "mesh {}\nposes {}\nsymmetry {}\nseed {}",
            show(mesh.as_slice()),
            show(&arguments.poses),
            show(arguments.symmetry.as_slice()),
            arguments.seed
        ),
    };
    let settings = format!("{benchmark}\nvoxels {}\neigenpairs {}\n", arguments.voxels, arguments.eigenpairs);
    let path = arguments.output.join("settings.txt");
    match fs::read_to_string(&path) {
        Ok(before) if before != settings => {
            let folder = arguments.output.display();
            Err(format!("{folder} holds results of other settings; give another folder, or remove it. It has:\n{before}").into())
        }
        Ok(_) => Ok(()),
        Err(_) => write(&path, &settings),
    }
}

fn write(path: &Path, text: &str) -> Result<(), Box<dyn Error>> {
    Ok(fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))?)
}

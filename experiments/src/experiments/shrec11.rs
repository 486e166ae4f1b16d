//! `cargo xtask shrec11`: scores detectors and descriptors on SHREC'10 or SHREC'11, or on a synthetic
//! benchmark in the same layout.
//!
//! benchmark -> detections (a text per shape and detector) -> scores -> tables and curves. What is
//! there already is not made again, so a run that was stopped goes on where it was.

mod all_shapes;
mod curves;
mod detectors;
mod one_shape;
mod page;
mod pictures;
mod progress;
mod store;
mod synthesize;
mod tables;
mod voxel_overlap;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use mser3d_evaluation::shrec::Benchmark;

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
    /// Only these strengths, 1 to 5
    #[arg(long, value_name = "STRENGTH", num_args = 1.., value_parser = clap::value_parser!(u32).range(1..=5))]
    strengths: Vec<u32>,
    /// Only these of our detectors
    #[arg(long, value_name = "NAME", num_args = 1..)]
    detectors: Vec<String>,
    /// Voxels of a null shape; its transforms get the same pitch
    #[arg(long, default_value_t = 45_000)]
    voxels: usize,
    /// Eigenpairs of each solid and surface
    #[arg(long, default_value_t = 100)]
    eigenpairs: usize,
    /// Folders of .regions files by other detectors, which are scored too
    #[arg(long, value_name = "DIR", num_args = 1..)]
    detections: Vec<PathBuf>,
    /// Folder for the results. What an interrupted run left there is used
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

impl Arguments {
    /// Whether transforms of a class and strength are asked for.
    fn wants(&self, class: &str, strength: u32) -> bool {
        (self.classes.is_empty() || self.classes.iter().any(|c| c == class))
            && (self.strengths.is_empty() || self.strengths.contains(&strength))
    }
}

/// Runs the evaluation.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let output = &arguments.output;
    let detectors = detectors::chosen(&arguments.detectors)?;
    fs::create_dir_all(output).map_err(|e| format!("{}: {e}", output.display()))?;
    let settings = same_settings(arguments)?;
    let folder = match &arguments.data {
        Some(folder) => folder.clone(),
        None => synthesize::benchmark(arguments)?,
    };
    let benchmark = Benchmark::open(&folder)?;
    let missing = missing(arguments, &benchmark);
    missing.iter().for_each(|problem| eprintln!("warning: {problem}"));
    all_shapes::detect(arguments, &benchmark, &detectors)?;
    let scored = all_shapes::score(arguments, &benchmark, &detectors)?;
    write(&output.join("regions.csv"), &tables::regions_csv(&scored))?;
    write(&output.join("shapes.csv"), &tables::shapes_csv(&scored))?;
    let summary = tables::summary(&scored, &settings);
    write(&output.join("summary.md"), &summary)?;
    let mut curves = Vec::new();
    for (name, drawing) in curves::all(&scored) {
        write(&output.join(&name), &drawing)?;
        curves.push(name);
    }
    let pictures = pictures::draw(arguments, &benchmark, detectors[0].name)?;
    let contents =
        page::Contents { settings: &settings, missing: &missing, curves: &curves, pictures: &pictures };
    write(&output.join("index.html"), &page::page(&scored, &contents))?;
    print!("{summary}");
    eprintln!("{} puts it all together", output.join("index.html").display());
    Ok(())
}

/// What is not there of what was asked for: classes by name, otherwise whatever a whole benchmark has.
fn missing(arguments: &Arguments, benchmark: &Benchmark) -> Vec<String> {
    let there = benchmark.classes();
    let mut missing: Vec<String> = arguments
        .classes
        .iter()
        .filter(|class| !there.contains(class.as_str()))
        .map(|class| {
            format!(
                "class {class}: no shapes; there are {}",
                there.iter().copied().collect::<Vec<_>>().join(", ")
            )
        })
        .collect();
    // In a synthetic benchmark only poses can be missing, and these nobody promised.
    if arguments.data.is_some() && arguments.classes.is_empty() && arguments.strengths.is_empty() {
        missing.extend(benchmark.missing());
    }
    missing
}

/// Refuses to mix results of different settings in one folder; returns them.
fn same_settings(arguments: &Arguments) -> Result<String, Box<dyn Error>> {
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
        Ok(_) => Ok(settings),
        Err(_) => write(&path, &settings).map(|()| settings),
    }
}

fn write(path: &Path, text: &str) -> Result<(), Box<dyn Error>> {
    Ok(fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))?)
}

//! `cargo xtask shrec11`: scores detectors and descriptors on SHREC'10 or SHREC'11, or on a synthetic
//! benchmark in the same layout.
//!
//! benchmark -> detections (a text per shape and detector) -> scores -> tables and curves. What is
//! there already is not made again, so a run that was stopped goes on where it was.

mod all_shapes;
mod arguments;
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

pub use arguments::Arguments;

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

//! Detections and scores of all shapes.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use mser3d::Domain;
use mser3d::shape::TriangleMesh;
use mser3d::voxelize::{Pitch, VoxelizeParameters, voxelize};
use mser3d_shrec11::{Benchmark, Detection, NullShape, Score, ShapeName, Transfer};
use rayon::prelude::*;

use super::Arguments;
use super::detectors::{self, Detector};
use crate::evaluate::Solved;

/// Scores by detector, in the order of the detectors.
pub type Scores = Vec<(String, Vec<Score>)>;

/// What the transforms of a null shape share with it.
struct Units {
    pitch: f64,
    volume: f64,
    area: f64,
}

/// Detects on every shape what is not there yet. What fails is named, and counts as nothing found.
pub fn detect(arguments: &Arguments, benchmark: &Benchmark) -> Result<(), Box<dyn Error>> {
    let detectors = detectors::all();
    for detector in &detectors {
        let folder = folder(arguments, detector.name);
        std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    for number in benchmark.null_numbers() {
        let null = match benchmark.null_shape(number) {
            Ok(null) => null,
            Err(error) => {
                eprintln!("warning: {error}; its transforms are left out");
                continue;
            }
        };
        let units = units(null.mesh(), arguments.voxels)?;
        let missing = |name: &ShapeName| {
            detectors
                .iter()
                .filter(|d| !Detection::is_in(&folder(arguments, d.name), name))
                .collect::<Vec<_>>()
        };
        let tasks: Vec<(&ShapeName, Vec<&Detector>)> = names(arguments, benchmark, number)
            .map(|n| (n, missing(n)))
            .filter(|(_, d)| !d.is_empty())
            .collect();
        let done = AtomicUsize::new(0);
        tasks.par_iter().for_each(|(name, detectors)| {
            let start = Instant::now();
            let problems = match shape(benchmark, name, &null) {
                Ok(mesh) => detect_on(arguments, name, &mesh, &units, detectors),
                Err(problem) => vec![problem],
            };
            let (count, seconds) = (done.fetch_add(1, Ordering::Relaxed) + 1, start.elapsed().as_secs_f64());
            eprintln!("{count:3}/{} {name} {seconds:.1} s", tasks.len());
            for problem in problems {
                eprintln!("warning: {name}: {problem}");
            }
        });
    }
    Ok(())
}

fn shape(benchmark: &Benchmark, name: &ShapeName, null: &NullShape) -> Result<TriangleMesh, String> {
    if name.is_null() {
        return Ok(null.mesh().clone());
    }
    benchmark.transformed(name, null).map(|t| t.mesh).map_err(|e| e.to_string())
}

/// Runs detectors on a shape, those of a domain on one spectrum. Returns what went wrong.
fn detect_on(
    arguments: &Arguments,
    name: &ShapeName,
    mesh: &TriangleMesh,
    units: &Units,
    detectors: &[&Detector],
) -> Vec<String> {
    let mut problems = Vec::new();
    // A scaled shape gets a pitch and times of its own, the null shape's scaled.
    let scaled = ["scaling", "scale"].contains(&name.class.as_str());
    let pitch = if scaled { Pitch::Voxels(arguments.voxels) } else { Pitch::Size(units.pitch) };
    for domain in [Domain::Volume, Domain::Surface] {
        let wanted: Vec<&&Detector> = detectors.iter().filter(|d| d.domain == domain).collect();
        let Some(first) = wanted.first() else { continue };
        let mut spectrum = first.parameters.spectrum.clone();
        spectrum.eigenpairs = arguments.eigenpairs;
        let solved = match domain {
            Domain::Volume => {
                Solved::volume(mesh, &VoxelizeParameters { pitch, ..Default::default() }, &spectrum)
            }
            Domain::Surface => Solved::surface(mesh, &spectrum),
        };
        let measure = if domain == Domain::Volume { units.volume } else { units.area };
        let found = solved.and_then(|solved| {
            for detector in wanted {
                let mut parameters = detector.parameters.clone();
                parameters.reference_measure = (!scaled).then_some(measure);
                solved.detect(&parameters)?.write(&folder(arguments, detector.name), name)?;
            }
            Ok(())
        });
        problems.extend(found.err().map(|e| format!("{domain:?}: {e}")));
    }
    problems
}

fn units(null: &TriangleMesh, voxels: usize) -> Result<Units, Box<dyn Error>> {
    let parameters = VoxelizeParameters { pitch: Pitch::Voxels(voxels), ..Default::default() };
    let grid = voxelize(null, &parameters)?.grid;
    Ok(Units { pitch: grid.frame().spacing()[0], volume: grid.volume(), area: null.area() })
}

/// Scores every detector on every transformed shape.
pub fn score(arguments: &Arguments, benchmark: &Benchmark) -> Result<Scores, Box<dyn Error>> {
    let mut folders: Vec<(String, PathBuf)> =
        detectors::all().iter().map(|d| (d.name.to_string(), folder(arguments, d.name))).collect();
    for other in &arguments.detections {
        let name = other.file_name().unwrap_or(other.as_os_str()).to_string_lossy().into_owned();
        folders.push((name, other.clone()));
    }
    let mut scores: Scores = folders.iter().map(|(name, _)| (name.clone(), Vec::new())).collect();
    for number in benchmark.null_numbers() {
        let Ok(null) = benchmark.null_shape(number) else { continue };
        let names: Vec<&ShapeName> = names(arguments, benchmark, number).filter(|n| !n.is_null()).collect();
        let vertices = null.mesh().vertices().len();
        let on_null: BTreeMap<&str, Detection> = folders
            .iter()
            .map(|(name, folder)| (name.as_str(), read(folder, &ShapeName::null(number), vertices)))
            .collect();
        let of_shape = |name: &&ShapeName| -> Option<Vec<Score>> {
            let shape = benchmark.transformed(name, &null).ok()?;
            let transfer = Transfer::new(null.mesh(), &shape.mesh, &shape.points).ok()?;
            let score = |(detector, folder): &(String, PathBuf)| {
                let found = read(folder, name, shape.mesh.vertices().len());
                Score::new(name, &null, &on_null[detector.as_str()], &found, &transfer)
            };
            match folders.iter().map(score).collect() {
                Ok(scores) => Some(scores),
                Err(error) => {
                    eprintln!("warning: {name}: {error}; left out");
                    None
                }
            }
        };
        // A shape without ground truth was named when it was to be detected on.
        for of_shape in names.par_iter().map(of_shape).collect::<Vec<_>>().into_iter().flatten() {
            for (all, score) in scores.iter_mut().zip(of_shape) {
                all.1.push(score);
            }
        }
    }
    Ok(scores)
}

/// What was found; nothing where the file is missing or wrong.
fn read(folder: &std::path::Path, name: &ShapeName, vertices: usize) -> Detection {
    Detection::read(folder, name, vertices).unwrap_or_else(|error| {
        eprintln!("warning: {error}; counts as nothing found");
        Detection::default()
    })
}

/// The null shape and the transforms that are asked for.
fn names<'a>(
    arguments: &'a Arguments,
    benchmark: &'a Benchmark,
    null: u32,
) -> impl Iterator<Item = &'a ShapeName> {
    let wanted =
        |n: &&ShapeName| n.is_null() || arguments.classes.is_empty() || arguments.classes.contains(&n.class);
    benchmark.names().filter(move |n| n.null == null).filter(wanted)
}

fn folder(arguments: &Arguments, detector: &str) -> PathBuf {
    arguments.output.join("detections").join(detector)
}

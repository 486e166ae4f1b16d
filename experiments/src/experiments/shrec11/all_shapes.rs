//! Detections and scores of all shapes.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};

use mser3d::shape::TriangleMesh;
use mser3d_evaluation::shrec::{Benchmark, Class, ShapeName, ShapeScore, SpaceMap, space_map};
use mser3d_evaluation::{Correspondence, DetectedRegions, Score};
use rayon::prelude::*;

use super::arguments::Arguments;
use super::detectors::{Description, Detector};
use super::one_shape::{Shared, Sizes};
use super::progress::Progress;
use super::store::Store;

/// A detector's scores, with one descriptor.
pub struct Scored {
    pub name: String,
    /// Whether another entry has the same regions, so that only the matching scores differ.
    pub same_regions: bool,
    pub scores: Vec<ShapeScore>,
    /// For each score the best overlaps in voxels; empty where they are not known.
    pub voxels: Vec<Vec<f64>>,
}

/// Detects on every shape what is not there yet. What fails is named, and counts as nothing found.
pub fn detect(
    arguments: &Arguments,
    benchmark: &Benchmark,
    detectors: &[Detector],
) -> Result<(), Box<dyn Error>> {
    let store = Store::new(&arguments.output);
    let sizes = Sizes { voxels: arguments.voxels, eigenpairs: arguments.eigenpairs };
    for number in benchmark.null_numbers() {
        let null = match benchmark.null_shape(number) {
            Ok(null) => null,
            Err(error) => {
                eprintln!("warning: {error}; its transforms are left out");
                continue;
            }
        };
        let shared = Shared::of_null(null.mesh(), &ShapeName::null(number), sizes, detectors, &store)?;
        let names: Vec<&ShapeName> = names(arguments, benchmark, number).collect();
        let left = |name: &&ShapeName| match benchmark.transformed(name, &null) {
            Ok(shape) if shared.is_done(&shape.mesh, name, detectors, &store) => None,
            shape => Some(((*name).clone(), shape.map(|s| s.mesh))),
        };
        let tasks: Vec<_> = names.par_iter().filter_map(left).collect();
        let progress = Progress::new(tasks.len());
        tasks.par_iter().for_each(|(name, shape)| {
            let problems = match shape {
                Ok(mesh) => {
                    let map =
                        arguments.synthesize.is_some().then(|| map_of(null.mesh(), name, arguments.seed));
                    shared.transform(mesh, name, map.flatten().as_ref(), detectors, &store)
                }
                Err(problem) => vec![problem.to_string()],
            };
            progress.done(name, &problems);
        });
    }
    Ok(())
}

/// How a transform that we made moves space.
fn map_of(null: &TriangleMesh, name: &ShapeName, seed: u64) -> Option<SpaceMap> {
    let class: Class = name.class.parse().ok()?;
    space_map(null, class, name.strength, seed).ok().flatten()
}

/// The folders that are scored, ours first.
fn folders(arguments: &Arguments, detectors: &[Detector]) -> Result<Vec<(Scored, PathBuf)>, Box<dyn Error>> {
    let store = Store::new(&arguments.output);
    let mut folders = Vec::new();
    for (name, description) in detectors.iter().flat_map(Detector::entries) {
        let folder = store.folder(&name)?;
        folders.push((Scored::new(name, description != Description::SidedSiHks), folder));
    }
    for other in &arguments.detections {
        let name = other.file_name().unwrap_or(other.as_os_str()).to_string_lossy().into_owned();
        folders.push((Scored::new(name, false), other.clone()));
    }
    Ok(folders)
}

impl Scored {
    fn new(name: String, same_regions: bool) -> Self {
        Self { name, same_regions, scores: Vec::new(), voxels: Vec::new() }
    }
}

/// Scores every detector on every transformed shape.
pub fn score(
    arguments: &Arguments,
    benchmark: &Benchmark,
    detectors: &[Detector],
) -> Result<Vec<Scored>, Box<dyn Error>> {
    let (mut scored, folders): (Vec<Scored>, Vec<PathBuf>) =
        folders(arguments, detectors)?.into_iter().unzip();
    for number in benchmark.null_numbers() {
        let Ok(null) = benchmark.null_shape(number) else { continue };
        let names: Vec<&ShapeName> = names(arguments, benchmark, number).collect();
        let vertices = null.mesh().vertices().len();
        let on_null: BTreeMap<&Path, DetectedRegions> = folders
            .iter()
            .map(|folder| (folder.as_path(), read(folder, &ShapeName::null(number), vertices)))
            .collect();
        let of_shape = |name: &&ShapeName| -> Option<Vec<(ShapeScore, Vec<f64>)>> {
            // A shape without ground truth was named when it was to be detected on.
            let shape = benchmark.transformed(name, &null).ok()?;
            let correspondence = Correspondence::new(null.mesh(), &shape.mesh, &shape.points).ok()?;
            let score = |folder: &PathBuf| {
                let found = read(folder, name, shape.mesh.vertices().len());
                let score = Score::new(&null, &on_null[folder.as_path()], &found, &correspondence);
                let shape = (*name).clone();
                score.map(|score| (ShapeScore { shape, score }, Store::voxel_overlaps(folder, name)))
            };
            let scores = folders.iter().map(score).collect::<Result<Vec<_>, _>>();
            scores.map_err(|error| eprintln!("warning: {name}: {error}; left out")).ok()
        };
        for of_shape in names.par_iter().map(of_shape).collect::<Vec<_>>().into_iter().flatten() {
            for (all, (score, voxels)) in scored.iter_mut().zip(of_shape) {
                all.scores.push(score);
                all.voxels.push(voxels);
            }
        }
    }
    Ok(scored)
}

/// What was found; nothing where the file is missing or wrong.
fn read(folder: &Path, name: &ShapeName, vertices: usize) -> DetectedRegions {
    DetectedRegions::read(folder, name, vertices).unwrap_or_else(|error| {
        eprintln!("warning: {error}; counts as nothing found");
        DetectedRegions::default()
    })
}

/// The transforms of a null shape that are asked for.
pub fn names<'a>(
    arguments: &'a Arguments,
    benchmark: &'a Benchmark,
    null: u32,
) -> impl Iterator<Item = &'a ShapeName> {
    let wanted = |n: &&ShapeName| arguments.wants(&n.class, n.strength);
    benchmark.names().filter(move |n| n.null == null && !n.is_null()).filter(wanted)
}

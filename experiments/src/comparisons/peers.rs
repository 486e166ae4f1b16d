//! `cargo xtask peers`: how well parts are found again, ours and other people's, at equal numbers.

mod cases;
mod ours;
mod report;
mod shape_diameter;
mod tomato;

use std::error::Error;
use std::path::{Path, PathBuf};

use mser3d::comptree::{StabilityParameters, StabilityRule};
use mser3d_evaluation::{IndexSet, share_above};
use rayon::prelude::*;

use super::python::{Python, PythonArguments};
use super::resources::processor;
use crate::pose_sets::{SetArguments, in_repository};
use cases::{Case, Shape};
use report::Row;
use shape_diameter::ShapeDiameter;
use tomato::Tomato;

/// What `cargo xtask peers` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    sets: SetArguments,
    #[command(flatten)]
    python: PythonArguments,
    /// Folder for peers.md and peers.csv [default: docs/results, when no SET is named]
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// How many parts of a shape are compared.
const COUNTS: [usize; 5] = [4, 6, 8, 12, 20];

/// Whether such a share of a shape is a part: what our detectors drop for its size doesn't count for the others either.
fn is_part(share: f64) -> bool {
    let StabilityParameters { min_volume_fraction, max_volume_fraction, .. } = StabilityParameters::default();
    (min_volume_fraction..=max_volume_fraction).contains(&share)
}

/// Who divides shapes into parts.
enum Detector {
    Ours(&'static str, StabilityRule),
    Tomato(Tomato),
    ShapeDiameter(ShapeDiameter),
}

/// For each of [`COUNTS`], parts as sets of the mesh's vertices.
type Parts = [Vec<IndexSet>; COUNTS.len()];

/// The parts of each shape, and on which shapes a detector failed, and why.
type OfSet = (Vec<Parts>, Vec<String>);

impl Detector {
    fn name(&self) -> &'static str {
        match self {
            Self::Ours(name, _) => name,
            Self::Tomato(_) => "ToMATo",
            Self::ShapeDiameter(_) => "shape diameter",
        }
    }

    /// The parts of all shapes of a set. What peers read and write may lie in `folder`.
    fn parts(&self, case: &Case, folder: &Path) -> Result<OfSet, Box<dyn Error>> {
        match self {
            Self::Ours(_, rule) => {
                let parts = case.shapes.par_iter().map(|s| ours::parts(s, *rule).map_err(|e| e.to_string()));
                Ok((parts.collect::<Result<_, String>>()?, Vec::new()))
            }
            Self::Tomato(tomato) => Ok(of_each(case, |number, shape| {
                tomato.parts(shape, &folder.join(format!("tomato-{number}.graph")))
            })),
            Self::ShapeDiameter(diameter) => {
                let (segmentations, failed) = of_each(case, |number, shape| {
                    diameter.segmentations(&shape.mesh, &folder.join(format!("diameter-{number}.mesh")))
                });
                Ok((shape_diameter::nearest(segmentations), failed))
            }
        }
    }
}

/// What a peer finds on each shape, and where it failed. A shape on which it fails is one where it finds nothing, and counts as
/// zero.
fn of_each<T: Default + Send>(
    case: &Case,
    find: impl Fn(usize, &Shape) -> Result<T, Box<dyn Error>> + Sync,
) -> (Vec<T>, Vec<String>) {
    let found = case.shapes.par_iter().enumerate().map(|(number, shape)| {
        find(number, shape)
            .map_or_else(|e| (T::default(), Some(format!("{} ({e})", shape.name))), |f| (f, None))
    });
    let (found, problems): (Vec<T>, Vec<Option<String>>) = found.unzip();
    (found, problems.into_iter().flatten().collect())
}

/// Compares all detectors on all sets, and prints and writes the table.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let python = Python::find(&arguments.python, &[&["numpy"], &["gudhi"]])?;
    let voxels = arguments.sets.voxels;
    let mut heading = vec![format!("Machine: {}. Solids of {voxels} voxels.", processor())];
    let mut detectors = vec![
        Detector::Ours("ours", StabilityRule::Windowed),
        Detector::Ours("paper", StabilityRule::Paper),
        Detector::Ours("baseline", StabilityRule::Baseline),
    ];
    match Tomato::find(&python) {
        Some(tomato) => {
            heading.push(format!("* ToMATo: {}", tomato.version));
            detectors.push(Detector::Tomato(tomato));
        }
        None => heading.push(format!("* no ToMATo (to get it: {})", tomato::ADVICE)),
    }
    match ShapeDiameter::find(&python.folder) {
        Some(diameter) => {
            heading.push(format!("* shape diameter: {}", diameter.version));
            detectors.push(Detector::ShapeDiameter(diameter));
        }
        None => heading.push(format!("* no shape diameter (to get it: {})", shape_diameter::ADVICE)),
    }
    heading.iter().for_each(|line| println!("{line}"));
    println!("{}", report::TITLES);
    let mut rows = Vec::new();
    let all = arguments.sets.sets.is_empty();
    let mut take = |case: Case| -> Result<(), Box<dyn Error>> {
        for detector in &detectors {
            let new = score(detector, &case, &python.folder)?;
            new.iter().for_each(|row| println!("{}", row.line()));
            rows.extend(new);
        }
        Ok(())
    };
    let sets = arguments.sets.read()?;
    for set in &sets {
        take(Case::of_set(set, voxels)?)?;
    }
    // The benchmark needs one body at rest, and there are two whose symmetry is known.
    for set in sets.iter().filter(|set| all && ["human", "makehuman"].contains(&&set.name[..])) {
        take(Case::synthetic(set, voxels)?)?;
    }
    match arguments.output.clone().or_else(|| all.then(|| in_repository("docs/results"))) {
        Some(folder) => report::write(&folder, &rows, &heading),
        None => Ok(()),
    }
}

/// The rows of a detector on a set, one for each number of parts.
fn score(detector: &Detector, case: &Case, folder: &Path) -> Result<Vec<Row>, Box<dyn Error>> {
    let (parts, failed) = detector.parts(case, folder)?;
    let rows = COUNTS.into_iter().enumerate().map(|(at, wanted)| {
        let of_count: Vec<&[IndexSet]> = parts.iter().map(|parts| &parts[at][..]).collect();
        let best = case.best_overlaps(&of_count)?;
        let mean = |t: f64| best.iter().map(|best| share_above(best, t)).sum::<f64>() / best.len() as f64;
        Ok(Row {
            set: case.name.clone(),
            detector: detector.name(),
            wanted,
            parts: of_count.iter().map(|parts| parts.len()).sum::<usize>() as f64 / of_count.len() as f64,
            repeatability: [mean(0.8), mean(0.9)],
            failed: failed.clone(),
        })
    });
    rows.collect()
}

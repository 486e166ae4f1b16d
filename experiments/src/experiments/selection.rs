//! `cargo xtask selection`: what each choice of the detector is worth, as docs/results/selection.md.

mod detectors;
mod repeats;
mod report;

use std::error::Error;
use std::path::{Path, PathBuf};

use mser3d::describe;
use mser3d::shape::{Connectivity, TriangleMesh};
use mser3d::spectral::SpectrumParameters;
use mser3d::voxelize::{Pitch, VoxelizeParameters};
use mser3d_evaluation::shrec::isometry;
use mser3d_evaluation::{NullShape, read_symmetry};
use rayon::prelude::*;

use crate::solved::{Solved, mesh, stem};
use detectors::Detector;
use repeats::{Found, Repeats};

/// What `cargo xtask selection` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// More figures: folders with poses of one mesh as .off files and their left-right symmetry in
    /// symmetry.txt; voxels are sized by the first by name
    figures: Vec<PathBuf>,
    /// Voxels of the first pose of each figure; others get the same pitch
    #[arg(long, default_value_t = 45_000)]
    voxels: usize,
    /// Where selection.md and selection.csv are written
    #[arg(short, long, default_value = "docs/results")]
    output: PathBuf,
}

/// Poses of one figure, with their spectra.
struct Figure {
    name: String,
    null: NullShape,
    poses: Vec<String>,
    solved: Vec<Solved>,
    /// The same voxels with links to 26 neighbours.
    solved_26: Vec<Solved>,
}

/// A detector's results on every figure, in order.
struct Row {
    detector: Detector,
    found: Vec<Vec<Found>>,
    repeats: Vec<Repeats>,
}

/// Runs every detector on every figure and writes the tables.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures");
    let fixture = |figure: &str, poses: &[&str]| {
        let paths = poses.iter().map(|pose| fixtures.join(format!("{figure}_{pose}.off"))).collect();
        (figure.to_owned(), paths, fixtures.join(format!("{figure}_symmetry.txt")))
    };
    let mut sources: Vec<(String, Vec<PathBuf>, PathBuf)> = vec![
        fixture("human", &["rest", "walk", "kick", "sit", "wave", "crouch", "touch", "press"]),
        fixture("quadruped", &["rest", "gallop", "graze"]),
    ];
    for folder in &arguments.figures {
        sources.push(folder_of_poses(folder)?);
    }
    let mut figures = Vec::new();
    for (name, paths, symmetry) in sources {
        eprintln!("spectra of {name}");
        figures.push(Figure::solve(name, &paths, &symmetry, arguments.voxels)?);
    }
    let mut rows = Vec::new();
    for detector in detectors::all() {
        eprintln!("{}", detector.title);
        let mut row = Row { detector, found: Vec::new(), repeats: Vec::new() };
        for figure in &figures {
            let found = figure.detect(&row.detector)?;
            row.repeats.push(Repeats::new(&figure.null, &found)?);
            row.found.push(found);
        }
        rows.push(row);
    }
    std::fs::create_dir_all(&arguments.output)?;
    std::fs::write(arguments.output.join("selection.csv"), report::csv(&figures, &rows))?;
    std::fs::write(arguments.output.join("selection.md"), report::markdown(&figures, &rows)?)?;
    Ok(())
}

fn folder_of_poses(folder: &Path) -> Result<(String, Vec<PathBuf>, PathBuf), Box<dyn Error>> {
    let mut poses: Vec<PathBuf> = std::fs::read_dir(folder)
        .map_err(|e| format!("{}: {e}", folder.display()))?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "off"))
        .collect();
    poses.sort();
    if poses.len() < 2 {
        return Err(format!("{}: two poses or more are needed, as .off files", folder.display()).into());
    }
    Ok((stem(folder), poses, folder.join("symmetry.txt")))
}

impl Figure {
    fn solve(
        name: String,
        paths: &[PathBuf],
        symmetry: &Path,
        voxels: usize,
    ) -> Result<Self, Box<dyn Error>> {
        let first = mesh(paths.first().ok_or("a figure without poses")?)?;
        let mirror = read_symmetry(symmetry, first.vertices().len())?;
        let null = NullShape::new(first).with_symmetry(mirror)?;
        let solve = |mesh: &TriangleMesh, pitch, connectivity| {
            let voxelize = VoxelizeParameters { pitch, connectivity, ..Default::default() };
            Solved::volume(mesh, &voxelize, &SpectrumParameters::default())
        };
        let rest = solve(null.mesh(), Pitch::Voxels(voxels), Connectivity::Six)?;
        let pitch = rest.pitch().map_or(Pitch::Voxels(voxels), Pitch::Size);
        let all = |connectivity| -> Result<Vec<Solved>, Box<dyn Error>> {
            let one = |path: &PathBuf| {
                let pose = mesh(path).and_then(|m| Ok(isometry(null.mesh(), &m)?));
                pose.and_then(|pose| solve(&pose.mesh, pitch, connectivity)).map_err(|e| e.to_string())
            };
            Ok(paths.par_iter().map(one).collect::<Result<Vec<_>, String>>()?)
        };
        let poses = paths.iter().map(|path| stem(path)).collect();
        let (solved, solved_26) = (all(Connectivity::Six)?, all(Connectivity::TwentySix)?);
        Ok(Self { name, null, poses, solved, solved_26 })
    }

    /// What a detector finds on every pose, at the times of the first.
    fn detect(&self, detector: &Detector) -> Result<Vec<Found>, Box<dyn Error>> {
        let solved = if detector.all_neighbours { &self.solved_26 } else { &self.solved };
        let mut parameters = detector.parameters.clone();
        parameters.reference_measure = solved.first().map(Solved::measure);
        let find = |solved: &Solved| -> Result<Found, String> {
            let regions = solved.regions(&parameters).map_err(|e| e.to_string())?;
            let descriptors = describe(solved.basis(), &regions, &parameters).map_err(|e| e.to_string())?;
            let detection = solved.detection(&regions, &descriptors).map_err(|e| e.to_string())?;
            Ok(Found { regions, detection })
        };
        Ok(solved.par_iter().map(find).collect::<Result<Vec<_>, String>>()?)
    }
}

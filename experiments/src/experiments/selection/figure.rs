//! Poses of one figure, and what detectors find on them.

use std::error::Error;
use std::path::{Path, PathBuf};

use mser3d::describe;
use mser3d::shape::{Connectivity, TriangleMesh};
use mser3d::spectral::SpectrumParameters;
use mser3d::voxelize::{Pitch, VoxelizeParameters};
use mser3d_evaluation::shrec::isometry;
use mser3d_evaluation::{NullShape, read_symmetry};
use rayon::prelude::*;

use super::detectors::Detector;
use super::repeats::{Found, Repeats};
use crate::solved::{Solved, mesh, stem};

/// Poses of one figure, with their spectra.
pub(super) struct Figure {
    pub name: String,
    pub null: NullShape,
    pub poses: Vec<String>,
    pub solved: Vec<Solved>,
    /// The same voxels with links to 26 neighbours.
    pub solved_26: Vec<Solved>,
}

/// A detector's results on every figure, in order.
pub(super) struct Row {
    pub detector: Detector,
    pub found: Vec<Vec<Found>>,
    pub repeats: Vec<Repeats>,
}

impl Figure {
    /// The poses in some files, voxelized at the pitch of the first, and their spectra.
    pub fn solve(
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
    pub fn detect(&self, detector: &Detector) -> Result<Vec<Found>, Box<dyn Error>> {
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

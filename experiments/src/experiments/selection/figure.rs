//! The shapes of a set, and what detectors find on them.

use std::error::Error;

use mser3d::shape::Connectivity;
use mser3d::spectral::SpectrumParameters;
use mser3d::voxelize::VoxelizeParameters;

use super::detectors::Detector;
use crate::pose_sets::PoseSet;
use crate::repeats::{Found, Repeats};
use crate::solved::Solved;

/// A set with its spectra.
pub(super) struct Figure<'s> {
    set: &'s PoseSet,
    solved: Vec<Solved>,
    /// The same voxels with links to 26 neighbours.
    solved_26: Vec<Solved>,
}

/// A detector's results on every set, in order.
pub(super) struct Row {
    pub detector: Detector,
    pub found: Vec<Vec<Found>>,
    pub repeats: Vec<Repeats>,
}

impl<'s> Figure<'s> {
    /// Solids and spectra of a set's shapes.
    pub fn solve(set: &'s PoseSet, voxels: usize) -> Result<Self, Box<dyn Error>> {
        let all = |connectivity| {
            let voxelize = VoxelizeParameters { connectivity, ..Default::default() };
            set.solve(voxels, &voxelize, &SpectrumParameters::default())
        };
        let (solved, solved_26) = (all(Connectivity::Six)?, all(Connectivity::TwentySix)?);
        Ok(Self { set, solved, solved_26 })
    }

    /// What a detector finds on every shape.
    pub fn detect(&self, detector: &Detector) -> Result<Vec<Found>, Box<dyn Error>> {
        let solved = if detector.all_neighbours { &self.solved_26 } else { &self.solved };
        self.set.detect(solved, &detector.parameters)
    }
}

use std::ops::ControlFlow;

use crate::Error;

/// The stages of [`crate::detect`], in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// The mesh becomes linked voxels (volumes only).
    Voxelize,
    /// The Laplacian's eigenpairs.
    Spectrum,
    /// Weights, component trees and their stable regions.
    Regions,
    /// The regions' descriptors.
    Descriptors,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Self; 4] = [Self::Voxelize, Self::Spectrum, Self::Regions, Self::Descriptors];

    /// A word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Voxelize => "voxelize",
            Self::Spectrum => "spectrum",
            Self::Regions => "regions",
            Self::Descriptors => "descriptors",
        }
    }
}

/// How far the work is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// The stage under way.
    pub stage: Stage,
    /// Units of it that are done: eigenpairs, trees.
    pub done: usize,
    /// Units in all.
    pub total: usize,
}

/// Called now and then from the working thread, or others; break to cancel.
pub type ProgressFn<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

/// Does nothing and never cancels.
pub fn no_progress(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

pub(crate) fn report(progress: ProgressFn, stage: Stage, done: usize, total: usize) -> Result<(), Error> {
    match progress(Progress { stage, done, total }) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Error::Cancelled),
    }
}

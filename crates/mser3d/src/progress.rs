use std::ops::ControlFlow;

use crate::Error;

mser3d_shape::choice! {
    /// The stages of [`Detector::detect`](crate::Detector::detect), in order.
    pub enum Stage("stage") {
        /// The mesh becomes linked voxels (volumes only)
        #[default]
        Voxelize = "voxelize",
        /// The Laplacian's eigenpairs
        Spectrum = "spectrum",
        /// Weights, component trees and their stable regions
        Regions = "regions",
        /// Deformed copies of the shape, searched for the same regions
        Reliability = "reliability",
        /// The regions' descriptors
        Descriptors = "descriptors",
        /// The bodies' parts, if they are asked for
        Parts = "parts",
    }
}

/// How far the work is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// The stage under way.
    pub stage: Stage,
    /// Units of it that are done: eigenpairs, trees, copies, regions. Where several bodies are searched each on its own, a
    /// hundredth of a body's.
    pub done: usize,
    /// Units in all.
    pub total: usize,
}

/// Called now and then from the working thread, or others; break to cancel.
pub type ProgressFn<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

/// Hears nothing and never cancels.
pub const NO_PROGRESS: ProgressFn<'static> = &|_| ControlFlow::Continue(());

pub(crate) fn report(progress: ProgressFn, stage: Stage, done: usize, total: usize) -> Result<(), Error> {
    match progress(Progress { stage, done, total }) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Error::Cancelled),
    }
}

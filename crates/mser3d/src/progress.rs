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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// The stage under way.
    pub stage: Stage,
    /// Share of its work that is done, 0 to 1. Never falls within a stage.
    pub done: f64,
    /// Share of all work, 0 to 1: the stages count as much as [`Parameters::estimate`](crate::Parameters::estimate) expects
    /// them to take. Never falls. Of a stage that is called by itself the same as `done`.
    pub overall: f64,
}

/// Called now and then from the working thread, or others; break to cancel.
pub type ProgressFn<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

/// Hears nothing and never cancels.
pub const NO_PROGRESS: ProgressFn<'static> = &|_| ControlFlow::Continue(());

pub(crate) fn report(progress: ProgressFn, stage: Stage, done: f64) -> Result<(), Error> {
    match progress(Progress { stage, done, overall: done }) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Error::Cancelled),
    }
}

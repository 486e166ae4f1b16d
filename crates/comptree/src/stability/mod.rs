//! Maximally stable components (section 4.2 of the paper; MSER of Matas et al. 2002): which nodes of a tree
//! are features.
mod branches;
mod levels;
mod parameters;
mod pointwise;
mod region;
mod select;
mod windowed;

pub use parameters::{AltitudeScale, StabilityParameters, StabilityRule};
pub(crate) use region::Candidate;
pub use region::{Merge, Selection, SelectionReport, StableRegion};
pub(crate) use select::regions_of;
pub use select::{stability, stable_regions};

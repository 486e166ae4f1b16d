//! How well detected regions repeat and match: the measures of Litman, Bronstein & Bronstein,
//! *Stable volumetric features in deformable shapes* (2012), section 6, and the benchmarks that they are taken on.
//!
//! A shape, the *null shape*, is transformed in known ways. A detector is good when it finds the same regions on the
//! transformed shape; a descriptor is good when it recognizes them. Regions are sets of vertices ([`IndexSet`]). The
//! ground truth is a [`Correspondence`]: it carries each region of the transformed shape to the null shape, where
//! [`Overlaps`] compares regions by area.
//!
//! ```
//! use mser3d_evaluation::shape::{IndexSet, TriangleMesh};
//! use mser3d_evaluation::{Correspondence, NullShape, Overlaps, share_above};
//!
//! let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
//! let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])?;
//! let null = NullShape::new(mesh);
//! let same_vertices = Correspondence::identity(4);
//!
//! let on_null = [IndexSet::from_members(4, [0, 1])?];
//! let on_transformed = [IndexSet::from_members(4, [0, 1, 2])?, IndexSet::from_members(4, [3])?];
//! let overlaps = Overlaps::new(&null, &on_null, &on_transformed, &same_vertices)?;
//! assert!(overlaps.best()[0] > 0.6 && overlaps.best()[1] == 0.0);
//! assert_eq!(share_above(&overlaps.best(), 0.5), 0.5); // the repeatability at overlap 0.5
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! * [`Score`]: repeatability, matching score and number of correspondences on one transformed shape, at any overlap;
//! * [`judge`]: which matches of a matcher are right, and which confuse left and right;
//! * [`DetectedRegions`]: what any detector found, as a text that any tool can write;
//! * [`read_symmetry`]: left-right symmetry, which the measures need because an intrinsic detector cannot tell sides;
//! * [`shrec`]: the files of the SHREC'10 and SHREC'11 benchmarks, and a synthetic benchmark in the same files.
#![warn(missing_docs)]

mod correspondence;
mod detected_regions;
mod error;
mod judge;
mod mat5;
mod null_shape;
mod overlap;
mod score;
pub mod shrec;
mod surface_point;
mod symmetry;

pub use correspondence::Correspondence;
pub use detected_regions::DetectedRegions;
pub use error::EvaluationError;
pub use judge::{Judged, MatchTruth, PrecisionRecall, Verdict, judge};
pub use null_shape::NullShape;
pub use overlap::Overlaps;
pub use score::{Score, share_above};
pub use surface_point::SurfacePoint;
pub use symmetry::read_symmetry;

pub use mser3d_meshio as meshio;
pub use mser3d_shape as shape;
pub use mser3d_shape::IndexSet;
pub use mser3d_voxelize as voxelize;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

//! The SHREC'10 and SHREC'11 feature detection benchmarks as a library: their files, a synthetic
//! benchmark in the same layout, and their measures of region detectors and descriptors.
//!
//! A *null shape* is transformed in known ways. A detector is good when it finds the same regions on
//! the transformed shape, a descriptor when it recognizes them. Regions are sets of vertices
//! ([`VertexSet`]); a [`Transfer`] carries those of the transformed shape to the null shape, where
//! [`Overlaps`] compares them by area.
//!
//! ```
//! use mser3d_shape::TriangleMesh;
//! use mser3d_shrec11::{NullShape, Overlaps, SurfacePoint, Transfer, VertexSet};
//!
//! let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
//! let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])?;
//! let null = NullShape::new(mesh.clone());
//! let transfer = Transfer::identity(4);
//!
//! let found = [VertexSet::from_members(4, [0, 1])?];
//! let again = [VertexSet::from_members(4, [0, 1, 2])?, VertexSet::from_members(4, [3])?];
//! let overlaps = Overlaps::new(&null, &found, &again, &transfer)?;
//! assert!(overlaps.best()[0] > 0.6 && overlaps.best()[1] == 0.0);
//! assert_eq!(mser3d_shrec11::share_above(&overlaps.best(), 0.5), 0.5); // repeatability at 0.5
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! * [`Benchmark`] reads the files of SHREC'10 and SHREC'11, and names what is missing;
//! * [`transform`] makes the synthetic benchmark, [`BenchmarkWriter`] puts it in the same files;
//! * [`Detection`] is what any detector found, as a text that any tool can write;
//! * [`Score`] is what it is worth.
//!
//! The benchmarks: Bronstein et al., *SHREC 2010: robust feature detection and description benchmark*;
//! Boyer et al., *SHREC 2011: robust feature detection and description benchmark*. The measures of
//! regions: Litman, Bronstein, Bronstein, *Stable volumetric features in deformable shapes*, section 6.
#![warn(missing_docs)]

mod correspondence;
mod error;
mod files;
mod overlap;
mod random;
mod score;
mod transfer;
mod transforms;
mod vector;
mod vertex_set;

pub use correspondence::SurfacePoint;
pub use error::ShrecError;
pub use files::{Benchmark, BenchmarkWriter, Detection, NotAShapeName, ShapeName, read_symmetry};
pub use overlap::{NullShape, Overlaps};
pub use score::{Score, mean_score, share_above};
pub use transfer::Transfer;
pub use transforms::{Class, SpaceMap, Transformed, isometry, space_map, transform};
pub use vertex_set::VertexSet;

//! The plain data that the crates of mser3d pass to each other, without dependencies:
//!
//! * [`TriangleMesh`]: a surface, vertices in the order of its file;
//! * [`VoxelGrid`]: a solid as occupied voxels *and the links between them*, one bit each; its [`Frame`] says where
//!   they lie, and [`Affine`] is the same for any volume;
//! * [`Graph`]: adjacency of voxels or vertices, in compressed rows;
//! * [`Eigenbasis`]: eigenvalues and M-orthonormal eigenfunctions of a Laplacian, in double or single precision ([`Functions`]);
//!   [`EigenbasisView`]: those that lie elsewhere;
//! * [`IndexSet`]: a region as a set of vertices or voxels;
//! * [`DisjointSets`]: union-find, which components and component trees share.
//!
//! And what more than one of them needs: three-[`vector`]s, a random stream ([`SplitMix64`]), named
//! [`choice!`]s, and the one error for a parameter out of range ([`InvalidParameter`]).
//!
//! Everything is checked when it is made, so that the numerical crates can index freely.
//!
//! ```
//! use mser3d_shape::{BitGrid, Frame, VoxelGrid};
//!
//! // A solid box of 4 x 3 x 2 voxels of pitch 0.5.
//! let frame = Frame::new([4, 3, 2], [0.0; 3], [0.5; 3])?;
//! let grid = VoxelGrid::solid(frame, BitGrid::full([4, 3, 2])?)?;
//! assert_eq!(grid.len(), 24);
//! assert_eq!(grid.volume(), 3.0);
//! assert_eq!(grid.index([3, 0, 0]), Some(3)); // x runs fastest
//! # Ok::<(), mser3d_shape::ShapeError>(())
//! ```
#![warn(missing_docs)]

mod affine;
mod bits;
mod choice;
mod disjoint_sets;
mod eigenbasis;
mod error;
mod frame;
mod functions;
mod graph;
mod grid;
mod index_set;
mod mesh;
mod nearest;
mod neighbours;
mod numbering;
mod parameter;
mod random;
mod readable;
mod runs;
mod split;
mod subdivision;
pub mod vector;
mod word_tree;

pub use affine::Affine;
pub use bits::{BitGrid, Bits};
pub use choice::{Choice, UnknownChoice};
pub use disjoint_sets::DisjointSets;
pub use eigenbasis::{Domain, Eigenbasis, EigenbasisView};
pub use error::ShapeError;
pub use frame::Frame;
pub use functions::{Functions, FunctionsView};
pub use graph::{Components, Graph};
pub use grid::VoxelGrid;
pub use index_set::{IndexSet, innermost_regions};
pub use mesh::{BoundingBox, TriangleMesh};
pub use nearest::NearestVoxels;
pub use neighbours::{Connectivity, DIAGONALS, Faces};
pub use parameter::InvalidParameter;
pub use random::SplitMix64;
pub use readable::{Bytes, Readable};
pub use subdivision::Subdivision;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

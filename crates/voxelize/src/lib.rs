//! Triangle meshes to solid voxel grids.
//!
//! * [`diagnose`] says what a mesh is like: closed, oriented, overlapping, and what that means;
//! * [`voxelize`] turns it into a [`VoxelGrid`](mser3d_shape::VoxelGrid): the voxels whose centre is
//!   inside, and links between neighbours, except where the surface runs between them;
//! * [`estimate`] foretells what that takes, and [`voxelize_with`] can be stopped half-way;
//! * [`inside`] gives the voxels alone, as bits, and [`dense_mask`] makes an array of them;
//! * [`Bvh`] and [`WindingTree`] answer rays, nearest points and winding numbers on their own.
//!
//! # How
//! Rays along grid lines need no tree: triangles are scan-converted over the lattice of grid lines,
//! with exact predicates where floating point cannot decide, and each line counts its crossings with
//! their sign. On a closed, oriented surface that is the winding number, an exact integer: 1 inside,
//! 2 where the solid overlaps itself. An open surface is closed by cones over its boundary loops; the
//! integer of the closed chain less the winding number of the cones is the generalized winding number
//! of the surface (Jacobson et al. 2013), and the cones, few and small, matter only near the holes.
//!
//! # Guarantees and limits
//! * On closed meshes the voxels inside and the links cut are those of exact arithmetic, for any
//!   coordinates that are not within a factor of 1e-100 of the limits of `f64`. A centre exactly on
//!   the surface counts as moved by an infinitesimal along +x, then +y, then +z.
//! * The result does not depend on the number of threads.
//! * A grid that is not given lies centred on the mesh's bounding box. Quarter turns and mirror images of a
//!   mesh give the turned or mirrored voxels and links, exactly, of open meshes too. Exceptions are voxel
//!   centres exactly on the surface (a slope of 45 degrees on a grid whose pitch divides the shape), and inside
//!   tests that count crossings of an open mesh.
//! * No vertex is moved. Merging vertices, turning triangles over and closing holes only change how a mesh is
//!   read, and warnings report them.
//! * Bodies that overlap or touch are one solid; one surface that overlaps or touches itself is parted there.
//!   Where bodies overlap, their surfaces are ordered along a line in floating point; closer than 1e-9 of the
//!   grid's longest side they count as in contact.
#![warn(missing_docs)]

mod axis_parity;
mod axis_sweep;
mod boundary_loops;
mod bvh;
mod cancel;
mod centre_lattice;
mod coarse_estimate;
mod cut_diagonals;
mod cut_links;
mod dense;
mod diagnosis;
mod error;
mod estimate;
mod fitted_spacing;
mod frame_around;
mod grid_frame;
mod grid_topology;
mod hole_corrections;
mod inside_rule;
mod inside_test;
mod mesh_analysis;
mod mesh_edges;
mod mesh_to_grid;
mod morphology;
mod parameters;
mod placed_surface;
mod predicates;
mod scan_conversion;
mod shells;
mod surface;
mod triangle_geometry;
mod voxel_fill;
mod voxelization;
mod warning;

pub use bvh::{Bvh, Hit, NearestPoint, WindingTree};
pub use cancel::CheckFn;
pub use dense::dense_mask;
#[cfg(feature = "ndarray")]
pub use dense::mask_array;
pub use diagnosis::{Diagnosis, diagnose, diagnose_with};
pub use error::VoxelizeError;
pub use estimate::{Cost, estimate};
pub use grid_topology::GridTopology;
pub use inside_test::{InsideTest, Reason};
pub use mesh_to_grid::{inside, voxelize, voxelize_with};
pub use morphology::Morphology;
pub use parameters::{Overlap, Pitch, VoxelizeParameters};
pub use voxelization::Voxelization;
pub use warning::Warning;

#[cfg(feature = "ndarray")]
pub use ndarray;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

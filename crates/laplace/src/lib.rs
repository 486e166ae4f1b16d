//! Laplace operators of solids and surfaces, in one form.
//!
//! The volume operator (7-point stencil, Neumann boundary) and the surface operator (cotangents) of Litman,
//! Bronstein & Bronstein 2012, sections 3.2 and 3.1, both become one [`Operator`]: a sparse symmetric positive
//! semidefinite stiffness W and a diagonal mass M with `W phi = lambda M phi`. From here on nothing knows
//! whether it came from voxels or from triangles. A matrix of your own becomes one by [`Operator::new`].
//!
//! * [`grid_laplacian`] and [`cotangent_laplacian`] assemble W as a [`sprs`] matrix.
//! * [`GridStencil`] is the same grid operator without a matrix: neighbours and weights, for iterative
//!   solvers.
//! * [`aggregate_grid`] makes a coarser operator of the same solid, for estimates.
//! * [`Operator::heat_flow`] smooths a function, [`Operator::harmonic`] continues one from where it is known.
//! * [`mean_curvature`] is what the cotangent operator says of the positions themselves.
//!
//! ```
//! use mser3d_laplace::grid_laplacian;
//! use mser3d_shape::{BitGrid, Frame, VoxelGrid};
//!
//! let frame = Frame::new([3, 1, 1], [0.0; 3], [0.5; 3])?;
//! let rod = VoxelGrid::solid(frame, BitGrid::full([3, 1, 1])?)?;
//! let operator = grid_laplacian(&rod);
//! // W = M L: off the diagonal -h^3 / h^2 = -h.
//! assert_eq!(operator.stiffness().get(0, 1), Some(&-0.5));
//! assert_eq!(operator.mass(), [0.125; 3]);
//! # Ok::<(), mser3d_shape::ShapeError>(())
//! ```
//!
//! Limits: the voxel operator joins face neighbours only; meshes get linear elements with lumped masses,
//! without Delaunay flips.

mod aggregate;
mod conjugate_gradients;
mod cotangent;
mod grid;
mod heat_flow;
mod mean_curvature;
mod operator;
mod stencil;

pub use aggregate::{Aggregation, aggregate_grid};
pub use cotangent::cotangent_laplacian;
pub use grid::grid_laplacian;
pub use mean_curvature::mean_curvature;
pub use mser3d_shape as shape;
pub use operator::{LaplaceError, Operator};
pub use sprs;
pub use stencil::GridStencil;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

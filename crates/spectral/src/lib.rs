//! The smallest eigenpairs of a Laplace operator, or of another sparse symmetric operator, complete with
//! multiplicities.
//!
//! * [`smallest_eigenpairs`] solves `W phi = lambda M phi` for any positive semidefinite
//!   [`Operator`](laplace::Operator), by thick-restart block Lanczos on the inverse (sparse `L D L^T`
//!   factorizations of shifted matrices).
//! * [`smallest_eigenpairs_of_grid`] solves it on a voxel grid without a matrix, by the same Lanczos
//!   iteration on a Chebyshev polynomial of the stencil: several times faster, with memory for about `2.5 k`
//!   vectors.
//!   On large grids by multigrid, with memory for about `1.1 k` vectors.
//! * [`count_below`] tells by a factorization how many eigenvalues lie below a bound.
//!
//! What is guaranteed:
//!
//! * Residuals are measured on the result, and a spectrum that misses the tolerance is an error. Where an
//!   eigenvalue is so small that rounding alone moves A x by more (on shapes a thousand times longer than
//!   thick, on meshes of slivers), a residual as small as rounding allows is accepted:
//!   [`SpectrumReport::residual`] tells. Eigenfunctions in single precision, of large grids and loose tolerances, are
//!   measured without the noise of their rounding.
//! * A component whose rows of W sum to zero (a Neumann boundary, a closed surface) has an eigenvalue of
//!   exactly 0 with an exactly constant eigenfunction.
//! * No copy of a multiple eigenvalue is missed: components are solved one by one, and where as many
//!   eigenvalues lie together as a block has columns, the iteration is repeated, orthogonal to those found.
//! * A negative eigenvalue is an error ([`SpectralError::Indefinite`]), never left out in silence.
//! * The same input gives the same bits on any number of threads.
//!
//! ```
//! use std::ops::ControlFlow;
//! use mser3d_laplace::grid_laplacian;
//! use mser3d_shape::{BitGrid, Frame, VoxelGrid};
//! use mser3d_spectral::{SpectrumParameters, smallest_eigenpairs};
//!
//! let frame = Frame::new([20, 4, 3], [0.0; 3], [1.0; 3])?;
//! let rod = VoxelGrid::solid(frame, BitGrid::full(frame.dims())?)?;
//! let parameters = SpectrumParameters { eigenpairs: 5.into(), ..Default::default() };
//! let spectrum =
//!     smallest_eigenpairs(&grid_laplacian(&rod), &parameters, &|_| ControlFlow::Continue(()))?;
//! // A box's Neumann spectrum: 2 - 2 cos(pi i / n) along each axis.
//! let expected = 2.0 - 2.0 * (std::f64::consts::PI / 20.0).cos();
//! assert!((spectrum.basis.eigenvalues()[1] - expected).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod block_matrix;
mod chebyshev;
mod components;
mod count;
mod dense;
mod eigenpairs;
mod elimination;
mod error;
mod factor;
mod filter;
mod fronts;
mod kernels;
mod lambda_max;
mod lanczos;
mod lanczos_basis;
mod limits;
mod multigrid;
mod multiplicity;
mod null_space;
mod parameters;
mod progress;
mod quality;
mod rayleigh_quotient;
mod report;
mod row;
mod shift_invert;
mod small_dense;
mod solve_grid;
mod solve_matrix;
mod standard_problem;
mod stencil;
mod temporal_blocking;

pub use count::count_below;
pub use error::SpectralError;
pub use mser3d_laplace as laplace;
pub use mser3d_shape as shape;
pub use multigrid::uses_multigrid;
pub use parameters::{EigenpairRange, Eigensolver, SpectrumParameters};
pub use report::{SolverUsed, Spectrum, SpectrumReport};
pub use solve_grid::{SINGLE_PRECISION, smallest_eigenpairs_of_grid};
pub use solve_matrix::smallest_eigenpairs;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

//! The smallest eigenpairs of a Laplace operator, complete with multiplicities.
//!
//! * [`smallest_eigenpairs`] solves `W phi = lambda M phi` for any [`mser3d_laplace::Operator`], by
//!   thick-restart block Lanczos on the inverse (sparse Cholesky factorization).
//! * [`smallest_eigenpairs_of_grid`] solves it on a voxel grid without a matrix, by the same Lanczos
//!   iteration on a Chebyshev polynomial of the stencil: several times faster, and in the memory of about
//!   2.5 k vectors.
//!
//! What is guaranteed: true residuals are measured on the result, and a spectrum that misses the
//! tolerance is an error. Where an eigenvalue is so small that rounding alone moves A x by more, on
//! shapes a thousand times longer than thick or meshes of slivers, what rounding allows is accepted
//! instead: [`SpectrumReport::residual`] tells. Zero modes are exactly constant on each component, one for
//! each. The same input gives the same bits on any number of threads.
//!
//! No copy of a multiple eigenvalue is missed: disconnected bodies are solved one by one, and where as many
//! eigenvalues lie together as a block has columns, the iteration is repeated orthogonally to what was found.
//! [`count_below`] tells by a factorization how many eigenvalues lie below a bound.
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

mod basis;
mod chebyshev;
mod complete;
mod count;
mod error;
mod extent;
mod factor;
mod filter;
mod lanczos;
mod parameters;
mod parts;
mod progress;
mod shift_invert;
mod solve;
mod standard;
mod stencil;
mod tall;
mod waves;

pub use count::count_below;
pub use error::SpectralError;
pub use parameters::{Eigensolver, Extent, Spectrum, SpectrumParameters, SpectrumReport};
pub use solve::{smallest_eigenpairs, smallest_eigenpairs_of_grid};

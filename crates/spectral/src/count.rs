//! How many eigenvalues lie below a bound, without computing any.

use mser3d_laplace::Operator;
use mser3d_shape::InvalidParameter;

use crate::SpectralError;
use crate::elimination::Elimination;
use crate::limits::check_memory;
use crate::standard_problem::StandardProblem;

/// Relative changes of the bound that are tried, one by one, where a factorization breaks down.
const NUDGES: [f64; 7] = [0.0, 1e-6, -1e-6, 3e-6, -3e-6, 1e-5, -1e-5];

/// The number of eigenvalues of `W phi = lambda M phi` below `bound` (length^-2), zero modes included: tells
/// whether a computed spectrum is complete. Negative eigenvalues count as well.
///
/// By Sylvester's law of inertia it is the number of negative entries of D in `A - bound I = L D L^T`, where
/// `A = M^(-1/2) W M^(-1/2)`. Choose the bound in a gap of the spectrum: eigenvalues within 10^-5 of it,
/// relative, may count or not, depending on rounding.
///
/// ```
/// use mser3d_laplace::grid_laplacian;
/// use mser3d_shape::{BitGrid, Frame, VoxelGrid};
///
/// // A rod of 9 voxels has the eigenvalues 2 - 2 cos(pi i / 9): 0, 0.12, 0.47, 1, ...
/// let frame = Frame::new([9, 1, 1], [0.0; 3], [1.0; 3])?;
/// let rod = VoxelGrid::solid(frame, BitGrid::full(frame.dims())?)?;
/// assert_eq!(mser3d_spectral::count_below(&grid_laplacian(&rod), 0.9, None)?, 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Cost: a sparse factorization; for a solid with n voxels about n^2 flops and 20 n^(4/3) numbers. Work that
/// needs more than `memory_limit` bytes is refused.
///
/// # Errors
/// [`SpectralError::InvalidParameter`] for a bound that is not finite, [`SpectralError::TooMuchMemory`],
/// [`SpectralError::NotFactored`].
pub fn count_below(
    operator: &Operator,
    bound: f64,
    memory_limit: Option<u64>,
) -> Result<usize, SpectralError> {
    InvalidParameter::unless(bound.is_finite(), "bound", bound, "a finite number")?;
    let problem = StandardProblem::new(operator);
    if problem.len() == 0 || bound <= 0.0 && operator.is_known_semidefinite() {
        return Ok(0);
    }
    let elimination = Elimination::new(&problem)?;
    check_memory(memory_limit, "pivots".into(), problem.len(), 2 * elimination.len())?;
    let mut broken = SpectralError::NotFactored { shift: bound };
    for nudge in NUDGES {
        match elimination.factor(bound * (1.0 + nudge)) {
            Ok(factor) => return Ok(factor.negative_pivots()),
            Err(error) => broken = error,
        }
    }
    Err(broken)
}

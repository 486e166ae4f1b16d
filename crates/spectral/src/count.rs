//! How many eigenvalues lie below a bound, without computing any.

use mser3d_laplace::Operator;

use crate::SpectralError;
use crate::factor::Elimination;
use crate::solve::check_memory;
use crate::standard::StandardProblem;

/// Relative changes of the bound that are tried, one by one, where a factorization breaks down.
const NUDGES: [f64; 7] = [0.0, 1e-6, -1e-6, 3e-6, -3e-6, 1e-5, -1e-5];

/// The number of eigenvalues of `W phi = lambda M phi` below `bound` (length^-2), zero modes included: tells
/// whether a computed spectrum is complete.
///
/// By Sylvester's law of inertia it is the number of negative entries of the D of
/// `A - bound I = L D L^T`, `A = M^(-1/2) W M^(-1/2)`. Choose the bound in a gap of the spectrum: eigenvalues within
/// 10^-5 of it, relative, may count or not, as rounding has it.
///
/// Cost: a sparse factorization, of a solid with n voxels about n^2 flops and 20 n^(4/3) numbers. Larger ones than
/// `memory_limit` bytes are refused.
///
/// # Errors
/// [`SpectralError::BadParameter`] for a bound that is no number, [`SpectralError::TooMuchMemory`],
/// [`SpectralError::NotFactored`].
pub fn count_below(
    operator: &Operator,
    bound: f64,
    memory_limit: Option<u64>,
) -> Result<usize, SpectralError> {
    if !bound.is_finite() {
        return Err(SpectralError::BadParameter {
            name: "bound",
            value: bound.to_string(),
            expected: "a finite number",
        });
    }
    let problem = StandardProblem::new(operator);
    if bound <= 0.0 || problem.len() == 0 {
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

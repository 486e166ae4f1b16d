//! How good eigenpairs are, as measured on the vectors: residuals, what rounding allows of them,
//! orthogonality.

use rayon::prelude::*;

use crate::SpectralError;
use crate::block_matrix::BlockMatrix;
use crate::row::{LANES, Lanes, Row};
use crate::standard_problem::StandardProblem;

/// `|A x - lambda x| / lambda` of each pair, measured on the vectors. An eigenvalue that is zero to rounding
/// is replaced in the denominator by the largest one that still is.
pub(crate) fn residuals(problem: &StandardProblem, values: &[f64], vectors: &BlockMatrix) -> Vec<f64> {
    let count = values.len();
    let least = Lanes::ROUNDING * problem.bound;
    let residuals = vectors.blocks()[..count.div_ceil(LANES)].par_iter().enumerate().map(|(b, x)| {
        let mut y = x.clone();
        problem.apply(x, &mut y);
        let mut sums = [0.0; LANES];
        for (x, y) in x.iter().zip(&y) {
            for l in 0..LANES.min(count - b * LANES) {
                sums[l] += (y.0[l] - values[b * LANES + l] * x.0[l]).powi(2);
            }
        }
        std::array::from_fn(|l| {
            sums[l].sqrt() / values.get(b * LANES + l).map_or(1.0, |value| value.max(least))
        })
    });
    let residuals: Vec<[f64; LANES]> = residuals.collect();
    residuals.as_flattened()[..count].to_vec()
}

/// The relative residual to reach at an eigenvalue: the tolerance, or what rounding allows. An operator
/// of norm `bound` is applied with an error of a few units in the last place of `bound`, which is much of a
/// small eigenvalue on long thin shapes and on meshes of very uneven triangles.
pub(crate) fn attainable<R: Row>(tolerance: f64, bound: f64, eigenvalue: f64) -> f64 {
    let rounding = R::ROUNDING * bound;
    tolerance.max(rounding / eigenvalue.max(rounding))
}

/// The largest residual, if all are below what is attainable.
pub(crate) fn check_residuals<R: Row>(
    values: &[f64],
    residuals: &[f64],
    bound: f64,
    tolerance: f64,
    restarts: usize,
) -> Result<f64, SpectralError> {
    let residual = residuals.iter().copied().fold(0.0, f64::max);
    let good = |&(&value, &residual): &(&f64, &f64)| residual <= attainable::<R>(tolerance, bound, value);
    let converged = values.iter().zip(residuals).filter(good).count();
    if converged == residuals.len() {
        return Ok(residual);
    }
    Err(SpectralError::NotConverged { converged, wanted: residuals.len(), restarts, residual, tolerance })
}

/// Largest entry of |V^T V - I| over the first columns.
pub(crate) fn orthogonality<R: Row>(vectors: &BlockMatrix<R>, count: usize) -> f64 {
    let gram = vectors.upper_gram(count.div_ceil(LANES));
    let entries = (0..count).flat_map(|i| (i..count).map(move |j| (i, j)));
    entries.map(|(i, j)| (gram[(i, j)] - f64::from(u8::from(i == j))).abs()).fold(0.0, f64::max)
}

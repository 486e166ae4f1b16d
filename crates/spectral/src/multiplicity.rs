//! Multiple eigenvalues: finds the copies that an iteration can have missed.
//!
//! A Krylov space that starts from b random vectors holds min(m, b) copies of an m-fold eigenvalue. So where
//! fewer than b of the eigenvalues found lie together, none is missing. Where b or more do, more may exist:
//! the iteration is repeated orthogonally to all eigenvectors found, until it finds nothing below the last
//! one wanted.

use crate::SpectralError;
use crate::block_matrix::BlockMatrix;

/// The relative distance within which eigenvalues count as copies. Those farther apart are told apart before they have
/// converged. What copies differ by is their error: the square of the residual over the gap to others, here a
/// hundredth of the eigenvalue.
fn together(tolerance: f64) -> f64 {
    (100.0 * tolerance.powi(2)).clamp(1e-8, 1e-4)
}

/// Adds to the smallest eigenpairs, `values.len()` of them in any order and found to a tolerance, the copies that an
/// iteration with `block` columns cannot have seen. `search(known, last)` finds the `block` smallest pairs
/// orthogonal to those known; those above `last` may be inexact.
pub(crate) fn add_missed_copies(
    mut values: Vec<f64>,
    mut vectors: BlockMatrix,
    block: usize,
    tolerance: f64,
    mut search: impl FnMut(&BlockMatrix, f64) -> Result<(Vec<f64>, BlockMatrix), SpectralError>,
) -> Result<(Vec<f64>, BlockMatrix), SpectralError> {
    while may_hide_copies(&values, block, tolerance) {
        let last = values.iter().copied().fold(0.0, f64::max);
        let (others, other_vectors) = search(&vectors, last)?;
        let missed = others.iter().filter(|&&value| value < last * (1.0 - 0.1 * together(tolerance))).count();
        if missed == 0 {
            break;
        }
        let wanted = values.len();
        values.extend(others);
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        order.truncate(wanted);
        let mut merged = BlockMatrix::zeros(vectors.rows(), wanted);
        merged.fill(wanted, |row, column| match order[column].checked_sub(wanted) {
            Some(other) => other_vectors.at(row, other),
            None => vectors.at(row, order[column]),
        });
        values = order.iter().map(|&at| values[at]).collect();
        vectors = merged;
        if missed < block {
            break;
        }
    }
    Ok((values, vectors))
}

/// Whether so many eigenvalues lie together that a block of `block` columns need not have seen all copies.
pub(crate) fn may_hide_copies(values: &[f64], block: usize, tolerance: f64) -> bool {
    let together = together(tolerance);
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.windows(block).any(|values| values[block - 1] - values[0] <= together * values[block - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_full_block_of_copies_raises_doubt() {
        let values = [3.0, 1.0, 2.0, 2.0, 2.000_000_01];
        assert!(may_hide_copies(&values, 3, 1e-9));
        assert!(!may_hide_copies(&values, 4, 1e-9));
        assert!(!may_hide_copies(&values[..2], 3, 1e-9));
    }

    #[test]
    fn copies_that_are_less_exact_lie_farther_apart() {
        let values = [1.0, 1.000_000_3, 1.000_000_7, 2.0];
        assert!(!may_hide_copies(&values, 3, 1e-6));
        assert!(may_hide_copies(&values, 3, 1e-4));
    }
}

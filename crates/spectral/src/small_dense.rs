//! Small dense problems: those that are projected, and the Gram matrices of blocks.

use faer::linalg::triangular_solve::solve_upper_triangular_in_place;
use faer::{Mat, Par};

/// Eigenvalues, ascending, and eigenvectors of a small symmetric matrix (its lower triangle is read).
pub(crate) fn small_eigen(matrix: &Mat<f64>) -> Option<(Vec<f64>, Mat<f64>)> {
    // The dense solver has thresholds that are not relative: give it entries of order one.
    let largest = (0..matrix.nrows()).map(|i| matrix[(i, i)].abs()).fold(f64::MIN_POSITIVE, f64::max);
    let scaled = Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)] / largest);
    let eigen = scaled.self_adjoint_eigen(faer::Side::Lower).ok()?;
    let values = (0..matrix.nrows()).map(|i| eigen.S()[i] * largest).collect();
    Some((values, eigen.U().to_owned()))
}

/// Combinations C of vectors with this Gram matrix, so that the combined vectors are orthonormal, and
/// how many there are: directions that are dependent to rounding are left out.
pub(crate) fn orthonormal_combinations(gram: &Mat<f64>) -> Option<Mat<f64>> {
    let m = gram.nrows();
    let scale: Vec<f64> = (0..m).map(|i| 1.0 / gram[(i, i)].sqrt().max(f64::MIN_POSITIVE)).collect();
    let scaled = Mat::from_fn(m, m, |i, j| gram[(i, j)] * scale[i] * scale[j]);
    if let Ok(factor) = scaled.llt(faer::Side::Lower) {
        let l = factor.L();
        if (0..m).all(|i| l[(i, i)] > 1e-6) {
            let mut basis = Mat::<f64>::identity(m, m);
            solve_upper_triangular_in_place(l.transpose(), basis.as_mut(), Par::Seq);
            return Some(Mat::from_fn(m, m, |i, j| scale[i] * basis[(i, j)]));
        }
    }
    let (values, vectors) = small_eigen(&scaled)?;
    let largest = values.last().copied().unwrap_or(1.0);
    let first = values.iter().position(|&v| v > 1e-13 * largest).unwrap_or(0);
    let entry = |i: usize, j: usize| scale[i] * vectors[(i, first + j)] / values[first + j].sqrt();
    Some(Mat::from_fn(m, m - first, entry))
}

#[cfg(test)]
mod tests {
    use mser3d_shape::SplitMix64;

    use super::*;
    use crate::block_matrix::BlockMatrix;

    #[test]
    fn dependent_vectors_are_found() {
        let mut a = BlockMatrix::zeros(500, 8);
        a.fill_noise(0..8, &mut SplitMix64::new(1));
        let sums: Vec<f64> = (0..500).map(|v| a.at(v, 0) + a.at(v, 1)).collect();
        a.blocks_mut()[0].iter_mut().zip(sums).for_each(|(row, sum)| row.0[5] = sum);
        let basis = orthonormal_combinations(&a.gram(0..1, &a)).unwrap();
        assert_eq!(basis.ncols(), 7);
        a.rotate(basis.as_ref());
        let gram = a.gram(0..1, &a);
        assert!((0..7).all(|i| (gram[(i, i)] - 1.0).abs() < 1e-10));
    }
}

//! Tall thin matrices, row by row: the dense kernels under both solvers.
//!
//! Work is split into chunks of rows whose size depends on nothing but the matrix, each done with
//! sequential kernels; sums over chunks are added in order. So results are the same bits for any
//! number of threads.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::reborrow::Reborrow;
use faer::{Accum, Mat, MatRef, Par};
use rayon::prelude::*;

/// Rows in a chunk: 512 rows of 150 columns are 600 KB, within the second-level cache.
const CHUNK: usize = 512;

/// An n x m matrix stored row by row, `stride >= m` numbers a row, so that columns can be appended.
#[derive(Clone, Debug)]
pub(crate) struct Tall {
    rows: usize,
    stride: usize,
    data: Vec<f64>,
}

impl Tall {
    pub fn zeros(rows: usize, stride: usize) -> Self {
        Self { rows, stride, data: vec![0.0; rows * stride] }
    }

    pub fn rows(&self) -> usize {
        self.rows
    }

    pub fn stride(&self) -> usize {
        self.stride
    }

    pub fn row(&self, row: usize) -> &[f64] {
        &self.data[row * self.stride..(row + 1) * self.stride]
    }

    pub fn data(&self) -> &[f64] {
        &self.data
    }

    pub fn data_mut(&mut self) -> &mut [f64] {
        &mut self.data
    }

    /// Columns `from..to` of a chunk of rows.
    fn panel(&self, chunk: usize, columns: &std::ops::Range<usize>) -> MatRef<'_, f64> {
        let first = chunk * CHUNK;
        let last = (first + CHUNK).min(self.rows);
        let data = &self.data[first * self.stride..last * self.stride];
        MatRef::from_row_major_slice(data, last - first, self.stride).subcols(columns.start, columns.len())
    }

    fn chunks(&self) -> usize {
        self.rows.div_ceil(CHUNK)
    }

    /// `self[:, a]^T other[:, b]`.
    pub fn gram(&self, a: std::ops::Range<usize>, other: &Self, b: std::ops::Range<usize>) -> Mat<f64> {
        self.sum_over_chunks(a.len(), b.len(), |chunk, sum| {
            let (left, right) = (self.panel(chunk, &a), other.panel(chunk, &b));
            matmul(sum.as_mut(), Accum::Add, left.transpose(), right, 1.0, Par::Seq);
        })
    }

    /// A matrix that is a sum over chunks of rows: partial sums of 16 chunks each, added in order.
    fn sum_over_chunks(&self, m: usize, n: usize, add: impl Fn(usize, &mut Mat<f64>) + Sync) -> Mat<f64> {
        let partial = |group: usize| {
            let mut sum = Mat::zeros(m, n);
            (16 * group..(16 * (group + 1)).min(self.chunks())).for_each(|chunk| add(chunk, &mut sum));
            sum
        };
        let partials: Vec<Mat<f64>> = (0..self.chunks().div_ceil(16)).into_par_iter().map(partial).collect();
        let mut sum = Mat::zeros(m, n);
        for partial in &partials {
            sum += partial;
        }
        sum
    }

    /// `self[:, a]^T self[:, a]`, of which the lower triangle is filled.
    pub fn self_gram(&self, a: std::ops::Range<usize>) -> Mat<f64> {
        self.sum_over_chunks(a.len(), a.len(), |chunk, sum| {
            let panel = self.panel(chunk, &a);
            let (lower, full) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
            triangular::matmul(
                sum.as_mut(),
                lower,
                Accum::Add,
                panel.transpose(),
                full,
                panel,
                full,
                1.0,
                Par::Seq,
            );
        })
    }

    /// `self -= other[:, b] coefficients`, over the first columns of `self`.
    pub fn subtract(&mut self, other: &Self, b: std::ops::Range<usize>, coefficients: MatRef<'_, f64>) {
        let stride = self.stride;
        self.data.par_chunks_mut(CHUNK * stride).enumerate().for_each(|(chunk, data)| {
            let rows = data.len() / stride;
            let target = faer::MatMut::from_row_major_slice_mut(data, rows, stride);
            let target = target.subcols_mut(0, coefficients.ncols());
            matmul(target, Accum::Add, other.panel(chunk, &b), coefficients, -1.0, Par::Seq);
        });
    }

    /// `self[:, to..] -= self[:, a] coefficients`; the columns written must not be among those read.
    pub fn subtract_within(&mut self, a: std::ops::Range<usize>, coefficients: MatRef<'_, f64>, to: usize) {
        let stride = self.stride;
        let written = to..to + coefficients.ncols();
        debug_assert!(a.end <= written.start || written.end <= a.start);
        self.data.par_chunks_mut(CHUNK * stride).for_each(|data| {
            let rows = data.len() / stride;
            let panel = faer::MatMut::from_row_major_slice_mut(data, rows, stride);
            let (read, write) = panel.split_at_col_mut(to);
            let target = write.subcols_mut(0, coefficients.ncols());
            let source = read.rb().subcols(a.start, a.len());
            matmul(target, Accum::Add, source, coefficients, -1.0, Par::Seq);
        });
    }

    /// `self[:, to..] = self[:, a] coefficients`, in place.
    pub fn rotate(&mut self, a: std::ops::Range<usize>, coefficients: MatRef<'_, f64>, to: usize) {
        let stride = self.stride;
        self.data.par_chunks_mut(CHUNK * stride).for_each(|data| {
            let rows = data.len() / stride;
            let mut product = vec![0.0; rows * coefficients.ncols()];
            let panel = MatRef::from_row_major_slice(&*data, rows, stride).subcols(a.start, a.len());
            let mut result = faer::MatMut::from_row_major_slice_mut(&mut product, rows, coefficients.ncols());
            matmul(result.as_mut(), Accum::Replace, panel, coefficients, 1.0, Par::Seq);
            for (row, values) in data.chunks_mut(stride).zip(product.chunks(coefficients.ncols())) {
                row[to..to + values.len()].copy_from_slice(values);
            }
        });
    }

    /// Copies the first columns of `block` to `self[:, to..to + count]`.
    pub fn set_columns(&mut self, to: usize, block: &Self, count: usize) {
        let (stride, width) = (self.stride, block.stride);
        let pairs = self.data.par_chunks_mut(CHUNK * stride).zip(block.data.par_chunks(CHUNK * width));
        pairs.for_each(|(target, source)| {
            for (row, values) in target.chunks_mut(stride).zip(source.chunks(width)) {
                row[to..to + count].copy_from_slice(&values[..count]);
            }
        });
    }

    /// Columns `from..from + block.stride` into `block`; beyond `count` it is filled with zeros.
    pub fn get_columns(&self, from: usize, count: usize, block: &mut Self) {
        let (stride, width) = (self.stride, block.stride);
        let pairs = block.data.par_chunks_mut(CHUNK * width).zip(self.data.par_chunks(CHUNK * stride));
        pairs.for_each(|(target, source)| {
            for (values, row) in target.chunks_mut(width).zip(source.chunks(stride)) {
                values[..count].copy_from_slice(&row[from..from + count]);
                values[count..].fill(0.0);
            }
        });
    }

    /// Euclidean norms of the columns.
    pub fn column_norms(&self) -> Vec<f64> {
        let partial: Vec<Vec<f64>> = self
            .data
            .par_chunks(16 * CHUNK * self.stride)
            .map(|rows| {
                let mut sums = vec![0.0; self.stride];
                for row in rows.chunks(self.stride) {
                    for (sum, x) in sums.iter_mut().zip(row) {
                        *sum += x * x;
                    }
                }
                sums
            })
            .collect();
        let mut norms = vec![0.0; self.stride];
        for sums in partial {
            for (norm, sum) in norms.iter_mut().zip(sums) {
                *norm += sum;
            }
        }
        norms.iter().map(|s| s.sqrt()).collect()
    }
}

/// Eigenvalues, ascending, and eigenvectors of a small symmetric matrix (its lower triangle is read).
pub(crate) fn small_eigen(matrix: &Mat<f64>) -> Option<(Vec<f64>, Mat<f64>)> {
    let eigen = matrix.self_adjoint_eigen(faer::Side::Lower).ok()?;
    let values = (0..matrix.nrows()).map(|i| eigen.S()[i]).collect();
    Some((values, eigen.U().to_owned()))
}

/// A reproducible stream of numbers in (-1, 1) (SplitMix64): starting vectors.
pub(crate) struct Noise(pub u64);

impl Noise {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_agree_with_their_definitions() {
        let (n, m) = (1300, 7);
        let mut noise = Noise(3);
        let mut a = Tall::zeros(n, m);
        a.data.iter_mut().for_each(|x| *x = noise.next());
        let mut b = Tall::zeros(n, 3);
        b.data.iter_mut().for_each(|x| *x = noise.next());

        let (whole, lower) = (a.gram(1..6, &a, 1..6), a.self_gram(1..6));
        assert!((0..5).all(|i| (0..=i).all(|j| (whole[(i, j)] - lower[(i, j)]).abs() < 1e-10)));
        let gram = a.gram(2..6, &b, 0..3);
        for i in 0..4 {
            for j in 0..3 {
                let direct: f64 = (0..n).map(|v| a.row(v)[2 + i] * b.row(v)[j]).sum();
                assert!((gram[(i, j)] - direct).abs() < 1e-10);
            }
        }
        let coefficients = Mat::from_fn(4, 3, |i, j| (i + 2 * j) as f64);
        let (before, old) = (b.clone(), a.clone());
        b.subtract(&a, 2..6, coefficients.as_ref());
        a.rotate(2..6, coefficients.as_ref(), 1);
        for v in [0, 511, 512, 1299] {
            for j in 0..3 {
                let product: f64 = (0..4).map(|i| old.row(v)[2 + i] * coefficients[(i, j)]).sum();
                assert!((before.row(v)[j] - product - b.row(v)[j]).abs() < 1e-12);
                assert!((a.row(v)[1 + j] - product).abs() < 1e-12);
            }
            assert_eq!(a.row(v)[0], old.row(v)[0]);
        }
        let mut within = old.clone();
        within.subtract_within(1..3, coefficients.submatrix(0, 0, 2, 3), 4);
        let expected = old.row(600)[5] - 2.0 * old.row(600)[1] - 3.0 * old.row(600)[2];
        assert!((within.row(600)[5] - expected).abs() < 1e-12);
    }
}

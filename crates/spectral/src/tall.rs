//! Tall thin matrices as blocks of eight columns: the dense kernels under both solvers.
//!
//! A row of a block is one cache line. A block is what filters, factors and stencils work on in
//! place; the dense kernels pack chunks of rows for matrix multiplication.
//!
//! Work is split into chunks of rows whose size depends on nothing but the matrix, each done with
//! sequential kernels; sums over chunks are added in order. So results are the same bits for any
//! number of threads.

use std::ops::Range;

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, Mat, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Columns of a block.
pub(crate) const LANES: usize = 8;

/// A row of a block, aligned so that a vector register reads it at once.
#[repr(align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lanes(pub [f64; LANES]);

/// A block of columns.
pub(crate) type Block = Vec<Lanes>;

/// Rows in a chunk: 256 rows of 150 columns are 300 KB, within the second-level cache.
const CHUNK: usize = 256;
/// Chunks that share a partial sum.
const GROUP: usize = 32;

/// A matrix of `rows` rows; columns beyond the used ones are zero or rubbish.
#[derive(Clone, Debug)]
pub(crate) struct Tall {
    rows: usize,
    columns: usize,
    blocks: Vec<Block>,
}

impl Tall {
    pub fn zeros(rows: usize, columns: usize) -> Self {
        let blocks = vec![vec![Lanes([0.0; LANES]); rows]; columns.div_ceil(LANES)];
        Self { rows, columns, blocks }
    }

    pub fn rows(&self) -> usize {
        self.rows
    }

    pub fn columns(&self) -> usize {
        self.columns
    }

    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.blocks[column / LANES][row].0[column % LANES]
    }

    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    pub fn blocks_mut(&mut self) -> &mut [Block] {
        &mut self.blocks
    }

    /// A block by value, to work on; give it back with [`Tall::put`].
    pub fn take(&mut self, block: usize) -> Block {
        std::mem::take(&mut self.blocks[block])
    }

    pub fn put(&mut self, block: usize, values: Block) {
        self.blocks[block] = values;
    }

    /// Sets each entry, row by row.
    pub fn fill(&mut self, mut value: impl FnMut(usize, usize) -> f64) {
        for row in 0..self.rows {
            for column in 0..self.columns {
                self.blocks[column / LANES][row].0[column % LANES] = value(row, column);
            }
        }
    }

    /// Fills some columns with noise.
    pub fn fill_noise(&mut self, columns: Range<usize>, noise: &mut Noise) {
        for column in columns {
            for row in &mut self.blocks[column / LANES] {
                row.0[column % LANES] = noise.next();
            }
        }
    }

    fn chunks(&self) -> usize {
        self.rows.div_ceil(CHUNK)
    }

    fn rows_of(&self, chunk: usize) -> Range<usize> {
        chunk * CHUNK..((chunk + 1) * CHUNK).min(self.rows)
    }

    /// Packs some columns of a chunk of rows, row by row; whole blocks are copied.
    fn pack(&self, chunk: usize, columns: &Range<usize>, buffer: &mut Vec<f64>) -> Panel {
        let rows = self.rows_of(chunk);
        let (first, last) = (columns.start / LANES, columns.end.div_ceil(LANES));
        let stride = (last - first) * LANES;
        buffer.resize(rows.len() * stride, 0.0);
        for (b, block) in self.blocks[first..last].iter().enumerate() {
            for (target, source) in buffer.chunks_exact_mut(stride).zip(&block[rows.clone()]) {
                target[b * LANES..(b + 1) * LANES].copy_from_slice(&source.0);
            }
        }
        Panel { rows: rows.len(), stride, offset: columns.start % LANES, columns: columns.len() }
    }

    /// A matrix that is a sum over chunks of rows.
    fn sum_over_chunks(
        &self,
        m: usize,
        n: usize,
        add: impl Fn(usize, &mut Mat<f64>, &mut [Vec<f64>; 2]) + Sync,
    ) -> Mat<f64> {
        let partial = |group: usize| {
            let (mut sum, mut buffers) = (Mat::zeros(m, n), [Vec::new(), Vec::new()]);
            let chunks = group * GROUP..((group + 1) * GROUP).min(self.chunks());
            chunks.for_each(|chunk| add(chunk, &mut sum, &mut buffers));
            sum
        };
        let partials: Vec<Mat<f64>> =
            (0..self.chunks().div_ceil(GROUP)).into_par_iter().map(partial).collect();
        let mut sum = Mat::zeros(m, n);
        partials.iter().for_each(|partial| sum += partial);
        sum
    }

    /// `self[:, a]^T other[:, b]`.
    pub fn gram(&self, a: Range<usize>, other: &Self, b: Range<usize>) -> Mat<f64> {
        self.sum_over_chunks(a.len(), b.len(), |chunk, sum, [left, right]| {
            let (p, q) = (self.pack(chunk, &a, left), other.pack(chunk, &b, right));
            matmul(sum.as_mut(), Accum::Add, p.of(left).transpose(), q.of(right), 1.0, Par::Seq);
        })
    }

    /// `self[:, a]^T self[:, a]`, of which the lower triangle is filled.
    pub fn self_gram(&self, a: Range<usize>) -> Mat<f64> {
        self.sum_over_chunks(a.len(), a.len(), |chunk, sum, [buffer, _]| {
            let panel = self.pack(chunk, &a, buffer).of(buffer);
            let (lower, full) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
            let transposed = panel.transpose();
            triangular::matmul(sum.as_mut(), lower, Accum::Add, transposed, full, panel, full, 1.0, Par::Seq);
        })
    }

    /// Calls `work` on every chunk of rows of all blocks, in parallel.
    fn for_each_chunk(&mut self, work: impl Fn(usize, &mut [&mut [Lanes]]) + Sync) {
        let mut chunks: Vec<Vec<&mut [Lanes]>> = (0..self.chunks()).map(|_| Vec::new()).collect();
        for block in &mut self.blocks {
            for (chunk, rows) in chunks.iter_mut().zip(block.chunks_mut(CHUNK)) {
                chunk.push(rows);
            }
        }
        chunks.par_iter_mut().enumerate().for_each(|(chunk, blocks)| work(chunk, blocks));
    }

    /// `self -= other[:, b] coefficients`, over the first columns of `self`.
    pub fn subtract(&mut self, other: &Self, b: Range<usize>, coefficients: MatRef<'_, f64>) {
        self.for_each_chunk(|chunk, blocks| {
            let mut buffer = Vec::new();
            let panel = other.pack(chunk, &b, &mut buffer);
            let product = multiply(panel.of(&buffer), coefficients);
            combine(blocks, 0, coefficients.ncols(), &product, |x, p| *x -= p);
        });
    }

    /// `self[:, to..] -= self[:, a] coefficients`; the columns written must not be among those read.
    pub fn subtract_within(&mut self, a: Range<usize>, coefficients: MatRef<'_, f64>, to: usize) {
        debug_assert!(a.end <= to || to + coefficients.ncols() <= a.start);
        self.for_each_chunk(|_, blocks| {
            let mut buffer = Vec::new();
            let panel = pack_rows(blocks, &a, &mut buffer);
            let product = multiply(panel.of(&buffer), coefficients);
            combine(blocks, to, coefficients.ncols(), &product, |x, p| *x -= p);
        });
    }

    /// `self[:, to..] = self[:, a] coefficients`, in place.
    pub fn rotate(&mut self, a: Range<usize>, coefficients: MatRef<'_, f64>, to: usize) {
        self.for_each_chunk(|_, blocks| {
            let mut buffer = Vec::new();
            let panel = pack_rows(blocks, &a, &mut buffer);
            let product = multiply(panel.of(&buffer), coefficients);
            combine(blocks, to, coefficients.ncols(), &product, |x, p| *x = p);
        });
    }

    /// Euclidean norms of the columns.
    pub fn column_norms(&self) -> Vec<f64> {
        let norms = |block: &Block| {
            let mut total = [0.0; LANES];
            for rows in block.chunks(CHUNK) {
                let mut sum = [0.0; LANES];
                for row in rows {
                    (0..LANES).for_each(|l| sum[l] += row.0[l] * row.0[l]);
                }
                (0..LANES).for_each(|l| total[l] += sum[l]);
            }
            total.map(f64::sqrt)
        };
        let norms: Vec<[f64; LANES]> = self.blocks.par_iter().map(norms).collect();
        norms.as_flattened()[..self.columns].to_vec()
    }
}

/// Where packed columns lie in their buffer.
struct Panel {
    rows: usize,
    stride: usize,
    offset: usize,
    columns: usize,
}

impl Panel {
    fn of<'b>(&self, buffer: &'b [f64]) -> MatRef<'b, f64> {
        MatRef::from_row_major_slice(&buffer[..self.rows * self.stride], self.rows, self.stride)
            .subcols(self.offset, self.columns)
    }
}

/// As [`Tall::pack`], of rows that are borrowed for writing.
fn pack_rows(blocks: &[&mut [Lanes]], columns: &Range<usize>, buffer: &mut Vec<f64>) -> Panel {
    let (first, last) = (columns.start / LANES, columns.end.div_ceil(LANES));
    let (rows, stride) = (blocks[0].len(), (last - first) * LANES);
    buffer.resize(rows * stride, 0.0);
    for (b, block) in blocks[first..last].iter().enumerate() {
        for (target, source) in buffer.chunks_exact_mut(stride).zip(block.iter()) {
            target[b * LANES..(b + 1) * LANES].copy_from_slice(&source.0);
        }
    }
    Panel { rows, stride, offset: columns.start % LANES, columns: columns.len() }
}

/// `panel coefficients`, row by row.
fn multiply(panel: MatRef<'_, f64>, coefficients: MatRef<'_, f64>) -> Vec<f64> {
    let (rows, columns) = (panel.nrows(), coefficients.ncols());
    let mut product = vec![0.0; rows * columns];
    let result = MatMut::from_row_major_slice_mut(&mut product, rows, columns);
    matmul(result, Accum::Replace, panel, coefficients, 1.0, Par::Seq);
    product
}

/// Combines columns `to..to + count` of a chunk with a product of `count` columns.
fn combine(
    blocks: &mut [&mut [Lanes]],
    to: usize,
    count: usize,
    product: &[f64],
    operation: impl Fn(&mut f64, f64),
) {
    let mut done = 0;
    while done < count {
        let (block, lane) = ((to + done) / LANES, (to + done) % LANES);
        let width = (LANES - lane).min(count - done);
        for (target, values) in blocks[block].iter_mut().zip(product.chunks_exact(count)) {
            for (x, &p) in target.0[lane..lane + width].iter_mut().zip(&values[done..done + width]) {
                operation(x, p);
            }
        }
        done += width;
    }
}

/// Eigenvalues, ascending, and eigenvectors of a small symmetric matrix (its lower triangle is read).
pub(crate) fn small_eigen(matrix: &Mat<f64>) -> Option<(Vec<f64>, Mat<f64>)> {
    let eigen = matrix.self_adjoint_eigen(faer::Side::Lower).ok()?;
    let values = (0..matrix.nrows()).map(|i| eigen.S()[i]).collect();
    Some((values, eigen.U().to_owned()))
}

/// Combinations of vectors with this Gram matrix (lower triangle) that are orthonormal, and the
/// condition of the scaled Gram matrix. Directions that are dependent to rounding are left out.
pub(crate) fn orthonormal_combinations(gram: &Mat<f64>) -> Option<(Mat<f64>, f64)> {
    let m = gram.nrows();
    let scale: Vec<f64> = (0..m).map(|i| 1.0 / gram[(i, i)].sqrt().max(f64::MIN_POSITIVE)).collect();
    let scaled = Mat::from_fn(m, m, |i, j| gram[(i.max(j), i.min(j))] * scale[i] * scale[j]);
    let (values, vectors) = small_eigen(&scaled)?;
    let largest = values.last().copied().unwrap_or(1.0);
    let first = values.iter().position(|&v| v > 1e-13 * largest).unwrap_or(0);
    let basis =
        Mat::from_fn(m, m - first, |i, j| scale[i] * vectors[(i, first + j)] / values[first + j].sqrt());
    Some((basis, largest / values[first]))
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

    fn noise(rows: usize, columns: usize, seed: u64) -> Tall {
        let mut tall = Tall::zeros(rows, columns);
        tall.fill_noise(0..columns, &mut Noise(seed));
        tall
    }

    #[test]
    fn kernels_agree_with_their_definitions() {
        let n = 9000;
        let (mut a, mut b) = (noise(n, 21, 3), noise(n, 3, 4));
        let (whole, lower) = (a.gram(5..19, &a, 5..19), a.self_gram(5..19));
        assert!((0..14).all(|i| (0..=i).all(|j| (whole[(i, j)] - lower[(i, j)]).abs() < 1e-9)));
        let gram = a.gram(6..10, &b, 0..3);
        for i in 0..4 {
            for j in 0..3 {
                let direct: f64 = (0..n).map(|v| a.at(v, 6 + i) * b.at(v, j)).sum();
                assert!((gram[(i, j)] - direct).abs() < 1e-9);
            }
        }
        let coefficients = Mat::from_fn(4, 3, |i, j| (i + 2 * j) as f64);
        let product = |a: &Tall, v: usize, j: usize| -> f64 {
            (0..4).map(|i| a.at(v, 6 + i) * coefficients[(i, j)]).sum()
        };
        let (old, before) = (a.clone(), b.clone());
        let mut within = a.clone();
        b.subtract(&a, 6..10, coefficients.as_ref());
        within.subtract_within(6..10, coefficients.as_ref(), 14);
        a.rotate(6..10, coefficients.as_ref(), 7);
        for v in [0, 255, 256, n - 1] {
            for j in 0..3 {
                let expected = product(&old, v, j);
                assert!((before.at(v, j) - expected - b.at(v, j)).abs() < 1e-12);
                assert!((old.at(v, 14 + j) - expected - within.at(v, 14 + j)).abs() < 1e-12);
                assert!((a.at(v, 7 + j) - expected).abs() < 1e-12);
            }
            assert_eq!(a.at(v, 6), old.at(v, 6));
            assert_eq!(a.at(v, 10), old.at(v, 10));
        }
        let norm = (0..n).map(|v| old.at(v, 20).powi(2)).sum::<f64>().sqrt();
        assert!((old.column_norms()[20] - norm).abs() < 1e-10);
    }

    #[test]
    fn dependent_vectors_are_found() {
        let mut a = noise(500, 6, 1);
        a.fill_noise(0..0, &mut Noise(0));
        let dependent: Vec<f64> = (0..500).map(|v| a.at(v, 0) + a.at(v, 1)).collect();
        for (row, value) in dependent.iter().enumerate() {
            a.blocks_mut()[0][row].0[5] = *value;
        }
        let (basis, _) = orthonormal_combinations(&a.self_gram(0..6)).unwrap();
        assert_eq!(basis.ncols(), 5);
        a.rotate(0..6, basis.as_ref(), 0);
        let gram = a.self_gram(0..5);
        assert!((0..5).all(|i| (gram[(i, i)] - 1.0).abs() < 1e-10));
    }
}

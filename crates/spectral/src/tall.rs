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
use faer::linalg::triangular_solve::solve_upper_triangular_in_place;
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
            add_lower(sum.as_mut(), panel, panel);
        })
    }

    /// `V^T V` and `V^T (A V)` for `V = self[:, a]`, of which the lower triangles are filled.
    /// `image(block, rows, target)` sets target to some rows of A times a block; the images are never
    /// stored.
    pub fn gram_and_energy(
        &self,
        a: Range<usize>,
        image: impl Fn(&Block, Range<usize>, &mut [Lanes]) + Sync,
    ) -> (Mat<f64>, Mat<f64>) {
        let m = a.len();
        let both = self.sum_over_chunks(m, 2 * m, |chunk, sum, [buffer, images]| {
            let (rows, blocks) = (self.rows_of(chunk), a.start / LANES..a.end.div_ceil(LANES));
            let panel = self.pack(chunk, &a, buffer);
            images.resize(buffer.len(), 0.0);
            let mut target = [Lanes([0.0; LANES]); CHUNK];
            for (b, block) in self.blocks[blocks].iter().enumerate() {
                image(block, rows.clone(), &mut target[..rows.len()]);
                for (packed, lanes) in images.chunks_exact_mut(panel.stride).zip(&target) {
                    packed[b * LANES..(b + 1) * LANES].copy_from_slice(&lanes.0);
                }
            }
            let (gram, energy) = sum.as_mut().split_at_col_mut(m);
            add_lower(gram, panel.of(buffer), panel.of(buffer));
            add_lower(energy, panel.of(buffer), panel.of(images));
        });
        (both.subcols(0, m).to_owned(), both.subcols(m, m).to_owned())
    }

    /// `|A v - theta v|` of all columns from block `first` on, with `image` as in
    /// [`Tall::gram_and_energy`].
    pub fn residual_norms(
        &self,
        first: usize,
        theta: &[f64],
        image: impl Fn(&Block, Range<usize>, &mut [Lanes]) + Sync,
    ) -> Vec<f64> {
        let norms = |(b, block): (usize, &Block)| {
            let from = (first + b) * LANES;
            let theta: [f64; LANES] = std::array::from_fn(|l| theta.get(from + l).copied().unwrap_or(0.0));
            let mut total = [0.0; LANES];
            let mut target = [Lanes([0.0; LANES]); CHUNK];
            for chunk in 0..self.chunks() {
                let rows = self.rows_of(chunk);
                image(block, rows.clone(), &mut target[..rows.len()]);
                let mut sum = [0.0; LANES];
                for (x, y) in block[rows].iter().zip(&target) {
                    (0..LANES).for_each(|l| sum[l] += (y.0[l] - theta[l] * x.0[l]).powi(2));
                }
                (0..LANES).for_each(|l| total[l] += sum[l]);
            }
            total.map(f64::sqrt)
        };
        let norms: Vec<[f64; LANES]> = self.blocks[first..].par_iter().enumerate().map(norms).collect();
        norms.as_flattened().to_vec()
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
}

/// `sum += a^T b`, lower triangle only.
fn add_lower(sum: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    let (lower, full) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
    triangular::matmul(sum, lower, Accum::Add, a.transpose(), full, b, full, 1.0, Par::Seq);
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

/// Combinations C of vectors with this Gram matrix (lower triangle), so that the combined vectors are
/// orthonormal, and the condition of the scaled Gram matrix. Directions that are dependent to rounding
/// are left out.
///
/// Cholesky where it can: it leaves the first vectors, those that have converged, nearly untouched.
pub(crate) fn orthonormal_combinations(gram: &Mat<f64>) -> Option<(Mat<f64>, f64)> {
    let m = gram.nrows();
    let scale: Vec<f64> = (0..m).map(|i| 1.0 / gram[(i, i)].sqrt().max(f64::MIN_POSITIVE)).collect();
    let scaled = Mat::from_fn(m, m, |i, j| gram[(i.max(j), i.min(j))] * scale[i] * scale[j]);
    if let Ok(factor) = scaled.llt(faer::Side::Lower) {
        let l = factor.L();
        let smallest = (0..m).map(|i| l[(i, i)]).fold(1.0, f64::min);
        if smallest > 1e-6 {
            let mut basis = Mat::<f64>::identity(m, m);
            solve_upper_triangular_in_place(l.transpose(), basis.as_mut(), Par::Seq);
            return Some((Mat::from_fn(m, m, |i, j| scale[i] * basis[(i, j)]), smallest.powi(-2)));
        }
    }
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
        // Against an "operator" that doubles each vector.
        let double = |x: &Block, rows: Range<usize>, y: &mut [Lanes]| {
            y.iter_mut().zip(&x[rows]).for_each(|(y, x)| *y = Lanes(x.0.map(|x| 2.0 * x)));
        };
        let (same, twice) = old.gram_and_energy(5..19, double);
        assert!((0..14).all(|i| (0..=i).all(|j| (same[(i, j)] - lower[(i, j)]).abs() < 1e-9)));
        assert!((0..14).all(|i| (0..=i).all(|j| (twice[(i, j)] - 2.0 * lower[(i, j)]).abs() < 1e-9)));
        let norm = (0..n).map(|v| old.at(v, 20).powi(2)).sum::<f64>().sqrt();
        let theta = vec![1.5; 21];
        assert!((old.residual_norms(1, &theta, double)[12] - 0.5 * norm).abs() < 1e-9);
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

//! Tall thin matrices as blocks of eight columns: the dense kernels under both solvers.
//!
//! A row of a block is one cache line and, with AVX-512, one register. Filters, factors and stencils
//! work on blocks in place; products of matrices are made of 8 x 8 kernels on them, without packing.
//!
//! Work is split into chunks of rows whose size depends on nothing but the matrix; sums over chunks
//! are added in order. So results are the same bits for any number of threads.

use std::ops::Range;

use faer::linalg::triangular_solve::solve_upper_triangular_in_place;
use faer::{Mat, MatRef, Par};
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

/// Columns of a block.
pub(crate) const LANES: usize = 8;

/// A row of a block, aligned so that a vector register reads it at once.
#[repr(align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lanes(pub [f64; LANES]);

impl Lanes {
    pub const ZERO: Self = Self([0.0; LANES]);
}

/// A block of columns.
pub(crate) type Block = Vec<Lanes>;

/// Products of a row of one block with a row of another: entry (i, j) is row i, lane j.
type Square = [Lanes; LANES];

/// Rows in a chunk: of a block 32 KB, enough for the processor to fetch ahead.
const CHUNK: usize = 512;
/// Chunks that share a partial sum.
const GROUP: usize = 16;

/// A matrix of `rows` rows and whole blocks of columns.
#[derive(Clone, Debug)]
pub(crate) struct Tall {
    rows: usize,
    blocks: Vec<Block>,
}

impl Tall {
    /// At least `columns` columns of zeros.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, blocks: vec![vec![Lanes::ZERO; rows]; columns.div_ceil(LANES)] }
    }

    pub fn from_blocks(rows: usize, blocks: Vec<Block>) -> Self {
        Self { rows, blocks }
    }

    pub fn rows(&self) -> usize {
        self.rows
    }

    #[inline]
    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.blocks[column / LANES][row].0[column % LANES]
    }

    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    pub fn blocks_mut(&mut self) -> &mut Vec<Block> {
        &mut self.blocks
    }

    /// Sets the first `columns` columns, row by row.
    pub fn fill(&mut self, columns: usize, mut value: impl FnMut(usize, usize) -> f64) {
        for row in 0..self.rows {
            for column in 0..columns {
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

    fn rows_of(&self, chunk: usize) -> Range<usize> {
        chunk * CHUNK..((chunk + 1) * CHUNK).min(self.rows)
    }

    /// `self[:, blocks]^T other`: rows are the columns of the blocks.
    pub fn gram(&self, blocks: Range<usize>, other: &Self) -> Mat<f64> {
        self.products(blocks, other, |_, _| true)
    }

    /// The blocks of `self^T self` on and above the diagonal, for the first `blocks` blocks; zeros below.
    pub fn upper_gram(&self, blocks: usize) -> Mat<f64> {
        self.products(0..blocks, self, |i, j| i <= j && j < blocks)
    }

    /// The blocks of `self[:, blocks]^T other` that are `wanted(i, j)`; zeros elsewhere.
    fn products(
        &self,
        blocks: Range<usize>,
        other: &Self,
        wanted: impl Fn(usize, usize) -> bool + Sync,
    ) -> Mat<f64> {
        let left = &self.blocks[blocks];
        let (m, n) = (left.len(), other.blocks.len());
        let partial = |group: usize| {
            let mut sums = vec![[Lanes::ZERO; LANES]; m * n];
            for chunk in group * GROUP..((group + 1) * GROUP).min(self.rows.div_ceil(CHUNK)) {
                let rows = self.rows_of(chunk);
                for (i, a) in left.iter().enumerate() {
                    for (j, b) in other.blocks.iter().enumerate().filter(|&(j, _)| wanted(i, j)) {
                        add_products(&a[rows.clone()], &b[rows.clone()], &mut sums[i * n + j]);
                    }
                }
            }
            sums
        };
        let groups = self.rows.div_ceil(CHUNK * GROUP);
        let partials: Vec<Vec<Square>> = (0..groups).into_par_iter().map(partial).collect();
        total(partials, m, n)
    }

    /// `self -= other[:, blocks] coefficients`.
    pub fn subtract(&mut self, other: &Self, blocks: Range<usize>, coefficients: MatRef<'_, f64>) {
        let squares = squares(coefficients, -1.0);
        let left = &other.blocks[blocks];
        self.update(0, |rows, targets, _| combine(left, rows, &squares, targets));
    }

    /// As [`Self::subtract`], and in the same pass `other[:, blocks]^T self` of what is left.
    pub fn subtract_then_gram(
        &mut self,
        other: &Self,
        blocks: Range<usize>,
        coefficients: MatRef<'_, f64>,
    ) -> Mat<f64> {
        let squares = squares(coefficients, -1.0);
        let left = &other.blocks[blocks];
        self.update(left.len(), |rows, targets, sums| {
            combine(left, rows.clone(), &squares, targets);
            let pairs = left.iter().flat_map(|a| targets.iter().map(move |b| (a, b)));
            pairs.zip(sums).for_each(|((a, b), sum)| add_products(&a[rows.clone()], b, sum));
        })
    }

    /// As [`Self::subtract`], and in the same pass `self^T self` of what is left.
    pub fn subtract_then_self_gram(
        &mut self,
        other: &Self,
        blocks: Range<usize>,
        coefficients: MatRef<'_, f64>,
    ) -> Mat<f64> {
        let squares = squares(coefficients, -1.0);
        let left = &other.blocks[blocks];
        self.update(self.blocks.len(), |rows, targets, sums| {
            combine(left, rows, &squares, targets);
            add_own_products(targets, sums);
        })
    }

    /// `self = self coefficients`, in place; columns beyond those of the coefficients stay.
    pub fn rotate(&mut self, coefficients: MatRef<'_, f64>) {
        let squares = squares(coefficients, 1.0);
        self.update(0, |_, targets, _| rotate(coefficients, &squares, targets));
    }

    /// As [`Self::rotate`], and in the same pass `self^T self` of the result.
    pub fn rotate_then_self_gram(&mut self, coefficients: MatRef<'_, f64>) -> Mat<f64> {
        let squares = squares(coefficients, 1.0);
        self.update(self.blocks.len(), |_, targets, sums| {
            rotate(coefficients, &squares, targets);
            add_own_products(targets, sums);
        })
    }

    /// Calls `work(rows, rows of all blocks, sums)` on every chunk of rows, in parallel, where sums are squares
    /// for each of `m` blocks with each block of self. Returns the sums.
    fn update(
        &mut self,
        m: usize,
        work: impl Fn(Range<usize>, &mut [&mut [Lanes]], &mut [Square]) + Sync,
    ) -> Mat<f64> {
        let (n, all) = (self.blocks.len(), self.rows);
        let mut groups: Vec<Vec<&mut [Lanes]>> =
            (0..all.div_ceil(CHUNK * GROUP)).map(|_| Vec::new()).collect();
        for block in &mut self.blocks {
            for (group, rows) in groups.iter_mut().zip(block.chunks_mut(CHUNK * GROUP)) {
                group.push(rows);
            }
        }
        let partial = |(group, mut blocks): (usize, Vec<&mut [Lanes]>)| {
            let mut sums = vec![[Lanes::ZERO; LANES]; m * n];
            for chunk in group * GROUP..((group + 1) * GROUP).min(all.div_ceil(CHUNK)) {
                let rows = chunk * CHUNK..((chunk + 1) * CHUNK).min(all);
                let first = rows.start - group * GROUP * CHUNK;
                let mut targets: Vec<&mut [Lanes]> =
                    blocks.iter_mut().map(|block| &mut block[first..first + rows.len()]).collect();
                work(rows, &mut targets, &mut sums);
            }
            sums
        };
        let partials = groups.into_par_iter().enumerate().map(partial).collect();
        total(partials, m, n)
    }
}

/// The sum of partial sums, m by n squares each, in their order.
fn total(partials: Vec<Vec<Square>>, m: usize, n: usize) -> Mat<f64> {
    let mut total = Mat::zeros(m * LANES, n * LANES);
    for sums in partials {
        for (at, square) in sums.iter().enumerate() {
            for i in 0..LANES {
                for j in 0..LANES {
                    total[(at / n * LANES + i, at % n * LANES + j)] += square[i].0[j];
                }
            }
        }
    }
    total
}

/// `targets += left[rows] coefficients`.
fn combine(left: &[Block], rows: Range<usize>, squares: &[Square], targets: &mut [&mut [Lanes]]) {
    for (a, squares) in left.iter().zip(squares.chunks_exact(targets.len())) {
        for (target, square) in targets.iter_mut().zip(squares) {
            add_combination(&a[rows.clone()], square, target);
        }
    }
}

/// `blocks = blocks coefficients`.
fn rotate(coefficients: MatRef<'_, f64>, squares: &[Square], blocks: &mut [&mut [Lanes]]) {
    let (m, n) = (coefficients.nrows().div_ceil(LANES), coefficients.ncols().div_ceil(LANES));
    let length = blocks[0].len();
    let mut product = vec![Lanes::ZERO; n * length];
    for (j, target) in product.chunks_exact_mut(length).enumerate() {
        for (i, a) in blocks[..m].iter().enumerate() {
            add_combination(a, &squares[i * n + j], target);
        }
    }
    for (block, values) in blocks.iter_mut().zip(product.chunks_exact(length)) {
        block.copy_from_slice(values);
    }
}

/// `sums += blocks^T blocks`.
fn add_own_products(blocks: &[&mut [Lanes]], sums: &mut [Square]) {
    let pairs = blocks.iter().flat_map(|a| blocks.iter().map(move |b| (a, b)));
    pairs.zip(sums).for_each(|((a, b), sum)| add_products(a, b, sum));
}

/// Coefficients as 8 x 8 squares, row by row of squares, filled up with zeros.
fn squares(coefficients: MatRef<'_, f64>, factor: f64) -> Vec<Square> {
    let (m, n) = (coefficients.nrows().div_ceil(LANES), coefficients.ncols().div_ceil(LANES));
    let entry = |i: usize, j: usize| {
        let inside = i < coefficients.nrows() && j < coefficients.ncols();
        if inside { factor * coefficients[(i, j)] } else { 0.0 }
    };
    let square = |at: usize| -> Square {
        std::array::from_fn(|i| Lanes(std::array::from_fn(|j| entry(at / n * LANES + i, at % n * LANES + j))))
    };
    (0..m * n).map(square).collect()
}

/// `sum += a^T b`.
fn add_products(a: &[Lanes], b: &[Lanes], sum: &mut Square) {
    pulp::Arch::new().dispatch(Products { a, b, sum });
}

/// `target += a coefficients`.
fn add_combination(a: &[Lanes], coefficients: &Square, target: &mut [Lanes]) {
    pulp::Arch::new().dispatch(Combination { a, coefficients, target });
}

struct Products<'a> {
    a: &'a [Lanes],
    b: &'a [Lanes],
    sum: &'a mut Square,
}

impl WithSimd for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for part in 0..LANES / S::F64_LANES {
            let load = |lanes: &Lanes| S::as_simd_f64s(&lanes.0).0[part];
            let mut sums: [S::f64s; LANES] = std::array::from_fn(|i| load(&self.sum[i]));
            for (a, b) in self.a.iter().zip(self.b) {
                let b = load(b);
                for i in 0..LANES {
                    sums[i] = simd.mul_add_f64s(simd.splat_f64s(a.0[i]), b, sums[i]);
                }
            }
            for (lanes, sum) in self.sum.iter_mut().zip(sums) {
                S::as_mut_simd_f64s(&mut lanes.0).0[part] = sum;
            }
        }
    }
}

struct Combination<'a> {
    a: &'a [Lanes],
    coefficients: &'a Square,
    target: &'a mut [Lanes],
}

impl WithSimd for Combination<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for part in 0..LANES / S::F64_LANES {
            let coefficients: [S::f64s; LANES] =
                std::array::from_fn(|i| S::as_simd_f64s(&self.coefficients[i].0).0[part]);
            for (a, target) in self.a.iter().zip(self.target.iter_mut()) {
                let target = &mut S::as_mut_simd_f64s(&mut target.0).0[part];
                // Two sums, so that one addition need not wait for the other.
                let mut even = *target;
                let mut odd = simd.mul_f64s(simd.splat_f64s(a.0[1]), coefficients[1]);
                even = simd.mul_add_f64s(simd.splat_f64s(a.0[0]), coefficients[0], even);
                for i in (2..LANES).step_by(2) {
                    even = simd.mul_add_f64s(simd.splat_f64s(a.0[i]), coefficients[i], even);
                    odd = simd.mul_add_f64s(simd.splat_f64s(a.0[i + 1]), coefficients[i + 1], odd);
                }
                *target = simd.add_f64s(even, odd);
            }
        }
    }
}

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
        let (mut a, mut b) = (noise(n, 32, 3), noise(n, 16, 4));
        let gram = a.gram(1..4, &b);
        for i in 0..24 {
            for j in 0..16 {
                let direct: f64 = (0..n).map(|v| a.at(v, 8 + i) * b.at(v, j)).sum();
                assert!((gram[(i, j)] - direct).abs() < 1e-9);
            }
        }
        let coefficients = Mat::from_fn(16, 16, |i, j| (i + 2 * j) as f64);
        let (old, before) = (a.clone(), b.clone());
        b.subtract(&a, 1..3, coefficients.as_ref());
        a.rotate(coefficients.subcols(0, 11));
        for v in [0, 127, 128, n - 1] {
            for j in 0..11 {
                let product =
                    |first: usize| (0..16).map(|i| old.at(v, first + i) * coefficients[(i, j)]).sum::<f64>();
                assert!((before.at(v, j) - product(8) - b.at(v, j)).abs() < 1e-11);
                assert!((a.at(v, j) - product(0)).abs() < 1e-11);
            }
            assert_eq!((a.at(v, 13), a.at(v, 16)), (0.0, old.at(v, 16)));
        }
    }

    #[test]
    fn dependent_vectors_are_found() {
        let mut a = noise(500, 8, 1);
        let sums: Vec<f64> = (0..500).map(|v| a.at(v, 0) + a.at(v, 1)).collect();
        a.blocks_mut()[0].iter_mut().zip(sums).for_each(|(row, sum)| row.0[5] = sum);
        let basis = orthonormal_combinations(&a.gram(0..1, &a)).unwrap();
        assert_eq!(basis.ncols(), 7);
        a.rotate(basis.as_ref());
        let gram = a.gram(0..1, &a);
        assert!((0..7).all(|i| (gram[(i, i)] - 1.0).abs() < 1e-10));
    }
}

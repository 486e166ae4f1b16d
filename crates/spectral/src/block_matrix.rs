//! Tall thin matrices in blocks of eight columns, and their products.
//!
//! Work is split into chunks of rows whose size depends on nothing but the matrix, and sums over chunks are
//! added in order. So results are the same bits for any number of threads.

use std::ops::Range;

use faer::{Mat, MatRef};
use mser3d_shape::SplitMix64;
use rayon::prelude::*;

use crate::kernels::{Square, add_own_products, add_products, combine, rotate, squares, total, with_next};
use crate::row::{Block, LANES, Lanes, Row};

/// Rows in a chunk: of a block 32 KB, enough for the processor to fetch ahead.
const CHUNK: usize = 512;
/// Chunks that share a partial sum.
const GROUP: usize = 16;
/// Rows that are given back at a time: of a block 64 MB, which an allocator gives back to the system.
pub(crate) const PIECE: usize = 1 << 20;

/// A matrix of `rows` rows and whole blocks of columns.
#[derive(Clone, Debug)]
pub(crate) struct BlockMatrix<R = Lanes> {
    rows: usize,
    blocks: Vec<Block<R>>,
}

impl<R: Row> BlockMatrix<R> {
    /// At least `columns` columns of zeros.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, blocks: vec![vec![R::ZERO; rows]; columns.div_ceil(LANES)] }
    }

    pub fn from_blocks(rows: usize, blocks: Vec<Block<R>>) -> Self {
        Self { rows, blocks }
    }

    pub fn rows(&self) -> usize {
        self.rows
    }

    #[inline]
    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.blocks[column / LANES][row].wide().0[column % LANES]
    }

    pub fn blocks(&self) -> &[Block<R>] {
        &self.blocks
    }

    pub fn blocks_mut(&mut self) -> &mut Vec<Block<R>> {
        &mut self.blocks
    }

    /// Rows of `width` numbers, in another order: `set(blocks, row, target)` sets the i-th from what was the row `source[i]` and is that
    /// `row` of the blocks by then. Large matrices are divided into pieces that are given back one by one, so that no more is held at a time
    /// than the matrix and a block, or the rows and a piece.
    pub fn into_rows(
        self,
        source: &[u32],
        width: usize,
        set: impl Fn(&[Block<R>], usize, &mut [R::Number]) + Sync,
    ) -> Vec<R::Number> {
        let mut all = vec![R::ZERO_NUMBER; self.rows * width];
        if self.rows <= PIECE {
            let targets = all.par_chunks_exact_mut(width).enumerate().with_min_len(CHUNK);
            targets.for_each(|(i, target)| set(&self.blocks, source[i] as usize, target));
            return all;
        }
        let mut pieces: Vec<Vec<Block<R>>> = source.chunks(PIECE).map(|_| Vec::new()).collect();
        for block in self.blocks {
            for (piece, rows) in pieces.iter_mut().zip(source.chunks(PIECE)) {
                piece.push(rows.par_iter().map(|&row| block[row as usize]).collect());
            }
        }
        for (piece, targets) in pieces.into_iter().zip(all.chunks_mut(PIECE * width)) {
            let targets = targets.par_chunks_exact_mut(width).enumerate().with_min_len(CHUNK);
            targets.for_each(|(row, target)| set(&piece, row, target));
        }
        all
    }

    fn rows_of(&self, chunk: usize) -> Range<usize> {
        chunk * CHUNK..((chunk + 1) * CHUNK).min(self.rows)
    }

    /// `self[:, blocks]^T other`: rows are the columns of the blocks.
    pub fn gram(&self, blocks: Range<usize>, other: &Self) -> Mat<f64> {
        self.products(blocks, other, |_| 0..other.blocks.len())
    }

    /// The blocks of `self^T self` on and above the diagonal, for the first `blocks` blocks; zeros below.
    pub fn upper_gram(&self, blocks: usize) -> Mat<f64> {
        self.products(0..blocks, self, |i| i..blocks)
    }

    /// The blocks (i, j) of `self[:, blocks]^T other` with j among those `wanted(i)`; zeros elsewhere.
    fn products(
        &self,
        blocks: Range<usize>,
        other: &Self,
        wanted: impl Fn(usize) -> Range<usize> + Sync,
    ) -> Mat<f64> {
        let left = &self.blocks[blocks];
        let (m, n) = (left.len(), other.blocks.len());
        let partial = |group: usize| {
            let mut sums = vec![[Lanes::ZERO; LANES]; m * n];
            let (mut left_room, mut right_room) = (Vec::new(), vec![Vec::new(); n]);
            for chunk in group * GROUP..((group + 1) * GROUP).min(self.rows.div_ceil(CHUNK)) {
                let rows = self.rows_of(chunk);
                let blocks = other.blocks.iter().zip(&mut right_room);
                let right: Vec<&[Lanes]> =
                    blocks.map(|(block, room)| R::widened(&block[rows.clone()], room)).collect();
                for (i, [a, next]) in with_next(left, rows).enumerate() {
                    let wanted = wanted(i);
                    let sums = &mut sums[i * n + wanted.start..i * n + wanted.end];
                    add_products(R::widened(a, &mut left_room), next, &right[wanted], sums);
                }
            }
            sums
        };
        let groups = self.rows.div_ceil(CHUNK * GROUP);
        let partials: Vec<Vec<Square>> = (0..groups).into_par_iter().map(partial).collect();
        total(partials, m, n)
    }

    /// `self = self coefficients`, in place; columns beyond those of the coefficients stay.
    pub fn rotate(&mut self, coefficients: MatRef<'_, f64>) {
        let squares = squares(coefficients, 1.0);
        self.update(0, |_, targets, _| rotate(coefficients, &squares, targets));
    }

    /// Calls `work(rows, rows of all blocks, sums)` on every chunk of rows, in parallel, where sums are
    /// squares for each of `m` blocks with each block of self. Returns the sums.
    fn update(
        &mut self,
        m: usize,
        work: impl Fn(Range<usize>, &mut [&mut [Lanes]], &mut [Square]) + Sync,
    ) -> Mat<f64> {
        let (n, all) = (self.blocks.len(), self.rows);
        let mut groups: Vec<Vec<&mut [R]>> = (0..all.div_ceil(CHUNK * GROUP)).map(|_| Vec::new()).collect();
        for block in &mut self.blocks {
            for (group, rows) in groups.iter_mut().zip(block.chunks_mut(CHUNK * GROUP)) {
                group.push(rows);
            }
        }
        let partial = |(group, mut blocks): (usize, Vec<&mut [R]>)| {
            let (mut sums, mut room) = (vec![[Lanes::ZERO; LANES]; m * n], vec![Vec::new(); n]);
            for chunk in group * GROUP..((group + 1) * GROUP).min(all.div_ceil(CHUNK)) {
                let rows = chunk * CHUNK..((chunk + 1) * CHUNK).min(all);
                let first = rows.start - group * GROUP * CHUNK;
                let mut targets: Vec<&mut [R]> =
                    blocks.iter_mut().map(|block| &mut block[first..first + rows.len()]).collect();
                R::change(&mut targets, &mut room, |targets| work(rows, targets, &mut sums));
            }
            sums
        };
        let partials = groups.into_par_iter().enumerate().map(partial).collect();
        total(partials, m, n)
    }
}

impl BlockMatrix {
    /// Sets the first `columns` columns, row by row.
    pub fn fill(&mut self, columns: usize, mut value: impl FnMut(usize, usize) -> f64) {
        for row in 0..self.rows {
            for column in 0..columns {
                self.blocks[column / LANES][row].0[column % LANES] = value(row, column);
            }
        }
    }

    /// Fills some columns with random numbers between -1 and 1.
    pub fn fill_noise(&mut self, columns: Range<usize>, random: &mut SplitMix64) {
        for column in columns {
            for row in &mut self.blocks[column / LANES] {
                row.0[column % LANES] = 2.0 * random.uniform() - 1.0;
            }
        }
    }

    /// Divides each column by its divisor.
    pub fn divide_columns(&mut self, divisors: &[f64]) {
        self.blocks.iter_mut().zip(divisors.chunks(LANES)).for_each(|(block, divisors)| {
            for row in block {
                divisors.iter().zip(&mut row.0).for_each(|(divisor, x)| *x /= divisor);
            }
        });
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
            for ([a, next], sums) in with_next(left, rows).zip(sums.chunks_exact_mut(targets.len())) {
                add_products(a, next, targets, sums);
            }
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

    /// As [`Self::rotate`], and in the same pass `self^T self` of the result.
    pub fn rotate_then_self_gram(&mut self, coefficients: MatRef<'_, f64>) -> Mat<f64> {
        let squares = squares(coefficients, 1.0);
        self.update(self.blocks.len(), |_, targets, sums| {
            rotate(coefficients, &squares, targets);
            add_own_products(targets, sums);
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(rows: usize, columns: usize, seed: u64) -> BlockMatrix {
        let mut matrix = BlockMatrix::zeros(rows, columns);
        matrix.fill_noise(0..columns, &mut SplitMix64::new(seed));
        matrix
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
    fn rows_in_another_order() {
        for n in [100, PIECE + 100] {
            let block = (0..n).map(|row| Lanes(std::array::from_fn(|l| (row * LANES + l) as f64))).collect();
            let source: Vec<u32> = (0..n as u32).rev().collect();
            let rows =
                BlockMatrix::from_blocks(n, vec![block]).into_rows(&source, 2, |blocks, row, target| {
                    target.copy_from_slice(&[blocks[0][row].0[0], blocks[0][row].0[7]]);
                });
            let expected = |i: usize| [(n - 1 - i) * LANES, (n - 1 - i) * LANES + 7].map(|x| x as f64);
            assert!(rows.chunks_exact(2).enumerate().all(|(i, row)| row == expected(i)), "{n}");
        }
    }
}

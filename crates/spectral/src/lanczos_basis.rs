//! The orthonormal basis of a Lanczos iteration, each block orthogonalized against all of it as late as
//! exactness allows.

use std::ops::Range;

use faer::{Mat, MatRef};
use mser3d_shape::SplitMix64;
use rayon::prelude::*;

use crate::SpectralError;
use crate::block_matrix::BlockMatrix;
use crate::null_space::NullSpace;
use crate::row::{Block, LANES};
use crate::small_dense::orthonormal_combinations;

/// Overlap that rounding leaves in an image, relative to the operator's norm.
const ROUNDING: f64 = 1e-15;
/// The most blocks that wait.
const WAITING: usize = 4;

/// The basis: columns that are orthonormal to rounding, and some blocks at the end that wait.
///
/// Streaming the basis from memory takes longer than computing with it. In exact arithmetic the image of a
/// block has no part along any but the last blocks, so a new block is orthogonalized against those at once,
/// and against the others together with those that follow it, before its overlap with them can matter.
pub(crate) struct Basis<'a> {
    columns: BlockMatrix,
    /// Columns of a block.
    block: usize,
    /// Columns that are orthonormal to rounding; the rest waits.
    settled: usize,
    /// Bounds of the overlaps of the last two blocks with settled columns.
    overlaps: [f64; 2],
    /// Overlap that a block may keep for a while.
    most_overlap: f64,
    null_space: &'a NullSpace,
    random: SplitMix64,
}

impl<'a> Basis<'a> {
    /// A block of noise, with room for `capacity` columns.
    pub fn new(
        rows: usize,
        block: usize,
        capacity: usize,
        most_overlap: f64,
        null_space: &'a NullSpace,
        seed: u64,
    ) -> Result<Self, SpectralError> {
        let columns = BlockMatrix::from_blocks(rows, Vec::with_capacity(capacity / LANES));
        let random = SplitMix64::new(0x6d73_6572_3364 + seed);
        let mut basis =
            Self { columns, block, settled: 0, overlaps: [0.0; 2], most_overlap, null_space, random };
        let mut start = BlockMatrix::zeros(rows, block);
        start.fill_noise(0..block, &mut basis.random);
        null_space.project_out(&mut start);
        let gram = start.gram(blocks(0..block), &start);
        basis.append(start, gram, 0.0)?;
        basis.settle();
        Ok(basis)
    }

    fn len(&self) -> usize {
        self.columns.blocks().len() * LANES
    }

    /// Columns that are orthonormal to rounding.
    pub fn settled(&self) -> usize {
        self.settled
    }

    /// A copy of the last block.
    pub fn last_block(&self) -> BlockMatrix {
        let first = (self.len() - self.block) / LANES;
        let copy = |block: &Block| block.par_iter().copied().collect();
        BlockMatrix::from_blocks(
            self.columns.rows(),
            self.columns.blocks()[first..].iter().map(copy).collect(),
        )
    }

    /// Takes out of `image` its part along all columns from `first` on. Returns the coefficients, and the
    /// Gram matrix of what is left.
    pub fn take_out(&self, image: &mut BlockMatrix, first: usize) -> (Mat<f64>, Mat<f64>) {
        let columns = blocks(first..self.len());
        // Twice: the large part, then what rounding left of it. Reading the columns takes longer than
        // computing with them, so each pass does what it can.
        let large = self.columns.gram(columns.clone(), image);
        let small = image.subtract_then_gram(&self.columns, columns.clone(), large.as_ref());
        let gram = image.subtract_then_self_gram(&self.columns, columns, small.as_ref());
        (large + small, gram)
    }

    /// Appends what is left of an image of the last block under an operator of this norm, given its Gram
    /// matrix. Returns the R of `rest = Q R`, where Q is the new block.
    pub fn append(
        &mut self,
        mut rest: BlockMatrix,
        gram: Mat<f64>,
        norm: f64,
    ) -> Result<Mat<f64>, SpectralError> {
        let mut r = self.orthonormalize(&mut rest, gram)?;
        self.columns.blocks_mut().append(rest.blocks_mut());
        // What rounding and the last two blocks had of settled columns, grown as the rest was scaled up.
        let scale = r.singular_values().map_err(|_| SpectralError::Overflow)?;
        let growth = norm / scale.last().copied().unwrap_or(0.0);
        let overlap = growth * (self.overlaps[0] + self.overlaps[1] + ROUNDING);
        self.overlaps = [self.overlaps[1], overlap];
        // Not `>`: where the bound is not a number, nothing may wait.
        let small = overlap <= self.most_overlap;
        if !small || self.len() - self.settled >= WAITING * self.block {
            self.settle();
        }
        if !small {
            // What was taken out was part of the columns' lengths.
            let mut last = self.remove_last_block();
            let gram = last.gram(blocks(0..self.block), &last);
            r = self.orthonormalize(&mut last, gram)? * r;
            self.columns.blocks_mut().append(last.blocks_mut());
            self.settled = self.len() - self.block;
            self.settle();
        }
        Ok(r)
    }

    /// Orthogonalizes the waiting columns against the settled ones.
    pub fn settle(&mut self) {
        let waiting = self.columns.blocks_mut().split_off(self.settled / LANES);
        let mut waiting = BlockMatrix::from_blocks(self.columns.rows(), waiting);
        if self.settled > 0 && !waiting.blocks().is_empty() {
            let settled = blocks(0..self.settled);
            let coefficients = self.columns.gram(settled.clone(), &waiting);
            waiting.subtract(&self.columns, settled, coefficients.as_ref());
        }
        self.columns.blocks_mut().append(waiting.blocks_mut());
        (self.settled, self.overlaps) = (self.len(), [0.0; 2]);
    }

    /// Replaces all columns but the last block by orthonormal combinations of them, whole blocks of them.
    pub fn combine(&mut self, combinations: MatRef<'_, f64>) {
        self.settle();
        let mut last = self.remove_last_block();
        self.columns.rotate(combinations);
        self.columns.blocks_mut().truncate(combinations.ncols().div_ceil(LANES));
        self.columns.blocks_mut().append(last.blocks_mut());
        self.settled = self.len();
    }

    /// All columns but the last block.
    pub fn into_columns(mut self) -> BlockMatrix {
        self.remove_last_block();
        self.columns
    }

    fn remove_last_block(&mut self) -> BlockMatrix {
        let first = (self.len() - self.block) / LANES;
        BlockMatrix::from_blocks(self.columns.rows(), self.columns.blocks_mut().split_off(first))
    }

    /// Makes the columns of `block` orthonormal, given their Gram matrix. Directions that depend on the
    /// others are replaced by noise orthogonal to the basis. Returns R of `block = Q R`; R is zero in the
    /// rows of replaced columns.
    fn orthonormalize(&mut self, block: &mut BlockMatrix, gram: Mat<f64>) -> Result<Mat<f64>, SpectralError> {
        let width = self.block;
        let mut r = Mat::<f64>::identity(width, width);
        let mut gram = gram;
        // Two rounds: the second mends what the condition of the first lost.
        for _ in 0..2 {
            let combination = orthonormal_combinations(&gram).ok_or(SpectralError::Overflow)?;
            let found = combination.ncols();
            // Q = X C, so Q^T X = C^T (X^T X).
            let mut step = Mat::<f64>::zeros(width, width);
            step.subrows_mut(0, found).copy_from(combination.transpose() * &gram);
            r = &step * &r;
            gram = block.rotate_then_self_gram(combination.as_ref());
            if found < width {
                block.fill_noise(found..width, &mut self.random);
                self.null_space.project_out(block);
                gram = self.take_out(block, 0).1;
            }
        }
        Ok(r)
    }
}

fn blocks(columns: Range<usize>) -> Range<usize> {
    columns.start / LANES..columns.end / LANES
}

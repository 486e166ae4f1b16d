//! Thick-restart block Lanczos with full reorthogonalization (Wu & Simon 2000; Golub & Underwood
//! 1977 for blocks), for the largest eigenpairs of a symmetric operator.
//!
//! A block sees as many copies of a multiple eigenvalue as it has columns; a single vector sees one.
//! All coefficients of the projected matrix are computed by orthogonalization against the whole
//! basis, so a restart needs no special case.

use std::ops::Range;

use faer::Mat;

use crate::SpectralError;
use crate::standard::NullSpace;
use crate::tall::{LANES, Noise, Tall, orthonormal_combinations, small_eigen};

/// Columns added at a time.
pub(crate) const BLOCK: usize = 2 * LANES;

/// What the iteration needs to know.
pub(crate) struct Lanczos<'a> {
    /// Rows.
    pub rows: usize,
    /// Eigenpairs wanted.
    pub wanted: usize,
    /// Most columns of the basis, a multiple of [`BLOCK`].
    pub capacity: usize,
    /// Columns from which on convergence is looked at before the basis is full.
    pub check_from: usize,
    /// Largest number of restarts.
    pub max_restarts: usize,
    /// Directions that take no part.
    pub null_space: &'a NullSpace,
}

/// Ritz pairs, largest first.
pub(crate) struct RitzPairs {
    pub values: Vec<f64>,
    pub vectors: Tall,
    pub restarts: usize,
    /// Vectors that the operator was applied to.
    pub applications: usize,
}

impl Lanczos<'_> {
    /// Runs until the first `wanted` pairs satisfy `accept(value, residual)`, or the restarts are used
    /// up. `apply(x)` replaces x by the operator times x. `progress(converged)` returns false to cancel.
    pub fn run(
        &self,
        mut apply: impl FnMut(&mut Tall),
        accept: impl Fn(f64, f64) -> bool,
        mut progress: impl FnMut(usize) -> bool,
    ) -> Result<RitzPairs, SpectralError> {
        let n = self.rows;
        let mut noise = Noise(0x6d73_6572_3364);
        let mut basis = Tall::from_blocks(n, Vec::with_capacity(self.capacity / LANES + 2));
        let mut projected = Mat::<f64>::zeros(self.capacity + BLOCK, self.capacity + BLOCK);
        let mut block = Tall::zeros(n, BLOCK);
        block.fill_noise(0..BLOCK, &mut noise);
        self.null_space.project_out(&mut block);
        orthonormalize(&mut block, &basis, self.null_space, &mut noise)?;
        basis.blocks_mut().append(block.blocks_mut());

        // Columns whose image is known; the basis has one block more.
        let (mut filled, mut applications, mut restarts) = (0, 0, 0);
        // After a restart the next image has a part along all columns, otherwise along the last two blocks.
        let mut coupled = 0;
        loop {
            let mut image = Tall::from_blocks(n, basis.blocks()[filled / LANES..].to_vec());
            apply(&mut image);
            applications += BLOCK;
            self.null_space.project_out(&mut image);
            let known = filled + BLOCK;
            // The large part first; then, against the whole basis, what rounding left.
            for columns in [coupled..known, 0..known] {
                let overlaps = basis.gram(blocks(&columns), &image);
                image.subtract(&basis, blocks(&columns), overlaps.as_ref());
                for j in 0..BLOCK {
                    for i in columns.clone() {
                        projected[(filled + j, i)] += overlaps[(i - columns.start, j)];
                    }
                }
            }
            let coupling = orthonormalize(&mut image, &basis, self.null_space, &mut noise)?;
            basis.blocks_mut().append(image.blocks_mut());
            coupled = filled;
            filled = known;
            if !progress(0) {
                return Err(SpectralError::Cancelled);
            }
            let full = filled + BLOCK > self.capacity;
            if !full && filled < self.check_from {
                continue;
            }
            let ritz = Ritz::new(&projected, filled, &coupling)?;
            let wanted = self.wanted.min(filled);
            let good = |at: &usize| accept(ritz.values[*at], ritz.residuals[*at]);
            let converged = (0..wanted).take_while(good).count();
            if !progress(converged) {
                return Err(SpectralError::Cancelled);
            }
            let last = converged == self.wanted || full && restarts == self.max_restarts;
            if !last && !full {
                continue;
            }
            // Keep the wanted ones and half of the rest: what is thrown away must be found again.
            let keep = if last { wanted } else { (wanted + filled) / 2 / BLOCK * BLOCK };
            let next = basis.blocks_mut().split_off(filled / LANES);
            basis.rotate(ritz.vectors.subcols(0, keep));
            basis.blocks_mut().truncate(keep.div_ceil(LANES));
            let values = ritz.values[..keep].to_vec();
            if last {
                return Ok(RitzPairs { values, vectors: basis, restarts, applications });
            }
            basis.blocks_mut().extend(next);
            projected.fill(0.0);
            for (i, &value) in values.iter().enumerate() {
                projected[(i, i)] = value;
            }
            (filled, coupled) = (keep, 0);
            restarts += 1;
        }
    }
}

fn blocks(columns: &Range<usize>) -> Range<usize> {
    columns.start / LANES..columns.end / LANES
}

/// Eigenpairs of the projected matrix, largest first, and the residuals of the Ritz pairs.
struct Ritz {
    values: Vec<f64>,
    vectors: Mat<f64>,
    residuals: Vec<f64>,
}

impl Ritz {
    /// The last block's coupling to the next, unexplored one gives the residuals.
    fn new(projected: &Mat<f64>, filled: usize, coupling: &Mat<f64>) -> Result<Self, SpectralError> {
        let square = projected.submatrix(0, 0, filled, filled).to_owned();
        let (values, vectors) = small_eigen(&square).ok_or(SpectralError::Overflow)?;
        let vectors = vectors.as_ref().reverse_cols().to_owned();
        let tails = coupling * vectors.subrows(filled - BLOCK, BLOCK);
        let norm = |at: usize| (0..BLOCK).map(|i| tails[(i, at)].powi(2)).sum::<f64>().sqrt();
        Ok(Self {
            values: values.into_iter().rev().collect(),
            residuals: (0..filled).map(norm).collect(),
            vectors,
        })
    }
}

/// Makes the columns of `block` orthonormal. Directions that depend on the others are replaced by
/// noise orthogonal to the basis. Returns R of `block = Q R`; R is zero in the rows of replaced columns.
fn orthonormalize(
    block: &mut Tall,
    basis: &Tall,
    null_space: &NullSpace,
    noise: &mut Noise,
) -> Result<Mat<f64>, SpectralError> {
    let mut r = Mat::<f64>::identity(BLOCK, BLOCK);
    let all: Range<usize> = 0..BLOCK / LANES;
    // Two rounds: the second mends what the condition of the first lost.
    for _ in 0..2 {
        let gram = block.gram(all.clone(), block);
        let combination = orthonormal_combinations(&gram).ok_or(SpectralError::Overflow)?;
        let found = combination.ncols();
        // Q = X C, so Q^T X = C^T (X^T X).
        let mut step = Mat::<f64>::zeros(BLOCK, BLOCK);
        step.subrows_mut(0, found).copy_from(combination.transpose() * &gram);
        r = &step * &r;
        block.rotate(combination.as_ref());
        if found < BLOCK {
            block.fill_noise(found..BLOCK, noise);
            null_space.project_out(block);
            for _ in 0..2 {
                let overlaps = basis.gram(0..basis.blocks().len(), block);
                block.subtract(basis, 0..basis.blocks().len(), overlaps.as_ref());
            }
        }
    }
    Ok(r)
}

//! Thick-restart block Lanczos with full reorthogonalization (Wu & Simon 2000; Golub & Underwood
//! 1977 for blocks), for the largest eigenpairs of a symmetric operator.
//!
//! A block sees as many copies of a multiple eigenvalue as it has columns; a single vector sees one.
//! All coefficients of the projected matrix are computed by orthogonalization against the whole
//! basis, so a restart needs no special case.

use faer::Mat;

use crate::SpectralError;
use crate::standard::NullSpace;
use crate::tall::{LANES, Noise, Tall, orthonormal_combinations, small_eigen};

/// What the iteration needs to know.
pub(crate) struct Lanczos<'a> {
    /// Rows.
    pub rows: usize,
    /// Eigenpairs wanted.
    pub wanted: usize,
    /// Columns of a block of the iteration, a multiple of [`LANES`].
    pub block: usize,
    /// Most columns of the basis.
    pub capacity: usize,
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
        let (b, n) = (self.block, self.rows);
        let mut basis = Tall::zeros(n, self.capacity + b);
        let mut projected = Mat::<f64>::zeros(self.capacity + b, self.capacity + b);
        let mut noise = Noise(0x6d73_6572_3364);
        let mut block = Tall::zeros(n, b);
        block.fill_noise(0..b, &mut noise);
        self.null_space.project_out(&mut block);
        orthonormalize(&mut block, &basis, 0, self.null_space, &mut noise)?;
        set_blocks(&mut basis, 0, block);

        let (mut filled, mut applications) = (0, 0); // columns whose image is known
        for restarts in 0.. {
            let mut coupling = Mat::zeros(b, b);
            while filled + b <= self.capacity {
                let mut image = get_blocks(&basis, filled, b);
                apply(&mut image);
                applications += b;
                self.null_space.project_out(&mut image);
                let known = filled + b;
                for _ in 0..2 {
                    let overlaps = basis.gram(0..known, &image, 0..b);
                    image.subtract(&basis, 0..known, overlaps.as_ref());
                    for j in 0..b {
                        for i in 0..known {
                            projected[(filled + j, i)] += overlaps[(i, j)];
                        }
                    }
                }
                coupling = orthonormalize(&mut image, &basis, known, self.null_space, &mut noise)?;
                set_blocks(&mut basis, known, image);
                filled = known;
                if !progress(0) {
                    return Err(SpectralError::Cancelled);
                }
            }
            // The last block's coupling to the next, unexplored one gives the residuals.
            let square =
                Mat::from_fn(
                    filled,
                    filled,
                    |i, j| {
                        if i >= j { projected[(i, j)] } else { projected[(j, i)] }
                    },
                );
            let (ascending, vectors) = small_eigen(&square).ok_or(SpectralError::DenseEigenproblem)?;
            let order: Vec<usize> = (0..filled).rev().collect();
            let residual = |at: usize| -> f64 {
                let entry = |i: usize| -> f64 {
                    (0..b).map(|j| coupling[(i, j)] * vectors[(filled - b + j, at)]).sum()
                };
                (0..b).map(|i| entry(i).powi(2)).sum::<f64>().sqrt()
            };
            let good = |&&at: &&usize| accept(ascending[at], residual(at));
            let converged = order[..self.wanted.min(filled)].iter().take_while(good).count();
            let done = converged == self.wanted;
            if !progress(converged) {
                return Err(SpectralError::Cancelled);
            }
            let last = done || restarts == self.max_restarts;
            // Keep the wanted ones and half of the rest: what is thrown away must be found again.
            let keep = if last { self.wanted.min(filled) } else { (self.wanted + filled) / 2 / b * b };
            let rotation = Mat::from_fn(filled, keep, |i, j| vectors[(i, order[j])]);
            basis.rotate(0..filled, rotation.as_ref(), 0);
            let values: Vec<f64> = order[..keep].iter().map(|&at| ascending[at]).collect();
            if last {
                return Ok(RitzPairs { values, vectors: basis, restarts, applications });
            }
            let next = get_blocks(&basis, filled, b);
            set_blocks(&mut basis, keep, next);
            projected.fill(0.0);
            for (i, &value) in values.iter().enumerate() {
                projected[(i, i)] = value;
            }
            filled = keep;
        }
        unreachable!("the loop ends by its last restart")
    }
}

fn get_blocks(basis: &Tall, from: usize, count: usize) -> Tall {
    let mut block = Tall::zeros(basis.rows(), count);
    let blocks = &basis.blocks()[from / LANES..];
    block.blocks_mut().iter_mut().zip(blocks).for_each(|(target, source)| target.clone_from(source));
    block
}

fn set_blocks(basis: &mut Tall, to: usize, mut block: Tall) {
    for b in 0..block.blocks().len() {
        basis.put(to / LANES + b, block.take(b));
    }
}

/// Makes the columns of `block` orthonormal, and orthogonal to the first `known` columns of `basis`
/// as they were before. Directions that depend on the others are replaced by noise. Returns R of
/// `block = Q R`; R is zero in the rows of replaced columns.
fn orthonormalize(
    block: &mut Tall,
    basis: &Tall,
    known: usize,
    null_space: &NullSpace,
    noise: &mut Noise,
) -> Result<Mat<f64>, SpectralError> {
    let b = block.columns();
    let mut r = Mat::<f64>::identity(b, b);
    // Two rounds: the second mends what the condition of the first lost.
    for _ in 0..2 {
        let gram = block.self_gram(0..b);
        let (combination, _) = orthonormal_combinations(&gram).ok_or(SpectralError::DenseEigenproblem)?;
        let found = combination.ncols();
        // Q = X C, so Q^T X = C^T (X^T X).
        let gram = Mat::from_fn(b, b, |i, j| gram[(i.max(j), i.min(j))]);
        let mut step = Mat::<f64>::zeros(b, b);
        step.subrows_mut(0, found).copy_from(combination.transpose() * &gram);
        r = &step * &r;
        block.rotate(0..b, combination.as_ref(), 0);
        if found < b {
            block.fill_noise(found..b, noise);
            null_space.project_out(block);
            for _ in 0..2 {
                let overlaps = basis.gram(0..known, block, 0..b);
                block.subtract(basis, 0..known, overlaps.as_ref());
            }
        }
    }
    Ok(r)
}

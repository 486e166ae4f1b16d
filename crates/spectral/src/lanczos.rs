//! Thick-restart block Lanczos with full reorthogonalization (Wu & Simon 2000; Golub & Underwood
//! 1977 for blocks), for the largest eigenpairs of a symmetric operator.
//!
//! A block sees as many copies of a multiple eigenvalue as it has columns; a single vector sees one.
//! All coefficients of the projected matrix are computed by orthogonalization against the whole
//! basis, so a restart needs no special case.

use faer::Mat;

use crate::SpectralError;
use crate::standard::NullSpace;
use crate::tall::{Noise, Tall, small_eigen};

/// What the iteration needs to know.
pub(crate) struct Lanczos<'a> {
    /// Rows.
    pub rows: usize,
    /// Eigenpairs wanted.
    pub wanted: usize,
    /// Columns of a block.
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
    /// up. `apply(x, y)` sets y to the operator times x. `progress(converged)` returns false to cancel.
    pub fn run(
        &self,
        mut apply: impl FnMut(&Tall, &mut Tall),
        accept: impl Fn(f64, f64) -> bool,
        mut progress: impl FnMut(usize) -> bool,
    ) -> Result<RitzPairs, SpectralError> {
        let (b, n) = (self.block, self.rows);
        let mut basis = Tall::zeros(n, self.capacity + b);
        let mut projected = Mat::<f64>::zeros(self.capacity + b, self.capacity + b);
        let mut noise = Noise(0x6d73_6572_3364);
        let mut block = Tall::zeros(n, b);
        block.data_mut().iter_mut().for_each(|x| *x = noise.next());
        self.null_space.project_out(&mut block);
        orthonormalize(&mut block, &basis, 0, self.null_space, &mut noise);
        basis.set_columns(0, &block, b);

        let (mut filled, mut applications) = (0, 0); // columns whose image is known
        for restarts in 0.. {
            let mut coupling = Mat::zeros(b, b);
            while filled + b <= self.capacity {
                basis.get_columns(filled, b, &mut block);
                let mut image = Tall::zeros(n, b);
                apply(&block, &mut image);
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
                coupling = orthonormalize(&mut image, &basis, known, self.null_space, &mut noise);
                basis.set_columns(known, &image, b);
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
            let mut next = Tall::zeros(n, b);
            basis.get_columns(filled, b, &mut next);
            basis.set_columns(keep, &next, b);
            projected.fill(0.0);
            for (i, &value) in values.iter().enumerate() {
                projected[(i, i)] = value;
            }
            filled = keep;
        }
        unreachable!("the loop ends by its last restart")
    }
}

/// Makes the columns of `block` orthonormal, and orthogonal to the first `known` columns of `basis`
/// as they were before. A column that depends on the others is replaced by noise. Returns R of
/// `block = Q R`; R is zero in the rows of replaced columns.
fn orthonormalize(
    block: &mut Tall,
    basis: &Tall,
    known: usize,
    null_space: &NullSpace,
    noise: &mut Noise,
) -> Mat<f64> {
    let b = block.stride();
    let mut r = Mat::<f64>::zeros(b, b);
    let scale = block.column_norms().iter().copied().fold(0.0, f64::max);
    let mut q = Tall::zeros(block.rows(), b);
    let mut column = Tall::zeros(block.rows(), 1);
    for j in 0..b {
        block.get_columns(j, 1, &mut column);
        let mut fresh = false;
        loop {
            for _ in 0..2 {
                let overlaps = q.gram(0..j, &column, 0..1);
                column.subtract(&q, 0..j, overlaps.as_ref());
                if !fresh {
                    (0..j).for_each(|i| r[(i, j)] += overlaps[(i, 0)]);
                }
            }
            let norm = column.column_norms()[0];
            if norm > 1e-13 * scale && norm > 0.0 {
                column.data_mut().iter_mut().for_each(|x| *x /= norm);
                if !fresh {
                    r[(j, j)] = norm;
                }
                break;
            }
            fresh = true;
            column.data_mut().iter_mut().for_each(|x| *x = noise.next());
            null_space.project_out(&mut column);
            for _ in 0..2 {
                let overlaps = basis.gram(0..known, &column, 0..1);
                column.subtract(basis, 0..known, overlaps.as_ref());
            }
        }
        q.set_columns(j, &column, 1);
    }
    *block = q;
    r
}

//! Thick-restart block Lanczos (Wu & Simon 2000; Golub & Underwood 1977 for blocks), for the largest
//! eigenpairs of a symmetric operator, or for those at both ends of its spectrum.
//!
//! A block sees as many copies of a multiple eigenvalue as it has columns; a single vector sees one.
//! The coefficients of the projected matrix are measured by orthogonalization, so a restart needs no
//! special case.

use faer::Mat;

use crate::SpectralError;
use crate::block_matrix::BlockMatrix;
use crate::lanczos_basis::Basis;
use crate::null_space::NullSpace;
use crate::progress::foreseen;
use crate::small_dense::small_eigen;

/// What a product of the basis with a matrix costs for each column, over a scalar product.
const COMBINE: f64 = 0.1;

/// What the iteration needs to know.
pub(crate) struct Lanczos<'a> {
    /// Rows.
    pub rows: usize,
    /// Columns added at a time, a multiple of [`crate::row::LANES`].
    pub block: usize,
    /// Eigenpairs wanted.
    pub wanted: usize,
    /// How many of them are at the negative end of the spectrum; the others are the largest.
    pub negative: usize,
    /// Most columns of the basis, a multiple of `block`.
    pub capacity: usize,
    /// With this many columns convergence is tested for the first time, unless the basis is full before.
    pub check_from: usize,
    /// What applying the operator to a vector costs, over a scalar product of two vectors: for the sake of progress.
    pub operator_cost: f64,
    /// Overlap that blocks of the basis may keep with each other for a while. Up to 1e-8 the projected matrix
    /// is as exact as with none (semiorthogonality, Simon 1984); Ritz vectors of values far smaller than the
    /// norm need less.
    pub overlap: f64,
    /// Largest number of restarts.
    pub max_restarts: usize,
    /// Directions that take no part.
    pub null_space: &'a NullSpace,
    /// Of the random vectors that it starts from: what one search missed, another from the same vectors misses too.
    pub seed: u64,
}

/// Ritz pairs: those of the negative end from the largest down, then the others from the largest down.
pub(crate) struct RitzPairs {
    pub values: Vec<f64>,
    pub vectors: BlockMatrix,
    pub restarts: usize,
    /// Vectors that the operator was applied to.
    pub applications: usize,
}

impl Lanczos<'_> {
    /// Runs until the first `wanted` pairs satisfy `accept(value, residual)`, or the restarts are used
    /// up. `apply(x)` replaces x by the operator times x. `progress(share)` hears how
    /// much of the work is done, and returns false to cancel.
    pub fn run(
        &self,
        mut apply: impl FnMut(&mut BlockMatrix),
        accept: impl Fn(f64, f64) -> bool,
        mut progress: impl FnMut(f64) -> bool,
    ) -> Result<RitzPairs, SpectralError> {
        let block = self.block;
        let mut basis =
            Basis::new(self.rows, block, self.capacity + block, self.overlap, self.null_space, self.seed)?;
        let mut projected = Mat::<f64>::zeros(self.capacity + block, self.capacity + block);
        // Columns whose image is known; the basis has one block more.
        let mut filled = 0;
        // First column that the next image may have a large part along: all of them after a restart.
        let mut coupled = 0;
        let (mut applications, mut restarts) = (0, 0);
        // Scalar products, and the columns at which the iteration is expected to end.
        let (mut done, mut columns) = (0.0, self.check_from.min(self.capacity));
        let mut next_check = self.check_from;
        loop {
            let mut image = basis.last_block();
            apply(&mut image);
            applications += block;
            done += (block * filled) as f64 + block as f64 * self.operator_cost;
            if !progress(foreseen(done, self.work_of(columns))) {
                return Err(SpectralError::Cancelled);
            }
            let first = coupled.min(basis.settled());
            let (coefficients, gram) = basis.take_out(&mut image, first);
            // What little the columns have of the null space is not little beside what is left of the image: taken out any
            // earlier, it would grow from block to block.
            self.null_space.project_out(&mut image);
            for j in 0..block {
                for i in 0..coefficients.nrows() {
                    projected[(filled + j, first + i)] = coefficients[(i, j)];
                }
            }
            let norm = (0..filled + block).map(|i| projected[(i, i)].abs()).fold(0.0, f64::max);
            let coupling = basis.append(image, gram, norm)?;
            // One block more than the recurrence's two: overlap with the third would falsify the
            // coefficients.
            coupled = filled.saturating_sub(block);
            filled += block;
            let full = filled + block > self.capacity;
            if !full && filled < next_check {
                continue;
            }
            let ritz = Ritz::new(&projected, filled, &coupling, self.negative)?;
            let wanted = self.wanted.min(filled);
            let good = |at: &usize| accept(ritz.values[*at], ritz.residuals[*at]);
            let converged = (0..wanted).filter(good).count();
            if !progress(foreseen(done, self.work_of(columns))) {
                return Err(SpectralError::Cancelled);
            }
            next_check = filled + self.columns_to_next_check(filled, converged);
            columns = columns.max(next_check);
            let last = converged == self.wanted || full && restarts == self.max_restarts;
            if !last && !full {
                continue;
            }
            // Keep the wanted ones and half of the rest: what is thrown away must be found again.
            let keep = if last { wanted } else { (wanted + filled) / 2 / block * block };
            basis.combine(ritz.vectors.subcols(0, keep));
            if last && !progress(1.0) {
                return Err(SpectralError::Cancelled);
            }
            let values = ritz.values[..keep].to_vec();
            if last {
                return Ok(RitzPairs { values, vectors: basis.into_columns(), restarts, applications });
            }
            projected.fill(0.0);
            for (i, &value) in values.iter().enumerate() {
                projected[(i, i)] = value;
            }
            (filled, coupled) = (keep, 0);
            restarts += 1;
        }
    }

    /// Scalar products until the basis has so many columns, and its vectors are combined.
    fn work_of(&self, columns: usize) -> f64 {
        let columns = columns as f64;
        columns * self.operator_cost + 0.5 * columns * columns + COMBINE * columns * self.wanted as f64
    }

    /// Each column brings at most one pair and a half. Where looking costs little beside streaming the basis,
    /// every block is looked at, for the sake of progress.
    fn columns_to_next_check(&self, filled: usize, converged: usize) -> usize {
        let needed = if 5 * filled * filled < self.rows { 0 } else { 2 * (self.wanted - converged) / 3 };
        needed / self.block * self.block
    }
}

/// Eigenpairs of the projected matrix, in the order of [`RitzPairs`], and the residuals of the Ritz pairs.
struct Ritz {
    values: Vec<f64>,
    vectors: Mat<f64>,
    residuals: Vec<f64>,
}

impl Ritz {
    /// The last block's coupling to the next, unexplored one gives the residuals.
    fn new(
        projected: &Mat<f64>,
        filled: usize,
        coupling: &Mat<f64>,
        negative: usize,
    ) -> Result<Self, SpectralError> {
        let block = coupling.nrows();
        let square = projected.submatrix(0, 0, filled, filled).to_owned();
        let (ascending, columns) = small_eigen(&square).ok_or(SpectralError::Overflow)?;
        // The negative end from its largest down, then the others from the largest down.
        let negative = negative.min(filled);
        let place = |at: usize| (filled + negative - 1 - at) % filled;
        let vectors = Mat::from_fn(filled, filled, |i, at| columns[(i, place(at))]);
        let tails = coupling * vectors.subrows(filled - block, block);
        let norm = |at: usize| (0..block).map(|i| tails[(i, at)].powi(2)).sum::<f64>().sqrt();
        Ok(Self {
            values: (0..filled).map(|at| ascending[place(at)]).collect(),
            residuals: (0..filled).map(norm).collect(),
            vectors,
        })
    }
}

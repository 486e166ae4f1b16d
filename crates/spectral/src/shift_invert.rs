//! The smallest eigenpairs by block Lanczos on `(A - sigma I)^(-1)` (Ericsson & Ruhe 1980).
//!
//! The inverse maps an eigenvalue `lambda` to `theta = 1 / (lambda - sigma)`. With the shift among the wanted
//! eigenvalues, a little above their middle, those below it become the negative end of the spectrum, where there
//! is nothing else, and those above it are spread twice as far as from a shift at zero: a third fewer columns
//! in the basis, half the work. How many lie below the shift is known from the factorization (Sylvester's law
//! of inertia), so none of them can be missed.
//!
//! A shift below the spectrum, `-V^(-2/3)` or `-1/A`, is slower, but is exact to eigenvalues far smaller than
//! the others. It serves where the other doesn't reach the tolerance.

use faer::Mat;
use rayon::prelude::*;

use crate::SpectralError;
use crate::complete::add_missed_copies;
use crate::factor::{Elimination, Factor, Search};
use crate::lanczos::{Lanczos, RitzPairs};
use crate::solve::{attainable, orthogonality, residuals};
use crate::standard::{NullSpace, StandardProblem};
use crate::tall::{LANES, Lanes, Tall};

/// Columns added to the basis at a time. More find more copies at once, but need a larger basis.
const BLOCK: usize = LANES;
/// Wanted pairs from which on a shift among them is worth its search.
const MANY: usize = 24;
/// The part of the wanted eigenvalues to have below the shift, and the parts that will do.
const SHARE: f64 = 0.55;
const SHARES: std::ops::RangeInclusive<f64> = 0.4..=0.66;
/// Eigenvalues nearest to the shift make a norm of thousands of times the smallest Ritz values.
const OVERLAP: f64 = 1e-11;

/// What to find.
pub(crate) struct Task {
    /// Non-zero eigenpairs.
    pub wanted: usize,
    pub tolerance: f64,
    pub max_restarts: usize,
}

/// Eigenpairs without the null space.
pub(crate) struct Pairs {
    /// Ascending.
    pub values: Vec<f64>,
    pub vectors: Tall,
    /// |A x - lambda x| / lambda of each pair.
    pub residuals: Vec<f64>,
    /// Largest entry of |X^T X - I|.
    pub orthogonality: f64,
    pub restarts: usize,
    /// Vectors that the inverse was applied to.
    pub applications: usize,
}

impl Pairs {
    /// As computed in one go, with residuals and orthogonality measured on the vectors.
    pub fn measured(problem: &StandardProblem, values: Vec<f64>, vectors: Tall) -> Self {
        let residuals = residuals(problem, &values, &vectors);
        let orthogonality = orthogonality(&vectors, values.len());
        Self { values, vectors, residuals, orthogonality, restarts: 0, applications: 0 }
    }
}

/// Most columns of the basis.
pub(crate) fn basis_columns(wanted: usize) -> usize {
    (5 * wanted / 2 + 64) / BLOCK * BLOCK
}

/// The smallest non-zero eigenpairs. `progress(converged)` returns false to cancel.
pub(crate) fn inverse_eigenpairs(
    problem: &StandardProblem,
    elimination: &Elimination<'_>,
    task: &Task,
    progress: &dyn Fn(usize) -> bool,
) -> Result<Pairs, SpectralError> {
    if let Some(inverse) = Inverse::among_wanted(elimination, task.wanted) {
        // Where it is slow, something is wrong with it.
        let task = Task { max_restarts: task.max_restarts.min(3), ..*task };
        let pairs = inverse.eigenpairs(problem, &task, progress)?;
        let bound = problem.bound();
        let good = |(&value, &r): (&f64, &f64)| r <= attainable(task.tolerance, bound, value);
        if pairs.values.iter().zip(&pairs.residuals).all(good) {
            return Ok(pairs);
        }
    }
    Inverse::below_all(problem, elimination)?.eigenpairs(problem, task, progress)
}

/// The inverse at a shift.
struct Inverse<'a> {
    factor: Factor<'a>,
    sigma: f64,
    /// Non-zero eigenvalues below the shift.
    below: usize,
}

impl<'a> Inverse<'a> {
    /// At a shift with about the right share of the wanted eigenvalues below it; `None` if there is none, or
    /// if it isn't worth it.
    fn among_wanted(elimination: &'a Elimination<'_>, wanted: usize) -> Option<Self> {
        if wanted < MANY {
            return None;
        }
        let wanted = wanted as f64;
        let near = SHARES.start() * wanted..=SHARES.end() * wanted;
        match elimination.search(SHARE * wanted, near) {
            Search::Found { factor, sigma, below } => Some(Self { factor, sigma, below }),
            Search::Failed { .. } => None,
        }
    }

    /// At a shift below the spectrum: well below the wanted eigenvalues (33 k^(2/3) V^(-2/3) by Weyl's law), but
    /// so far that the matrix is well conditioned.
    fn below_all(problem: &StandardProblem, elimination: &'a Elimination<'_>) -> Result<Self, SpectralError> {
        let sigma = -problem.unit_eigenvalue;
        let factor = elimination.factor(sigma)?;
        if factor.negative_pivots() > 0 {
            return Err(SpectralError::NotFactored { shift: sigma });
        }
        Ok(Self { factor, sigma, below: 0 })
    }

    /// `x = (A - sigma I)^(-1) x`, block by block.
    fn apply(&self, x: &mut Tall) {
        let n = x.rows();
        x.blocks_mut().par_iter_mut().for_each(|block| {
            let mut work = vec![Lanes::ZERO; n];
            self.factor.solve(block, &mut work);
        });
    }

    fn eigenvalue(&self, theta: f64) -> f64 {
        (self.sigma + 1.0 / theta).max(0.0)
    }

    /// The smallest eigenpairs, with all copies of multiple ones.
    fn eigenpairs(
        &self,
        problem: &StandardProblem,
        task: &Task,
        progress: &dyn Fn(usize) -> bool,
    ) -> Result<Pairs, SpectralError> {
        let found = self.iterate(&problem.null_space, task, self.below, f64::INFINITY, progress)?;
        let (mut restarts, mut applications) = (found.restarts, found.applications);
        let below = found.values.iter().filter(|&&value| value < self.sigma).count();
        let (values, vectors) = add_missed_copies(found.values, found.vectors, BLOCK, |known, last| {
            let rest = problem.len() - problem.null_space.len() - known.blocks().len() * LANES;
            let task = Task { wanted: BLOCK.min(rest), ..*task };
            let left = self.below.saturating_sub(below).min(task.wanted);
            let others = self.iterate(&problem.null_space.and(known), &task, left, last, progress)?;
            restarts += others.restarts;
            applications += others.applications;
            Ok((others.values, others.vectors))
        })?;
        let mut pairs = Pairs { restarts, applications, ..Pairs::measured(problem, values, vectors) };
        if pairs.orthogonality > 1e-12 {
            self.separate(&mut pairs.vectors, &pairs.values);
            pairs = Pairs { restarts, applications, ..Pairs::measured(problem, pairs.values, pairs.vectors) };
        }
        Ok(pairs)
    }

    /// The step of inverse iteration multiplies what rounding left of one eigenvector in another, the more the
    /// nearer that one is to the shift. So it is taken out of the farther of the two.
    fn separate(&self, vectors: &mut Tall, values: &[f64]) {
        let gram = vectors.gram(0..vectors.blocks().len(), vectors);
        let distance = |i: usize| (values[i] - self.sigma).abs();
        let entry = |i: usize, j: usize| match i == j {
            true => 1.5 - 0.5 * gram[(i, i)],
            false if distance(i) < distance(j) => -gram[(i, j)],
            false => 0.0,
        };
        vectors.rotate(Mat::from_fn(values.len(), values.len(), entry).as_ref());
    }

    /// The smallest eigenvalues and their vectors, `below` of them below the shift. Those that turn out to be above `enough` may be
    /// inexact.
    fn iterate(
        &self,
        null_space: &NullSpace,
        task: &Task,
        below: usize,
        enough: f64,
        progress: &dyn Fn(usize) -> bool,
    ) -> Result<RitzPairs, SpectralError> {
        let zeros = null_space.len();
        let Task { wanted, tolerance, max_restarts } = *task;
        let lanczos = Lanczos {
            rows: null_space.rows(),
            wanted,
            negative: below,
            block: BLOCK,
            capacity: basis_columns(wanted),
            check_from: 4 * wanted / 3 + 64,
            overlap: OVERLAP,
            max_restarts,
            null_space,
        };
        // A residual r of the inverse is one of r / theta^2 of A after the step of inverse iteration below. A floor
        // where rounding ends all progress, because true residuals decide in the end.
        let accept = |theta: f64, residual: f64| {
            let relative = (1.0 + self.sigma * theta).abs();
            residual <= theta.abs() * (0.9 * tolerance * relative).max(1e-14)
                || theta > 0.0 && self.eigenvalue(theta + residual) > enough
        };
        let mut ritz = lanczos.run(|x| self.apply(x), accept, |n| progress(zeros + n))?;
        // Lanczos leaves its residual, and the rounding errors of hundreds of columns, in directions that A
        // multiplies. The inverse makes them small. Residuals of Ritz vectors are orthogonal to all of them, so this changes
        // their scalar products only by the square of the residuals.
        self.apply(&mut ritz.vectors);
        rescale(&mut ritz.vectors, &ritz.values);
        ritz.values.iter_mut().for_each(|theta| *theta = self.eigenvalue(*theta));
        Ok(ritz)
    }
}

/// Divides each column by its Ritz value.
pub(crate) fn rescale(vectors: &mut Tall, theta: &[f64]) {
    vectors.blocks_mut().iter_mut().zip(theta.chunks(LANES)).for_each(|(block, theta)| {
        for row in block {
            theta.iter().zip(&mut row.0).for_each(|(theta, x)| *x /= theta);
        }
    });
}

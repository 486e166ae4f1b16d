//! The smallest eigenpairs by block Lanczos on `(A - sigma I)^(-1)` (Ericsson & Ruhe 1980).
//!
//! The inverse maps an eigenvalue `lambda` to `theta = 1 / (lambda - sigma)`. With the shift among the wanted
//! eigenvalues, a little above their middle, those below it become the negative end of the spectrum, where
//! there is nothing else, and those above it are spread twice as far as from a shift at zero: a third fewer
//! columns in the basis, half the work. How many lie below the shift is known from the factorization
//! (Sylvester's law of inertia), so none of them can be missed.
//!
//! A shift below the spectrum, by `V^(-2/3)` or `1/A`, is slower, but is exact to eigenvalues far smaller
//! than the others. It serves where the other doesn't reach the tolerance.

use faer::Mat;
use rayon::prelude::*;

use crate::SpectralError;
use crate::block_matrix::BlockMatrix;
use crate::eigenpairs::Pairs;
use crate::elimination::{Elimination, Search};
use crate::factor::Factor;
use crate::lanczos::{Lanczos, RitzPairs};
use crate::multiplicity::add_missed_copies;
use crate::null_space::NullSpace;
use crate::quality::attainable;
use crate::row::{LANES, Lanes};
use crate::standard_problem::StandardProblem;

/// Columns added to the basis at a time. More find more copies at once, but need a larger basis.
const BLOCK: usize = LANES;
/// From this many wanted pairs on, a shift among them is worth the search for it.
const MANY: usize = 24;
/// The part of the wanted eigenvalues to have below the shift, and the parts that will do.
const SHARE: f64 = 0.55;
const SHARES: std::ops::RangeInclusive<f64> = 0.4..=0.66;
/// Overlap that blocks of the basis may keep for a while. It is small, because eigenvalues near the shift make
/// the norm thousands of times larger than the smallest Ritz values.
const OVERLAP: f64 = 1e-11;

/// What a solve costs for each number of the factor in a row, over a scalar product of two vectors.
const SOLVE: f64 = 2.0;
/// Shares of the work at which the factorizations, the iteration and the search for copies end.
const FACTORED: f64 = 0.15;
const ITERATED: f64 = 0.85;
const CHECKED: f64 = 0.95;

/// What to find.
pub(crate) struct Task {
    /// Non-zero eigenpairs.
    pub wanted: usize,
    pub tolerance: f64,
    pub max_restarts: usize,
}

/// Most columns of the basis.
pub(crate) fn basis_columns(wanted: usize) -> usize {
    (5 * wanted / 2 + 64) / BLOCK * BLOCK
}

/// The smallest non-zero eigenpairs. `progress(share)` returns false to cancel.
pub(crate) fn inverse_eigenpairs(
    problem: &StandardProblem,
    elimination: &Elimination<'_>,
    task: &Task,
    progress: &dyn Fn(f64) -> bool,
) -> Result<Pairs, SpectralError> {
    if let Some(inverse) = Inverse::among_wanted(problem, elimination, task.wanted) {
        // If more restarts are needed, something is wrong with the shift.
        let task = Task { max_restarts: task.max_restarts.min(3), ..*task };
        let bound = problem.bound;
        let good = |(&value, &r): (&f64, &f64)| r <= attainable::<Lanes>(task.tolerance, bound, value);
        match inverse.eigenpairs(&task, progress) {
            Ok(pairs) if pairs.values.iter().zip(&pairs.residuals).all(good) => return Ok(pairs),
            // A shift below all eigenvalues is exact to smaller ones, and tells for certain if any is
            // negative.
            Ok(_) | Err(SpectralError::Indefinite { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    Inverse::below_all(problem, elimination)?.eigenpairs(task, progress)
}

/// The inverse at a shift.
struct Inverse<'a> {
    problem: &'a StandardProblem,
    factor: Factor<'a>,
    sigma: f64,
    /// Non-zero eigenvalues below the shift.
    below: usize,
}

impl<'a> Inverse<'a> {
    /// At a shift with about the right share of the wanted eigenvalues below it; `None` if there is none, or
    /// if it isn't worth it.
    fn among_wanted(
        problem: &'a StandardProblem,
        elimination: &'a Elimination<'_>,
        wanted: usize,
    ) -> Option<Self> {
        if wanted < MANY {
            return None;
        }
        let wanted = wanted as f64;
        let near = SHARES.start() * wanted..=SHARES.end() * wanted;
        match elimination.search(SHARE * wanted, near) {
            Search::Found { factor, sigma, below } => Some(Self { problem, factor, sigma, below }),
            Search::Failed { .. } => None,
        }
    }

    /// At a shift below the spectrum: well below the wanted eigenvalues (15 k^(2/3) V^(-2/3) by Weyl's law),
    /// but so far that the matrix is well conditioned.
    fn below_all(
        problem: &'a StandardProblem,
        elimination: &'a Elimination<'_>,
    ) -> Result<Self, SpectralError> {
        let sigma = problem.lower_bound - problem.unit_eigenvalue;
        let factor = elimination.factor(sigma)?;
        match factor.negative_pivots() {
            0 => Ok(Self { problem, factor, sigma, below: 0 }),
            _ if sigma < 0.0 => Err(SpectralError::Indefinite { eigenvalue: sigma }),
            // The lower bound is no better than rounding errors of huge entries.
            _ => Err(SpectralError::NotFactored { shift: sigma }),
        }
    }

    /// `x = (A - sigma I)^(-1) x`, block by block.
    fn apply(&self, x: &mut BlockMatrix) {
        let n = x.rows();
        x.blocks_mut().par_iter_mut().for_each(|block| {
            let mut work = vec![Lanes::ZERO; n];
            self.factor.solve(block, &mut work);
        });
    }

    fn eigenvalue(&self, theta: f64) -> f64 {
        self.sigma + 1.0 / theta
    }

    /// The smallest eigenpairs, with all copies of multiple ones.
    fn eigenpairs(&self, task: &Task, progress: &dyn Fn(f64) -> bool) -> Result<Pairs, SpectralError> {
        let problem = self.problem;
        let within = |from: f64, to: f64| move |share: f64| progress(from + (to - from) * share);
        let first = within(FACTORED, ITERATED);
        let found = self.iterate(&problem.null_space, task, self.below, f64::INFINITY, 0, &first)?;
        let (mut restarts, mut applications, mut searches) = (found.restarts, found.applications, 0);
        let below = found.values.iter().filter(|&&value| value < self.sigma).count();
        let search = |known: &BlockMatrix, last: f64| {
            let rest = problem.len() - problem.null_space.len() - known.blocks().len() * LANES;
            let task = Task { wanted: BLOCK.min(rest), ..*task };
            let left = self.below.saturating_sub(below).min(task.wanted);
            let again = within(ITERATED, CHECKED);
            searches += 1;
            let others = self.iterate(&problem.null_space.and(known), &task, left, last, searches, &again)?;
            restarts += others.restarts;
            applications += others.applications;
            Ok((others.values, others.vectors))
        };
        let (values, vectors) =
            add_missed_copies(found.values, found.vectors, BLOCK, task.tolerance, search)?;
        let mut pairs = Pairs { restarts, applications, ..Pairs::measured(problem, values, vectors) };
        if pairs.orthogonality > 1e-12 {
            self.separate(&mut pairs.vectors, &pairs.values);
            pairs = Pairs { restarts, applications, ..Pairs::measured(problem, pairs.values, pairs.vectors) };
        }
        Ok(pairs)
    }

    /// The step of inverse iteration multiplies what rounding left of one eigenvector in another, the more
    /// the nearer that one is to the shift. So it is taken out of the farther of the two.
    fn separate(&self, vectors: &mut BlockMatrix, values: &[f64]) {
        let gram = vectors.gram(0..vectors.blocks().len(), vectors);
        let distance = |i: usize| (values[i] - self.sigma).abs();
        let entry = |i: usize, j: usize| match i == j {
            true => 1.5 - 0.5 * gram[(i, i)],
            false if distance(i) < distance(j) => -gram[(i, j)],
            false => 0.0,
        };
        vectors.rotate(Mat::from_fn(values.len(), values.len(), entry).as_ref());
    }

    /// The smallest eigenvalues and their vectors, `below` of them below the shift. Those that turn out to be
    /// above `enough` may be inexact. Each search has a seed of its own.
    fn iterate(
        &self,
        null_space: &NullSpace,
        task: &Task,
        below: usize,
        enough: f64,
        seed: u64,
        progress: &dyn Fn(f64) -> bool,
    ) -> Result<RitzPairs, SpectralError> {
        let Task { wanted, tolerance, max_restarts } = *task;
        let lanczos = Lanczos {
            rows: null_space.rows(),
            wanted,
            negative: below,
            block: BLOCK,
            capacity: basis_columns(wanted),
            check_from: 4 * wanted / 3 + 64,
            operator_cost: SOLVE * (self.factor.len() as f64 / null_space.rows() as f64),
            overlap: OVERLAP,
            max_restarts,
            null_space,
            seed,
        };
        // After the step of inverse iteration below, a residual r of the inverse means one of r / theta^2 of A.
        // Below the floor of 1e-14 rounding ends all progress; true residuals decide in the end.
        let accept = |theta: f64, residual: f64| {
            let relative = (1.0 + self.sigma * theta).abs();
            residual <= theta.abs() * (0.9 * tolerance * relative).max(1e-14)
                || theta > 0.0 && self.eigenvalue(theta + residual) > enough
        };
        let mut ritz = lanczos.run(|x| self.apply(x), accept, progress)?;
        // Lanczos leaves its residual, and the rounding errors of hundreds of columns, in directions that A
        // multiplies. The inverse makes them small. Residuals of Ritz vectors are orthogonal to all of them,
        // so this changes their scalar products only by the square of the residuals.
        self.apply(&mut ritz.vectors);
        ritz.vectors.divide_columns(&ritz.values);
        for value in &mut ritz.values {
            let eigenvalue = self.eigenvalue(*value);
            self.problem.check_semidefinite(eigenvalue)?;
            *value = eigenvalue.max(0.0);
        }
        Ok(ritz)
    }
}

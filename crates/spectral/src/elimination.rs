//! Sparse factorizations `L D L^T` of `A - sigma I` (faer's, supernodal, AMD ordering), and the search for a
//! shift.

use std::ops::RangeInclusive;

use faer::Par;
use faer::Side;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};

use crate::SpectralError;
use crate::factor::Factor;
use crate::standard_problem::StandardProblem;

/// The factor by which terms of `L D L^T` may exceed the matrix. The rounding error times this is still small
/// beside a spectral gap.
const MOST_GROWTH: f64 = 1e5;

/// Factorizations spent on finding a shift.
const TRIALS: usize = 6;

/// The order of elimination and the pattern of L: the same for all shifts.
pub(crate) struct Elimination<'a> {
    problem: &'a StandardProblem,
    symbolic: SymbolicCholesky<usize>,
}

impl<'a> Elimination<'a> {
    /// # Errors
    /// [`SpectralError::NotFactored`] if memory runs out.
    pub fn new(problem: &'a StandardProblem) -> Result<Self, SpectralError> {
        let n = problem.len();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &problem.starts, None, &problem.columns);
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Lower, SymmetricOrdering::Amd, parameters)
            .map_err(|_| SpectralError::NotFactored { shift: 0.0 })?;
        Ok(Self { problem, symbolic })
    }

    /// Entries of L: numbers that a factor holds.
    pub fn len(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Looks for a shift with about `target` eigenvalues between the null space and it, a number in `near`.
    pub fn search(&self, target: f64, near: RangeInclusive<f64>) -> Search<'_> {
        let problem = self.problem;
        let floor = problem.lower_bound;
        // Weyl's law of a surface or a solid, to begin with; then the secant of the logarithms.
        let pi = std::f64::consts::PI;
        let mut exponent = 2.0 / f64::from(problem.dimension);
        let constant = if problem.dimension == 2 { 4.0 * pi } else { 6.0 * pi * pi };
        // How far the shift lies above the lower bound of the spectrum.
        let mut height = problem.unit_eigenvalue * (constant * target).powf(exponent);
        let (mut too_low, mut too_high) = (0.0, f64::INFINITY);
        let mut before: Option<(f64, f64)> = None;
        for _ in 0..TRIALS {
            let sigma = floor + height;
            let Ok(factor) = self.factor(sigma) else { break };
            let below = factor.negative_pivots().saturating_sub(problem.null_space.len());
            if near.contains(&(below as f64)) {
                return Search::Found { factor, sigma, below };
            }
            // Half an eigenvalue more, as the count may be 0.
            let (count, logarithm) = ((below as f64 + 0.5).ln(), height.ln());
            if let Some((old_count, old_logarithm)) = before.filter(|old| old.0 != count) {
                exponent = ((logarithm - old_logarithm) / (count - old_count)).clamp(0.1, 3.0);
            }
            before = Some((count, logarithm));
            if (below as f64) < target {
                too_low = height
            } else {
                too_high = height
            }
            height = (logarithm + exponent * (target.ln() - count)).exp();
            if height <= too_low || height >= too_high {
                height = (too_low * too_high).sqrt();
            }
        }
        Search::Failed { too_high: floor + too_high }
    }

    /// Factors `A - sigma I`.
    ///
    /// There is no pivoting, so a shift very near an eigenvalue of a leading submatrix makes a pivot tiny and
    /// the others huge. The inverse and the inertia would be wrong, so that is an error; another shift will
    /// do.
    ///
    /// # Errors
    /// [`SpectralError::NotFactored`].
    pub fn factor(&self, sigma: f64) -> Result<Factor<'_>, SpectralError> {
        let problem = self.problem;
        let n = problem.len();
        let broken = || SpectralError::NotFactored { shift: sigma };
        let mut values = problem.values.clone();
        for row in 0..n {
            for at in problem.starts[row]..problem.starts[row + 1] {
                if problem.columns[at] == row {
                    values[at] -= sigma;
                }
            }
        }
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &problem.starts, None, &problem.columns);
        let mut factor = vec![0.0; self.symbolic.len_val()];
        let scratch = self.symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| broken())?;
        self.symbolic
            .factorize_numeric_ldlt(
                &mut factor,
                SparseColMatRef::new(pattern, &values),
                Side::Lower,
                LdltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|_| broken())?;
        let factor = Factor::new(&self.symbolic, factor);
        if factor.largest_term() <= MOST_GROWTH * (problem.bound + sigma.abs()) {
            Ok(factor)
        } else {
            Err(broken())
        }
    }
}

/// What the search for a shift came to.
pub(crate) enum Search<'a> {
    /// The shift, the factor there, and the non-zero eigenvalues below it.
    Found { factor: Factor<'a>, sigma: f64, below: usize },
    /// None, for instance where the number jumps at a multiple eigenvalue.
    Failed {
        /// The lowest shift tried with too many eigenvalues below it, or infinity.
        too_high: f64,
    },
}

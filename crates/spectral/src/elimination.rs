//! Sparse `L D L^T` of `A - sigma I` (faer's supernodal factorization, AMD ordering), solves on blocks of
//! eight columns, and the inertia.
//!
//! The solves are our own: a row of a block is one vector register, so a supernode's columns become
//! fused multiply-adds without gathering rows into a dense matrix first.

use std::ops::RangeInclusive;

use faer::Par;
use faer::Side;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLdltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use pulp::{Simd, WithSimd};

use crate::SpectralError;
use crate::standard::StandardProblem;
use crate::tall::{LANES, Lanes};

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

    /// Looks for a shift with about `target` non-zero eigenvalues below it, a number in `near`.
    pub fn search(&self, target: f64, near: RangeInclusive<f64>) -> Search<'_> {
        let problem = self.problem;
        // Weyl's law of a surface or a solid, to begin with; then the secant of the logarithms.
        let pi = std::f64::consts::PI;
        let mut exponent = 2.0 / f64::from(problem.dimension);
        let constant = if problem.dimension == 2 { 4.0 * pi } else { 6.0 * pi * pi };
        let mut sigma = problem.unit_eigenvalue * (constant * target).powf(exponent);
        let (mut too_low, mut too_high) = (0.0, f64::INFINITY);
        let mut before: Option<(f64, f64)> = None;
        for _ in 0..TRIALS {
            let Ok(factor) = self.factor(sigma) else { break };
            let below = factor.negative_pivots().saturating_sub(problem.null_space.len());
            if near.contains(&(below as f64)) {
                return Search::Found { factor, sigma, below };
            }
            // Half an eigenvalue more, as the count may be 0.
            let (count, shift) = ((below as f64 + 0.5).ln(), sigma.ln());
            if let Some((old_count, old_shift)) = before.filter(|old| old.0 != count) {
                exponent = ((shift - old_shift) / (count - old_count)).clamp(0.1, 3.0);
            }
            before = Some((count, shift));
            if (below as f64) < target {
                too_low = sigma
            } else {
                too_high = sigma
            }
            sigma = (shift + exponent * (target.ln() - count)).exp();
            if sigma <= too_low || sigma >= too_high {
                sigma = (too_low * too_high).sqrt();
            }
        }
        Search::Failed { too_high }
    }

    /// Factors `A - sigma I`.
    ///
    /// There is no pivoting: a shift very near an eigenvalue of a leading submatrix makes a pivot tiny and
    /// the others huge. That is an error too, as the inverse and the inertia would be wrong; another shift will do.
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
        let factor = Factor { symbolic: &self.symbolic, values: factor };
        if factor.largest_term() <= MOST_GROWTH * (problem.bound() + sigma.abs()) {
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

/// `P^T L D L^T P = A - sigma I`; L has a unit diagonal, D is stored in its place.
pub(crate) struct Factor<'a> {
    symbolic: &'a SymbolicCholesky<usize>,
    values: Vec<f64>,
}

impl Factor<'_> {
    /// Eigenvalues below the shift: by Sylvester's law of inertia, as many as D has negative entries.
    pub fn negative_pivots(&self) -> usize {
        let count = |node: Supernode<'_>| (0..node.width).filter(|&j| node.entry(j, j) < 0.0).count();
        self.supernodes().map(count).sum()
    }

    /// The largest diagonal entry of `|L| |D| |L^T|`; not finite if the factorization broke down.
    fn largest_term(&self) -> f64 {
        let mut terms = vec![0.0; self.symbolic.nrows()];
        for node in self.supernodes() {
            for j in 0..node.width {
                let (pivot, column) = (node.entry(j, j).abs(), node.column(j));
                terms[node.start + j] += pivot;
                for i in j + 1..node.width {
                    terms[node.start + i] += pivot * column[i] * column[i];
                }
                for (&row, l) in node.below.iter().zip(&column[node.width..]) {
                    terms[row] += pivot * l * l;
                }
            }
        }
        terms.iter().fold(0.0, |most: f64, &term| if term <= most { most } else { term })
    }

    /// `x = (A - sigma I)^(-1) x`; `work` is of the size of x.
    pub fn solve(&self, x: &mut [Lanes], work: &mut [Lanes]) {
        pulp::Arch::new().dispatch(Solve { factor: self, x, work });
    }

    fn supernodes(&self) -> impl DoubleEndedIterator<Item = Supernode<'_>> {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            unreachable!("supernodal was asked for")
        };
        let factor = SupernodalLdltRef::new(symbolic, &self.values);
        (0..symbolic.n_supernodes()).map(move |s| {
            let node = factor.supernode(s);
            let (rows, width) = (node.val().nrows(), node.val().ncols());
            let first = symbolic.col_ptr_for_val()[s];
            let values = &self.values[first..first + rows * width];
            Supernode { start: node.start(), width, below: node.pattern(), values }
        })
    }
}

/// Neighbouring columns of L that share their rows below.
struct Supernode<'a> {
    start: usize,
    width: usize,
    below: &'a [usize],
    /// Column by column, `width + below.len()` rows each.
    values: &'a [f64],
}

/// The factor by which terms of `L D L^T` may exceed the matrix: so many times the rounding error is
/// still small beside a spectral gap.
const MOST_GROWTH: f64 = 1e5;

/// Columns that are worked on at once, in registers.
const TILE: usize = 8;

impl Supernode<'_> {
    #[inline(always)]
    fn entry(&self, row: usize, column: usize) -> f64 {
        self.values[column * (self.width + self.below.len()) + row]
    }

    /// Column `j` of L, from its diagonal on.
    #[inline(always)]
    fn column(&self, j: usize) -> &[f64] {
        let rows = self.width + self.below.len();
        &self.values[j * rows..(j + 1) * rows]
    }
}

struct Solve<'a> {
    factor: &'a Factor<'a>,
    x: &'a mut [Lanes],
    work: &'a mut [Lanes],
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { factor, x, work } = self;
        let order = factor.symbolic.perm().map(|p| p.arrays().0);
        match order {
            Some(order) => work.iter_mut().zip(order).for_each(|(to, &from)| *to = x[from]),
            None => work.copy_from_slice(x),
        }
        for node in factor.supernodes() {
            for first in (0..node.width).step_by(TILE) {
                forward(simd, &node, first, work);
            }
        }
        for node in factor.supernodes().rev() {
            for first in (0..node.width).step_by(TILE).rev() {
                backward(simd, &node, first, work);
            }
        }
        match order {
            Some(order) => work.iter().zip(order).for_each(|(from, &to)| x[to] = *from),
            None => x.copy_from_slice(work),
        }
    }
}

#[inline(always)]
fn forward<S: Simd>(simd: S, node: &Supernode<'_>, first: usize, x: &mut [Lanes]) {
    match node.width - first {
        1 => forward_tile::<S, 1>(simd, node, first, x),
        2 => forward_tile::<S, 2>(simd, node, first, x),
        3 => forward_tile::<S, 3>(simd, node, first, x),
        4 => forward_tile::<S, 4>(simd, node, first, x),
        5 => forward_tile::<S, 5>(simd, node, first, x),
        6 => forward_tile::<S, 6>(simd, node, first, x),
        7 => forward_tile::<S, 7>(simd, node, first, x),
        _ => forward_tile::<S, 8>(simd, node, first, x),
    }
}

#[inline(always)]
fn backward<S: Simd>(simd: S, node: &Supernode<'_>, first: usize, x: &mut [Lanes]) {
    match node.width - first {
        1 => backward_tile::<S, 1>(simd, node, first, x),
        2 => backward_tile::<S, 2>(simd, node, first, x),
        3 => backward_tile::<S, 3>(simd, node, first, x),
        4 => backward_tile::<S, 4>(simd, node, first, x),
        5 => backward_tile::<S, 5>(simd, node, first, x),
        6 => backward_tile::<S, 6>(simd, node, first, x),
        7 => backward_tile::<S, 7>(simd, node, first, x),
        _ => backward_tile::<S, 8>(simd, node, first, x),
    }
}

/// `L^(-1)` of W columns.
#[inline(always)]
fn forward_tile<S: Simd, const W: usize>(simd: S, node: &Supernode<'_>, first: usize, x: &mut [Lanes]) {
    let columns: [&[f64]; W] = std::array::from_fn(|j| node.column(first + j));
    let top = node.start + first;
    for part in 0..LANES / S::F64_LANES {
        let mut known = [simd.splat_f64s(0.0); W];
        for i in 0..W {
            let target = &mut S::as_mut_simd_f64s(&mut x[top + i].0).0[part];
            let mut sum = *target;
            for j in 0..i {
                sum = simd.mul_add_f64s(simd.splat_f64s(-columns[j][first + i]), known[j], sum);
            }
            *target = sum;
            known[i] = sum;
        }
        let known = known.map(|v| simd.neg_f64s(v));
        let rest = &mut x[node.start..node.start + node.width][first + W..];
        for (i, row) in rest.iter_mut().enumerate() {
            let target = &mut S::as_mut_simd_f64s(&mut row.0).0[part];
            let mut sum = *target;
            for j in 0..W {
                sum = simd.mul_add_f64s(simd.splat_f64s(columns[j][first + W + i]), known[j], sum);
            }
            *target = sum;
        }
        let columns: [&[f64]; W] = std::array::from_fn(|j| &columns[j][node.width..][..node.below.len()]);
        for (i, &row) in node.below.iter().enumerate() {
            let target = &mut S::as_mut_simd_f64s(&mut x[row].0).0[part];
            let mut sum = *target;
            for j in 0..W {
                sum = simd.mul_add_f64s(simd.splat_f64s(columns[j][i]), known[j], sum);
            }
            *target = sum;
        }
    }
}

/// `L^(-T) D^(-1)` of W columns.
#[inline(always)]
fn backward_tile<S: Simd, const W: usize>(simd: S, node: &Supernode<'_>, first: usize, x: &mut [Lanes]) {
    let columns: [&[f64]; W] = std::array::from_fn(|j| node.column(first + j));
    let top = node.start + first;
    for part in 0..LANES / S::F64_LANES {
        let mut sums = [simd.splat_f64s(0.0); W];
        let below: [&[f64]; W] = std::array::from_fn(|j| &columns[j][node.width..][..node.below.len()]);
        for (i, &row) in node.below.iter().enumerate() {
            let source = S::as_simd_f64s(&x[row].0).0[part];
            for j in 0..W {
                sums[j] = simd.mul_add_f64s(simd.splat_f64s(below[j][i]), source, sums[j]);
            }
        }
        for i in first + W..node.width {
            let source = S::as_simd_f64s(&x[node.start + i].0).0[part];
            for j in 0..W {
                sums[j] = simd.mul_add_f64s(simd.splat_f64s(columns[j][i]), source, sums[j]);
            }
        }
        for i in (0..W).rev() {
            let pivot = simd.splat_f64s(1.0 / columns[i][first + i]);
            let target = &mut S::as_mut_simd_f64s(&mut x[top + i].0).0[part];
            let value = simd.sub_f64s(simd.mul_f64s(*target, pivot), sums[i]);
            *target = value;
            for j in 0..i {
                sums[j] = simd.mul_add_f64s(simd.splat_f64s(columns[j][first + i]), value, sums[j]);
            }
        }
    }
}

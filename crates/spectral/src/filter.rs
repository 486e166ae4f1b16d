//! The smallest eigenpairs of a grid's Laplacian A without a matrix: block Lanczos on p(A), where the
//! Chebyshev polynomial p is large on the wanted eigenvalues and small on all others.
//!
//! The polynomial does what a factorization does for shift-invert: it spreads the wanted end of the spectrum.
//! It costs a few dozen stencil applications and no memory. The cut-off, where "wanted" ends, comes from the
//! spectrum of a coarser operator; it need not be exact, only above the wanted eigenvalues, and if it was too
//! low the iteration says so by finding too few pairs below it and starts again.

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use mser3d_laplace::aggregate_grid;
use mser3d_shape::VoxelGrid;

use crate::block_matrix::BlockMatrix;
use crate::chebyshev::Polynomial;
use crate::eigenpairs::GridPairs;
use crate::elimination::{Elimination, Search};
use crate::lanczos::Lanczos;
use crate::null_space::NullSpace;
use crate::quality::attainable;
use crate::rayleigh_quotient::rayleigh_quotients;
use crate::row::{Block, LANES, Lanes};
use crate::standard_problem::StandardProblem;
use crate::stencil::SlicedStencil;
use crate::temporal_blocking::Tiling;
use crate::{SpectralError, SpectrumParameters};

/// Columns added at a time: fewer span the wanted pairs than in larger blocks, since each step of Lanczos,
/// whatever its width, tells wanted from unwanted equally well.
const BLOCK: usize = LANES;
/// About the logarithm of p(0) over the largest |p| above the cut-off: how far the polynomial spreads the
/// wanted eigenvalues. A larger one needs fewer columns, but more applications of A; the sum of both costs
/// is least from 7 to 9, and some hundredths more at 6 and 12. Rounding errors of p(A) are relative to p(0), so a smaller one is
/// more exact.
const GROWTH: f64 = 8.0;
/// The cut-off is the coarse eigenvalue of this number of times the wanted one.
const GUARD: f64 = 1.2;
/// Rows of the coarse operator for each eigenvalue that is asked of it.
const COARSE_ROWS: usize = 12;
/// Smoothing divides a residual by about this: 60 to 1000, measured on two shapes. Where that is too little, p
/// itself is applied once more.
const SMOOTHING: f64 = 100.0;
/// No pair is taken for converged above this, or a copy of a multiple eigenvalue might still be on its way.
const LARGEST_RESIDUAL: f64 = 1e-7;
/// Columns of the basis for each wanted pair; the iteration usually ends before it is full.
const COLUMNS_PER_PAIR: f64 = 2.5;

/// What a step of the polynomial costs over a scalar product of two vectors.
const UPDATE: f64 = 0.4;
/// Shares of the work at which the iteration begins, after the coarse operator, and ends, before the eigenvalues are taken; and
/// at which smoothing begins, by one polynomial and by the other. Measured on a figure of 10,000 to 200,000 voxels.
const BEGIN: f64 = 0.05;
const END: f64 = 0.8;
const SMOOTHED: [f64; 2] = [0.85, 0.95];

/// Columns of the Lanczos basis.
pub(crate) fn basis_columns(wanted: usize) -> usize {
    ((COLUMNS_PER_PAIR * wanted as f64) as usize + 4 * BLOCK) / BLOCK * BLOCK
}

/// The edge of the coarse cells, or `None` for a grid too small to coarsen.
pub(crate) fn coarse_factor(voxels: usize, wanted: usize) -> Option<u32> {
    let cell = voxels / (COARSE_ROWS * wanted.max(16));
    let factor = (1..=32u32).take_while(|f| f.pow(3) as usize <= cell).last()?;
    (factor >= 2).then_some(factor)
}

/// The smallest `wanted` non-zero eigenpairs of a connected grid, `pairs` in all.
pub(crate) fn filtered_eigenpairs(
    grid: &VoxelGrid,
    pairs: usize,
    parameters: &SpectrumParameters,
    progress: &(dyn Fn(f64) -> ControlFlow<()> + Sync),
) -> Result<GridPairs, SpectralError> {
    let stencil = SlicedStencil::new(grid);
    let n = stencil.len();
    // One component: bodies are solved one by one.
    let null_space = NullSpace::new(&vec![0; n], &vec![grid.frame().voxel_volume().sqrt(); n], |_| true);
    let zeros = null_space.len().min(pairs);
    let wanted = pairs - zeros;
    let capacity = basis_columns(wanted).min((n - null_space.len()) / BLOCK * BLOCK);
    let mut lanczos = Lanczos {
        rows: n,
        block: BLOCK,
        wanted,
        negative: 0,
        capacity,
        check_from: 5 * wanted / 4,
        operator_cost: 0.0,
        overlap: 1e-8,
        max_restarts: parameters.max_iterations,
        null_space: &null_space,
        seed: 0,
    };
    let mut cutoff = first_cutoff(grid, wanted)?.min(0.5 * stencil.bound());
    let (mut applications, mut restarts) = (0, 0);
    // How much an estimated residual must be below the tolerance; more, if the true one comes out above it.
    let mut margin = 1.0;
    let mut work = Block::new();
    let cancelled = AtomicBool::new(false);
    loop {
        let filter = Filter::new(&stencil, cutoff, &cancelled);
        lanczos.operator_cost = UPDATE * filter.polynomial.degree as f64;
        let tell = |share: f64| {
            let go_on = progress(share).is_continue();
            cancelled.store(!go_on, Ordering::Relaxed);
            go_on
        };
        let report = |share: f64| tell(BEGIN + (END - BEGIN) * share);
        let accept =
            |theta: f64, residual: f64| filter.accepts(theta, residual, margin * parameters.tolerance);
        let ritz = lanczos.run(|x| filter.apply(x, &mut work, &report), accept, report)?;
        applications += ritz.applications * filter.polynomial.degree;
        restarts += ritz.restarts;
        // Below the cut-off p falls, so the order by p is the order by eigenvalue; beyond it, it is not.
        let below = ritz.values.iter().filter(|&&theta| theta > 2.0 * filter.floor).count();
        if below < wanted && cutoff < 0.5 * stencil.bound() {
            cutoff *= 1.5;
            continue;
        }
        let mut vectors = ritz.vectors;
        let (mut values, mut residuals) = rayleigh_quotients(&stencil, vectors.blocks_mut(), &mut work);
        let weak = |values: &[f64], residuals: &[f64]| -> Vec<usize> {
            let short = |&at: &usize| {
                residuals[at] > attainable::<Lanes>(parameters.tolerance, stencil.bound(), values[at])
            };
            let mut blocks: Vec<usize> = (0..wanted).filter(short).map(|at| at / LANES).collect();
            blocks.dedup();
            blocks
        };
        // What is left of the other eigenvectors is tiny, but most of it rough, which is much beside a small
        // eigenvalue: the rest of the last columns, and the rounding errors of hundreds. A polynomial of a
        // quarter of the degree smooths nearly all of it away; if that isn't enough, p does.
        let smoother = Filter::new(&stencil, (16.0 * cutoff).min(0.5 * stencil.bound()), &cancelled);
        for (filter, share) in [&smoother, &filter].into_iter().zip(SMOOTHED) {
            tell(share);
            let again = weak(&values, &residuals);
            if again.is_empty() {
                break;
            }
            let mut some = BlockMatrix::from_blocks(
                n,
                again.iter().map(|&at| std::mem::take(&mut vectors.blocks_mut()[at])).collect(),
            );
            filter.apply(&mut some, &mut work, &report);
            if cancelled.load(Ordering::Relaxed) {
                return Err(SpectralError::Cancelled);
            }
            let scale = again.iter().flat_map(|&at| &values[at * LANES..(at + 1) * LANES]);
            some.divide_columns(&scale.map(|&lambda| filter.value(lambda)).collect::<Vec<f64>>());
            let (new_values, new_residuals) = rayleigh_quotients(&stencil, some.blocks_mut(), &mut work);
            for (place, (&at, block)) in again.iter().zip(some.blocks_mut()).enumerate() {
                let (from, to) = (place * LANES..(place + 1) * LANES, at * LANES..(at + 1) * LANES);
                values[to.clone()].copy_from_slice(&new_values[from.clone()]);
                residuals[to].copy_from_slice(&new_residuals[from]);
                vectors.blocks_mut()[at] = std::mem::take(block);
            }
            applications += again.len() * LANES * filter.polynomial.degree;
        }
        if margin > 1e-4 && !weak(&values, &residuals).is_empty() {
            margin *= 1e-2;
            continue;
        }
        values.truncate(wanted);
        residuals.truncate(wanted);
        return Ok(GridPairs {
            values,
            vectors,
            bound: stencil.bound(),
            order: stencil.order,
            residuals,
            restarts,
            applications,
        });
    }
}

/// A value with about `GUARD * wanted` eigenvalues of a coarser operator below it, corrected for that one's
/// dispersion: on cells of size h a wave of wave number w has the eigenvalue 4 sin^2(w h / 2) / h^2 instead
/// of w^2.
fn first_cutoff(grid: &VoxelGrid, wanted: usize) -> Result<f64, SpectralError> {
    let factor = coarse_factor(grid.len(), wanted).unwrap_or(2);
    let coarse = StandardProblem::new(&aggregate_grid(grid, factor).operator);
    let target = GUARD * wanted as f64 + 4.0;
    let elimination = Elimination::new(&coarse)?;
    // Weyl's law as the last resort: a solid has more eigenvalues below it.
    let weyl = coarse.unit_eigenvalue * (6.0 * PI * PI * target).powf(2.0 / 3.0);
    let cutoff = match elimination.search(target, 0.93 * target..=1.12 * target + 1.0) {
        Search::Found { sigma, .. } => sigma,
        Search::Failed { too_high } => {
            if too_high.is_finite() {
                too_high
            } else {
                weyl
            }
        }
    };
    let cell = f64::from(factor) * grid.frame().spacing().iter().copied().fold(0.0, f64::max);
    let half_phase = (cutoff.sqrt() * cell / 2.0).min(1.0).asin();
    Ok((2.0 * half_phase / cell).powi(2).max(cutoff))
}

/// The polynomial of the stencil, as an operator for Lanczos.
struct Filter<'a> {
    stencil: &'a SlicedStencil,
    tiling: Tiling,
    polynomial: Polynomial,
    /// |p| is at most this above the cut-off.
    floor: f64,
    cancelled: &'a AtomicBool,
}

impl<'a> Filter<'a> {
    fn new(stencil: &'a SlicedStencil, cutoff: f64, cancelled: &'a AtomicBool) -> Self {
        let rate = Polynomial::rate(0.0, cutoff, stencil.bound());
        let degree = ((GROWTH / rate).ceil() as usize).next_multiple_of(2);
        let polynomial = Polynomial { degree, target: 0.0, cutoff };
        let floor = 1.0 / (degree as f64 * rate).cosh();
        Self { stencil, tiling: Tiling::new::<Lanes>(stencil), polynomial, floor, cancelled }
    }

    /// `x = p(A) x`, all threads on one block after the other.
    fn apply(&self, x: &mut BlockMatrix, work: &mut Block, report: &(dyn Fn(f64) -> bool + Sync)) {
        for block in x.blocks_mut() {
            work.resize(block.len(), Lanes::ZERO);
            self.polynomial.apply(
                self.stencil,
                self.tiling,
                rayon::current_num_threads(),
                block,
                work,
                &|| {
                    report(0.0);
                    self.cancelled.load(Ordering::Relaxed)
                },
            );
        }
    }

    /// p at an eigenvalue below the cut-off.
    fn value(&self, lambda: f64) -> f64 {
        let rate = Polynomial::rate(lambda, self.polynomial.cutoff, self.stencil.bound());
        self.floor * (self.polynomial.degree as f64 * rate).cosh()
    }

    /// The eigenvalue of A that p maps to `theta`, by bisection: p falls from 1 to the floor on
    /// `[0, cutoff]`.
    fn eigenvalue(&self, theta: f64) -> f64 {
        let (mut low, mut high) = (0.0, self.polynomial.cutoff);
        for _ in 0..52 {
            let middle = 0.5 * (low + high);
            if self.value(middle) > theta { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Whether a residual of p(A) means that of A is below the tolerance, relative to the eigenvalue, when it
    /// has been smoothed. What is missing from a Ritz vector lies above the cut-off, spread over the rest of
    /// the spectrum, where p is nearly 0 and A half its bound on average, as measured.
    fn accepts(&self, theta: f64, residual: f64, tolerance: f64) -> bool {
        let missing = residual / (theta - self.floor).max(f64::MIN_POSITIVE);
        let enough = (SMOOTHING * tolerance).min(LARGEST_RESIDUAL).max(3.0 * tolerance);
        self.stencil.bound() / 2.0 * missing <= enough * self.eigenvalue(theta)
    }
}

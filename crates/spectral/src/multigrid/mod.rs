//! The smallest eigenpairs of a large grid's Laplacian: those of a coarse level, carried up level by level and corrected there.
//!
//! Where a voxel is small beside the waves that are wanted, nearly all of them is known from coarser levels (hierarchical subspace
//! iteration: Nasikun & Hildebrandt 2022). What is left is corrected as in Davidson's method: with an approximate solution of
//! `(A - lambda) d = A x - lambda x`, here a multigrid cycle, x - d is three to ten times as near. The work for a pair does not grow
//! with the grid, while polynomials grow as the number of voxels along it.

mod cycle;
mod hierarchy;
mod level;
mod ritz;
mod transfer;

use std::ops::ControlFlow;

use mser3d_shape::VoxelGrid;

use self::cycle::{Cycle, Workspace, correct};
use self::hierarchy::Hierarchy;
use self::level::rows;
use self::ritz::rayleigh_ritz;
use crate::block_matrix::BlockMatrix;
use crate::chebyshev::Polynomial;
use crate::eigenpairs::GridPairs;
use crate::quality::{attainable, check_residuals};
use crate::rayleigh_quotient::rayleigh_quotients;
use crate::row::{Block, LANES, Lanes, Row, Short};
use crate::solve_matrix::connected_eigenpairs;
use crate::stencil::SlicedStencil;
use crate::temporal_blocking::{self, Tiling};
use crate::{Eigensolver, SpectralError, SpectrumParameters};

/// Vectors beside the wanted ones, as a share of these: what is left out must have a larger eigenvalue than any wanted one.
const GUARD: f64 = 0.1;
/// The same on the levels, where the eigenvalues of thin limbs are a tenth off, so that others come before them.
const GUARD_ON_LEVELS: f64 = 0.5;
/// Shifts end at this share of the largest eigenvalue that is iterated.
const BELOW: f64 = 0.8;
/// Nearer to an eigenvalue of a level than this share they are not, if there is room elsewhere down to the second.
const AWAY: f64 = 0.0075;
const NEAR: f64 = 0.9;
/// Rows of the coarsest level for each vector, at least: its waves must be a few rows long.
const COARSEST_ROWS: usize = 60;
/// Rows of the grid for each of the coarsest level, at most: as many are solved in a hundredth of the time.
const COARSEST_SHARE: usize = 8192;
/// How exact the coarsest level's eigenvectors are.
const COARSEST_TOLERANCE: f64 = 1e-5;
/// The most corrections of the grid's vectors from one look at them to the next.
const TOGETHER: usize = 3;
/// The share of an error that a correction leaves, at most: of waves that the first level shows, but poorly.
const RATE: f64 = 0.3;
/// Degree of the polynomial that smooths what is rough on the grid.
const DEGREE: usize = 12;
/// What is rough begins at this share of the smallest eigenvalue that the first level cannot show: waves a little longer are shown by it,
/// but poorly.
const ROUGH: f64 = 0.3;
/// Eigenvalues within this relative distance may be copies of one.
const COPIES: f64 = 1e-6;
/// What a correction leaves of the largest residual at most, or corrections lead away.
const PROGRESS: f64 = 0.8;
/// Then it goes on with this share of the largest shift, and after so many times it has come to a stop. Where levels have an eigenvalue
/// next to a shift, it is the vectors with that shift that are led away.
const LOWER: f64 = 0.8;
const LOWERED: usize = 3;
/// It is faster than the filter from this many voxels on for each pair and cubed logarithm of the tolerance, as the filter's work grows
/// as `n^(4/3) k^(2/3)`, and this as `n k` and the logarithm. At a million voxels with 50 pairs and 1e-6 it took .76 of the filter's
/// CPU time, with 100 and 1e-4 .77; at half a million with 50 and 1e-4 .58, with 100 pairs 1.6.
const PAYS: f64 = 10.0;
/// Residuals up to this number of times what rounding allows are taken for its noise.
const ROUNDED: f64 = 10.0;
/// Shares of the work: at the first level, at the grid, at the end of the iteration.
const SHARES: [f64; 3] = [0.05, 0.2, 0.95];

/// Vectors that are iterated on the grid: in single precision, where memory counts most, as few as will do.
pub(crate) fn columns(wanted: usize, single: bool) -> usize {
    with_guard(wanted, GUARD, if single { 0 } else { 2 })
}

/// Vectors that are iterated on the levels.
fn columns_on_levels(wanted: usize) -> usize {
    with_guard(wanted, GUARD_ON_LEVELS, 2)
}

fn with_guard(wanted: usize, guard: f64, more: usize) -> usize {
    (wanted + (guard * wanted as f64).ceil() as usize + more).next_multiple_of(LANES)
}

/// Whether these eigenpairs of a connected grid are computed by multigrid: where that is asked for and there are coarser levels fine enough,
/// or by [`Eigensolver::Auto`] where it is faster than the filter. (Plates, which suit the inverse, `Auto` solves by that.)
///
/// ```
/// use mser3d_spectral::{SpectrumParameters, uses_multigrid};
/// let parameters = SpectrumParameters { tolerance: 1e-4, ..Default::default() };
/// assert!(uses_multigrid(10_000_000, 30, &parameters));
/// assert!(!uses_multigrid(45_000, 100, &parameters));
/// ```
pub fn uses_multigrid(voxels: usize, eigenpairs: usize, parameters: &SpectrumParameters) -> bool {
    let has_levels = voxels >= 8 * COARSEST_ROWS * columns_on_levels(eigenpairs);
    let pays = || voxels as f64 >= PAYS * eigenpairs as f64 * parameters.tolerance.ln().abs().powi(3);
    match parameters.solver {
        Eigensolver::Auto => has_levels && pays(),
        Eigensolver::Multigrid => has_levels,
        Eigensolver::Filter | Eigensolver::ShiftInvert => false,
    }
}

/// The smallest non-zero eigenpairs of a connected grid, `pairs` in all. None of a shape whose coarser levels stay large, as of
/// voxels that hardly hang together.
///
/// # Errors
/// [`SpectralError::NotConverged`], where corrections come to a stop; those of the coarsest level; [`SpectralError::Cancelled`].
pub(crate) fn multigrid_eigenpairs<R: Row>(
    grid: &VoxelGrid,
    pairs: usize,
    parameters: &SpectrumParameters,
    progress: &(dyn Fn(f64) -> ControlFlow<()> + Sync),
) -> Result<Option<GridPairs<R>>, SpectralError> {
    let tell = |share: f64| match progress(share) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(SpectralError::Cancelled),
    };
    let stencil = SlicedStencil::new(grid);
    let n = stencil.len();
    // One component, with one constant: bodies are solved one by one.
    let wanted = pairs - 1;
    let m = columns_on_levels(wanted);
    let coarsest = (COARSEST_ROWS * m).max(n / COARSEST_SHARE);
    let hierarchy = Hierarchy::new(grid, &stencil.order, coarsest);
    if hierarchy.coarsest().len() >= 8 * coarsest {
        return Ok(None);
    }
    let mut subspace = Subspace::coarsest(&hierarchy, wanted, parameters, progress)?;
    tell(SHARES[0])?;
    for at in (0..hierarchy.levels.len() - 1).rev() {
        subspace.vectors = subspace.carried_up(at + 1, hierarchy.levels[at].len());
        subspace.correct_on_level(at)?;
        tell(SHARES[0])?;
    }
    subspace.vectors.blocks_mut().truncate(columns(wanted, R::ROUGH_ROUNDING.is_some()) / LANES);
    let mut vectors: BlockMatrix<R> = subspace.carried_up(0, n);
    let Subspace { cycle, mut spaces, known, .. } = subspace;
    let mut finest = Finest::new(&stencil, cycle, grid, known);
    vectors.blocks_mut().iter_mut().for_each(|block| finest.smooth(block));
    let (mut first, mut last, mut corrections) = (None, f64::INFINITY, TOGETHER);
    let bound = stencil.bound();
    let (mut looks, mut lowered) = (0, 0);
    loop {
        looks += 1;
        let (values, residuals) = finest.look(&mut vectors, wanted, &mut spaces, &tell)?;
        // Over what is asked for.
        let excess = |at: usize| residuals[at] / attainable::<R>(parameters.tolerance, bound, values[at]);
        // Rayleigh and Ritz mix copies of an eigenvalue, so the last one wanted is only as good as its copies beyond.
        let copies = values.partition_point(|&value| value < values[wanted - 1] * (1.0 + COPIES));
        let worst = (0..copies).map(excess).fold(0.0, f64::max);
        let (values_wanted, residuals_wanted) = (&values[..wanted], &residuals[..wanted]);
        match check_residuals::<R>(values_wanted, residuals_wanted, bound, parameters.tolerance, looks) {
            Ok(_) => {
                vectors.blocks_mut().truncate(wanted.div_ceil(LANES));
                return Ok(Some(GridPairs {
                    values: values_wanted.to_vec(),
                    residuals: residuals_wanted.to_vec(),
                    applications: finest.applications,
                    restarts: looks,
                    vectors,
                    bound,
                    order: stencil.order,
                }));
            }
            Err(stopped) if looks == parameters.max_iterations => return Err(stopped),
            Err(stopped) if worst > PROGRESS.powi(corrections as i32) * last => {
                if lowered == LOWERED {
                    return Err(stopped);
                }
                lowered += 1;
                finest.most *= LOWER;
            }
            Err(_) => {}
        }
        let from = first.get_or_insert(worst).ln().max(f64::MIN_POSITIVE);
        tell(SHARES[1] + (SHARES[2] - SHARES[1]) * (1.0 - worst.ln() / from).clamp(0.0, 1.0))?;
        if last.is_finite() {
            // As many as are needed if they go on as they did.
            let each = (last / worst).ln() / corrections as f64;
            corrections = (worst.ln() / each).clamp(1.0, TOGETHER as f64).ceil() as usize;
        }
        last = worst;
        let weak = (0..wanted).position(|at| excess(at) > 1.0).unwrap_or(0) / LANES;
        // Where rounding's noise is all that is left, a cycle alone leaves less of it than steps of smoothing, which round each.
        let rounded: Vec<bool> = (values.chunks(LANES).zip(residuals.chunks(LANES)))
            .map(|(values, residuals)| {
                let noise = |value: f64| ROUNDED * R::ROUNDING * bound / value;
                values.iter().zip(residuals).all(|(&value, &r)| r <= noise(value))
            })
            .collect();
        for at in 0..corrections {
            let relaxation = relaxation(at, corrections);
            for (at, values) in values.chunks(LANES).enumerate().skip(weak) {
                tell(SHARES[1])?;
                let block = &mut vectors.blocks_mut()[at];
                if !rounded[at] {
                    finest.correct(block, values, relaxation, &mut spaces);
                    finest.smooth(block);
                } else if (at * LANES..wanted.min((at + 1) * LANES)).any(|pair| excess(pair) > 1.0) {
                    finest.correct(block, values, relaxation, &mut spaces);
                }
            }
        }
    }
}

/// By how much the step of one of several corrections is longer than the cycle says. A correction leaves between 0 and [`RATE`] of each part
/// of the error; the roots of a Chebyshev polynomial on this interval make several leave less than as many equal ones.
fn relaxation(at: usize, of: usize) -> f64 {
    let angle = std::f64::consts::PI * (at as f64 + 0.5) / of as f64;
    1.0 / (1.0 - RATE * 0.5 * (1.0 - angle.cos()))
}

/// Approximate eigenvectors of a level.
struct Subspace<'a> {
    cycle: Cycle<'a>,
    spaces: Vec<Workspace>,
    wanted: usize,
    vectors: BlockMatrix,
    /// Eigenvalues in the unit of the levels.
    values: Vec<f64>,
    /// Those of all coarser levels.
    known: Vec<f64>,
}

impl<'a> Subspace<'a> {
    /// The eigenvectors of the coarsest level.
    fn coarsest(
        hierarchy: &'a Hierarchy,
        wanted: usize,
        parameters: &SpectrumParameters,
        progress: &(dyn Fn(f64) -> ControlFlow<()> + Sync),
    ) -> Result<Self, SpectralError> {
        let m = columns_on_levels(wanted);
        let level = hierarchy.coarsest();
        // The constant, the vectors, and one beyond.
        let parameters = SpectrumParameters {
            eigenpairs: (m + 2).into(),
            tolerance: COARSEST_TOLERANCE,
            solver: Eigensolver::Auto,
            ..parameters.clone()
        };
        let progress = |share: f64| progress(SHARES[0] * share);
        let found = connected_eigenpairs(&level.operator()?, m + 2, &parameters, &progress)?.basis;
        let mut vectors = BlockMatrix::zeros(level.len(), m);
        vectors.fill(m, |row, column| found.at(row)[column + 1]);
        let values = found.eigenvalues()[1..].to_vec();
        let cycle = Cycle::new(hierarchy, &vectors, values.clone());
        let spaces = cycle.workspaces();
        Ok(Self { cycle, spaces, wanted, vectors, known: values.clone(), values })
    }

    /// The vectors on the next finer level, of `rows` rows. Blocks are given back one by one.
    fn carried_up<R: Row>(&mut self, transfer: usize, rows: usize) -> BlockMatrix<R> {
        let transfer = &self.cycle.hierarchy.transfers[transfer];
        let up = |block: Block| {
            let mut fine = vec![R::ZERO; rows];
            transfer.interpolate(
                &block,
                &mut fine,
                #[inline(always)]
                |target, value| *target = R::narrow(value),
            );
            fine
        };
        let blocks = std::mem::take(self.vectors.blocks_mut()).into_iter().map(up).collect();
        BlockMatrix::from_blocks(rows, blocks)
    }

    /// Corrects the vectors of a level once, and makes them orthonormal again.
    fn correct_on_level(&mut self, at: usize) -> Result<(), SpectralError> {
        let level = &self.cycle.hierarchy.levels[at];
        let spaces = &mut self.spaces[at..];
        let mut work = BlockMatrix::zeros(level.len(), LANES);
        let most = largest_shift(&self.values, self.wanted);
        for (block, values) in self.vectors.blocks_mut().iter_mut().zip(self.values.chunks(LANES)) {
            let image = &mut work.blocks_mut()[0];
            level.apply(block, image);
            let mass = level.mass();
            let entry =
                |row: usize, l: usize| image[row].0[l] - values[l] * f64::from(mass[row]) * block[row].0[l];
            rows(
                &mut spaces[0].residual,
                #[inline(always)]
                |row, r| *r = Short(std::array::from_fn(|l| entry(row, l) as f32)),
            );
            self.cycle.run(at, &shifts(values, most), spaces);
            correct(block, &spaces[0].d);
        }
        let mass = Some(level.mass());
        self.values = rayleigh_ritz(&mut self.vectors, mass, &mut work, |x, y| level.apply(x, y))?;
        self.known.extend(&self.values);
        Ok(())
    }
}

/// The largest shift: the largest wanted eigenvalue, or less where that is near those that are left out. A shift near these would lead
/// away, where a level's errors reach across the gap.
fn largest_shift(values: &[f64], wanted: usize) -> f64 {
    values[wanted - 1].min(BELOW * values[values.len() - 1])
}

/// The largest shift, or a little less, away from known eigenvalues of the grid and of the levels, which show each a little higher. On a
/// level with an eigenvalue next to the shift the equation is nearly singular: what the level's eigenvector has beside the
/// grid's is multiplied with each correction.
fn away_from(mut known: Vec<f64>, most: f64) -> f64 {
    known.sort_by(|a, b| b.total_cmp(a));
    let nearest = |shift: &f64| known.iter().map(|value| (value - shift).abs()).fold(f64::INFINITY, f64::min);
    let between = known.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    let between = between.filter(|shift| (NEAR * most..most).contains(shift));
    let all: Vec<f64> = std::iter::once(most).chain(between).collect();
    let far = |shift: &&f64| nearest(shift) >= AWAY * most;
    let farthest = || all.iter().max_by(|a, b| nearest(a).total_cmp(&nearest(b)));
    all.iter().find(far).or_else(farthest).copied().unwrap_or(most)
}

/// Shifts for some eigenvalues, none above `most`.
fn shifts(values: &[f64], most: f64) -> [f32; LANES] {
    std::array::from_fn(|l| values[l].clamp(0.0, most) as f32)
}

/// The grid itself: A without a matrix.
struct Finest<'a, R> {
    stencil: &'a SlicedStencil,
    tiling: Tiling,
    cycle: Cycle<'a>,
    smoother: Polynomial,
    /// The eigenvalue that is 1 on the levels: the largest weight.
    unit: f64,
    /// The largest shift.
    most: f64,
    /// The eigenvalues of all levels.
    known: Vec<f64>,
    work: BlockMatrix<R>,
    /// Vectors that A was applied to.
    applications: usize,
}

/// Tells progress, or that the work is cancelled.
type Tell<'a> = dyn Fn(f64) -> Result<(), SpectralError> + 'a;

impl<'a, R: Row> Finest<'a, R> {
    fn new(stencil: &'a SlicedStencil, cycle: Cycle<'a>, grid: &VoxelGrid, known: Vec<f64>) -> Self {
        let unit = grid.frame().spacing().iter().map(|h| 1.0 / (h * h)).fold(0.0, f64::max);
        // A wave of two voxels along an axis has four times its weight, one of four voxels half of that.
        let cutoff = ROUGH * 2.0 * cycle.hierarchy.weakest * unit;
        let smoother = Polynomial { degree: DEGREE, target: 0.0, cutoff };
        let work = BlockMatrix::zeros(stencil.len(), LANES);
        Self {
            stencil,
            tiling: Tiling::new::<R>(stencil),
            cycle,
            smoother,
            unit,
            most: f64::INFINITY,
            known: known.into_iter().map(|value| unit * value).collect(),
            work,
            applications: 0,
        }
    }

    /// Smooths what the first level cannot show. A polynomial of A in place of the equation's solution: what it leaves of smooth parts is
    /// nearly all, so that x needs no right-hand side.
    fn smooth(&mut self, block: &mut Block<R>) {
        let threads = rayon::current_num_threads();
        let work = &mut self.work.blocks_mut()[0];
        self.smoother.apply(self.stencil, self.tiling, threads, block, work, &|| false);
        self.applications += DEGREE * LANES;
    }

    /// Makes the vectors orthonormal and measures their residuals, |A x - lambda x| / lambda. Returns the eigenvalues and the residuals.
    fn look(
        &mut self,
        vectors: &mut BlockMatrix<R>,
        wanted: usize,
        spaces: &mut [Workspace],
        tell: &Tell,
    ) -> Result<(Vec<f64>, Vec<f64>), SpectralError> {
        let (stencil, tiling) = (self.stencil, self.tiling);
        let count = rayleigh_ritz(vectors, None, &mut self.work, |x, y| {
            temporal_blocking::apply(stencil, tiling, x, y)
        })?
        .len();
        self.cycle.know(vectors)?;
        tell(SHARES[1])?;
        let (mut values, mut residuals) = (Vec::new(), Vec::new());
        for block in vectors.blocks_mut() {
            let (own, mut left) =
                rayleigh_quotients(stencil, std::slice::from_mut(block), &mut self.work.blocks_mut()[0]);
            if let Some(rounding) = R::ROUGH_ROUNDING {
                self.restrict_residual(block, &own, &mut spaces[0]);
                let smooth = self.cycle.smooth_residual(&mut spaces[0]);
                for l in 0..LANES {
                    let rough = left[l] - rounding * stencil.bound() / own[l];
                    left[l] = rough.max(smooth[l] * self.unit / own[l]);
                }
            }
            values.extend(own);
            residuals.extend(left);
        }
        self.applications += 2 * count;
        // A vector that was led away has a larger value than before: it tells nothing of what is left out.
        let known = [&values[..], &self.known].concat();
        self.most = self.most.min(away_from(known, largest_shift(&values, wanted)));
        Ok((values, residuals))
    }

    /// Corrects a block of vectors with these eigenvalues; what is rough of the corrections stays in it.
    fn correct(&mut self, block: &mut Block<R>, values: &[f64], relaxation: f64, spaces: &mut [Workspace]) {
        temporal_blocking::apply(self.stencil, self.tiling, block, &mut self.work.blocks_mut()[0]);
        self.applications += LANES;
        self.restrict_residual(block, values, &mut spaces[0]);
        let unit = self.unit;
        // Columns of A sum to zero, so the residual tells how much of the constant x has.
        let sums = spaces[0].sums_of_residual();
        if R::ROUGH_ROUNDING.is_some() {
            // The cycle would correct what rounding leaves of it once more, and it would grow.
            spaces[0].take_out_of_residual(sums, self.cycle.hierarchy.levels[0].mass());
        }
        let mean: [f64; LANES] = std::array::from_fn(|l| -sums[l] * unit / (values[l] * block.len() as f64));
        let values: [f64; LANES] = std::array::from_fn(|l| values[l] / unit);
        self.cycle.run(0, &shifts(&values, self.most / unit), spaces);
        let transfer = &self.cycle.hierarchy.transfers[0];
        transfer.interpolate(
            &spaces[0].d,
            block,
            #[inline(always)]
            |row, d: Short| {
                let x = row.wide().0;
                let by: [f64; LANES] = std::array::from_fn(|l| relaxation * f64::from(d.0[l]) + mean[l]);
                *row = R::narrow(Lanes(std::array::from_fn(|l| x[l] - by[l])));
            },
        );
    }

    /// `A x - lambda x` of a block whose image is in the work space, on the first level and in its unit.
    fn restrict_residual(&self, block: &Block<R>, values: &[f64], space: &mut Workspace) {
        let (image, unit) = (&self.work.blocks()[0], self.unit);
        self.cycle.hierarchy.transfers[0].restrict(
            &mut space.residual,
            #[inline(always)]
            |row| {
                let (image, x) = (image[row].wide().0, block[row].wide().0);
                std::array::from_fn(|l| ((image[l] - values[l] * x[l]) / unit) as f32)
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_shift_is_away_from_what_levels_show() {
        // Far enough already.
        assert_eq!(away_from(vec![1.0, 2.0, 2.8, 3.1], 3.0), 3.0);
        // Next to an eigenvalue of a level, 3.01; between it and 2.99 there is no room, but below that.
        assert_eq!(away_from(vec![1.0, 2.75, 2.99, 3.01, 4.0], 3.0), 0.5 * (2.75 + 2.99));
        // No room anywhere: the farthest.
        let dense: Vec<f64> = (0..100).map(|i| 2.5 + 0.01 * f64::from(i)).filter(|x| *x != 2.85).collect();
        assert!((away_from(dense, 3.0) - 2.85).abs() < 1e-12);
    }
}

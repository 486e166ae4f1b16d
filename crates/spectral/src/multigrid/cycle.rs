//! The W-cycle: about the solution d of `(W - shift M) d = r`, with a shift for each column, without the eigenvectors below.
//!
//! Rough parts are solved by Chebyshev's iteration on each level (Adams, Brezina, Hu & Tuminaro 2003), smooth ones on the next coarser
//! level. The shift makes smooth parts converge that lie just above the wanted eigenvalues. What belongs to the wanted
//! eigenvectors is taken out on the coarsest level, where these are known: the equation is nearly singular there, and Rayleigh and
//! Ritz do it better.

use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use super::hierarchy::Hierarchy;
use super::level::{ChebyshevStep, Columns, Level, ROWS, rows};
use super::ritz::rayleigh_ritz;
use crate::SpectralError;
use crate::block_matrix::BlockMatrix;
use crate::row::{Block, LANES, Lanes, Row, Short};

/// Steps of smoothing before the next coarser level, and after it.
const SMOOTHING: usize = 4;
/// Visits of the next coarser level: two, for what a level shows wrongly is not right the first time, and they cost a quarter.
const VISITS: usize = 2;
/// What is smoothed, of the spectrum of D^-1 W: all waves that the next level cannot show, with room for ragged surfaces.
const ROUGH: [f32; 2] = [0.25, 2.0];
/// Steps of smoothing that leave less than a thousandth of what is rough.
const SMOOTHED: usize = 12;
/// The logarithm of by how much the coarsest level's error falls.
const COARSEST: f64 = 5.0;

/// The vectors of a level.
pub(super) struct Workspace {
    pub residual: Vec<Short>,
    pub d: Vec<Short>,
    along: Vec<Short>,
    next: Vec<Short>,
}

impl Workspace {
    /// The sum of each column of the residual.
    pub fn sums_of_residual(&self) -> [f64; LANES] {
        self.sum(|_, r| r)
    }

    /// Takes these sums out of the residual's columns, by mass: what is left has no part along the constant.
    pub fn take_out_of_residual(&mut self, sums: [f64; LANES], mass: &[f32]) {
        let all: f64 = mass.iter().map(|&mass| f64::from(mass)).sum();
        let mean: Columns = std::array::from_fn(|l| (sums[l] / all) as f32);
        rows(
            &mut self.residual,
            #[inline(always)]
            |row, r| *r = Short(std::array::from_fn(|l| r.0[l] - mass[row] * mean[l])),
        );
    }

    /// The sum over the rows of a term in the residual at a row.
    fn sum(&self, term: impl Fn(usize, f64) -> f64 + Sync) -> [f64; LANES] {
        let part = |(chunk, rows): (usize, &[Short])| {
            let mut sums = [0.0; LANES];
            for (i, r) in rows.iter().enumerate() {
                (0..LANES).for_each(|l| sums[l] += term(chunk * ROWS + i, f64::from(r.0[l])));
            }
            sums
        };
        let parts: Vec<[f64; LANES]> = self.residual.par_chunks(ROWS).enumerate().map(part).collect();
        parts.iter().fold([0.0; LANES], |sums, part| std::array::from_fn(|l| sums[l] + part[l]))
    }
}

/// The levels, and what is known of the coarsest.
pub(super) struct Cycle<'a> {
    pub hierarchy: &'a Hierarchy,
    /// Eigenvectors of the coarsest level, the constant among them, M-orthonormal.
    known: Vec<Vec<Short>>,
    /// The eigenvalues of the coarsest level but 0, at least one more than vectors are known.
    values: Vec<f64>,
}

impl<'a> Cycle<'a> {
    /// With the eigenvectors of the coarsest level, without the constant, and their eigenvalues and the one that follows.
    pub fn new(hierarchy: &'a Hierarchy, vectors: &BlockMatrix, values: Vec<f64>) -> Self {
        Self { hierarchy, known: with_constant(hierarchy.coarsest(), vectors), values }
    }

    /// Takes what the grid's vectors are on the coarsest level for known: where two eigenvalues are in another order there than on
    /// the grid, the wrong one would be taken out.
    pub fn know<R: Row>(&mut self, vectors: &BlockMatrix<R>) -> Result<(), SpectralError> {
        let Hierarchy { transfers, levels, .. } = self.hierarchy;
        let coarsest = self.hierarchy.coarsest();
        let down = |block: &Block<R>| {
            let mut fine = vec![Lanes::ZERO; levels[0].len()];
            transfers[0].average(
                &mut fine,
                levels[0].mass(),
                #[inline(always)]
                |row| block[row].wide().0,
            );
            for (transfer, pair) in transfers[1..].iter().zip(levels.windows(2)) {
                let mut coarse = vec![Lanes::ZERO; pair[1].len()];
                let mass = pair[0].mass();
                transfer.average(
                    &mut coarse,
                    pair[1].mass(),
                    #[inline(always)]
                    |row| fine[row].0.map(|x| x * f64::from(mass[row])),
                );
                fine = coarse;
            }
            fine
        };
        let mut known = BlockMatrix::from_blocks(coarsest.len(), vectors.blocks().iter().map(down).collect());
        let mut work = BlockMatrix::zeros(coarsest.len(), LANES);
        rayleigh_ritz(&mut known, Some(coarsest.mass()), &mut work, |x, y| coarsest.apply(x, y))?;
        self.known = with_constant(coarsest, &known);
        Ok(())
    }

    /// Room for the cycles.
    pub fn workspaces(&self) -> Vec<Workspace> {
        let room = |level: &Level| {
            let block = || vec![Short::default(); level.len()];
            Workspace { residual: block(), d: block(), along: block(), next: block() }
        };
        self.hierarchy.levels.iter().map(room).collect()
    }

    /// The norm of the smooth part of a residual on the first level: what smoothing leaves of it.
    pub fn smooth_residual(&self, space: &mut Workspace) -> [f64; LANES] {
        let level = &self.hierarchy.levels[0];
        chebyshev(level, &[0.0; LANES], ROUGH.map(|end| [end; LANES]), SMOOTHED, space);
        space.sum(|row, r| r * r / f64::from(level.mass()[row])).map(f64::sqrt)
    }

    /// `spaces[0].d` = about `(W - shift M)^-1 spaces[0].residual` on the level `at`, to which the first of the spaces belongs.
    pub fn run(&self, at: usize, shift: &Columns, spaces: &mut [Workspace]) {
        let level = &self.hierarchy.levels[at];
        let Some((own, coarser)) = spaces.split_first_mut() else { return };
        rows(
            &mut own.d,
            #[inline(always)]
            |_, d| *d = Short::default(),
        );
        if coarser.is_empty() {
            self.take_out(
                &mut own.residual,
                #[inline(always)]
                |_| 1.0,
                #[inline(always)]
                |row| level.mass()[row],
            );
            let beyond = self.values[(self.known.len() - 1) * LANES];
            let gap = |shift: f32| (beyond - f64::from(shift)).max(0.1 * beyond);
            let low = shift.map(|shift| (level.mass_over_diagonal * gap(shift)).min(0.5) as f32);
            let worst = f64::from(low.iter().copied().fold(0.5, f32::min));
            let steps = (0.5 * COARSEST * (2.0 / worst).sqrt()).ceil() as usize;
            chebyshev(level, shift, [low, [ROUGH[1]; LANES]], steps, own);
            self.take_out(
                &mut own.d,
                #[inline(always)]
                |row| level.mass()[row],
                #[inline(always)]
                |_| 1.0,
            );
            return;
        }
        let interval = ROUGH.map(|end| [end; LANES]);
        chebyshev(level, shift, interval, SMOOTHING, own);
        let transfer = &self.hierarchy.transfers[at + 1];
        for _ in 0..VISITS {
            level.subtract_image(&own.along, shift, &mut own.residual);
            transfer.restrict(
                &mut coarser[0].residual,
                #[inline(always)]
                |row| own.residual[row].0,
            );
            self.run(at + 1, shift, coarser);
            transfer.interpolate(
                &coarser[0].d,
                &mut own.along,
                #[inline(always)]
                |target, value| *target = value,
            );
            rows(
                &mut own.d,
                #[inline(always)]
                |row, d| *d = Short(std::array::from_fn(|l| d.0[l] + own.along[row].0[l])),
            );
            level.subtract_image(&own.along, shift, &mut own.residual);
            chebyshev(level, shift, interval, SMOOTHING, own);
        }
    }

    /// Takes the known eigenvectors K out: `x -= right K (K^T left x)` with a factor for each row on either side.
    fn take_out(
        &self,
        x: &mut [Short],
        left: impl Fn(usize) -> f32 + Sync,
        right: impl Fn(usize) -> f32 + Sync,
    ) {
        let part = |(chunk, x): (usize, &[Short])| -> Vec<Square> {
            let first = chunk * ROWS;
            let overlaps = |known: &Vec<Short>| {
                let known = &known[first..first + x.len()];
                pulp::Arch::new().dispatch(Overlaps { first, known, x, left: &left })
            };
            self.known.iter().map(overlaps).collect()
        };
        let parts: Vec<Vec<Square>> = x.par_chunks(ROWS).enumerate().map(part).collect();
        let mut sums = vec![[[0.0; LANES]; LANES]; self.known.len()];
        for part in &parts {
            for (sum, part) in sums.as_flattened_mut().iter_mut().zip(part.as_flattened()) {
                (0..LANES).for_each(|l| sum[l] += part[l]);
            }
        }
        rows(
            x,
            #[inline(always)]
            |row, x| {
                let (right, mut left_over) = (right(row), x.0);
                for (known, sums) in self.known.iter().zip(&sums) {
                    for (k, sum) in known[row].0.iter().zip(sums) {
                        left_over = std::array::from_fn(|l| left_over[l] - right * k * sum[l]);
                    }
                }
                *x = Short(left_over);
            },
        );
    }
}

/// Products of each column of a block with each of another one.
type Square = [Columns; LANES];

/// `K^T left x` of some rows from the first on.
struct Overlaps<'a, F> {
    first: usize,
    known: &'a [Short],
    x: &'a [Short],
    left: &'a F,
}

impl<F: Fn(usize) -> f32> WithSimd for Overlaps<'_, F> {
    type Output = Square;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Square {
        let mut sums = [[0.0; LANES]; LANES];
        for (i, (known, x)) in self.known.iter().zip(self.x).enumerate() {
            let left = (self.left)(self.first + i);
            let x: Columns = std::array::from_fn(|l| left * x.0[l]);
            for (sum, k) in sums.iter_mut().zip(known.0) {
                *sum = std::array::from_fn(|l| sum[l] + k * x[l]);
            }
        }
        sums
    }
}

/// Chebyshev's iteration for `(W - shift M) d = residual` on an interval of the spectrum of `D^-1 (W - shift M)`, for each column.
/// Afterwards the residual is the one before the last direction, which is in `along`.
fn chebyshev(level: &Level, shift: &Columns, interval: [Columns; 2], steps: usize, space: &mut Workspace) {
    let [low, high] = interval;
    let theta: Columns = std::array::from_fn(|l| 0.5 * (high[l] + low[l]));
    let delta: Columns = std::array::from_fn(|l| 0.5 * (high[l] - low[l]));
    level.first_direction(&theta.map(|theta| 1.0 / theta), &space.residual, &mut space.along, &mut space.d);
    let mut rho: Columns = std::array::from_fn(|l| delta[l] / theta[l]);
    for _ in 1..steps {
        let next: Columns = std::array::from_fn(|l| 1.0 / (2.0 * theta[l] / delta[l] - rho[l]));
        let step = ChebyshevStep {
            along: std::array::from_fn(|l| next[l] * rho[l]),
            residual: std::array::from_fn(|l| 2.0 * next[l] / delta[l]),
        };
        level.next_direction(shift, &step, &space.along, &mut space.next, &mut space.residual, &mut space.d);
        std::mem::swap(&mut space.along, &mut space.next);
        rho = next;
    }
}

/// The constant of a level and some vectors, orthonormal, in single precision.
fn with_constant(level: &Level, vectors: &BlockMatrix) -> Vec<Vec<Short>> {
    let constant = 1.0 / level.mass().iter().map(|&mass| f64::from(mass)).sum::<f64>().sqrt();
    let first = Short(std::array::from_fn(|l| if l == 0 { constant as f32 } else { 0.0 }));
    let short = |block: &Block| block.iter().map(|row| Short(row.0.map(|x| x as f32))).collect();
    std::iter::once(vec![first; level.len()]).chain(vectors.blocks().iter().map(short)).collect()
}

/// `x -= d` in double precision.
pub(super) fn correct(x: &mut [Lanes], d: &[Short]) {
    rows(
        x,
        #[inline(always)]
        |row, x| *x = Lanes(std::array::from_fn(|l| x.0[l] - f64::from(d[row].0[l]))),
    );
}

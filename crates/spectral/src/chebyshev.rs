//! Chebyshev polynomials of the grid Laplacian, applied to blocks of vectors without a matrix.

use std::ops::Range;

use mser3d_laplace::GridStencil;
use mser3d_shape::VoxelGrid;
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use crate::tall::{LANES, Lanes};

/// The stencil with its voxels reordered slice by slice along the solid's longest axis.
///
/// Slices across the longest axis are the smallest, and neighbours lie in the same or the next
/// slice: so several steps of the recurrence can follow each other through the slices like waves
/// (temporal blocking), while a slice is in the cache.
pub(crate) struct SlicedStencil {
    /// Neighbours of each row, in the new order; the row itself where there is none.
    neighbours: Vec<[u32; 6]>,
    weights: [f64; 3],
    /// The voxel of each row.
    pub order: Vec<u32>,
    /// First row of each slice, and the number of rows.
    slices: Vec<usize>,
    bound: f64,
}

/// A Chebyshev polynomial of degree `degree` in A, small on `[cutoff, bound]` and scaled to 1 at `target`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polynomial {
    pub degree: usize,
    pub target: f64,
    pub cutoff: f64,
}

/// Bytes that a wave of slices may fill: of a core's second-level cache, and, where that holds too few
/// slices, of its share of the third-level cache.
const WAVE_BYTES: [usize; 2] = [512 << 10, 6 << 20];
/// Steps in a wave: fewer than the first are not worth it, more than the second gain nothing.
const WAVE_STEPS: [usize; 2] = [4, 16];

impl SlicedStencil {
    pub fn new(grid: &VoxelGrid) -> Self {
        let stencil = GridStencil::new(grid);
        let dims = grid.frame().dims();
        let axis = (0..3).rev().max_by_key(|&a| dims[a]).unwrap_or(2);
        let mut counts = vec![0usize; dims[axis] + 1];
        grid.voxels().for_each(|v| counts[v[axis] as usize + 1] += 1);
        for i in 0..dims[axis] {
            counts[i + 1] += counts[i];
        }
        let mut next = counts.clone();
        let (mut order, mut position) = (vec![0u32; grid.len()], vec![0u32; grid.len()]);
        for (v, voxel) in grid.voxels().enumerate() {
            let row = &mut next[voxel[axis] as usize];
            order[*row] = v as u32;
            position[v] = *row as u32;
            *row += 1;
        }
        let moved = |&v: &u32| stencil.neighbours()[v as usize].map(|u| position[u as usize]);
        let neighbours = order.iter().map(moved).collect();
        counts.dedup();
        let (weights, bound) = (stencil.weights(), stencil.spectral_bound());
        Self { neighbours, weights, order, slices: counts, bound }
    }

    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Upper bound of the spectrum.
    pub fn bound(&self) -> f64 {
        self.bound
    }

    /// The components, as labels of the rows.
    pub fn labels(&self) -> Vec<u32> {
        let mut sets = mser3d_shape::DisjointSets::new(self.len());
        for (row, around) in self.neighbours.iter().enumerate() {
            for &u in around {
                sets.union(row as u32, u);
            }
        }
        (0..self.len() as u32).map(|row| sets.find(row)).collect()
    }

    /// `y = A x`.
    pub fn apply(&self, x: &[Lanes], y: &mut [Lanes]) {
        pulp::Arch::new().dispatch(Apply { stencil: self, x, y });
    }

    /// `x = p(A) x`; `work` is of the size of x and holds rubbish afterwards. Asks now and then whether
    /// it was `cancelled`, and then stops with rubbish in x. Up to `parts` threads share the slices.
    pub fn filter(
        &self,
        p: Polynomial,
        x: &mut [Lanes],
        work: &mut [Lanes],
        parts: usize,
        cancelled: &(dyn Fn() -> bool + Sync),
    ) {
        let steps = p.steps(self.bound);
        let depth = self.wave_steps();
        let cuts = self.cuts(parts, depth);
        // An even number of steps leaves the result in x.
        let (mut first, mut second) = (x, work);
        for steps in steps.chunks(depth) {
            if cancelled() {
                return;
            }
            self.waves(steps, first, second, &cuts);
            if steps.len() % 2 == 1 {
                std::mem::swap(&mut first, &mut second);
            }
        }
    }

    /// Runs steps on all slices. Between two cuts a thread can go on alone, if it leaves out one more slice
    /// at a cut with each step; what was left out follows when both sides have come that far.
    fn waves(&self, steps: &[Step], first: &mut [Lanes], second: &mut [Lanes], cuts: &[usize]) {
        let count = self.slices.len() - 1;
        let ends: Vec<usize> = [0].iter().chain(cuts).chain(&[count]).copied().collect();
        let parts = ends.windows(2).map(|ends| {
            let [low, high] = [ends[0], ends[1]];
            Region { rows: low..high, start: low..high, inward: [low > 0, high < count], outward: false }
        });
        self.run(parts.collect(), steps, first, second);
        let middles: Vec<usize> = ends.windows(2).map(|ends| ends[0].midpoint(ends[1])).collect();
        let seams = middles.windows(2).zip(cuts).map(|(middles, &cut)| Region {
            rows: middles[0]..middles[1],
            start: cut..cut,
            inward: [false; 2],
            outward: true,
        });
        self.run(seams.collect(), steps, first, second);
    }

    /// Runs steps on some regions, ascending, in parallel.
    fn run(&self, regions: Vec<Region>, steps: &[Step], first: &mut [Lanes], second: &mut [Lanes]) {
        let (mut first, mut second, mut base) = (first, second, 0);
        let mut waves = Vec::with_capacity(regions.len());
        for region in regions {
            let [low, high] = [region.rows.start, region.rows.end].map(|slice| self.slices[slice]);
            let (mine_first, rest) = std::mem::take(&mut first)[low - base..].split_at_mut(high - low);
            first = rest;
            let (mine_second, rest) = std::mem::take(&mut second)[low - base..].split_at_mut(high - low);
            second = rest;
            base = high;
            waves.push(Waves { stencil: self, steps, region, first: mine_first, second: mine_second });
        }
        waves.into_par_iter().for_each(|waves| pulp::Arch::new().dispatch(waves));
    }

    /// Slices that part the work for up to `parts` threads, each part thicker than two waves.
    fn cuts(&self, parts: usize, depth: usize) -> Vec<usize> {
        let count = self.slices.len() - 1;
        let thinnest = 2 * (depth + 1);
        let parts = parts.min(count / thinnest).max(1);
        let mut cuts = Vec::with_capacity(parts);
        for part in 1..parts {
            let row = self.len() * part / parts;
            let least = cuts.last().map_or(0, |&cut: &usize| cut) + thinnest;
            let most = count - (parts - part) * thinnest;
            cuts.push(self.slices.partition_point(|&start| start < row).clamp(least, most));
        }
        cuts
    }

    /// How many steps follow each other through the slices: a wave of s steps touches s + 2 slices of
    /// two blocks.
    fn wave_steps(&self) -> usize {
        let slice = (2 * size_of::<Lanes>() * self.len()).div_ceil((self.slices.len() - 1).max(1)).max(1);
        let steps = WAVE_BYTES.map(|bytes| (bytes / slice).saturating_sub(2));
        let steps = if steps[0] >= WAVE_STEPS[0] { steps[0] } else { steps[1] };
        steps.clamp(1, WAVE_STEPS[1])
    }

    /// `y = step.a A x + step.x x + step.previous y` on a range of rows; x and y begin with row `base`.
    #[inline(always)]
    fn step<S: Simd>(
        &self,
        simd: S,
        step: Step,
        x: &[Lanes],
        y: &mut [Lanes],
        rows: Range<usize>,
        base: usize,
    ) {
        let [wx, wy, wz] = self.weights.map(|w| simd.splat_f64s(-step.a * w));
        let diagonal = simd.splat_f64s(step.x + 2.0 * step.a * self.weights.iter().sum::<f64>());
        let previous = simd.splat_f64s(step.previous);
        // A row is one vector with AVX-512, two with AVX2, eight numbers without SIMD.
        let width = LANES / S::F64_LANES;
        let own = rows.start - base..rows.end - base;
        let centres = x[own.clone()].iter().zip(&mut y[own]);
        for (around, (centre, target)) in self.neighbours[rows].iter().zip(centres) {
            let lanes = around.map(|u| S::as_simd_f64s(&x[u as usize - base].0).0);
            let (centre, target) = (S::as_simd_f64s(&centre.0).0, S::as_mut_simd_f64s(&mut target.0).0);
            for part in 0..width {
                let at = |slot: usize| lanes[slot][part];
                let sum = simd.mul_f64s(diagonal, centre[part]);
                let sum = simd.mul_add_f64s(wx, simd.add_f64s(at(2), at(3)), sum);
                let sum = simd.mul_add_f64s(wy, simd.add_f64s(at(1), at(4)), sum);
                let sum = simd.mul_add_f64s(wz, simd.add_f64s(at(0), at(5)), sum);
                target[part] = simd.mul_add_f64s(previous, target[part], sum);
            }
        }
    }
}

/// The kernels as pulp wants them: `WithSimd` compiles them for each instruction set.
struct Apply<'a> {
    stencil: &'a SlicedStencil,
    x: &'a [Lanes],
    y: &'a mut [Lanes],
}

impl WithSimd for Apply<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let step = Step { a: 1.0, x: 0.0, previous: 0.0 };
        self.stencil.step(simd, step, self.x, self.y, 0..self.stencil.len(), 0);
    }
}

/// Slices that some steps of a recurrence go through.
struct Region {
    /// All slices that are read or written.
    rows: Range<usize>,
    /// Slices before the first step.
    start: Range<usize>,
    /// Whether each step leaves out one more slice at the lower and at the upper end.
    inward: [bool; 2],
    /// Whether each step takes one more slice at both ends.
    outward: bool,
}

impl Region {
    /// The slices of step `lag`, counted from 0.
    fn slices(&self, lag: usize) -> Range<usize> {
        let [low, high] = self.inward.map(|inward| if inward { lag + 1 } else { 0 });
        let more = if self.outward { lag + 1 } else { 0 };
        self.start.start + low - more..self.start.end + more - high
    }
}

/// Some steps of a recurrence, one behind the other through the slices of a region; the first reads
/// `first`. Both hold the rows of the region only.
struct Waves<'a> {
    stencil: &'a SlicedStencil,
    steps: &'a [Step],
    region: Region,
    first: &'a mut [Lanes],
    second: &'a mut [Lanes],
}

impl WithSimd for Waves<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let slices = &self.stencil.slices;
        let Range { start, end } = self.region.rows;
        for wave in start..end + self.steps.len() - 1 {
            for (lag, step) in self.steps.iter().enumerate() {
                if let Some(slice) = wave.checked_sub(lag).filter(|s| self.region.slices(lag).contains(s)) {
                    let (x, y) = if lag % 2 == 0 {
                        (&*self.first, &mut *self.second)
                    } else {
                        (&*self.second, &mut *self.first)
                    };
                    let rows = slices[slice]..slices[slice + 1];
                    self.stencil.step(simd, *step, x, y, rows, slices[start]);
                }
            }
        }
    }
}

/// One step of the three-term recurrence: `y <- a A x + x x + previous y`.
#[derive(Clone, Copy, Debug)]
struct Step {
    a: f64,
    x: f64,
    previous: f64,
}

impl Polynomial {
    /// The growth of the polynomial from the cutoff to `lambda` below it, per degree, as a logarithm.
    pub fn rate(lambda: f64, cutoff: f64, bound: f64) -> f64 {
        let x = (bound + cutoff - 2.0 * lambda) / (bound - cutoff);
        if x > 1.0 { x.acosh() } else { 0.0 }
    }

    /// The scaled recurrence (Zhou, Saad, Tiago & Chelikowsky 2006), an even number of steps.
    fn steps(self, bound: f64) -> Vec<Step> {
        let (e, c) = ((bound - self.cutoff) / 2.0, (bound + self.cutoff) / 2.0);
        let first = e / (self.target - c);
        let mut sigma = first;
        let mut steps = vec![Step { a: first / e, x: -c * first / e, previous: 0.0 }];
        for _ in 1..self.degree.next_multiple_of(2) {
            let next = 1.0 / (2.0 / first - sigma);
            steps.push(Step { a: 2.0 * next / e, x: -2.0 * next * c / e, previous: -sigma * next });
            sigma = next;
        }
        steps
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mser3d_shape::{BitGrid, Frame};

    #[test]
    fn filters_a_cosine_of_a_box_by_the_polynomials_value() {
        let dims = [23, 9, 70];
        let frame = Frame::new(dims, [0.0; 3], [0.5; 3]).unwrap();
        let grid = VoxelGrid::solid(frame, BitGrid::full(dims).unwrap()).unwrap();
        let stencil = SlicedStencil::new(&grid);
        let voxels: Vec<_> = grid.voxels().collect();
        // Lane l holds the eigenvector of wave number l + 1 along x.
        let angle = |l: usize| std::f64::consts::PI * (l + 1) as f64 / 23.0;
        let lambda = |l: usize| (2.0 - 2.0 * angle(l).cos()) / 0.25;
        let value = |v: u32, l: usize| ((f64::from(voxels[v as usize][0]) + 0.5) * angle(l)).cos();
        let start: Vec<Lanes> =
            stencil.order.iter().map(|&v| Lanes(std::array::from_fn(|l| value(v, l)))).collect();
        for (degree, parts) in [(2, 1), (7, 1), (40, 1), (7, 2), (40, 2), (40, 3)] {
            let p = Polynomial { degree, target: lambda(0), cutoff: 6.0 };
            let (mut x, mut work) = (start.clone(), vec![Lanes([1e3; LANES]); start.len()]);
            stencil.filter(p, &mut x, &mut work, parts, &|| false);
            let (e, c) = ((48.0 - 6.0) / 2.0, 27.0);
            let chebyshev = |t: f64| -> f64 {
                let d = degree.next_multiple_of(2) as f64;
                if t.abs() <= 1.0 {
                    (d * t.acos()).cos()
                } else {
                    t.signum().powf(d) * (d * t.abs().acosh()).cosh()
                }
            };
            for l in 0..LANES {
                let factor = chebyshev((lambda(l) - c) / e) / chebyshev((lambda(0) - c) / e);
                for row in (0..x.len()).step_by(97) {
                    assert!(
                        (x[row].0[l] - factor * start[row].0[l]).abs() < 1e-11,
                        "degree {degree} lane {l}"
                    );
                }
            }
        }
    }
}

//! Several steps of a recurrence on a stencil in one pass over memory (temporal blocking).
//!
//! A step at a slice needs the step before it at this slice and the two beside it. So the steps can follow
//! each other through the slices, one slice apart, like waves: while `s` steps run, `s + 2` slices are in
//! use, and if these fit in a cache, memory is read once for `s` steps (wavefronts: Wonnacott 2000; Malas,
//! Hager, Ltaief, Stengel, Wellein & Keyes 2015).
//!
//! Where slices are too large for that, they are tiled: a tile is w lines of all slices, moved one line
//! back with each step. Step s of tile j works on the lines `[j w - s, (j + 1) w - s)`. At step s - 1 the
//! line after any of these belongs to the same tile, where it was reached earlier in the wave, and the line
//! before to the same or the tile before. So tiles one after the other find all they need. Nothing is
//! overwritten too early either: the two buffers take turns, so step s overwrites what step s - 2 left in its
//! own row, and all steps that read it have run, as step s needed their results.

use std::ops::Range;

use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use crate::row::Row;
use crate::stencil::{SlicedStencil, Step};

/// Bytes that the slices of a wave may fill of a core's second-level cache, where they stay without being
/// asked for, and of its share of the third-level cache.
const WAVE_BYTES: [usize; 2] = [400 << 10, 6 << 20];
/// Bytes that the steps of a tile may fill: part of them lie in the second-level cache.
const TILE_BYTES: usize = 2 << 20;
/// Fewer steps together than these are not worth it in the second-level cache and in the third; more than the
/// most gain nothing.
const FEWEST_STEPS: [usize; 2] = [4, 8];
const MOST_STEPS: usize = 16;

/// How many steps run together, and on how many lines of a slice.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tiling {
    pub steps: usize,
    pub lines: usize,
}

impl Tiling {
    /// By the stencil's average slice: whole slices in the second-level cache, or else in the third, or else
    /// tiles of them.
    pub fn new<R: Row>(stencil: &SlicedStencil) -> Self {
        let slice = (2 * size_of::<R>() * stencil.len()).div_ceil(stencil.slices()).max(1);
        let whole = stencil.lines() + MOST_STEPS;
        for (bytes, fewest) in WAVE_BYTES.into_iter().zip(FEWEST_STEPS) {
            let steps = (bytes / slice).saturating_sub(2);
            if steps >= fewest {
                return Self { steps: steps.min(MOST_STEPS), lines: whole };
            }
        }
        let steps = FEWEST_STEPS[1];
        let lines = stencil.lines() * TILE_BYTES / (slice * (steps + 2));
        Self { steps, lines: lines.max(steps) }
    }
}

/// `y = A x`; x stays as it is.
pub(crate) fn apply<R: Row>(stencil: &SlicedStencil, tiling: Tiling, x: &mut [R], y: &mut [R]) {
    let once = [Step { a: 1.0, x: 0.0, previous: 0.0 }];
    run(stencil, tiling, rayon::current_num_threads(), &once, x, y);
}

/// Runs at most `tiling.steps` steps on all rows; the first reads `first`. Up to `parts` threads share the
/// slices.
///
/// Between two cuts a thread can go on alone, if it leaves out one more slice at a cut with each step; what
/// was left out follows when both sides have come that far.
pub(crate) fn run<R: Row>(
    stencil: &SlicedStencil,
    tiling: Tiling,
    parts: usize,
    steps: &[Step],
    first: &mut [R],
    second: &mut [R],
) {
    let count = stencil.slices();
    let cuts = cuts(stencil, parts, tiling.steps);
    let ends: Vec<usize> = [0].iter().chain(&cuts).chain(&[count]).copied().collect();
    let parts = ends.windows(2).map(|ends| {
        let [low, high] = [ends[0], ends[1]];
        Region { slices: low..high, start: low..high, inward: [low > 0, high < count], outward: false }
    });
    let waves = Waves { stencil, lines: tiling.lines, steps };
    waves.run(parts.collect(), first, second);
    let mut middles: Vec<usize> = ends.windows(2).map(|ends| ends[0].midpoint(ends[1])).collect();
    // The first seam and the last may go to the end.
    (middles[0], middles[cuts.len()]) = (0, count);
    let seams = middles.windows(2).zip(&cuts).map(|(middles, &cut)| Region {
        slices: middles[0]..middles[1],
        start: cut..cut,
        inward: [false; 2],
        outward: true,
    });
    waves.run(seams.collect(), first, second);
}

/// Slices that part the rows for up to `parts` threads. There is a cut for each thread, so that the seams are
/// shared as evenly as the rest: inner parts are twice as large as the two at the ends, which share a thread.
fn cuts(stencil: &SlicedStencil, parts: usize, steps: usize) -> Vec<usize> {
    let count = stencil.slices();
    let end = steps + 1;
    let wanted = if parts > 1 { parts.min(count / (2 * end)) } else { 0 };
    let mut cuts: Vec<usize> = Vec::with_capacity(wanted);
    for cut in 0..wanted {
        let row = stencil.len() * (2 * cut + 1) / (2 * wanted);
        let slice = (0..count).take_while(|&slice| stencil.first_row(slice) < row).count();
        let least = cuts.last().map_or(end, |&cut| cut + 2 * end);
        cuts.push(slice.clamp(least, count - (wanted - cut - 1) * 2 * end - end));
    }
    cuts
}

/// Slices that some steps go through.
struct Region {
    /// All slices that are read or written.
    slices: Range<usize>,
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

/// Some steps of a recurrence on a stencil, in tiles of so many lines.
#[derive(Clone, Copy)]
struct Waves<'a> {
    stencil: &'a SlicedStencil,
    lines: usize,
    steps: &'a [Step],
}

impl Waves<'_> {
    /// Runs the steps on some regions, ascending, in parallel.
    fn run<R: Row>(self, regions: Vec<Region>, first: &mut [R], second: &mut [R]) {
        let (mut first, mut second, mut base) = (first, second, 0);
        let mut parts = Vec::with_capacity(regions.len());
        for region in regions {
            let [low, high] = [region.slices.start, region.slices.end].map(|s| self.stencil.first_row(s));
            let skipped = low - base;
            let (mine, rest) = std::mem::take(&mut first)[skipped..].split_at_mut(high - low);
            first = rest;
            let (mine_too, rest) = std::mem::take(&mut second)[skipped..].split_at_mut(high - low);
            second = rest;
            base = high;
            parts.push(Part { waves: self, region, first: mine, second: mine_too });
        }
        parts.into_par_iter().for_each(|part| pulp::Arch::new().dispatch(part));
    }
}

/// One thread's part, as pulp wants it: `WithSimd` compiles it for each instruction set. Both buffers hold
/// the rows of its region only.
struct Part<'a, R> {
    waves: Waves<'a>,
    region: Region,
    first: &'a mut [R],
    second: &'a mut [R],
}

impl<R: Row> WithSimd for Part<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Waves { stencil, lines: width, steps } = self.waves;
        let Range { start, end } = self.region.slices;
        let (lines, base) = (stencil.lines(), stencil.first_row(start));
        // A tile that begins behind the last line reaches back to it in a later step.
        for tile in (0..lines + steps.len() - 1).step_by(width) {
            for wave in start..end + steps.len() - 1 {
                for (lag, step) in steps.iter().enumerate() {
                    let slice = wave.checked_sub(lag).filter(|s| self.region.slices(lag).contains(s));
                    let Some(slice) = slice else { continue };
                    let [low, high] = [tile, tile + width].map(|line| line.saturating_sub(lag).min(lines));
                    let (x, y) = if lag % 2 == 0 {
                        (&*self.first, &mut *self.second)
                    } else {
                        (&*self.second, &mut *self.first)
                    };
                    stencil.step(simd, *step, x, y, stencil.runs(slice, low..high), base);
                }
            }
        }
    }
}

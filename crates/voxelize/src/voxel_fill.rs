//! The inside of a surface as bits, from sweeps along the grid lines.

use crate::axis_parity::majority;
use crate::axis_sweep::{AxisSweep, SlabLines};
use crate::cancel::Stop;
use crate::centre_lattice::CentreLattice;
use crate::error::VoxelizeError;
use crate::inside_rule::{InsideRule, RunningWinding};
use crate::inside_test::InsideTest;
use crate::placed_surface::PlacedSurface;
use crate::surface::Surface;
use mser3d_shape::{BitGrid, Frame, ShapeError};
use rayon::prelude::*;
use std::ops::Range;

/// The voxels inside, and what was seen on the way.
pub(crate) struct Solid {
    pub occupancy: BitGrid,
    /// Voxels covered more than once.
    pub doubled: usize,
    /// Voxels that could be called otherwise.
    pub ambiguous: usize,
    /// Voxels of which the link along each axis is cut, whether inside or not.
    pub cuts: [Vec<[u32; 3]>; 3],
}

/// The solid of a surface on a grid, without links.
pub(crate) fn sweep(
    surface: &Surface,
    frame: &Frame,
    rule: InsideRule,
    inside_test: InsideTest,
    stop: &Stop,
) -> Result<Solid, VoxelizeError> {
    let lattice = CentreLattice::new(frame, surface.scale, surface.reach);
    solve(&PlacedSurface::new(surface, &lattice, rule, false, stop), inside_test)
}

/// The same of a surface that is on its lattice already, with its cut links if it is to have any.
pub(crate) fn solve(placed: &PlacedSurface, inside_test: InsideTest) -> Result<Solid, VoxelizeError> {
    let mut solid = placed.solid()?;
    if inside_test == InsideTest::Vote {
        let (y, z) = (placed.parity_along(1)?, placed.parity_along(2)?);
        (solid.occupancy, solid.ambiguous) = majority(&solid.occupancy, &y, &z);
    }
    placed.stop.check()?;
    Ok(solid)
}

#[derive(Default)]
struct Tally {
    doubled: usize,
    ambiguous: usize,
    cuts: Vec<[u32; 3]>,
}

impl<'a> PlacedSurface<'a> {
    /// Sweeps along x for the inside, and along all axes for cut links.
    pub fn solid(&self) -> Result<Solid, ShapeError> {
        let mut occupancy = BitGrid::empty(self.lattice.dims)?;
        let sweep = self.sweep(0);
        let slab_words = sweep.rows_per_slab() * self.lattice.dims[1] * occupancy.row_words();
        let row_words = occupancy.row_words();
        let tallies: Vec<Tally> = occupancy
            .words_mut()
            .par_chunks_mut(slab_words.max(1))
            .enumerate()
            .map_init(SlabLines::default, |lines, (slab, words)| {
                self.fill_slab(&sweep, slab, lines, words, row_words)
            })
            .collect();
        drop(sweep);
        let mut solid = Solid { occupancy, doubled: 0, ambiguous: 0, cuts: Default::default() };
        for tally in tallies {
            solid.doubled += tally.doubled;
            solid.ambiguous += tally.ambiguous;
            solid.cuts[0].extend(tally.cuts);
        }
        if self.cut_links {
            solid.cuts[1] = self.cuts_along(1);
            solid.cuts[2] = self.cuts_along(2);
        }
        Ok(solid)
    }

    fn fill_slab(
        &self,
        sweep: &AxisSweep,
        slab: usize,
        lines: &mut SlabLines,
        words: &mut [u64],
        row_words: usize,
    ) -> Tally {
        let mut tally = Tally::default();
        let mut state = RunningWinding::new(self.surface, self.rule);
        let [nx, ny, _] = self.lattice.dims;
        let first_row = sweep.slab_rows(slab).start * ny;
        sweep.for_each_line(slab, lines, self.holes.is_some(), |j, k, crossings| {
            let start = (k * ny + j - first_row) * row_words;
            let row = &mut words[start..start + row_words];
            state.reset();
            let mut from = 0;
            for &crossing in crossings {
                if crossing.cell() > from {
                    self.fill_run(&state, from..crossing.cell(), [j, k], row, &mut tally);
                    from = crossing.cell();
                }
                if self.counts(crossing) {
                    state.cross(crossing);
                }
            }
            if self.rule == InsideRule::Parity && crossings.len() % 2 == 1 {
                // A hole: the line never comes out again.
                tally.ambiguous += row.iter().map(|w| w.count_ones() as usize).sum::<usize>() + nx - from;
            }
            self.fill_run(&state, from..nx, [j, k], row, &mut tally);
            if self.cut_links {
                self.cut_line(sweep, [j, k], crossings, &mut state, &mut tally.cuts);
            }
        });
        tally
    }

    /// Sets the bits of a run of voxels without crossings between them.
    #[inline]
    fn fill_run(
        &self,
        state: &RunningWinding,
        run: Range<usize>,
        [j, k]: [usize; 2],
        row: &mut [u64],
        tally: &mut Tally,
    ) {
        let (inside, doubled) = (state.inside(), state.doubled());
        let plain = |run: Range<usize>, row: &mut [u64], tally: &mut Tally| {
            tally.doubled += if doubled { run.len() } else { 0 };
            if inside {
                fill(row, run);
            }
        };
        let Some(holes) = &self.holes else { return plain(run, row, tally) };
        let mut from = run.start;
        for (place, voxels) in holes.along(run.clone(), [j, k]) {
            plain(from..voxels.start, row, tally);
            from = voxels.end;
            for i in voxels {
                let (state, unclear) = state.corrected(holes, place, [i, j, k]);
                if state.inside() {
                    fill(row, i..i + 1);
                }
                tally.doubled += usize::from(state.doubled());
                tally.ambiguous += usize::from(unclear);
            }
        }
        plain(from..run.end, row, tally);
    }
}

/// Sets a range of bits of a row.
#[inline]
fn fill(row: &mut [u64], range: Range<usize>) {
    if range.is_empty() {
        return;
    }
    let (first, last) = (range.start / 64, (range.end - 1) / 64);
    let low = u64::MAX << (range.start % 64);
    let high = u64::MAX >> (63 - (range.end - 1) % 64);
    if first == last {
        row[first] |= low & high;
    } else {
        row[first] |= low;
        row[first + 1..last].fill(u64::MAX);
        row[last] |= high;
    }
}

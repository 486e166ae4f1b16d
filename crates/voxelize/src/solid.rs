//! The inside of a surface as bits, from sweeps along the axes.

use crate::coverage::{Rule, State};
use crate::holes::{BLOCK, HoleField};
use crate::lattice::{Lattice, Placed};
use crate::surface::Surface;
use crate::sweep::{Crossing, SlabLines, Sweep};
use mser3d_shape::{BitGrid, ShapeError};
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

/// A surface on a lattice, ready to be swept.
pub(crate) struct Scene<'a> {
    pub lattice: &'a Lattice,
    pub surface: &'a Surface<'a>,
    pub rule: Rule,
    pub field: Option<HoleField>,
    placed: Vec<Placed>,
    cut_links: bool,
}

#[derive(Default)]
struct Tally {
    doubled: usize,
    ambiguous: usize,
    cuts: Vec<[u32; 3]>,
}

impl<'a> Scene<'a> {
    pub fn new(surface: &'a Surface<'a>, lattice: &'a Lattice, rule: Rule, cut_links: bool) -> Self {
        let field = HoleField::new(surface, lattice);
        let placed = lattice.place(&surface.vertices);
        Self { lattice, surface, rule, field, placed, cut_links }
    }

    fn sweep(&self, axis: usize) -> Sweep<'_> {
        Sweep::new(self.lattice, &self.surface.vertices, &self.placed, &self.surface.triangles, axis)
    }

    /// Whether a crossing changes the integer winding number.
    #[inline]
    pub fn counts(&self, crossing: Crossing) -> bool {
        !self.surface.bodies[self.surface.body_of(crossing.triangle())].scattered
    }

    /// Whether a crossing is one with the surface, and not with the cap of a larger hole.
    #[inline]
    pub fn parts(&self, crossing: Crossing) -> bool {
        crossing.triangle() < self.surface.patched
    }

    /// Whether any two crossings part neighbours: with one body, or with bodies that are not told apart.
    pub fn any_two_part(&self) -> bool {
        matches!(self.rule, Rule::Parity | Rule::Total { join: false })
    }

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
        sweep: &Sweep,
        slab: usize,
        lines: &mut SlabLines,
        words: &mut [u64],
        row_words: usize,
    ) -> Tally {
        let mut tally = Tally::default();
        let mut state = State::new(self.surface, self.rule);
        let [nx, ny, _] = self.lattice.dims;
        let first_row = sweep.slab_rows(slab).start * ny;
        sweep.for_each_line(slab, lines, self.field.is_some(), |j, k, crossings| {
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
            if self.rule == Rule::Parity && crossings.len() % 2 == 1 {
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
        state: &State,
        run: Range<usize>,
        [j, k]: [usize; 2],
        row: &mut [u64],
        tally: &mut Tally,
    ) {
        let Some(field) = &self.field else {
            if state.inside() {
                fill(row, run.clone());
            }
            tally.doubled += if state.doubled() { run.len() } else { 0 };
            return;
        };
        let mut from = run.start;
        while from < run.end {
            let to = ((from / BLOCK + 1) * BLOCK).min(run.end);
            if !field.is_marked([from, j, k]) {
                if state.inside() {
                    fill(row, from..to);
                }
                tally.doubled += if state.doubled() { to - from } else { 0 };
            } else {
                for i in from..to {
                    let (state, unclear) = state.corrected(field, [i, j, k]);
                    if state.inside() {
                        fill(row, i..i + 1);
                    }
                    tally.doubled += usize::from(state.doubled());
                    tally.ambiguous += usize::from(unclear);
                }
            }
            from = to;
        }
    }

    fn cuts_along(&self, axis: usize) -> Vec<[u32; 3]> {
        let sweep = self.sweep(axis);
        let lists: Vec<Vec<[u32; 3]>> = (0..sweep.slabs())
            .into_par_iter()
            .map_init(SlabLines::default, |lines, slab| {
                let mut cuts = Vec::new();
                let mut state = State::new(self.surface, self.rule);
                sweep.for_each_line(slab, lines, false, |u, v, crossings| {
                    self.cut_line(&sweep, [u, v], crossings, &mut state, &mut cuts);
                });
                cuts
            })
            .collect();
        lists.concat()
    }

    /// Finds the links of a line that the surface cuts: those between whose ends the line leaves the
    /// solid. With one body, or bodies that are not told apart, that is any two crossings.
    fn cut_line(
        &self,
        sweep: &Sweep,
        [u, v]: [usize; 2],
        crossings: &[Crossing],
        state: &mut State<'a>,
        cuts: &mut Vec<[u32; 3]>,
    ) {
        let axes = sweep.axes();
        let last = self.lattice.dims[axes.d];
        let mut place = 0;
        for gap in crossings.chunk_by(|a, b| a.cell() == b.cell()) {
            let (cell, before) = (gap[0].cell(), place);
            place += gap.len();
            if cell == 0
                || cell >= last
                || gap.len() < 2
                || gap.iter().filter(|c| self.parts(**c)).count() < 2
            {
                continue;
            }
            let mut voxel = [0; 3];
            (voxel[axes.u], voxel[axes.v], voxel[axes.d]) = (u, v, cell - 1);
            if self.any_two_part() || self.leaves(sweep, voxel, &crossings[..before], gap, state) {
                cuts.push(voxel.map(|x| x as u32));
            }
        }
    }

    /// Whether the segment from a voxel's centre to the next along the sweep is outside somewhere.
    fn leaves(
        &self,
        sweep: &Sweep,
        voxel: [usize; 3],
        before: &[Crossing],
        gap: &[Crossing],
        state: &mut State<'a>,
    ) -> bool {
        state.reset();
        before.iter().filter(|c| self.counts(**c)).for_each(|&c| state.cross(c));
        let axes = sweep.axes();
        let depth = |c: Crossing| sweep.depth(c.triangle(), voxel[axes.u], voxel[axes.v]);
        let passed: Vec<(f64, Crossing)> = gap.iter().map(|&c| (depth(c), c)).collect();
        self.leaves_between(state, voxel, passed)
    }

    /// Whether a segment that starts at a voxel's centre is outside somewhere between these crossings, given
    /// with their places along the segment in voxels.
    pub fn leaves_between(
        &self,
        state: &State<'a>,
        voxel: [usize; 3],
        mut passed: Vec<(f64, Crossing)>,
    ) -> bool {
        passed.retain(|p| self.parts(p.1));
        for (place, crossing) in &mut passed {
            // Surfaces in contact part: at one place, leaving comes first.
            *place += if crossing.entering() { CONTACT } else { 0.0 };
        }
        passed.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut state = match &self.field {
            Some(field) if field.is_marked(voxel) => state.corrected(field, voxel).0,
            _ => state.clone(),
        };
        passed.pop();
        passed.iter().any(|&(_, crossing)| {
            state.cross(crossing);
            !state.inside()
        })
    }

    /// The parity of crossings along one axis, and the number of voxels on lines that never come out.
    pub fn parity_along(&self, axis: usize) -> Result<BitGrid, ShapeError> {
        let mut bits = BitGrid::empty(self.lattice.dims)?;
        let sweep = self.sweep(axis);
        let axes = sweep.axes();
        let toggles: Vec<Vec<[u32; 3]>> = (0..sweep.slabs())
            .into_par_iter()
            .map_init(SlabLines::default, |lines, slab| {
                let mut toggles = Vec::new();
                sweep.for_each_line(slab, lines, false, |u, v, crossings| {
                    for crossing in crossings.iter().filter(|c| c.cell() < self.lattice.dims[axis]) {
                        let mut voxel = [0; 3];
                        (voxel[axes.u], voxel[axes.v]) = (u as u32, v as u32);
                        voxel[axes.d] = crossing.cell() as u32;
                        toggles.push(voxel);
                    }
                });
                toggles
            })
            .collect();
        for voxel in toggles.into_iter().flatten() {
            let (word, bit) = bits.position(voxel);
            bits.words_mut()[word] ^= 1 << bit;
        }
        prefix_xor(&mut bits, axis);
        Ok(bits)
    }
}

/// Surfaces closer than this, in voxels, are in contact.
const CONTACT: f64 = 1e-9;

/// Replaces each bit by the parity of the bits up to it along an axis.
fn prefix_xor(bits: &mut BitGrid, axis: usize) {
    let ([nx, ny, nz], row) = (bits.dims(), bits.row_words());
    if row == 0 {
        return;
    }
    let words = bits.words_mut();
    match axis {
        0 => {
            for line in words.chunks_mut(row) {
                let mut carry = 0;
                for word in line.iter_mut() {
                    for shift in [1, 2, 4, 8, 16, 32] {
                        *word ^= *word << shift;
                    }
                    *word ^= carry;
                    carry = if *word >> 63 == 1 { u64::MAX } else { 0 };
                }
                if nx % 64 != 0 {
                    line[row - 1] &= (1 << (nx % 64)) - 1;
                }
            }
        }
        _ => {
            let stride = if axis == 1 { row } else { row * ny };
            for word in 0..row * ny * nz {
                let place = if axis == 1 { word / row % ny } else { word / (row * ny) };
                if place > 0 {
                    words[word] ^= words[word - stride];
                }
            }
        }
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

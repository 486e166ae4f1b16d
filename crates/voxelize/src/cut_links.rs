//! Links to face neighbours that the surface cuts, found on the grid lines.

use crate::axis_sweep::{AxisSweep, Crossing, SlabLines};
use crate::inside_rule::RunningWinding;
use crate::placed_surface::PlacedSurface;
use rayon::prelude::*;

/// Bodies closer than this part of the grid's longest side are in contact: coordinates are not more precise.
const CONTACT: f64 = 1e-9;

impl<'a> PlacedSurface<'a> {
    /// Voxels whose link along an axis is cut, whether they are inside or not.
    pub fn cuts_along(&self, axis: usize) -> Vec<[u32; 3]> {
        let sweep = self.sweep(axis);
        let lists: Vec<Vec<[u32; 3]>> = (0..sweep.slabs())
            .into_par_iter()
            .map_init(SlabLines::default, |lines, slab| {
                let mut cuts = Vec::new();
                let mut state = RunningWinding::new(self.surface, self.rule);
                sweep.for_each_line(slab, lines, false, |u, v, crossings| {
                    self.cut_line(&sweep, [u, v], crossings, &mut state, &mut cuts);
                });
                cuts
            })
            .collect();
        lists.concat()
    }

    /// Finds the links of a line that the surface cuts: those between whose ends the line leaves the
    /// solid. With one shell, or shells that are not told apart, that is any two crossings.
    pub fn cut_line(
        &self,
        sweep: &AxisSweep,
        [u, v]: [usize; 2],
        crossings: &[Crossing],
        state: &mut RunningWinding<'a>,
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
        sweep: &AxisSweep,
        voxel: [usize; 3],
        before: &[Crossing],
        gap: &[Crossing],
        state: &mut RunningWinding<'a>,
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
        state: &RunningWinding<'a>,
        voxel: [usize; 3],
        mut passed: Vec<(f64, Crossing)>,
    ) -> bool {
        passed.retain(|p| self.parts(p.1));
        // At one place, going in comes first: bodies in contact are one solid, as those that overlap. A shell
        // in contact with itself is covered twice for a moment, and so parted, unless overlaps are joined.
        let contact = CONTACT * self.lattice.dims.into_iter().max().unwrap_or(1) as f64;
        for (place, crossing) in &mut passed {
            *place -= if crossing.entering() { contact } else { 0.0 };
        }
        passed.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let holes = self.holes.as_ref().and_then(|holes| Some((holes, holes.place(voxel)?)));
        let mut state =
            holes.map_or_else(|| state.clone(), |(holes, place)| state.corrected(holes, place, voxel).0);
        passed.pop();
        passed.iter().any(|&(_, crossing)| {
            state.cross(crossing);
            !state.inside()
        })
    }
}

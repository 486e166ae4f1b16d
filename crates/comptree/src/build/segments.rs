//! Step 3 of the construction: which branch each vertex lies on, and where on it. Branches are cut into segments
//! where others join, the arcs of an augmented merge tree, and segments into bins.
use std::ops::Range;

use super::branches::{Branches, Joined};
use super::filtration::Filtration;
use super::scale::Scale;
use crate::tree::NONE;

/// Vertices of a bin, on average.
const BIN: u32 = 2048;

/// Turns the basins of a range of vertices into branches, and counts the vertices of each.
pub(super) fn climb<R: Filtration>(
    filtration: &R,
    labels: &mut [u32],
    start: usize,
    branches: &Branches,
) -> Vec<u32> {
    let mut sizes = vec![0; branches.len()];
    // Next to each other most vertices lie on one branch.
    let (mut basin, mut branch, mut low, mut high) = (NONE, 0, 0.0, 0.0);
    let mut run = 0;
    for (label, v) in labels.iter_mut().zip(start as u32..) {
        let level = filtration.level(v);
        if *label != basin || level < low || level >= high {
            if run > 0 {
                sizes[branch as usize] += run;
            }
            run = 0;
            basin = *label;
            (branch, low, high) = branches.climb(basin, level);
        }
        *label = branch;
        run += 1;
    }
    if run > 0 {
        sizes[branch as usize] += run;
    }
    sizes
}

/// Cuts all branches into bins: by level into equal parts, and these where others join. Along a branch the numbers of
/// bins ascend with their levels.
pub(super) struct Bins<'a> {
    joined: &'a Joined,
    spans: Vec<Span>,
    /// How many branches join in the parts before each one, at the sum of its number and the branch's first bin.
    below: Vec<u32>,
    /// The first bin of each segment, and the number of bins.
    starts: Vec<u32>,
    /// Which segments have a bin for each level; empty if levels are no integers.
    units: Vec<bool>,
}

/// The parts of a branch.
#[derive(Clone, Copy)]
struct Span {
    scale: Scale,
    parts: u32,
    /// The first bin.
    first: u32,
    /// Where the branches that join are in the list.
    slots: [u32; 2],
}

impl Span {
    #[inline(always)]
    fn part(&self, level: f64) -> u32 {
        self.scale.part(level, self.parts)
    }

    #[inline(always)]
    fn slots(&self) -> Range<usize> {
        self.slots[0] as usize..self.slots[1] as usize
    }

    /// Whether each part is a level, of levels that are integers.
    #[inline(always)]
    fn is_unit(&self) -> bool {
        self.scale.is_unit()
    }
}

impl<'a> Bins<'a> {
    /// `sizes`: how many vertices each branch has.
    pub fn new<R: Filtration>(
        filtration: &R,
        branches: &Branches,
        joined: &'a Joined,
        sizes: &[u32],
    ) -> Self {
        let mut first = 0;
        let mut units = Vec::new();
        let mut spans = Vec::with_capacity(branches.len());
        let mut starts = Vec::with_capacity(branches.len() + joined.list.len() + 1);
        for (branch, &size) in sizes.iter().enumerate() {
            let slots = [joined.starts[branch], joined.starts[branch + 1]];
            let joins = slots[1] - slots[0];
            let (low, high) = (branches.births[branch], branches.joins[branch].level.min(filtration.top()));
            let (parts, scale) = if R::INTEGERS && high - low <= f64::from(joins.max(size)) {
                // A part for each level, if these are not too many: then nothing is left to sort.
                ((high - low).max(0.0) as u32 + 1, Scale::unit(low))
            } else {
                let parts = (joins / 2).max(size / BIN).max(1);
                (parts, Scale::new(low, high, parts))
            };
            let span = Span { scale, parts, first, slots };
            starts.push(first);
            let levels = &joined.levels[span.slots()];
            starts.extend(levels.iter().zip(first + 1..).map(|(&level, bin)| bin + span.part(level)));
            spans.push(span);
            if R::INTEGERS {
                units.resize(starts.len(), span.is_unit());
            }
            first += parts + joins;
        }
        starts.push(first);
        let mut below = vec![0u32; first as usize];
        for span in spans.iter().filter(|span| !span.slots().is_empty()) {
            let below = &mut below[span.first as usize..][..=span.parts as usize];
            joined.levels[span.slots()].iter().for_each(|&level| below[span.part(level) as usize + 1] += 1);
            for part in 1..below.len() {
                below[part] += below[part - 1];
            }
        }
        Self { joined, spans, below, starts, units }
    }

    /// The number of bins.
    pub fn len(&self) -> usize {
        self.below.len()
    }

    /// The bins of a segment.
    #[inline(always)]
    pub fn of_segment(&self, segment: usize) -> Range<usize> {
        self.starts[segment] as usize..self.starts[segment + 1] as usize
    }

    /// Whether a bin of a segment is one level.
    pub fn are_levels(&self, segment: usize) -> bool {
        self.units[segment]
    }

    /// The bin of a level on a branch.
    #[inline(always)]
    pub fn find<R: Filtration>(&self, branch: u32, level: f64) -> u32 {
        let span = &self.spans[branch as usize];
        let bin = span.first + span.part(level);
        let slots = span.slots();
        if slots.is_empty() {
            return bin;
        }
        let (from, to) = (self.below[bin as usize], self.below[bin as usize + 1]);
        if from == to || R::INTEGERS && span.is_unit() {
            return bin + to;
        }
        let inside = &self.joined.levels[slots][from as usize..to as usize];
        // Mostly they join at one level.
        let count = if inside[inside.len() - 1] <= level {
            to
        } else if inside[0] > level {
            from
        } else {
            from + inside.partition_point(|&join| join <= level) as u32
        };
        bin + count
    }

    /// Turns the branches of a range of vertices into bins, and finds how many vertices each bin has and the first
    /// one.
    pub fn count<R: Filtration>(&self, filtration: &R, labels: &mut [u32], start: usize) -> Vec<Count> {
        let mut counts = vec![Count::default(); self.len()];
        // From the last one down, each can take the place of the first.
        for (i, label) in labels.iter_mut().enumerate().rev() {
            let v = (start + i) as u32;
            *label = self.find::<R>(*label, filtration.level(v));
            counts[*label as usize].add(v);
        }
        counts
    }
}

/// How many vertices, and the first one: in one number, which memory takes in and gives back at once.
#[derive(Clone, Copy, Default)]
pub(super) struct Count(u64);

impl Count {
    #[inline(always)]
    fn add(&mut self, vertex: u32) {
        self.0 = ((self.0 >> 32) + 1) << 32 | u64::from(vertex);
    }

    /// Makes this the place where the first of the vertices goes; returns how many there are.
    #[inline(always)]
    pub fn start_at(&mut self, place: u32) -> u32 {
        (std::mem::replace(&mut self.0, u64::from(place)) >> 32) as u32
    }

    /// Where the next vertex goes.
    #[inline(always)]
    pub fn next(&mut self) -> usize {
        self.0 += 1;
        self.0 as usize - 1
    }

    /// [`NONE`] if there are none.
    #[inline(always)]
    pub fn first(self) -> u32 {
        if self.0 == 0 { NONE } else { self.0 as u32 }
    }
}

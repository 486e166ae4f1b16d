//! Step 4 of the construction: branches cut where others join, the arcs of an augmented merge tree.
use std::ops::Range;

use rayon::prelude::*;

use super::branches::{Branches, Join, Joined};
use super::filtration::Filtration;
use super::sorted_vertices::SortedVertices;
use crate::tree::NONE;

/// A number of vertices and of nodes, or a place in their order.
#[derive(Clone, Copy, Default)]
pub(super) struct Extent {
    pub vertices: u32,
    pub nodes: u32,
}

impl Extent {
    /// Differences can be negative: they wrap, and sums with them wrap back.
    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        Self {
            vertices: self.vertices.wrapping_add(other.vertices),
            nodes: self.nodes.wrapping_add(other.nodes),
        }
    }

    #[inline(always)]
    pub fn minus(self, other: Self) -> Self {
        Self {
            vertices: self.vertices.wrapping_sub(other.vertices),
            nodes: self.nodes.wrapping_sub(other.nodes),
        }
    }
}

/// The vertices of a branch that enter between two levels at which others join it. The first level is
/// included; of branches that join at one level only the last has them.
#[derive(Clone, Copy)]
pub(super) struct Segment {
    /// Where the vertices are among all sorted ones.
    pub start: u32,
    /// How many, and how many nodes they make.
    pub size: Extent,
    /// The smallest vertex.
    pub least: u32,
    /// Whether the first node has no vertex of its own: with weights on edges, branches can join where
    /// no vertex enters.
    pub bare: bool,
}

impl Segment {
    pub fn entries(&self) -> Range<usize> {
        self.start as usize..(self.start + self.size.vertices) as usize
    }
}

/// All branches, cut where others join.
pub(super) struct Segments {
    /// The segment of each branch before any other joins.
    pub first: Vec<Segment>,
    /// Those that follow, one for each branch that joins, as in [`Joined::list`].
    pub later: Vec<Segment>,
}

impl Segments {
    pub fn new<R: Filtration>(
        filtration: &R,
        branches: &Branches,
        joined: &Joined,
        sorted: &SortedVertices,
    ) -> Self {
        let level = |slot: usize| joined.joins[slot].level;
        let split = |join: &Join| sorted.split(filtration, join.into, join.level);
        let splits: Vec<u32> = joined.joins.par_iter().with_min_len(256).map(split).collect();
        let measured = |branch: usize, start: u32, next: usize| {
            let last = next == joined.starts[branch + 1] as usize;
            let end = if last { sorted.starts[branch + 1] } else { splits[next] };
            measure(filtration, sorted, start..end)
        };
        let first = |branch: usize| {
            let start = sorted.starts[branch];
            measured(branch, start, joined.starts[branch] as usize)
        };
        let later = |slot: usize| {
            let branch = joined.joins[slot].into as usize;
            let mut segment = measured(branch, splits[slot], slot + 1);
            let together = slot + 1 < joined.starts[branch + 1] as usize && level(slot + 1) == level(slot);
            let enters = sorted.entries().get(segment.start as usize).filter(|_| segment.size.vertices > 0);
            segment.bare = !together && enters.is_none_or(|e| filtration.level(e[0]) != level(slot));
            segment.size.nodes += u32::from(segment.bare);
            segment
        };
        let tasks = |count: usize| (0..count).into_par_iter().with_min_len(256);
        Self {
            first: tasks(branches.len()).map(first).collect(),
            later: tasks(joined.list.len()).map(later).collect(),
        }
    }
}

/// Finds the smallest vertex of a stretch of one branch and counts its levels.
fn measure<R: Filtration>(filtration: &R, sorted: &SortedVertices, stretch: Range<u32>) -> Segment {
    let range = stretch.start as usize..stretch.end as usize;
    let block = |block: Range<usize>| {
        let least = sorted.entries()[block.clone()].iter().map(|entry| entry[0]).min();
        let first = u32::from(block.start == range.start && !block.is_empty());
        let rises = sorted.rises(filtration, block.start.max(range.start + 1)..block.end);
        (least.unwrap_or(NONE), first + rises)
    };
    let (least, nodes) = in_blocks(range.clone()).map_or_else(
        || block(range.clone()),
        |blocks| {
            let join = |a: (u32, u32), b: (u32, u32)| (a.0.min(b.0), a.1 + b.1);
            blocks.map(&block).reduce(|| (NONE, 0), join)
        },
    );
    let size = Extent { vertices: range.len() as u32, nodes };
    Segment { start: stretch.start, size, least, bare: false }
}

/// A long range in blocks for threads; `None` for a short one.
pub(super) fn in_blocks(range: Range<usize>) -> Option<impl ParallelIterator<Item = Range<usize>>> {
    const BLOCK: usize = 1 << 16;
    let count = range.len().div_ceil(BLOCK);
    let part = move |i: usize| range.start + i * BLOCK..range.end.min(range.start + (i + 1) * BLOCK);
    (count > 1).then(|| (0..count).into_par_iter().map(part))
}

//! Step 4 of the construction: where each segment comes in the canonical numbering, so that threads can write
//! nodes in any order. Not in a paper: it replaces a walk through the finished tree.
use rayon::prelude::*;

use super::branches::{Branches, Joined};
use super::segments::{Extent, Segments};
use crate::tree::NONE;

/// Where everything comes in the tree: children before parents, siblings by their smallest vertex.
pub(super) struct Placement {
    /// The place of the first segment of each branch.
    pub first: Vec<Extent>,
    /// Of the segments that follow, the place seen from the branch's first.
    pub later: Vec<Extent>,
    /// The node above each branch.
    pub above: Vec<u32>,
    /// Vertices and nodes of the whole tree.
    pub total: Extent,
}

/// A branch and all that join it: a subtree.
#[derive(Clone, Copy)]
struct Block {
    size: Extent,
    /// The smallest vertex.
    least: u32,
}

/// Places along some branches, all seen from the first segment of the branch.
#[derive(Default)]
struct Along {
    /// Of each branch the beginning of its block: blocks with smaller vertices lie between.
    fronts: Vec<Extent>,
    /// Of each branch that joins, its block.
    blocks: Vec<Extent>,
    /// Of each branch that joins, the segment at the join.
    segments: Vec<Extent>,
}

/// Finds the place of each segment.
pub(super) fn place(branches: &Branches, joined: &Joined, segments: &Segments) -> Placement {
    let blocks = blocks(branches, joined, segments);
    let along = along(branches, joined, segments, &blocks);
    let mut first: Vec<Extent> = along.fronts.iter().map(|&front| Extent::default().minus(front)).collect();
    let mut above = vec![NONE; branches.len()];
    let mut total = Extent::default();
    let mut roots = branches.roots();
    roots.sort_unstable_by_key(|&root| blocks[root as usize].least);
    for &root in &roots {
        first[root as usize] = first[root as usize].plus(total);
        total = total.plus(blocks[root as usize].size);
    }
    // From the roots down, places along a branch become places in the tree.
    for &branch in roots.iter().chain(branches.order.iter().rev()) {
        let base = first[branch as usize];
        for slot in joined.slots(branch) {
            let child = joined.list[slot] as usize;
            first[child] = first[child].plus(base.plus(along.blocks[slot]));
            above[child] = base.plus(along.segments[slot]).nodes;
        }
    }
    Placement { first, later: along.segments, above, total }
}

/// The subtree of each branch.
fn blocks(branches: &Branches, joined: &Joined, segments: &Segments) -> Vec<Block> {
    let own = |branch: usize| {
        let later = &segments.later[joined.slots(branch as u32)];
        let all = later.iter().chain([&segments.first[branch]]);
        let join = |block: Block, segment: &super::segments::Segment| Block {
            size: block.size.plus(segment.size),
            least: block.least.min(segment.least),
        };
        all.fold(Block { size: Extent::default(), least: NONE }, join)
    };
    let mut blocks: Vec<Block> = (0..branches.len()).into_par_iter().with_min_len(256).map(own).collect();
    for &branch in &branches.order {
        let Block { size, least } = blocks[branch as usize];
        let into = &mut blocks[branches.joins[branch as usize].into as usize];
        *into = Block { size: into.size.plus(size), least: into.least.min(least) };
    }
    blocks
}

fn along(branches: &Branches, joined: &Joined, segments: &Segments, blocks: &[Block]) -> Along {
    let step = branches.len().div_ceil(8 * rayon::current_num_threads()).max(1024);
    let parts = (0..branches.len().div_ceil(step)).into_par_iter().map(|part| {
        let mut along = Along::default();
        let mut group = Vec::new();
        for branch in part * step..((part + 1) * step).min(branches.len()) {
            along.add(branch as u32, joined, segments, blocks, &mut group);
        }
        along
    });
    let mut all = Along::default();
    for part in parts.collect::<Vec<_>>() {
        all.fronts.extend(part.fronts);
        all.blocks.extend(part.blocks);
        all.segments.extend(part.segments);
    }
    all
}

impl Along {
    fn add(
        &mut self,
        branch: u32,
        joined: &Joined,
        segments: &Segments,
        blocks: &[Block],
        group: &mut Vec<(u32, usize)>,
    ) {
        let slots = joined.slots(branch);
        let offset = slots.start - self.blocks.len();
        self.blocks.resize(slots.end - offset, Extent::default());
        let block = |slot: usize| blocks[joined.list[slot] as usize];
        let level = |slot: usize| joined.joins[slot].level;
        // The component so far reaches from `front` to `end` and has `least` as its smallest vertex.
        let first = segments.first[branch as usize];
        let (mut front, mut end, mut least) = (Extent::default(), first.size, first.least);
        let mut slot = slots.start;
        while slot < slots.end {
            // Siblings: what joins at one level.
            let together = (slot..slots.end).take_while(|&other| level(other) == level(slot));
            group.clear();
            group.extend(together.map(|slot| (block(slot).least, slot)));
            group.sort_unstable();
            let before = group.partition_point(|sibling| sibling.0 < least);
            let size = |sum: Extent, &(_, slot): &(u32, usize)| sum.plus(block(slot).size);
            front = front.minus(group[..before].iter().fold(Extent::default(), size));
            let mut at = front;
            for (i, &(_, slot)) in group.iter().enumerate() {
                if i == before {
                    at = end;
                }
                self.blocks[slot - offset] = at;
                at = at.plus(block(slot).size);
            }
            end = group[before..].iter().fold(end, size);
            self.segments.extend(group.iter().map(|_| end));
            slot += group.len();
            let last = segments.later[slot - 1];
            end = end.plus(last.size);
            least = least.min(group[0].0).min(last.least);
        }
        self.fronts.push(front);
    }
}

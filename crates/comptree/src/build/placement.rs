//! Step 4 of the construction: in which order segments come in the canonical numbering, so that threads can put
//! vertices where they belong in any order. Not in a paper: it replaces a walk through the finished tree.
use rayon::prelude::*;

use super::branches::{Branches, Joined};
use crate::tree::NONE;

/// The order of all segments in the tree: children before parents, siblings by their smallest vertex.
pub(super) struct Placement {
    /// The segments in this order.
    pub order: Vec<u32>,
    /// The segment above each branch; [`NONE`] for a root's.
    pub above: Vec<u32>,
}

/// A branch and all that join it: a subtree.
#[derive(Clone, Copy)]
struct Block {
    /// The number of segments.
    len: u32,
    /// The smallest vertex.
    least: u32,
}

/// Places along some branches, all seen from the first segment of the branch. Those before it are negative: they
/// wrap, and sums with them wrap back.
#[derive(Default)]
struct Along {
    /// Of each branch the beginning of its block: blocks with smaller vertices lie between.
    fronts: Vec<u32>,
    /// Of each branch that joins, the first place of its block.
    blocks: Vec<u32>,
    /// Of each branch that joins, the place of the segment at the join.
    segments: Vec<u32>,
    /// Of each branch that joins, the segment above: of those that start at one level the last.
    above: Vec<u32>,
}

/// Finds the place of each segment; `leasts` are their smallest vertices.
pub(super) fn place(branches: &Branches, joined: &Joined, leasts: &[u32]) -> Placement {
    let blocks = blocks(branches, joined, leasts);
    let along = along(branches, joined, leasts, &blocks);
    let mut first: Vec<u32> = along.fronts.iter().map(|front| front.wrapping_neg()).collect();
    let mut above = vec![NONE; branches.len()];
    let mut total = 0;
    let mut roots = branches.roots();
    roots.sort_unstable_by_key(|&root| blocks[root as usize].least);
    for &root in &roots {
        first[root as usize] = first[root as usize].wrapping_add(total);
        total += blocks[root as usize].len;
    }
    let mut order = vec![0; leasts.len()];
    // From the roots down, places along a branch become places in the tree.
    for &branch in roots.iter().chain(branches.order.iter().rev()) {
        let base = first[branch as usize];
        let mut numbers = joined.segments(branch);
        order[base as usize] = numbers.start as u32;
        numbers.start += 1;
        for (slot, number) in joined.slots(branch).zip(numbers) {
            order[base.wrapping_add(along.segments[slot]) as usize] = number as u32;
            let child = joined.list[slot] as usize;
            first[child] = first[child].wrapping_add(base.wrapping_add(along.blocks[slot]));
            above[child] = along.above[slot];
        }
    }
    Placement { order, above }
}

/// The subtree of each branch.
fn blocks(branches: &Branches, joined: &Joined, leasts: &[u32]) -> Vec<Block> {
    let own = |branch: usize| {
        let own = &leasts[joined.segments(branch as u32)];
        Block { len: own.len() as u32, least: own.iter().fold(NONE, |a, &b| a.min(b)) }
    };
    let mut blocks: Vec<Block> = (0..branches.len()).into_par_iter().with_min_len(256).map(own).collect();
    for &branch in &branches.order {
        let Block { len, least } = blocks[branch as usize];
        let into = &mut blocks[branches.joins[branch as usize].into as usize];
        *into = Block { len: into.len + len, least: into.least.min(least) };
    }
    blocks
}

fn along(branches: &Branches, joined: &Joined, leasts: &[u32], blocks: &[Block]) -> Along {
    let step = branches.len().div_ceil(8 * rayon::current_num_threads()).max(1024);
    let parts = (0..branches.len().div_ceil(step)).into_par_iter().map(|part| {
        let mut along = Along::default();
        let mut group = Vec::new();
        for branch in part * step..((part + 1) * step).min(branches.len()) {
            along.add(branch as u32, joined, leasts, blocks, &mut group);
        }
        along
    });
    let mut all = Along::default();
    for part in parts.collect::<Vec<_>>() {
        all.fronts.extend(part.fronts);
        all.blocks.extend(part.blocks);
        all.segments.extend(part.segments);
        all.above.extend(part.above);
    }
    all
}

impl Along {
    fn add(
        &mut self,
        branch: u32,
        joined: &Joined,
        leasts: &[u32],
        blocks: &[Block],
        group: &mut Vec<(u32, usize)>,
    ) {
        let slots = joined.slots(branch);
        let offset = slots.start - self.blocks.len();
        self.blocks.resize(slots.end - offset, 0);
        let block = |slot: usize| blocks[joined.list[slot] as usize];
        let level = |slot: usize| joined.levels[slot];
        let own = &leasts[joined.segments(branch)];
        // The component so far reaches from `front` to `end` and has `least` as its smallest vertex.
        let (mut front, mut end, mut least) = (0u32, 1u32, own[0]);
        let mut slot = slots.start;
        while slot < slots.end {
            // Siblings: what joins at one level.
            let together = (slot..slots.end).take_while(|&other| level(other) == level(slot));
            group.clear();
            group.extend(together.map(|slot| (block(slot).least, slot)));
            group.sort_unstable();
            let before = group.partition_point(|sibling| sibling.0 < least);
            let len = |group: &[(u32, usize)]| group.iter().map(|&(_, slot)| block(slot).len).sum::<u32>();
            front = front.wrapping_sub(len(&group[..before]));
            let mut at = front;
            for (i, &(_, slot)) in group.iter().enumerate() {
                if i == before {
                    at = end;
                }
                self.blocks[slot - offset] = at;
                at = at.wrapping_add(block(slot).len);
            }
            end += len(&group[before..]);
            slot += group.len();
            self.segments.extend((end..).take(group.len()));
            self.above.extend(std::iter::repeat_n((slot + branch as usize) as u32, group.len()));
            end += group.len() as u32;
            least = least.min(group[0].0).min(own[slot - slots.start]);
        }
        self.fronts.push(front);
    }
}

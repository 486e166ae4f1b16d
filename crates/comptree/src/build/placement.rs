//! Step 4 of the construction: in which order segments come in the canonical numbering, so that threads can put
//! vertices where they belong in any order. Not in a paper: it replaces a walk through the finished tree.
use rayon::prelude::*;

use super::branches::{Branches, Joined};
use super::sorted_vertices::split_off;
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

/// Where a branch joins another. Places are seen from the first segment of that other branch; those before it are
/// negative: they wrap, and sums with them wrap back.
#[derive(Clone, Copy, Default)]
struct Place {
    /// The first place of the subtree that joins.
    block: u32,
    /// The place of the segment that starts here.
    segment: u32,
    /// The segment above: of those that start at one level the last.
    above: u32,
}

/// Finds the place of each segment; `leasts` are their smallest vertices.
pub(super) fn place(branches: &Branches, joined: &Joined, leasts: &[u32]) -> Placement {
    let blocks = blocks(branches, joined, leasts);
    let (mut first, places) = along(branches, joined, leasts, &blocks);
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
            let place = places[slot];
            order[base.wrapping_add(place.segment) as usize] = number as u32;
            let child = joined.list[slot] as usize;
            first[child] = first[child].wrapping_add(base.wrapping_add(place.block));
            above[child] = place.above;
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

/// For each branch, how many places of its block come before its first segment; the places of all that join.
fn along(branches: &Branches, joined: &Joined, leasts: &[u32], blocks: &[Block]) -> (Vec<u32>, Vec<Place>) {
    let mut before = vec![0; branches.len()];
    let mut places = vec![Place::default(); joined.list.len()];
    let step = branches.len().div_ceil(8 * rayon::current_num_threads()).max(1024);
    let mut rest = &mut places[..];
    let mut tasks = Vec::new();
    for (before, start) in before.chunks_mut(step).zip((0..).step_by(step)) {
        let count = joined.starts[start + before.len()] - joined.starts[start];
        tasks.push((before, start, split_off(&mut rest, count as usize)));
    }
    tasks.into_par_iter().for_each(|(before, start, mut places)| {
        let mut group = Vec::new();
        for (before, branch) in before.iter_mut().zip(start as u32..) {
            let places = split_off(&mut places, joined.slots(branch).len());
            *before = along_one(branch, joined, leasts, blocks, places, &mut group);
        }
    });
    (before, places)
}

fn along_one(
    branch: u32,
    joined: &Joined,
    leasts: &[u32],
    blocks: &[Block],
    places: &mut [Place],
    group: &mut Vec<(u32, usize)>,
) -> u32 {
    let slots = joined.slots(branch);
    let levels = &joined.levels[slots.clone()];
    let block = |i: usize| blocks[joined.list[slots.start + i] as usize];
    let own = joined.segments(branch);
    let leasts = &leasts[own.clone()];
    // The component so far reaches from `before` its first segment to `end` and has `least` as its smallest vertex.
    let (mut before, mut end, mut least) = (0, 1u32, leasts[0]);
    let mut first = 0;
    while first < places.len() {
        // Siblings: what joins at one level.
        let together = (first..places.len()).take_while(|&other| levels[other] == levels[first]);
        group.clear();
        group.extend(together.map(|i| (block(i).least, i)));
        group.sort_unstable();
        let smaller = group.partition_point(|sibling| sibling.0 < least);
        let len = |group: &[(u32, usize)]| group.iter().map(|&(_, i)| block(i).len).sum::<u32>();
        before += len(&group[..smaller]);
        let mut at = 0u32.wrapping_sub(before);
        for (k, &(_, i)) in group.iter().enumerate() {
            if k == smaller {
                at = end;
            }
            places[i].block = at;
            at = at.wrapping_add(block(i).len);
        }
        end += len(&group[smaller..]);
        let next = first + group.len();
        for (place, segment) in places[first..next].iter_mut().zip(end..) {
            place.segment = segment;
            place.above = (own.start + next) as u32;
        }
        end += group.len() as u32;
        least = least.min(group[0].0).min(leasts[next]);
        first = next;
    }
    before
}

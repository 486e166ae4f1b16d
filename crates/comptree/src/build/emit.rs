use std::ops::Range;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use super::arrange::{Arrangement, arrange};
use super::branches::{Branches, Join, Joined};
use super::relief::Relief;
use super::segments::{Extent, Segment, Segments, in_blocks};
use super::sorted::Sorted;
use crate::Polarity;
use crate::tree::Nodes;

/// Makes nodes of the sorted vertices. `memory`, one entry for each vertex, becomes part of the tree.
pub(super) fn nodes<R: Relief>(
    relief: &R,
    branches: &Branches,
    sorted: Sorted,
    memory: Vec<u32>,
    polarity: Polarity,
) -> Nodes {
    let joined = branches.joined();
    let segments = Segments::new(relief, branches, &joined, &sorted);
    let arrangement = arrange(branches, &joined, &segments);
    let output = Output::new(arrangement.total, memory);
    let write = |segment: &Segment, place: Extent, bare: f64| {
        output.write(relief, &sorted, segment, place, polarity, bare);
    };
    (0..branches.len()).into_par_iter().with_min_len(256).for_each(|branch| {
        write(&segments.first[branch], arrangement.first[branch], f64::NAN);
    });
    (0..joined.list.len()).into_par_iter().with_min_len(256).for_each(|slot| {
        let Join { level, into } = joined.joins[slot];
        let place = arrangement.first[into as usize].plus(arrangement.later[slot]);
        write(&segments.later[slot], place, level);
    });
    let Output { vertices, altitudes, ends } = output;
    // The sorted vertices are no longer needed, their memory is.
    let memory = sorted.memory;
    let parents = parents(branches, &joined, &segments, &arrangement, memory);
    Nodes {
        parents,
        altitudes: altitudes.into_iter().map(|bits| f64::from_bits(bits.into_inner())).collect(),
        ends: ends.into_iter().map(AtomicU32::into_inner).collect(),
        vertices: vertices.into_iter().map(AtomicU32::into_inner).collect(),
    }
}

/// The arrays of the tree, written in any order.
struct Output {
    vertices: Vec<AtomicU32>,
    altitudes: Vec<AtomicU64>,
    /// Empty where each node has one vertex.
    ends: Vec<AtomicU32>,
}

impl Output {
    fn new(total: Extent, memory: Vec<u32>) -> Self {
        let nodes = total.nodes as usize;
        let ends = vec![0; if nodes == memory.len() { 0 } else { nodes }];
        Self {
            vertices: memory.into_iter().map(AtomicU32::new).collect(),
            altitudes: vec![0; nodes].into_iter().map(AtomicU64::new).collect(),
            ends: ends.into_iter().map(AtomicU32::new).collect(),
        }
    }

    /// Writes a segment to its place; `bare` is the level of the node that has no vertex of its own.
    fn write<R: Relief>(
        &self,
        relief: &R,
        sorted: &Sorted,
        segment: &Segment,
        place: Extent,
        polarity: Polarity,
        bare: f64,
    ) {
        let start = segment.start as usize;
        if self.ends.is_empty() {
            let place = place.vertices as usize;
            let copy = |range: Range<usize>| {
                let to = place + (range.start - start)..place + (range.end - start);
                let out = self.vertices[to.clone()].iter().zip(&self.altitudes[to]);
                for (&[v, _], (vertex, altitude)) in sorted.entries()[range].iter().zip(out) {
                    vertex.store(v, Relaxed);
                    altitude.store(polarity.orient(relief.level(v)).to_bits(), Relaxed);
                }
            };
            match in_blocks(segment.entries()) {
                Some(blocks) => blocks.for_each(copy),
                None => copy(segment.entries()),
            }
            return;
        }
        let (mut node, mut end) = (place.nodes as usize, place.vertices);
        let begin = |node: usize, level: f64| {
            self.altitudes[node].store(polarity.orient(level).to_bits(), Relaxed);
        };
        if segment.bare {
            begin(node, bare);
            self.ends[node].store(end, Relaxed);
            node += 1;
        }
        let mut last = f64::NAN;
        for &[v, _] in &sorted.entries()[segment.entries()] {
            self.vertices[end as usize].store(v, Relaxed);
            end += 1;
            let level = relief.level(v);
            if level != last {
                begin(node, level);
                node += 1;
                last = level;
            }
            self.ends[node - 1].store(end, Relaxed);
        }
    }
}

/// Each node's parent is the next one, but for the last of a segment.
fn parents(
    branches: &Branches,
    joined: &Joined,
    segments: &Segments,
    arrangement: &Arrangement,
    mut parents: Vec<u32>,
) -> Vec<u32> {
    parents.truncate(arrangement.total.nodes as usize);
    parents.shrink_to_fit();
    parents.par_iter_mut().enumerate().for_each(|(node, parent)| *parent = node as u32 + 1);
    for branch in 0..branches.len() {
        let base = arrangement.first[branch];
        let mut above = arrangement.above[branch];
        let mut end = |segment: &Segment, place: Extent| {
            if segment.size.nodes > 0 {
                parents[(place.nodes + segment.size.nodes) as usize - 1] = above;
                above = place.nodes;
            }
        };
        for slot in joined.slots(branch as u32).rev() {
            end(&segments.later[slot], base.plus(arrangement.later[slot]));
        }
        end(&segments.first[branch], base);
    }
    parents
}

//! Step 4 of the construction: each level of a segment becomes a node, written to its place in postorder.
use std::ops::Range;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use super::branches::{Branches, Join, Joined};
use super::filtration::Filtration;
use super::placement::{Placement, place};
use super::segments::{Extent, Segment, Segments, in_blocks};
use super::sorted_vertices::SortedVertices;
use crate::Polarity;
use crate::tree::Nodes;

/// Makes nodes of the sorted vertices. `memory`, one entry for each vertex, becomes part of the tree.
pub(super) fn write<R: Filtration>(
    filtration: &R,
    branches: &Branches,
    sorted: SortedVertices,
    memory: Vec<u32>,
    polarity: Polarity,
) -> Nodes {
    let joined = branches.joined();
    let segments = Segments::new(filtration, branches, &joined, &sorted);
    let placement = place(branches, &joined, &segments);
    let output = Output::new(placement.total, memory);
    let write = |segment: &Segment, place: Extent, bare: f64| {
        output.write(filtration, &sorted, segment, place, polarity, bare);
    };
    (0..branches.len()).into_par_iter().with_min_len(256).for_each(|branch| {
        write(&segments.first[branch], placement.first[branch], f64::NAN);
    });
    (0..joined.list.len()).into_par_iter().with_min_len(256).for_each(|slot| {
        let Join { level, into } = joined.joins[slot];
        let place = placement.first[into as usize].plus(placement.later[slot]);
        write(&segments.later[slot], place, level);
    });
    let Output { vertices, altitudes, ends } = output;
    // The sorted vertices are no longer needed, their memory is.
    let memory = sorted.memory;
    let parents = parents(branches, &joined, &segments, &placement, memory);
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
    fn write<R: Filtration>(
        &self,
        filtration: &R,
        sorted: &SortedVertices,
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
                    altitude.store(polarity.orient(filtration.level(v)).to_bits(), Relaxed);
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
            let level = filtration.level(v);
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
    placement: &Placement,
    mut parents: Vec<u32>,
) -> Vec<u32> {
    parents.truncate(placement.total.nodes as usize);
    parents.shrink_to_fit();
    parents.par_iter_mut().enumerate().for_each(|(node, parent)| *parent = node as u32 + 1);
    for branch in 0..branches.len() {
        let base = placement.first[branch];
        let mut above = placement.above[branch];
        let mut end = |segment: &Segment, place: Extent| {
            if segment.size.nodes > 0 {
                parents[(place.nodes + segment.size.nodes) as usize - 1] = above;
                above = place.nodes;
            }
        };
        for slot in joined.slots(branch as u32).rev() {
            end(&segments.later[slot], base.plus(placement.later[slot]));
        }
        end(&segments.first[branch], base);
    }
    parents
}

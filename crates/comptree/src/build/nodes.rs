//! Step 5 of the construction: each level of a segment becomes a node.
use rayon::prelude::*;

use super::branches::Joined;
use super::filtration::Filtration;
use super::placement::Placement;
use super::sorted_vertices::{SortedVertices, split_off};
use crate::tree::{NONE, Nodes};

/// Makes nodes of the sorted vertices. `memory`, one entry for each vertex, becomes part of the tree.
pub(super) fn write<R: Filtration>(
    filtration: &R,
    joined: &Joined,
    placement: &Placement,
    mut sorted: SortedVertices,
    memory: Vec<u32>,
) -> Nodes {
    let bare = if R::BARE_JOINS { bare(filtration, joined, &sorted) } else { Vec::new() };
    for &(segment, _) in &bare {
        let first = sorted.first_bin(segment);
        sorted.bins[first].nodes += 1;
    }
    let mut total = 0;
    for bin in &mut sorted.bins {
        total += bin.nodes;
        bin.nodes = total;
    }
    let parents = parents(&placement.above, joined, &sorted, memory);
    if total as usize == sorted.altitudes.len() {
        let SortedVertices { vertices, altitudes, .. } = sorted;
        return Nodes { parents, altitudes, ends: Vec::new(), vertices };
    }
    if bare.is_empty() && !sorted.altitudes.is_empty() {
        let (altitudes, ends) = compact(&mut sorted);
        return Nodes { parents, altitudes, ends, vertices: sorted.vertices };
    }
    let (mut altitudes, mut ends) = levels(filtration, &sorted);
    for (segment, level) in bare {
        let start = sorted.start(sorted.first_bin(segment));
        altitudes[start.nodes as usize] = filtration.polarity().orient(level);
        ends[start.nodes as usize] = start.vertices;
    }
    Nodes { parents, altitudes, ends, vertices: sorted.vertices }
}

/// The segments whose first node has no vertex of its own, and its level.
fn bare<R: Filtration>(filtration: &R, joined: &Joined, sorted: &SortedVertices) -> Vec<(usize, f64)> {
    let branch = |branch: usize| {
        let slots = joined.slots(branch as u32);
        let levels = &joined.levels[slots];
        let numbers = joined.segments(branch as u32).skip(1);
        let found = numbers.zip(levels).enumerate().filter(move |&(i, (segment, &level))| {
            // Of branches that join at one level only the last has a segment.
            let last = levels.get(i + 1) != Some(&level);
            let first = sorted.first_bin(segment);
            let vertices =
                &sorted.vertices[sorted.start(first).vertices as usize..sorted.bins[first].vertices as usize];
            last && vertices.first().is_none_or(|&v| filtration.level(v) != level)
        });
        found.map(|(_, (segment, &level))| (segment, level))
    };
    let branches = joined.starts.len() - 1;
    (0..branches).into_par_iter().with_min_len(256).flat_map_iter(branch).collect()
}

/// The altitude of each node and where its vertices end.
fn levels<R: Filtration>(filtration: &R, sorted: &SortedVertices) -> (Vec<f64>, Vec<u32>) {
    let count = sorted.bins.last().map_or(0, |bin| bin.nodes as usize);
    let (mut altitudes, mut ends) = (vec![0.0; count], vec![0u32; count]);
    let (mut rest_altitudes, mut rest_ends) = (&mut altitudes[..], &mut ends[..]);
    let mut tasks = Vec::new();
    for group in sorted.groups().into_iter().filter(|group| !group.is_empty()) {
        let len = (sorted.bins[group.end - 1].nodes - sorted.start(group.start).nodes) as usize;
        tasks.push((group, split_off(&mut rest_altitudes, len), split_off(&mut rest_ends, len)));
    }
    let altitude = |at: usize| match sorted.altitudes.get(at) {
        Some(&altitude) => altitude,
        None => filtration.polarity().orient(filtration.level(sorted.vertices[at])),
    };
    tasks.into_par_iter().for_each(|(group, altitudes, ends)| {
        let base = sorted.start(group.start).nodes as usize;
        let mut start = sorted.start(group.start);
        for &bin in &sorted.bins[group] {
            let range = start.vertices as usize..bin.vertices as usize;
            if bin.nodes == start.nodes + 1 && !range.is_empty() {
                altitudes[start.nodes as usize - base] = altitude(range.start);
                ends[start.nodes as usize - base] = bin.vertices;
            } else {
                // From the end: before the first node that has vertices there can be one that has none.
                let mut node = bin.nodes as usize - base;
                let mut last = f64::NAN;
                for at in range.rev() {
                    let level = altitude(at);
                    if level != last {
                        node -= 1;
                        altitudes[node] = level;
                        ends[node] = at as u32 + 1;
                        last = level;
                    }
                }
            }
            start = bin;
        }
    });
    (altitudes, ends)
}

/// As [`levels`], where each node has a vertex and vertices have altitudes: those of the nodes take their place.
fn compact(sorted: &mut SortedVertices) -> (Vec<f64>, Vec<u32>) {
    let mut altitudes = std::mem::take(&mut sorted.altitudes);
    let mut ends = vec![0; sorted.bins.last().map_or(0, |bin| bin.nodes as usize)];
    let (mut rest_altitudes, mut rest_ends) = (&mut altitudes[..], &mut ends[..]);
    let mut tasks = Vec::new();
    for group in sorted.groups() {
        let (start, end) = (sorted.start(group.start), sorted.start(group.end));
        let altitudes = split_off(&mut rest_altitudes, (end.vertices - start.vertices) as usize);
        let ends = split_off(&mut rest_ends, (end.nodes - start.nodes) as usize);
        tasks.push((group, altitudes, ends));
    }
    let moves: Vec<_> = tasks
        .into_par_iter()
        .map(|(group, altitudes, ends)| {
            let before = sorted.start(group.start);
            let (mut at, mut node) = (0, 0);
            for bin in &sorted.bins[group] {
                let mut last = f64::NAN;
                while at < (bin.vertices - before.vertices) as usize {
                    let altitude = altitudes[at];
                    at += 1;
                    if altitude != last {
                        altitudes[node] = altitude;
                        node += 1;
                        last = altitude;
                    }
                    ends[node - 1] = before.vertices + at as u32;
                }
            }
            (before, node)
        })
        .collect();
    for (before, nodes) in moves {
        let start = before.vertices as usize;
        altitudes.copy_within(start..start + nodes, before.nodes as usize);
    }
    altitudes.truncate(ends.len());
    altitudes.shrink_to_fit();
    (altitudes, ends)
}

/// Each node's parent is the next one, but for the last of a segment.
fn parents(above: &[u32], joined: &Joined, sorted: &SortedVertices, mut parents: Vec<u32>) -> Vec<u32> {
    parents.truncate(sorted.bins.last().map_or(0, |bin| bin.nodes as usize));
    parents.shrink_to_fit();
    parents.par_iter_mut().enumerate().for_each(|(node, parent)| *parent = node as u32 + 1);
    for (branch, &above) in above.iter().enumerate() {
        let mut above = if above == NONE { NONE } else { sorted.nodes(above as usize).start };
        for segment in joined.segments(branch as u32).rev() {
            let nodes = sorted.nodes(segment);
            if !nodes.is_empty() {
                parents[nodes.end as usize - 1] = above;
                above = nodes.start;
            }
        }
    }
    parents
}

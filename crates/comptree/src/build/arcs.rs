use mser3d_shape::DisjointSets;
use rayon::prelude::*;

use super::basins::Basins;
use super::relief::Relief;
use crate::order::NONE;

/// The tree of basins: each arc spans the levels from its birth to that of its parent. Children have
/// smaller numbers than their parents, and births rise strictly.
pub(super) struct Arcs {
    pub parents: Vec<u32>,
    /// A minimum's level or the level at which children merge.
    pub births: Vec<f64>,
    /// The lowest arc of each basin.
    pub of_basin: Vec<u32>,
    /// An ancestor further up, so that climbing takes a logarithmic number of steps (Myers 1983).
    jumps: Vec<u32>,
}

impl Arcs {
    /// The arc, from `arc` upwards, that spans `level`.
    #[inline]
    pub fn climb(&self, mut arc: u32, level: f64) -> u32 {
        loop {
            let parent = self.parents[arc as usize];
            if parent == NONE || self.births[parent as usize] > level {
                return arc;
            }
            let jump = self.jumps[arc as usize];
            arc = if self.births[jump as usize] <= level { jump } else { parent };
        }
    }
}

/// An edge between basins at the level where it enters.
#[derive(Clone, Copy)]
struct Saddle {
    level: f64,
    basins: [u32; 2],
}

/// Kruskal's algorithm on the graph of basins.
pub(super) fn merge_basins<R: Relief>(relief: &R, basins: &Basins, parts: usize) -> Arcs {
    let mut saddles = saddles(relief, basins, parts);
    saddles.par_sort_unstable_by(|a, b| a.level.total_cmp(&b.level));
    let count = basins.minima.len();
    let mut parents = vec![NONE; count];
    let mut births: Vec<f64> = basins.minima.iter().map(|&v| relief.level(v)).collect();
    let mut sets = DisjointSets::new(count);
    let mut top: Vec<u32> = (0..count as u32).collect();
    for Saddle { level, basins: [a, b] } in saddles {
        if let Some((stays, goes)) = sets.union(a, b) {
            let arc = parents.len() as u32;
            parents[top[stays as usize] as usize] = arc;
            parents[top[goes as usize] as usize] = arc;
            top[stays as usize] = arc;
            parents.push(NONE);
            births.push(level);
        }
    }
    without_empty(parents, births, count)
}

/// Drops arcs that end at the level where they begin.
fn without_empty(parents: Vec<u32>, births: Vec<f64>, basins: usize) -> Arcs {
    let ends = |arc: usize| parents[arc] != NONE && births[parents[arc] as usize] == births[arc];
    let mut number = vec![0u32; parents.len()];
    let mut count = 0;
    for arc in 0..parents.len() {
        number[arc] = count;
        count += u32::from(!ends(arc));
    }
    // Whatever hangs below an empty arc hangs below its parent, from the root down.
    for arc in (0..parents.len()).rev() {
        if ends(arc) {
            number[arc] = number[parents[arc] as usize];
        }
    }
    let kept = (0..parents.len()).filter(|&arc| !ends(arc));
    let parent = |arc: usize| if parents[arc] == NONE { NONE } else { number[parents[arc] as usize] };
    let new_parents: Vec<u32> = kept.clone().map(parent).collect();
    let births = kept.map(|arc| births[arc]).collect();
    number.truncate(basins);
    let jumps = jumps(&new_parents);
    Arcs { parents: new_parents, births, of_basin: number, jumps }
}

fn jumps(parents: &[u32]) -> Vec<u32> {
    let mut depth = vec![0u32; parents.len()];
    let mut jumps: Vec<u32> = (0..parents.len() as u32).collect();
    for arc in (0..parents.len()).rev().filter(|&arc| parents[arc] != NONE) {
        let parent = parents[arc] as usize;
        let (once, twice) = (jumps[parent] as usize, jumps[jumps[parent] as usize]);
        depth[arc] = depth[parent] + 1;
        let even = depth[parent] - depth[once] == depth[once] - depth[twice as usize];
        jumps[arc] = if even { twice } else { parent as u32 };
    }
    jumps
}

/// Enough edges between basins for a minimum spanning forest.
///
/// Where they are few, all of them. Where they are many, as in noise, Borůvka's rounds come first:
/// each joins every basin by its lowest edge, without storing the others.
fn saddles<R: Relief>(relief: &R, basins: &Basins, parts: usize) -> Vec<Saddle> {
    let Basins { labels, minima } = basins;
    let ranges = relief.split_edges(parts);
    let most = relief.len() / 8 / ranges.len().max(1) + 1024;
    let mut sets = DisjointSets::new(minima.len());
    let mut group: Vec<u32> = (0..minima.len() as u32).collect();
    let mut forest = Vec::new();
    loop {
        let of = |v: u32| group[labels[v as usize] as usize];
        let few = |range: &std::ops::Range<usize>| {
            let mut found = Vec::new();
            let mut count = 0;
            relief.boundary(range.clone(), labels, |v, w, level| {
                if of(v) != of(w) {
                    count += 1;
                    if found.len() < most {
                        // Of the basins themselves: a group may only be joined further up.
                        let basins = [v, w].map(|v| labels[v as usize]);
                        found.push(Saddle { level, basins });
                    }
                }
            });
            (count <= most).then_some(found)
        };
        let found: Option<Vec<Vec<Saddle>>> = ranges.par_iter().map(few).collect();
        if let Some(found) = found {
            forest.extend(found.into_iter().flatten());
            return forest;
        }
        let lowest = |range: &std::ops::Range<usize>| {
            let mut best = vec![Lowest::NONE; minima.len()];
            relief.boundary(range.clone(), labels, |v, w, level| {
                let (a, b) = (of(v), of(w));
                if a != b {
                    let edge = Lowest { level, ends: [v, w] };
                    best[a as usize].take(edge);
                    best[b as usize].take(edge);
                }
            });
            best
        };
        let join = |mut a: Vec<Lowest>, b: Vec<Lowest>| {
            a.iter_mut().zip(b).for_each(|(a, b)| a.take(b));
            a
        };
        let best = ranges.par_iter().map(lowest).reduce_with(join).unwrap_or_default();
        for edge in best.into_iter().filter(|edge| edge.ends[0] != NONE) {
            let basins = edge.ends.map(|v| labels[v as usize]);
            if sets.union(basins[0], basins[1]).is_some() {
                forest.push(Saddle { level: edge.level, basins });
            }
        }
        for (basin, group) in group.iter_mut().enumerate() {
            *group = sets.find(basin as u32);
        }
    }
}

/// The lowest edge out of a group of basins; of equal ones the one with the smallest ends, so that
/// the choices of all groups never close a circle.
#[derive(Clone, Copy)]
struct Lowest {
    level: f64,
    ends: [u32; 2],
}

impl Lowest {
    const NONE: Self = Self { level: f64::INFINITY, ends: [NONE; 2] };

    #[inline]
    fn take(&mut self, other: Self) {
        if other.level < self.level || other.level == self.level && other.ends < self.ends {
            *self = other;
        }
    }
}

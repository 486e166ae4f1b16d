use std::ops::Range;

use mser3d_shape::DisjointSets;
use rayon::prelude::*;

use super::basins::Basins;
use super::relief::Relief;
use super::trunk::Trunk;
use crate::order::NONE;

/// The tree of basins: each arc spans the levels from its birth to that of its parent. Children have
/// smaller numbers than their parents, and births rise strictly.
pub(super) struct Arcs {
    pub parents: Vec<u32>,
    /// A minimum's level or the level at which children merge.
    pub births: Vec<f64>,
    /// The lowest arc of each basin.
    pub of_basin: Vec<u32>,
    steps: Vec<Step>,
    trunk: Trunk,
}

/// The ways up from an arc: what a climb reads lies together.
#[derive(Clone, Copy)]
struct Step {
    /// The level from which on the arc is part of the trunk.
    joins: f64,
    /// Birth of the parent.
    end: f64,
    /// Birth of the arc that `jump` leads to.
    landing: f64,
    parent: u32,
    /// An ancestor further up, so that a climb takes a logarithmic number of steps (Myers 1983).
    jump: u32,
}

impl Arcs {
    /// The arc, from `arc` upwards, that spans `level`, and the level at which it ends.
    #[inline]
    pub fn climb(&self, mut arc: u32, level: f64) -> (u32, f64) {
        if self.steps[arc as usize].joins <= level {
            return self.trunk.at(level);
        }
        loop {
            let step = &self.steps[arc as usize];
            if step.end > level || step.parent == NONE {
                return (arc, step.end);
            }
            arc = if step.landing <= level { step.jump } else { step.parent };
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
    sort(&mut saddles, parts);
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

/// By level: sorted runs, one a thread, which the stable sort then only merges.
fn sort(saddles: &mut [Saddle], parts: usize) {
    let order = |a: &Saddle, b: &Saddle| a.level.total_cmp(&b.level);
    if parts > 1 {
        let run = saddles.len().div_ceil(parts).max(1);
        saddles.par_chunks_mut(run).for_each(|run| run.sort_unstable_by(order));
        saddles.sort_by(order);
    } else {
        saddles.sort_unstable_by(order);
    }
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
    let births: Vec<f64> = kept.map(|arc| births[arc]).collect();
    number.truncate(basins);
    let (trunk, joins) = Trunk::new(&new_parents, &births, &number);
    let steps = steps(&new_parents, &births, &joins);
    Arcs { parents: new_parents, births, of_basin: number, steps, trunk }
}

fn steps(parents: &[u32], births: &[f64], joins: &[f64]) -> Vec<Step> {
    let mut depth = vec![0u32; parents.len()];
    let root = |arc: u32| Step {
        joins: joins[arc as usize],
        end: f64::INFINITY,
        landing: f64::INFINITY,
        parent: NONE,
        jump: arc,
    };
    let mut steps: Vec<Step> = (0..parents.len() as u32).map(root).collect();
    for arc in (0..parents.len()).rev().filter(|&arc| parents[arc] != NONE) {
        let parent = parents[arc];
        let once = steps[parent as usize].jump;
        let twice = steps[once as usize].jump;
        let at = |arc: u32| depth[arc as usize];
        let jump = if at(parent) - at(once) == at(once) - at(twice) { twice } else { parent };
        depth[arc] = at(parent) + 1;
        let birth = |arc: u32| births[arc as usize];
        steps[arc] = Step { joins: joins[arc], end: birth(parent), landing: birth(jump), parent, jump };
    }
    steps
}

/// Enough edges between basins for a minimum spanning forest: those that Borůvka's rounds choose, each
/// round the lowest edge out of every group of basins, and the rest once they are few.
///
/// The first rounds look through the relief, so that in noise not all edges are in memory at once; the
/// later ones through a list of those left between groups.
fn saddles<R: Relief>(relief: &R, basins: &Basins, parts: usize) -> Vec<Saddle> {
    let count = basins.minima.len();
    let mut sets = DisjointSets::new(count);
    let mut group: Vec<u32> = (0..count as u32).collect();
    let mut forest = Vec::new();
    let mut list: Option<Vec<Saddle>> = None;
    loop {
        let best = match &list {
            Some(list) => Lowest::of(count, list, &group),
            None => match scan(relief, &basins.labels, &group, parts) {
                Found::Many(best) => best,
                Found::Few(saddles) => {
                    list = Some(saddles);
                    continue;
                }
            },
        };
        for Lowest { level, basins } in best.into_iter().filter(|edge| edge.basins[0] != NONE) {
            if sets.union(basins[0], basins[1]).is_some() {
                forest.push(Saddle { level, basins });
            }
        }
        for (basin, group) in group.iter_mut().enumerate() {
            *group = sets.find(basin as u32);
        }
        if let Some(list) = &mut list {
            list.retain(|saddle| group[saddle.basins[0] as usize] != group[saddle.basins[1] as usize]);
            // A round costs as much as sorting a few edges for each basin.
            if list.len() <= count {
                forest.append(list);
                return forest;
            }
        }
    }
}

/// The edges between groups of basins, or the lowest of each group if they are too many to list.
fn scan<R: Relief>(relief: &R, labels: &[u32], group: &[u32], parts: usize) -> Found {
    let ranges = relief.split_edges(parts);
    let most = 3 * relief.len() / 2 / ranges.len().max(1) + 1024;
    let collect = |range: &Range<usize>| {
        let mut found = Found::Few(Vec::new());
        relief.boundary(range.clone(), labels, |v, w, level| {
            let basins = [v, w].map(|v| labels[v as usize]);
            let [a, b] = basins.map(|basin| group[basin as usize]);
            if a == b {
                return;
            }
            match &mut found {
                // Along a row the same two basins often meet again.
                Found::Few(saddles) if saddles.last().is_some_and(|last| last.basins == basins) => {
                    let last = saddles.len() - 1;
                    saddles[last].level = saddles[last].level.min(level);
                }
                Found::Few(saddles) if saddles.len() < most => saddles.push(Saddle { level, basins }),
                Found::Few(saddles) => {
                    let mut best = Lowest::of(group.len(), saddles, group);
                    Lowest::take(&mut best, [a, b], Lowest { level, basins });
                    found = Found::Many(best);
                }
                Found::Many(best) => Lowest::take(best, [a, b], Lowest { level, basins }),
            }
        });
        found
    };
    let found: Vec<Found> = ranges.par_iter().map(collect).collect();
    found.into_iter().reduce(|a, b| a.join(b, group)).unwrap_or(Found::Few(Vec::new()))
}

/// The edges between groups of basins that one range of edges holds.
enum Found {
    /// All of them.
    Few(Vec<Saddle>),
    /// The lowest of each group.
    Many(Vec<Lowest>),
}

impl Found {
    fn join(self, other: Self, group: &[u32]) -> Self {
        match (self, other) {
            (Self::Few(mut a), Self::Few(b)) => {
                a.extend(b);
                Self::Few(a)
            }
            (Self::Few(few), Self::Many(many)) | (Self::Many(many), Self::Few(few)) => {
                Self::Many(many).join(Self::Many(Lowest::of(group.len(), &few, group)), group)
            }
            (Self::Many(mut a), Self::Many(b)) => {
                a.iter_mut().zip(b).for_each(|(a, b)| a.keep_lower(b));
                Self::Many(a)
            }
        }
    }
}

/// The lowest edge out of a group of basins; of equal ones the one between the smallest basins, so that
/// the choices of all groups never close a circle.
#[derive(Clone, Copy)]
struct Lowest {
    level: f64,
    basins: [u32; 2],
}

impl Lowest {
    const NONE: Self = Self { level: f64::INFINITY, basins: [NONE; 2] };

    fn of(count: usize, saddles: &[Saddle], group: &[u32]) -> Vec<Self> {
        let mut best = vec![Self::NONE; count];
        for &Saddle { level, basins } in saddles {
            Self::take(&mut best, basins.map(|basin| group[basin as usize]), Self { level, basins });
        }
        best
    }

    #[inline]
    fn take(best: &mut [Self], groups: [u32; 2], Self { level, basins: [a, b] }: Self) {
        let edge = Self { level, basins: [a.min(b), a.max(b)] };
        groups.into_iter().for_each(|group| best[group as usize].keep_lower(edge));
    }

    #[inline]
    fn keep_lower(&mut self, other: Self) {
        if other.level < self.level || other.level == self.level && other.basins < self.basins {
            *self = other;
        }
    }
}

//! Step 4 of the construction: vertices sorted along their segments only (ExTreeM's augmentation), by counting
//! into bins that lie where the tree wants them.
use std::ops::Range;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use super::branches::{Branches, Joined};
use super::filtration::Filtration;
use super::placement::{Placement, place};
use super::scale::Scale;
use super::segments::{Bins, Count, climb};
use crate::Polarity;
use crate::tree::NONE;

/// All vertices in the order of the tree: along a segment by level, and of one level by number.
pub(super) struct SortedVertices {
    pub vertices: Vec<u32>,
    /// The weight of each of them, as it was given; none where levels are integers.
    pub altitudes: Vec<f64>,
    /// Those with any vertices, in this order.
    pub bins: Vec<Bin>,
    /// Where the bins of each segment are.
    segments: Vec<[u32; 2]>,
}

/// A range of vertices with levels that no other bin of the segment has, and of the nodes they make.
#[derive(Clone, Copy, Default)]
pub(super) struct Bin {
    /// Where the vertices end.
    pub vertices: u32,
    /// Where the nodes end.
    pub nodes: u32,
}

impl SortedVertices {
    /// `labels` are the vertices' basins, and will be bins.
    pub fn new<R: Filtration>(
        filtration: &R,
        labels: &mut [u32],
        branches: &Branches,
        joined: &Joined,
        parts: usize,
    ) -> (Self, Placement) {
        let step = labels.len().div_ceil(parts.max(1)).max(1);
        let climb = |(part, labels): (usize, &mut [u32])| climb(filtration, labels, part * step, branches);
        let sizes: Vec<Vec<u32>> = labels.par_chunks_mut(step).enumerate().map(climb).collect();
        let size = |branch: usize| sizes.iter().map(|part| part[branch]).sum();
        let sizes: Vec<u32> = (0..branches.len()).map(size).collect();
        let bins = Bins::new(filtration, branches, joined, &sizes);
        let count = |(part, labels): (usize, &mut [u32])| bins.count(filtration, labels, part * step);
        let mut counts: Vec<Vec<Count>> = labels.par_chunks_mut(step).enumerate().map(count).collect();
        let least = |segment: usize| {
            let firsts = |part: &Vec<Count>| part[bins.of_segment(segment)].iter().map(|c| c.first()).min();
            counts.iter().filter_map(firsts).min().unwrap_or(NONE)
        };
        let segments = branches.len() + joined.list.len();
        let leasts: Vec<u32> = (0..segments).into_par_iter().with_min_len(256).map(least).collect();
        let placement = place(branches, joined, &leasts);
        let mut sorted = Self::laid_out::<R>(&bins, &mut counts, &placement.order);
        sorted.scatter(filtration, labels, step, counts);
        sorted.sort(filtration);
        (sorted, placement)
    }

    /// Decides where bins go; turns the counts of each part into where its vertices go.
    fn laid_out<R: Filtration>(bins: &Bins<'_>, counts: &mut [Vec<Count>], order: &[u32]) -> Self {
        let mut segments = vec![[0; 2]; order.len()];
        let mut laid_out: Vec<Bin> = Vec::with_capacity(order.len());
        let mut sum = 0;
        for &segment in order {
            let segment = segment as usize;
            let first = laid_out.len() as u32;
            // Until they are counted: 1 where that is known before.
            let nodes = u32::from(R::INTEGERS && bins.are_levels(segment));
            for bin in bins.of_segment(segment) {
                let before = sum;
                for part in counts.iter_mut() {
                    sum += part[bin].start_at(sum);
                }
                // A segment in which no vertex enters can have a node too.
                if sum > before || R::BARE_JOINS && laid_out.len() as u32 == first {
                    laid_out.push(Bin { vertices: sum, nodes });
                }
            }
            segments[segment] = [first, laid_out.len() as u32];
        }
        Self { vertices: Vec::new(), altitudes: Vec::new(), bins: laid_out, segments }
    }

    /// Puts all vertices into their bins, ascending in each.
    fn scatter<R: Filtration>(
        &mut self,
        filtration: &R,
        labels: &[u32],
        step: usize,
        mut cursors: Vec<Vec<Count>>,
    ) {
        let sorted: Vec<AtomicU32> = vec![0; labels.len()].into_iter().map(AtomicU32::new).collect();
        let levels = vec![0; if R::INTEGERS { 0 } else { labels.len() }];
        let levels: Vec<AtomicU64> = levels.into_iter().map(AtomicU64::new).collect();
        labels.par_chunks(step).zip(&mut cursors).enumerate().for_each(|(part, (labels, cursors))| {
            for (&bin, v) in labels.iter().zip((part * step) as u32..) {
                let at = cursors[bin as usize].next();
                sorted[at].store(v, Relaxed);
                if !R::INTEGERS {
                    levels[at].store(filtration.level(v).to_bits(), Relaxed);
                }
            }
        });
        self.vertices = sorted.into_iter().map(AtomicU32::into_inner).collect();
        self.altitudes = levels.into_iter().map(|bits| f64::from_bits(bits.into_inner())).collect();
    }

    /// Sorts each bin and counts its nodes.
    fn sort<R: Filtration>(&mut self, filtration: &R) {
        let groups = self.groups();
        let (mut bins, mut vertices, mut levels) =
            (&mut self.bins[..], &mut self.vertices[..], &mut self.altitudes[..]);
        let mut tasks = Vec::with_capacity(groups.len());
        let mut from = 0;
        for group in groups {
            let bins = split_off(&mut bins, group.len());
            let end = bins.last().map_or(from, |bin| bin.vertices);
            let len = (end - from) as usize;
            let vertices = split_off(&mut vertices, len);
            let levels = split_off(&mut levels, if R::INTEGERS { 0 } else { len });
            tasks.push((bins, vertices, levels, from));
            from = end;
        }
        tasks.into_par_iter().for_each(|(bins, vertices, levels, from)| {
            let mut scratch = Scratch::default();
            let mut start = 0;
            for bin in bins {
                let range = start..(bin.vertices - from) as usize;
                start = range.end;
                let vertices = &mut vertices[range.clone()];
                bin.nodes = if vertices.len() < 2 || bin.nodes == 1 {
                    u32::from(!vertices.is_empty())
                } else if R::INTEGERS {
                    let mut levels = std::mem::take(&mut scratch.levels);
                    levels.clear();
                    levels.extend(vertices.iter().map(|&v| filtration.level(v)));
                    sort_bin(&mut levels, vertices, &mut scratch);
                    let nodes = count_levels(&levels);
                    scratch.levels = levels;
                    nodes
                } else {
                    let levels = &mut levels[range.clone()];
                    sort_bin(levels, vertices, &mut scratch);
                    count_levels(levels)
                };
            }
            if filtration.polarity() == Polarity::Superlevel {
                levels.iter_mut().for_each(|level| *level = Polarity::Superlevel.orient(*level));
            }
        });
    }

    /// Ranges of bins with about equally many vertices, a few for each thread.
    pub fn groups(&self) -> Vec<Range<usize>> {
        let n = self.vertices.len();
        let wanted = if n < 1 << 16 { 1 } else { 8 * rayon::current_num_threads() };
        let mut groups = Vec::with_capacity(wanted);
        let mut start = 0;
        for group in 1..=wanted {
            let goal = (n * group).div_ceil(wanted);
            let end = if group == wanted {
                self.bins.len()
            } else {
                start + self.bins[start..].partition_point(|bin| (bin.vertices as usize) < goal)
            };
            groups.push(start..end);
            start = end;
        }
        groups
    }

    /// The first bin of a segment, or the one that would follow.
    #[inline(always)]
    pub fn first_bin(&self, segment: usize) -> usize {
        self.segments[segment][0] as usize
    }

    /// The nodes of a segment, once they have been counted.
    #[inline(always)]
    pub fn nodes(&self, segment: usize) -> Range<u32> {
        let [start, end] = self.segments[segment].map(|bin| self.start(bin as usize).nodes);
        start..end
    }

    /// The end of what lies before a bin.
    #[inline(always)]
    pub fn start(&self, bin: usize) -> Bin {
        if bin == 0 { Bin::default() } else { self.bins[bin - 1] }
    }
}

/// Takes the first elements off a slice.
pub(super) fn split_off<'a, T>(rest: &mut &'a mut [T], len: usize) -> &'a mut [T] {
    let (first, others) = std::mem::take(rest).split_at_mut(len);
    *rest = others;
    first
}

/// More are no longer near in memory.
const MOST_BUCKETS: u32 = 1 << 12;

/// Memory that sorting uses again and again.
#[derive(Default)]
struct Scratch {
    levels: Vec<f64>,
    pairs: Vec<(f64, u32)>,
    next: Vec<u32>,
}

#[inline(always)]
fn count_levels(levels: &[f64]) -> u32 {
    1 + levels.iter().zip(&levels[1..]).fold(0, |sum, (a, b)| sum + u32::from(a != b))
}

/// Sorts the vertices of a bin, which come ascending, by level.
fn sort_bin(levels: &mut [f64], vertices: &mut [u32], scratch: &mut Scratch) {
    if levels.len() > 24 {
        distribute(levels, vertices, scratch);
        swap_neighbours(levels, vertices);
    }
    if !insertion_sort(levels, vertices) {
        let pairs = &mut scratch.pairs;
        pairs.clear();
        pairs.extend(levels.iter().copied().zip(vertices.iter().copied()));
        pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for ((level, vertex), pair) in levels.iter_mut().zip(vertices).zip(pairs) {
            (*level, *vertex) = *pair;
        }
    }
}

/// Puts vertices nearly in order, by counting; those of one level stay ascending.
fn distribute(levels: &mut [f64], vertices: &mut [u32], scratch: &mut Scratch) {
    let (low, high) = levels.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &level| {
        (if level < low { level } else { low }, if level > high { level } else { high })
    });
    if low == high {
        return;
    }
    let buckets = (2 * levels.len() as u32).min(MOST_BUCKETS);
    let scale = Scale::new(low, high, buckets);
    let Scratch { pairs, next, .. } = scratch;
    next.clear();
    next.resize(buckets as usize, 0);
    pairs.clear();
    for (&level, &vertex) in levels.iter().zip(vertices.iter()) {
        pairs.push((level, vertex));
        next[scale.part(level, buckets) as usize] += 1;
    }
    let mut sum = 0;
    for next in next.iter_mut() {
        sum += std::mem::replace(next, sum);
    }
    for &(level, vertex) in pairs.iter() {
        let at = &mut next[scale.part(level, buckets) as usize];
        levels[*at as usize] = level;
        vertices[*at as usize] = vertex;
        *at += 1;
    }
}

/// Swaps neighbours that are out of order, by arithmetic: what branches would do here cannot be guessed. Of what
/// counting leaves out of order, this leaves little.
fn swap_neighbours(levels: &mut [f64], vertices: &mut [u32]) {
    let Some((mut level, mut vertex)) = levels.first().copied().zip(vertices.first().copied()) else {
        return;
    };
    for i in 1..levels.len().min(vertices.len()) {
        let swap = levels[i] < level;
        let change = (vertices[i] ^ vertex) & u32::from(swap).wrapping_neg();
        (vertices[i - 1], vertex) = (vertex ^ change, vertices[i] ^ change);
        let next = levels[i];
        levels[i - 1] = if next < level { next } else { level };
        level = if next > level { next } else { level };
        levels[i] = level;
        vertices[i] = vertex;
    }
}

/// Fast where hardly anything is out of place; gives up, with all still there, where much is.
fn insertion_sort(levels: &mut [f64], vertices: &mut [u32]) -> bool {
    let mut patience = 16 * levels.len();
    for i in 1..levels.len() {
        let (level, vertex) = (levels[i], vertices[i]);
        let mut at = i;
        while at > 0 && levels[at - 1] > level {
            levels[at] = levels[at - 1];
            vertices[at] = vertices[at - 1];
            at -= 1;
        }
        levels[at] = level;
        vertices[at] = vertex;
        match patience.checked_sub(i - at) {
            Some(left) => patience = left,
            None => return false,
        }
    }
    true
}

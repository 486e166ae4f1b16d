use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use super::arcs::Arcs;
use super::relief::Relief;
use crate::Polarity;
use crate::layout::postorder;
use crate::order::NONE;
use crate::tree::Nodes;

/// Vertices to sort at once, on average.
const BIN: usize = 256;

/// Sorts the vertices along their arcs and makes nodes of them. `labels` are the vertices' basins.
pub(super) fn place<R: Relief>(
    relief: &R,
    polarity: Polarity,
    mut labels: Vec<u32>,
    arcs: &Arcs,
    parts: usize,
) -> Nodes {
    let n = labels.len();
    let step = n.div_ceil(parts.max(1)).max(1);
    let counts: Vec<Vec<u32>> = labels
        .par_chunks_mut(step)
        .enumerate()
        .map(|(part, labels)| climb(relief, labels, part * step, arcs))
        .collect();
    let order = Order::new(arcs, &labels, counts, relief.top());
    let pairs = order.scatter(relief, labels, step);
    let (vertices, levels, ties) = order.sort(relief, pairs);
    let mut nodes = order.nodes(vertices, levels, ties, arcs);
    if polarity == Polarity::Superlevel {
        nodes.altitudes.par_iter_mut().for_each(|altitude| *altitude = polarity.orient(*altitude));
    }
    nodes
}

/// Turns the basins of a range of vertices into arcs, and counts the vertices of each.
fn climb<R: Relief>(relief: &R, labels: &mut [u32], start: usize, arcs: &Arcs) -> Vec<u32> {
    let mut count = vec![0; arcs.parents.len()];
    // Next to each other most vertices lie on one arc.
    let (mut basin, mut arc, mut span) = (NONE, NONE, f64::INFINITY..f64::INFINITY);
    for (i, label) in labels.iter_mut().enumerate() {
        let level = relief.level((start + i) as u32);
        if *label != basin || !span.contains(&level) {
            basin = *label;
            let end;
            (arc, end) = arcs.climb(arcs.of_basin[basin as usize], level);
            span = arcs.births[arc as usize]..end;
        }
        *label = arc;
        count[arc as usize] += 1;
    }
    count
}

/// The arcs in postorder, and the bins of vertices along them.
struct Order {
    /// Arcs in postorder, siblings by their smallest vertex.
    arcs: Vec<u32>,
    /// Where the vertices of the arcs begin, in postorder, and their number.
    starts: Vec<u32>,
    /// The bins of each arc, by its number.
    bins: Vec<Bins>,
    bin_count: usize,
}

/// A map from levels to bins that never falls: bins of one arc hold ascending levels.
#[derive(Clone, Copy)]
struct Bins {
    first: u32,
    last: u32,
    low: f64,
    scale: f64,
}

impl Bins {
    /// The bin of a level, and its place in the bin as a fraction of 2^32.
    #[inline(always)]
    fn of(&self, level: f64) -> (u32, u32) {
        let place = (finite(level) - self.low) * self.scale;
        let bin = (place as u32).min(self.last);
        (self.first + bin, ((place - f64::from(bin)) * 4_294_967_296.0) as u32)
    }
}

/// Infinite levels count as very large ones: their differences are finite.
#[inline(always)]
fn finite(level: f64) -> f64 {
    level.clamp(-1e307, 1e307)
}

impl Order {
    fn new(arcs: &Arcs, labels: &[u32], counts: Vec<Vec<u32>>, top: f64) -> Self {
        let count = arcs.parents.len();
        let mut own = vec![0u32; count];
        for part in counts {
            own.iter_mut().zip(part).for_each(|(sum, count)| *sum += count);
        }
        let postorder = postorder(&arcs.parents, labels);
        let mut bins = vec![Bins { first: 0, last: 0, low: 0.0, scale: 0.0 }; count];
        let (mut starts, mut start, mut bin) = (Vec::with_capacity(count + 1), 0, 0u32);
        for &arc in &postorder {
            let arc = arc as usize;
            starts.push(start);
            start += own[arc];
            let high = if arcs.parents[arc] == NONE { top } else { arcs.births[arcs.parents[arc] as usize] };
            let (low, high) = (finite(arcs.births[arc]), finite(high));
            let wanted = (own[arc] as usize / BIN).max(1) as u32;
            // A span too short to divide is one bin, sorted by comparison.
            let scale = f64::from(wanted) / (high - low);
            let scale = if scale.is_finite() { scale } else { 0.0 };
            bins[arc] = Bins { first: bin, last: wanted - 1, low, scale };
            bin += wanted;
        }
        starts.push(start);
        Self { arcs: postorder, starts, bins, bin_count: bin as usize }
    }

    /// All vertices by bin, ascending in each, with their place in the bin in the upper half.
    fn scatter<R: Relief>(&self, relief: &R, labels: Vec<u32>, step: usize) -> Binned {
        let of = |v: u32, arc: u32| self.bins[arc as usize].of(relief.level(v));
        let vertices = |part: usize| (part * step) as u32..;
        let mut cursors: Vec<Vec<u32>> = labels
            .par_chunks(step)
            .enumerate()
            .map(|(part, labels)| {
                let mut count = vec![0u32; self.bin_count];
                labels.iter().zip(vertices(part)).for_each(|(&arc, v)| count[of(v, arc).0 as usize] += 1);
                count
            })
            .collect();
        let mut ends = vec![0u32; self.bin_count];
        let mut sum = 0;
        for bin in 0..self.bin_count {
            for part in &mut cursors {
                sum += std::mem::replace(&mut part[bin], sum);
            }
            ends[bin] = sum;
        }
        let pairs: Vec<AtomicU64> = (0..labels.len()).map(|_| AtomicU64::new(0)).collect();
        labels.par_chunks(step).zip(&mut cursors).enumerate().for_each(|(part, (labels, cursor))| {
            for (&arc, v) in labels.iter().zip(vertices(part)) {
                let (bin, place) = of(v, arc);
                let at = &mut cursor[bin as usize];
                pairs[*at as usize].store(u64::from(place) << 32 | u64::from(v), Relaxed);
                *at += 1;
            }
        });
        let pairs = pairs.into_iter().map(AtomicU64::into_inner).collect();
        Binned { pairs, ends }
    }

    /// Sorts each bin; gives the vertices, their levels, and whether any two on an arc are equal.
    fn sort<R: Relief>(&self, relief: &R, binned: Binned) -> (Vec<u32>, Vec<f64>, bool) {
        let Binned { mut pairs, ends } = binned;
        let n = pairs.len();
        let (mut vertices, mut levels) = (vec![0u32; n], vec![0f64; n]);
        // Groups of whole bins, a few for each thread.
        let wanted = if n < 1 << 16 { 1 } else { 8 * rayon::current_num_threads() };
        let mut groups: Vec<Group<'_>> = Vec::new();
        let (mut rest, mut from) = ((&mut pairs[..], &mut vertices[..], &mut levels[..]), 0);
        let mut bin = 0;
        while bin < ends.len() {
            let goal = from as usize + n.div_ceil(wanted);
            let last = (bin + ends[bin..].partition_point(|&e| (e as usize) < goal)).min(ends.len() - 1);
            let len = (ends[last] - from) as usize;
            let (pairs, a) = rest.0.split_at_mut(len);
            let (vertices, b) = rest.1.split_at_mut(len);
            let (levels, c) = rest.2.split_at_mut(len);
            rest = (a, b, c);
            groups.push(Group { pairs, vertices, levels, ends: &ends[bin..=last], from });
            (bin, from) = (last + 1, ends[last]);
        }
        let ties = groups.into_par_iter().map(|group| group.sort(relief)).reduce(|| false, |a, b| a || b);
        (vertices, levels, ties)
    }

    /// Makes a node of each level at which something enters or merges.
    fn nodes(&self, vertices: Vec<u32>, mut levels: Vec<f64>, ties: bool, arcs: &Arcs) -> Nodes {
        let birth = |arc: u32| arcs.births[arc as usize];
        let starts = |at: usize| self.starts[at] as usize..self.starts[at + 1] as usize;
        // With weights on edges components can merge where no vertex enters.
        let entered = |at: usize| levels[starts(at)].first() == Some(&birth(self.arcs[at]));
        let one_each = !ties && (0..self.arcs.len()).all(entered);
        let mut ends: Vec<u32>;
        // The first node of each arc, in postorder, and the number of nodes.
        let mut first_nodes = self.starts.clone();
        if one_each {
            ends = (1..=vertices.len() as u32).collect();
        } else {
            ends = Vec::new();
            let mut nodes = 0;
            for (at, &arc) in self.arcs.iter().enumerate() {
                first_nodes[at] = nodes as u32;
                // In place: a minimum's level is its first vertex's own, and every merge has more
                // minima below it, with vertices of equal level, than merges.
                levels[nodes] = birth(arc);
                ends.push(self.starts[at]);
                nodes += 1;
                for entry in starts(at) {
                    if levels[entry] != levels[nodes - 1] {
                        levels[nodes] = levels[entry];
                        ends.push(0);
                        nodes += 1;
                    }
                    ends[nodes - 1] = entry as u32 + 1;
                }
            }
            first_nodes[self.arcs.len()] = nodes as u32;
            levels.truncate(nodes);
            levels.shrink_to_fit();
            ends.shrink_to_fit();
        }
        let mut parents: Vec<u32> = (1..=levels.len() as u32).collect();
        let mut place = vec![0u32; self.arcs.len()];
        self.arcs.iter().enumerate().for_each(|(at, &arc)| place[arc as usize] = at as u32);
        for (at, &arc) in self.arcs.iter().enumerate() {
            let last = first_nodes[at + 1] as usize - 1;
            parents[last] = match arcs.parents[arc as usize] {
                NONE => NONE,
                parent => first_nodes[place[parent as usize] as usize],
            };
        }
        Nodes { parents, altitudes: levels, ends, vertices }
    }
}

struct Binned {
    pairs: Vec<u64>,
    ends: Vec<u32>,
}

/// Neighbouring bins and what is made of them.
struct Group<'a> {
    pairs: &'a mut [u64],
    vertices: &'a mut [u32],
    levels: &'a mut [f64],
    ends: &'a [u32],
    from: u32,
}

impl Group<'_> {
    fn sort<R: Relief>(self, relief: &R) -> bool {
        let mut ties = false;
        let mut start = 0;
        for &end in self.ends {
            let end = (end - self.from) as usize;
            let range = std::mem::replace(&mut start, end)..end;
            if !range.is_empty() {
                ties |= sort_bin(relief, self.pairs, self.vertices, self.levels, range);
            }
        }
        ties
    }
}

/// Sorts one bin by (level, vertex); says whether two levels are equal.
fn sort_bin<R: Relief>(
    relief: &R,
    pairs: &mut [u64],
    vertices: &mut [u32],
    levels: &mut [f64],
    range: Range<usize>,
) -> bool {
    let (pairs, vertices, levels) =
        (&mut pairs[range.clone()], &mut vertices[range.clone()], &mut levels[range]);
    pairs.sort_unstable();
    for ((pair, vertex), level) in pairs.iter().zip(&mut *vertices).zip(&mut *levels) {
        *vertex = *pair as u32;
        *level = relief.level(*vertex);
    }
    if !levels.is_sorted() {
        // Too close for 32 bits of their bin: rare, so compare them in full.
        vertices.sort_unstable_by(|&a, &b| relief.level(a).total_cmp(&relief.level(b)).then(a.cmp(&b)));
        levels.iter_mut().zip(&*vertices).for_each(|(level, &v)| *level = relief.level(v));
    }
    levels.windows(2).any(|pair| pair[0] == pair[1])
}

//! Step 3 of the construction: vertices sorted along their branches only (ExTreeM's augmentation), by
//! counting into bins.
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use rayon::prelude::*;

use super::branches::Branches;
use super::filtration::Filtration;

/// Vertices to sort at once, on average.
const BIN: usize = 256;

/// A vertex and where in its bin it lies, as a fraction of 2^32.
pub(super) type Entry = [u32; 2];

/// All vertices by branch, along a branch by level, and of one level by number.
pub(super) struct SortedVertices {
    /// The [`entries`](Self::entries), flat: this memory will become part of the tree.
    pub memory: Vec<u32>,
    /// Where the vertices of each branch begin, and their number.
    pub starts: Vec<u32>,
    bins: Vec<Bins>,
    /// The end of each bin.
    ends: Vec<u32>,
}

/// A map from levels to bins that never falls: bins of one branch hold ascending levels.
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

impl SortedVertices {
    /// `labels` are the vertices' basins; gives back their memory.
    pub fn new<R: Filtration>(
        filtration: &R,
        mut labels: Vec<u32>,
        branches: &Branches,
        parts: usize,
    ) -> (Self, Vec<u32>) {
        let step = labels.len().div_ceil(parts.max(1)).max(1);
        let counts: Vec<Vec<u32>> = labels
            .par_chunks_mut(step)
            .enumerate()
            .map(|(part, labels)| climb(filtration, labels, part * step, branches))
            .collect();
        let mut sorted = Self::laid_out(branches, counts, filtration.top());
        sorted.scatter(filtration, &labels, step);
        sorted.sort(filtration);
        (sorted, labels)
    }

    /// Decides on the bins.
    fn laid_out(branches: &Branches, counts: Vec<Vec<u32>>, top: f64) -> Self {
        let mut starts = vec![0u32; branches.len() + 1];
        for part in counts {
            starts[1..].iter_mut().zip(part).for_each(|(sum, count)| *sum += count);
        }
        let mut bins = Vec::with_capacity(branches.len());
        let mut bin = 0u32;
        for branch in 0..branches.len() {
            let own = starts[branch + 1];
            starts[branch + 1] += starts[branch];
            let high = branches.joins[branch].level.min(top);
            let (low, high) = (finite(branches.births[branch]), finite(high));
            let wanted = (own as usize / BIN).max(1) as u32;
            // A span too short to divide is one bin, sorted by comparison.
            let scale = f64::from(wanted) / (high - low);
            let scale = if scale.is_finite() { scale } else { 0.0 };
            bins.push(Bins { first: bin, last: wanted - 1, low, scale });
            bin += wanted;
        }
        Self { memory: Vec::new(), starts, bins, ends: vec![0; bin as usize] }
    }

    /// Puts all vertices into their bins, ascending in each.
    fn scatter<R: Filtration>(&mut self, filtration: &R, labels: &[u32], step: usize) {
        let of = |v: u32, branch: u32| self.bins[branch as usize].of(filtration.level(v));
        let vertices = |part: usize| (part * step) as u32..;
        let mut cursors: Vec<Vec<u32>> = labels
            .par_chunks(step)
            .enumerate()
            .map(|(part, labels)| {
                let mut count = vec![0u32; self.ends.len()];
                labels.iter().zip(vertices(part)).for_each(|(&b, v)| count[of(v, b).0 as usize] += 1);
                count
            })
            .collect();
        let mut sum = 0;
        for (bin, end) in self.ends.iter_mut().enumerate() {
            for part in &mut cursors {
                sum += std::mem::replace(&mut part[bin], sum);
            }
            *end = sum;
        }
        let shared: Vec<AtomicU32> = vec![0; 2 * labels.len()].into_iter().map(AtomicU32::new).collect();
        let entries = shared.as_chunks::<2>().0;
        labels.par_chunks(step).zip(&mut cursors).enumerate().for_each(|(part, (labels, cursor))| {
            for (&branch, v) in labels.iter().zip(vertices(part)) {
                let (bin, place) = of(v, branch);
                let at = &mut cursor[bin as usize];
                let entry = &entries[*at as usize];
                entry[0].store(v, Relaxed);
                entry[1].store(place, Relaxed);
                *at += 1;
            }
        });
        self.memory = shared.into_iter().map(AtomicU32::into_inner).collect();
    }

    /// Sorts each bin.
    fn sort<R: Filtration>(&mut self, filtration: &R) {
        let entries = self.memory.as_chunks_mut::<2>().0;
        let n = entries.len();
        // Groups of whole bins, a few for each thread.
        let wanted = if n < 1 << 16 { 1 } else { 8 * rayon::current_num_threads() };
        let mut groups: Vec<(&mut [Entry], &[u32], u32)> = Vec::new();
        let (mut rest, mut ends, mut from) = (entries, &self.ends[..], 0);
        while !ends.is_empty() {
            let goal = from as usize + n.div_ceil(wanted);
            let bins = (ends.partition_point(|&e| (e as usize) < goal) + 1).min(ends.len());
            let (here, later) = ends.split_at(bins);
            let (entries, more) = rest.split_at_mut((here[bins - 1] - from) as usize);
            groups.push((entries, here, from));
            (rest, ends, from) = (more, later, here[bins - 1]);
        }
        groups.into_par_iter().for_each(|(entries, ends, from)| {
            let mut scratch = Vec::new();
            let mut start = 0;
            for &end in ends {
                let end = (end - from) as usize;
                sort_bin(filtration, &mut entries[start..end], &mut scratch);
                start = end;
            }
        });
    }

    #[inline(always)]
    pub fn entries(&self) -> &[Entry] {
        self.memory.as_chunks().0
    }

    /// Where in a branch the vertices begin that enter at a level of its span or above.
    pub fn split<R: Filtration>(&self, filtration: &R, branch: u32, level: f64) -> u32 {
        let (bin, place) = self.bins[branch as usize].of(level);
        let start = if bin == 0 { 0 } else { self.ends[bin as usize - 1] };
        let bin = &self.entries()[start as usize..self.ends[bin as usize] as usize];
        let below = |e: &Entry| e[1] < place || e[1] == place && filtration.level(e[0]) < level;
        start + bin.partition_point(below) as u32
    }

    /// How many vertices of a range enter at another level than the one before them.
    #[inline(always)]
    pub fn rises<R: Filtration>(&self, filtration: &R, range: Range<usize>) -> u32 {
        if range.is_empty() {
            return 0;
        }
        let entries = &self.entries()[range.start - 1..range.end];
        let pairs = || entries.iter().zip(&entries[1..]);
        let unclear = pairs().fold(0, |sum, (a, b)| sum + u32::from(a[1] == b[1]));
        let level = |entry: &Entry| filtration.level(entry[0]);
        let equal = |(a, b): &(&Entry, &Entry)| a[1] == b[1] && level(a) == level(b);
        // Of different places levels differ, nearly always.
        range.len() as u32 - if unclear == 0 { 0 } else { pairs().filter(equal).count() as u32 }
    }
}

/// Turns the basins of a range of vertices into branches, and counts the vertices of each.
fn climb<R: Filtration>(filtration: &R, labels: &mut [u32], start: usize, branches: &Branches) -> Vec<u32> {
    let mut count = vec![0; branches.len()];
    // Next to each other most vertices lie on one branch.
    let (mut basin, mut branch, mut low, mut high) = (u32::MAX, 0, 0.0, 0.0);
    for (i, label) in labels.iter_mut().enumerate() {
        let level = filtration.level((start + i) as u32);
        if *label != basin || level < low || level >= high {
            basin = *label;
            (branch, low, high) = branches.climb(basin, level);
        }
        *label = branch;
        count[branch as usize] += 1;
    }
    count
}

#[inline(always)]
fn key(&[vertex, place]: &Entry) -> u64 {
    u64::from(place) << 32 | u64::from(vertex)
}

/// Sorts one bin by (level, vertex). The vertices come ascending.
fn sort_bin<R: Filtration>(filtration: &R, entries: &mut [Entry], scratch: &mut Vec<Entry>) {
    if entries.len() < 2 {
        return;
    }
    distribute(entries, scratch);
    // Of one place levels can differ by less than 32 bits of their bin.
    let mut start = 0;
    while let Some(offset) = entries[start..].windows(2).position(|e| e[0][1] == e[1][1]) {
        let first = start + offset;
        let place = entries[first][1];
        let len = entries[first..].iter().take_while(|e| e[1] == place).count();
        let run = &mut entries[first..first + len];
        let level = |e: &Entry| filtration.level(e[0]);
        if !run.is_sorted_by(|a, b| level(a) <= level(b)) {
            run.sort_unstable_by(|a, b| level(a).total_cmp(&level(b)).then(a[0].cmp(&b[0])));
        }
        start = first + len;
    }
}

/// Sorts entries, of which those with the same place come ascending, by their keys.
fn distribute(entries: &mut [Entry], scratch: &mut Vec<Entry>) {
    const BUCKETS: usize = 256;
    if entries.len() < 32 {
        insertion_sort(entries);
        return;
    }
    let bucket = |entry: &Entry| (entry[1] >> 24) as usize;
    let mut next = [0u32; BUCKETS];
    entries.iter().for_each(|e| next[bucket(e)] += 1);
    let mut sum = 0;
    let mut most = 0;
    for next in &mut next {
        most = most.max(*next);
        sum += std::mem::replace(next, sum);
    }
    if most > 32 {
        entries.sort_unstable_by_key(key);
        return;
    }
    scratch.clear();
    scratch.extend_from_slice(entries);
    for entry in scratch.iter() {
        let at = &mut next[bucket(entry)];
        entries[*at as usize] = *entry;
        *at += 1;
    }
    insertion_sort(entries);
}

/// Fast where hardly anything is out of place.
fn insertion_sort(entries: &mut [Entry]) {
    for i in 1..entries.len() {
        let entry = entries[i];
        let mut at = i;
        while at > 0 && entries[at - 1][1] > entry[1] {
            entries[at] = entries[at - 1];
            at -= 1;
        }
        entries[at] = entry;
    }
}

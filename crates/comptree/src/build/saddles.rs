//! Step 2 of the construction: a minimum spanning forest of the basins by filter-Kruskal (Osipov, Sanders and
//! Singler 2009), tile by tile.
use std::ops::Range;

use mser3d_shape::DisjointSets;
use rayon::prelude::*;

use super::basins::Basins;
use super::filtration::Filtration;
use super::scale::Scale;
use crate::tree::NONE;

/// Vertices of a tile, or more.
const TILE: usize = 1 << 17;

/// An edge between basins at the level where it enters.
#[derive(Clone, Copy)]
pub(super) struct Saddle {
    pub level: f64,
    /// The smaller first.
    pub basins: [u32; 2],
}

/// The edges of a minimum spanning forest of the basins, and perhaps a few more, by ascending level.
///
/// What is not in the forest of some of the edges is not in that of all. So most edges are dropped tile by
/// tile: there the basins are few enough to stay near in memory, and tiles go to different threads.
pub(super) fn find<R: Filtration>(filtration: &R, basins: &Basins, parts: usize) -> Vec<Saddle> {
    let count = basins.minima.len();
    let tiles = filtration.split_edges(parts.max(filtration.len() / TILE));
    let labels = &basins.labels;
    if let [tile] = &tiles[..] {
        let mut recent = Recent::new();
        recent.find(filtration, labels, tile.clone());
        return forest(&recent.list, count, &mut Vec::new());
    }
    let thinned = |memory: &mut Memory, tile: &Range<usize>| memory.forest(filtration, labels, tile.clone());
    let found: Vec<_> = tiles.par_iter().map_init(|| Memory::new(count), thinned).collect();
    let mut saddles = found.concat();
    // Those of a tile are sorted: this only merges.
    saddles.sort_by(by_level);
    saddles
}

fn by_level(a: &Saddle, b: &Saddle) -> std::cmp::Ordering {
    a.level.total_cmp(&b.level)
}

/// A list of edges that knows where the pairs of basins met last are: two basins mostly meet along a
/// surface, of which only the lowest edge counts.
struct Recent {
    list: Vec<Saddle>,
    places: Vec<u32>,
}

impl Recent {
    const BITS: u32 = 12;

    fn new() -> Self {
        Self { list: Vec::new(), places: vec![0; 1 << Self::BITS] }
    }

    /// The edges of a tile between basins, of most pairs of basins only the lowest.
    fn find<R: Filtration>(&mut self, filtration: &R, labels: &[u32], tile: Range<usize>) {
        self.list.clear();
        filtration.boundary(tile, labels, |v, w, level| {
            let [a, b] = [labels[v as usize], labels[w as usize]];
            self.add(Saddle { level, basins: [a.min(b), a.max(b)] });
        });
    }

    #[inline(always)]
    fn add(&mut self, saddle: Saddle) {
        let [a, b] = saddle.basins;
        let hash = a.wrapping_mul(0x9E37_79B1).wrapping_add(b).wrapping_mul(0x85EB_CA77);
        let place = &mut self.places[(hash >> (32 - Self::BITS)) as usize];
        match self.list.get_mut(*place as usize) {
            Some(known) if known.basins == saddle.basins => known.level = known.level.min(saddle.level),
            _ => {
                *place = self.list.len() as u32;
                self.list.push(saddle);
            }
        }
    }
}

/// What work on one tile leaves to the next: memory, most of all.
struct Memory {
    recent: Recent,
    /// A number for each basin of the tile, from zero; [`NONE`] for those of other tiles.
    of: Vec<u32>,
    /// The basins of the tile.
    basins: Vec<u32>,
    sorted: Vec<Saddle>,
}

impl Memory {
    fn new(count: usize) -> Self {
        Self { recent: Recent::new(), of: vec![NONE; count], basins: Vec::new(), sorted: Vec::new() }
    }

    /// The forest of the edges of a tile.
    fn forest<R: Filtration>(&mut self, filtration: &R, labels: &[u32], tile: Range<usize>) -> Vec<Saddle> {
        self.recent.find(filtration, labels, tile);
        for basin in self.recent.list.iter_mut().flat_map(|saddle| &mut saddle.basins) {
            let number = &mut self.of[*basin as usize];
            if *number == NONE {
                *number = self.basins.len() as u32;
                self.basins.push(*basin);
            }
            *basin = *number;
        }
        let mut forest = forest(&self.recent.list, self.basins.len(), &mut self.sorted);
        for basin in forest.iter_mut().flat_map(|saddle| &mut saddle.basins) {
            *basin = self.basins[*basin as usize];
        }
        self.basins.drain(..).for_each(|basin| self.of[basin as usize] = NONE);
        forest
    }
}

/// A minimum spanning forest of `count` basins, by ascending level.
///
/// Edges are counted into buckets by level. What lower buckets have joined already is dropped before a bucket is
/// sorted: of many edges most.
fn forest(list: &[Saddle], count: usize, sorted: &mut Vec<Saddle>) -> Vec<Saddle> {
    let (low, high) = list.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), saddle| {
        (saddle.level.min(low), saddle.level.max(high))
    });
    let buckets = (list.len() / 128).clamp(1, 1 << 10) as u32;
    let scale = Scale::new(low, high, buckets);
    let mut ends = vec![0u32; buckets as usize];
    list.iter().for_each(|saddle| ends[scale.part(saddle.level, buckets) as usize] += 1);
    let mut sum = 0;
    for end in &mut ends {
        sum += std::mem::replace(end, sum);
    }
    sorted.clear();
    sorted.resize(list.len(), Saddle { level: 0.0, basins: [0; 2] });
    for &saddle in list {
        let at = &mut ends[scale.part(saddle.level, buckets) as usize];
        sorted[*at as usize] = saddle;
        *at += 1;
    }
    let mut sets = DisjointSets::new(count);
    let mut forest = Vec::with_capacity(count);
    let mut bucket = Vec::new();
    let mut start = 0;
    for end in ends {
        let all = sorted[start..end as usize].iter();
        bucket.clear();
        bucket.extend(all.filter(|saddle| sets.find(saddle.basins[0]) != sets.find(saddle.basins[1])));
        bucket.sort_unstable_by(by_level);
        forest
            .extend(bucket.iter().filter(|saddle| sets.union(saddle.basins[0], saddle.basins[1]).is_some()));
        start = end as usize;
    }
    forest
}

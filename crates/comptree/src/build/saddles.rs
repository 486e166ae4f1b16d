//! Step 2 of the construction: a minimum spanning forest of the basins by rounds of Borůvka (1926), tile by
//! tile.
use std::ops::Range;

use mser3d_shape::DisjointSets;
use rayon::prelude::*;

use super::basins::Basins;
use super::filtration::Filtration;
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

impl Saddle {
    const NONE: Self = Self { level: f64::INFINITY, basins: [NONE; 2] };

    /// A strict order: of equal levels, the one between the smaller basins comes first.
    #[inline(always)]
    fn before(&self, other: &Self) -> bool {
        self.level < other.level || self.level == other.level && self.basins < other.basins
    }
}

/// The edges of a minimum spanning forest of the basins, and perhaps a few more, by ascending level.
///
/// What is not in the forest of some of the edges is not in that of all. So most edges are dropped tile by
/// tile: there the basins are few enough to stay near in memory, and tiles go to different threads.
pub(super) fn find<R: Filtration>(filtration: &R, basins: &Basins, parts: usize) -> Vec<Saddle> {
    let count = basins.minima.len();
    let tiles = filtration.split_edges(parts.max(filtration.len() / TILE));
    let mut saddles = if let [tile] = &tiles[..] {
        forest(between(filtration, &basins.labels, tile.clone()), count)
    } else {
        let thinned = |numbers: &mut Numbers, tile: &Range<usize>| {
            let found = between(filtration, &basins.labels, tile.clone());
            numbers.forest(found)
        };
        let found: Vec<_> = tiles.par_iter().map_init(|| Numbers::new(count), thinned).collect();
        found.concat()
    };
    sort(&mut saddles, parts);
    saddles
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

/// The edges of a tile between basins, of most pairs of basins only the lowest.
fn between<R: Filtration>(filtration: &R, labels: &[u32], tile: Range<usize>) -> Vec<Saddle> {
    let mut recent = Recent::new();
    filtration.boundary(tile, labels, |v, w, level| {
        let [a, b] = [labels[v as usize], labels[w as usize]];
        recent.add(Saddle { level, basins: [a.min(b), a.max(b)] });
    });
    recent.list
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

/// Numbers for the basins of a tile, from zero.
struct Numbers {
    /// The number of each basin; [`NONE`] for those of other tiles.
    of: Vec<u32>,
    /// The basins of the tile.
    basins: Vec<u32>,
}

impl Numbers {
    fn new(count: usize) -> Self {
        Self { of: vec![NONE; count], basins: Vec::new() }
    }

    /// The forest of the edges of a tile.
    fn forest(&mut self, mut list: Vec<Saddle>) -> Vec<Saddle> {
        for basin in list.iter_mut().flat_map(|saddle| &mut saddle.basins) {
            let number = &mut self.of[*basin as usize];
            if *number == NONE {
                *number = self.basins.len() as u32;
                self.basins.push(*basin);
            }
            *basin = *number;
        }
        let mut forest = forest(list, self.basins.len());
        for basin in forest.iter_mut().flat_map(|saddle| &mut saddle.basins) {
            *basin = self.basins[*basin as usize];
        }
        self.basins.drain(..).for_each(|basin| self.of[basin as usize] = NONE);
        forest
    }
}

/// Thins out a list of edges by Borůvka's rounds: each chooses the lowest edge out of every group of
/// basins, and drops the edges within what it joins.
fn forest(mut list: Vec<Saddle>, count: usize) -> Vec<Saddle> {
    let mut sets = DisjointSets::new(count);
    let mut group: Vec<u32> = (0..count as u32).collect();
    let mut forest = Vec::with_capacity(count);
    // A few edges more cost less than another round.
    while list.len() > count / 8 {
        let mut best = vec![Saddle::NONE; count];
        for saddle in &list {
            for basin in saddle.basins {
                let best = &mut best[group[basin as usize] as usize];
                if saddle.before(best) {
                    *best = *saddle;
                }
            }
        }
        for edge in best.into_iter().filter(|edge| edge.basins[0] != NONE) {
            if sets.union(edge.basins[0], edge.basins[1]).is_some() {
                forest.push(edge);
            }
        }
        for (basin, group) in group.iter_mut().enumerate() {
            *group = sets.find(basin as u32);
        }
        list.retain(|saddle| group[saddle.basins[0] as usize] != group[saddle.basins[1] as usize]);
    }
    forest.append(&mut list);
    forest
}

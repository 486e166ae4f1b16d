//! Step 2 of the construction: branches of basins (branch decomposition, Pascucci et al. 2004) by Kruskal's
//! algorithm.
use std::ops::Range;

use mser3d_shape::DisjointSets;
use rayon::prelude::*;

use super::saddles::Saddle;
use crate::tree::NONE;

/// The tree of basins, cut into branches: each basin's goes from its minimum up to where it joins a
/// branch of at least as many basins.
///
/// These are the joins of union by size, so that no vertex lies below more than log2(basins) of them.
pub(super) struct Branches {
    /// The level of each basin's minimum.
    pub births: Vec<f64>,
    /// Where each branch ends.
    pub joins: Vec<Join>,
    /// The branches that join another, by ascending level.
    pub order: Vec<u32>,
}

/// The upper end of a branch.
#[derive(Clone, Copy)]
pub(super) struct Join {
    /// Infinite for a root's branch.
    pub level: f64,
    /// The branch that goes on from here, to a higher level; [`NONE`] for a root's.
    pub into: u32,
}

impl Branches {
    /// Kruskal's algorithm: `saddles` by ascending level.
    pub fn new(births: Vec<f64>, saddles: &[Saddle]) -> Self {
        let count = births.len();
        let mut joins = vec![Join { level: f64::INFINITY, into: NONE }; count];
        let mut order = Vec::with_capacity(count);
        let mut sets = DisjointSets::new(count);
        for &Saddle { level, basins: [a, b] } in saddles {
            if let Some((stays, goes)) = sets.union(a, b) {
                joins[goes as usize] = Join { level, into: stays };
                order.push(goes);
            }
        }
        // A branch that ends at the level at which another joins it is not there any more.
        for &branch in order.iter().rev() {
            let Join { level, into } = joins[branch as usize];
            let next = joins[into as usize];
            if next.into != NONE && next.level == level {
                joins[branch as usize].into = next.into;
            }
        }
        Self { births, joins, order }
    }

    pub fn len(&self) -> usize {
        self.joins.len()
    }

    /// The branches that join no other, one for each component of the graph.
    pub fn roots(&self) -> Vec<u32> {
        (0..self.len() as u32).filter(|&branch| self.joins[branch as usize].into == NONE).collect()
    }

    /// The branch, from `branch` upwards, that is there at `level`; the levels from and below which
    /// the answer is the same.
    #[inline(always)]
    pub fn climb(&self, mut branch: u32, level: f64) -> (u32, f64, f64) {
        let mut low = f64::NEG_INFINITY;
        loop {
            let join = self.joins[branch as usize];
            if join.level > level || join.into == NONE {
                return (branch, low, join.level);
            }
            (branch, low) = (join.into, join.level);
        }
    }

    /// Which branches join each branch, by ascending level.
    pub fn joined(&self) -> Joined {
        let mut starts = vec![0u32; self.len() + 1];
        for &branch in &self.order {
            starts[self.joins[branch as usize].into as usize + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut list = vec![0u32; self.order.len()];
        for &branch in &self.order {
            let at = &mut next[self.joins[branch as usize].into as usize];
            list[*at as usize] = branch;
            *at += 1;
        }
        let levels = list.par_iter().map(|&branch| self.joins[branch as usize].level).collect();
        Joined { starts, list, levels }
    }
}

/// The branches that join each branch, one after the other. They cut it into segments.
pub(super) struct Joined {
    /// Where those of each branch begin, and their number.
    pub starts: Vec<u32>,
    pub list: Vec<u32>,
    /// Where each of the list joins.
    pub levels: Vec<f64>,
}

impl Joined {
    /// Places in the list.
    #[inline(always)]
    pub fn slots(&self, branch: u32) -> Range<usize> {
        self.starts[branch as usize] as usize..self.starts[branch as usize + 1] as usize
    }

    /// The numbers of a branch's segments, from below: one more than branches that join.
    #[inline(always)]
    pub fn segments(&self, branch: u32) -> Range<usize> {
        let slots = self.slots(branch);
        slots.start + branch as usize..slots.end + branch as usize + 1
    }
}

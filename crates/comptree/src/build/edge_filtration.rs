//! Weights on edges: a vertex enters with its lowest edge and descends along it (the first round of Borůvka
//! 1926).
use std::ops::Range;

use rayon::prelude::*;

use super::filtration::Filtration;
use crate::topology::Topology;
use crate::{Polarity, TreeError};

/// The lowest edge of a vertex: its level and the vertex it leads to.
///
/// Of equal levels the one with the smaller (smaller end, larger end) is lower, so that no circle of
/// lowest edges can close.
#[derive(Clone, Copy, Debug)]
struct LowestEdge {
    level: f64,
    to: u32,
}

impl LowestEdge {
    /// For a vertex without edges, which is there at any level.
    fn none(v: u32) -> Self {
        Self { level: f64::NEG_INFINITY, to: v }
    }

    #[inline]
    fn take(&mut self, v: u32, level: f64, to: u32) {
        let ends = |to: u32| (v.min(to), v.max(to));
        if self.to == v || level < self.level || level == self.level && ends(to) < ends(self.to) {
            *self = Self { level, to };
        }
    }
}

/// The lowest edge of each vertex.
struct LowestEdges {
    levels: Vec<f64>,
    to: Vec<u32>,
    top: f64,
}

impl LowestEdges {
    fn top(levels: &[f64]) -> f64 {
        levels.par_iter().copied().reduce(|| f64::NEG_INFINITY, f64::max)
    }
}

/// Weights on edges, which enter at their own levels.
pub(super) struct EdgeFiltration<E> {
    edges: E,
    polarity: Polarity,
    lowest: LowestEdges,
}

/// Edges with their weights.
pub(super) trait Edges: Sync {
    /// Ranges of the `n` vertices.
    fn split(&self, n: usize, parts: usize) -> Vec<Range<usize>>;

    /// Ranges of edges.
    fn split_edges(&self, parts: usize) -> Vec<Range<usize>>;

    /// Calls `f` with each edge of a range of [`split_edges`](Self::split_edges) whose ends have different
    /// labels, and its weight.
    fn boundary(&self, range: Range<usize>, labels: &[u32], f: impl FnMut(u32, u32, f64));
}

/// Edges and their weights in lists.
pub(super) struct Listed<'a> {
    edges: &'a [[u32; 2]],
    weights: &'a [f64],
}

impl<'a> EdgeFiltration<Listed<'a>> {
    /// # Errors
    /// Sizes that differ, and NaN.
    pub fn of_list(
        n: usize,
        edges: &'a [[u32; 2]],
        weights: &'a [f64],
        polarity: Polarity,
    ) -> Result<Self, TreeError> {
        if weights.len() != edges.len() {
            let (found, expected) = (weights.len(), edges.len());
            return Err(TreeError::SizeMismatch { what: "weights of edges", found, expected });
        }
        if let Some(index) = weights.iter().position(|w| w.is_nan()) {
            return Err(TreeError::NotANumber { what: "edge", index });
        }
        let mut lowest: Vec<LowestEdge> = (0..n as u32).map(LowestEdge::none).collect();
        for (&[u, v], &weight) in edges.iter().zip(weights).filter(|(e, _)| e[0] != e[1]) {
            let level = polarity.orient(weight);
            lowest[u as usize].take(u, level, v);
            lowest[v as usize].take(v, level, u);
        }
        let levels: Vec<f64> = lowest.iter().map(|edge| edge.level).collect();
        let to = lowest.iter().map(|edge| edge.to).collect();
        let lowest = LowestEdges { top: LowestEdges::top(&levels), levels, to };
        Ok(Self { edges: Listed { edges, weights }, polarity, lowest })
    }
}

impl Edges for Listed<'_> {
    fn split(&self, n: usize, parts: usize) -> Vec<Range<usize>> {
        crate::topology::split_evenly(n, 1, parts)
    }

    fn split_edges(&self, parts: usize) -> Vec<Range<usize>> {
        crate::topology::split_evenly(self.edges.len(), 1, parts)
    }

    fn boundary(&self, range: Range<usize>, labels: &[u32], mut f: impl FnMut(u32, u32, f64)) {
        for (&[u, v], &weight) in self.edges[range.clone()].iter().zip(&self.weights[range]) {
            if labels[u as usize] != labels[v as usize] {
                f(u.min(v), u.max(v), weight);
            }
        }
    }
}

/// The edges of a topology with weights that a function gives.
pub(super) struct Weighed<'a, T, W> {
    topology: &'a T,
    weight: W,
}

impl<'a, T: Topology, W: Fn(u32, u32) -> f64 + Sync> EdgeFiltration<Weighed<'a, T, W>> {
    /// # Errors
    /// NaN.
    pub fn of_function(
        topology: &'a T,
        weight: W,
        polarity: Polarity,
        parts: usize,
    ) -> Result<Self, TreeError> {
        let (mut levels, mut to) = (vec![0.0; topology.len()], vec![0u32; topology.len()]);
        let mut ranges = Vec::new();
        let (mut rest_levels, mut rest_to) = (&mut levels[..], &mut to[..]);
        for range in topology.split(parts) {
            let (levels, a) = rest_levels.split_at_mut(range.len());
            let (to, b) = rest_to.split_at_mut(range.len());
            (rest_levels, rest_to) = (a, b);
            ranges.push((range, levels, to));
        }
        let find = |(range, levels, to): (Range<usize>, &mut [f64], &mut [u32])| {
            let mut nan = None;
            topology.visit(range.clone(), |v, neighbours| {
                let mut lowest = LowestEdge::none(v);
                for &w in neighbours {
                    let level = polarity.orient(weight(v.min(w), v.max(w)));
                    if level.is_nan() {
                        nan = nan.or(Some(v as usize));
                    }
                    lowest.take(v, level, w);
                }
                levels[v as usize - range.start] = lowest.level;
                to[v as usize - range.start] = lowest.to;
            });
            nan
        };
        let nan: Vec<Option<usize>> = ranges.into_par_iter().map(find).collect();
        if let Some(&index) = nan.iter().flatten().next() {
            return Err(TreeError::NotANumber { what: "an edge of vertex", index });
        }
        let lowest = LowestEdges { top: LowestEdges::top(&levels), levels, to };
        Ok(Self { edges: Weighed { topology, weight }, polarity, lowest })
    }
}

impl<T: Topology, W: Fn(u32, u32) -> f64 + Sync> Edges for Weighed<'_, T, W> {
    fn split(&self, _: usize, parts: usize) -> Vec<Range<usize>> {
        self.topology.split(parts)
    }

    fn split_edges(&self, parts: usize) -> Vec<Range<usize>> {
        self.topology.split(parts)
    }

    fn boundary(&self, range: Range<usize>, labels: &[u32], mut f: impl FnMut(u32, u32, f64)) {
        self.topology.boundary(range, labels, |v, w| f(v, w, (self.weight)(v, w)));
    }
}

impl<E: Edges> Filtration for EdgeFiltration<E> {
    const INTEGERS: bool = false;
    const BARE_JOINS: bool = true;

    fn polarity(&self) -> Polarity {
        self.polarity
    }

    fn len(&self) -> usize {
        self.lowest.to.len()
    }

    fn split(&self, parts: usize) -> Vec<Range<usize>> {
        self.edges.split(self.len(), parts)
    }

    fn split_edges(&self, parts: usize) -> Vec<Range<usize>> {
        self.edges.split_edges(parts)
    }

    #[inline(always)]
    fn level(&self, v: u32) -> f64 {
        self.lowest.levels[v as usize]
    }

    fn top(&self) -> f64 {
        self.lowest.top
    }

    /// Along lowest edges levels never rise. Two vertices with the same lowest edge are a minimum, and the
    /// smaller one represents both.
    fn descend(&self, range: Range<usize>, mut f: impl FnMut(u32, u32)) {
        let to = &self.lowest.to;
        for v in range.start as u32..range.end as u32 {
            let next = to[v as usize];
            f(v, if v < next && to[next as usize] == v { v } else { next });
        }
    }

    fn boundary(&self, range: Range<usize>, labels: &[u32], mut f: impl FnMut(u32, u32, f64)) {
        self.edges.boundary(range, labels, |u, v, weight| f(u, v, self.polarity.orient(weight)));
    }
}

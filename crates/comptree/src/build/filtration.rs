//! When vertices and edges enter as the level rises, the lower-star filtration of Morse theory: what a tree
//! is built from.
use std::ops::Range;

use rayon::prelude::*;

use crate::topology::Topology;
use crate::{GreyValue, Polarity, TreeError};

/// A weighted graph whose vertices and edges enter while a level rises.
///
/// A vertex counts as entered once something can be joined to it; so it is connected to where it
/// descends to at its own level.
pub(super) trait Filtration: Sync {
    /// Whether all levels are integers.
    const INTEGERS: bool;

    /// Whether components can join at levels at which no vertex enters.
    const BARE_JOINS: bool;

    fn polarity(&self) -> Polarity;

    fn len(&self) -> usize;

    /// Ranges of vertices that can go to different threads, about `parts` of them.
    fn split(&self, parts: usize) -> Vec<Range<usize>>;

    /// The level at which a vertex enters.
    fn level(&self, v: u32) -> f64;

    /// A level not below that of any vertex.
    fn top(&self) -> f64;

    /// Calls `f` with each vertex of the range, ascending, and the neighbour that a strict order has it
    /// descend to; itself for a minimum.
    fn descend(&self, range: Range<usize>, f: impl FnMut(u32, u32));

    /// Calls `f` with each edge whose ends have different labels and the level at which it enters.
    /// Every edge belongs to one of the ranges of [`split_edges`](Self::split_edges).
    fn boundary(&self, range: Range<usize>, labels: &[u32], f: impl FnMut(u32, u32, f64));

    /// Ranges for [`boundary`](Self::boundary).
    fn split_edges(&self, parts: usize) -> Vec<Range<usize>> {
        self.split(parts)
    }
}

/// Weights on vertices: an edge enters with the later of its ends.
pub(super) struct VertexFiltration<'a, T, V> {
    topology: &'a T,
    values: &'a [V],
    polarity: Polarity,
    top: f64,
}

impl<'a, T: Topology, V: GreyValue> VertexFiltration<'a, T, V> {
    /// # Errors
    /// Sizes that differ, and NaN.
    pub fn new(topology: &'a T, values: &'a [V], polarity: Polarity) -> Result<Self, TreeError> {
        if values.len() != topology.len() {
            let (found, expected) = (values.len(), topology.len());
            return Err(TreeError::SizeMismatch { what: "weights of vertices", found, expected });
        }
        // Comparing with itself is what tells a NaN from any other value.
        #[expect(clippy::eq_op)]
        let nan = |v: V| v != v;
        let summary = |part: &[V]| {
            let higher = |a: V, b: V| if (a < b) == (polarity == Polarity::Sublevel) { b } else { a };
            let top = part.iter().copied().reduce(higher);
            (part.iter().any(|&v| nan(v)), top.map_or(f64::NEG_INFINITY, |v| polarity.orient(v.into())))
        };
        let join = |a: (bool, f64), b: (bool, f64)| (a.0 || b.0, a.1.max(b.1));
        let (bad, top) = values.par_chunks(1 << 16).map(summary).reduce(|| (false, f64::NEG_INFINITY), join);
        if bad && let Some(index) = values.iter().position(|&v| nan(v)) {
            return Err(TreeError::NotANumber { what: "vertex", index });
        }
        Ok(Self { topology, values, polarity, top })
    }
}

impl<T: Topology, V: GreyValue> Filtration for VertexFiltration<'_, T, V> {
    const INTEGERS: bool = V::INTEGER;
    const BARE_JOINS: bool = false;

    fn polarity(&self) -> Polarity {
        self.polarity
    }

    fn len(&self) -> usize {
        self.topology.len()
    }

    fn split(&self, parts: usize) -> Vec<Range<usize>> {
        self.topology.split(parts)
    }

    #[inline(always)]
    fn level(&self, v: u32) -> f64 {
        self.polarity.orient(self.values[v as usize].into())
    }

    fn top(&self) -> f64 {
        self.top
    }

    fn descend(&self, range: Range<usize>, f: impl FnMut(u32, u32)) {
        match self.polarity {
            Polarity::Sublevel => self.topology.descend::<V, false>(range, self.values, f),
            Polarity::Superlevel => self.topology.descend::<V, true>(range, self.values, f),
        }
    }

    fn boundary(&self, range: Range<usize>, labels: &[u32], mut f: impl FnMut(u32, u32, f64)) {
        self.topology.boundary(range, labels, |v, w| f(v, w, self.level(v).max(self.level(w))));
    }
}

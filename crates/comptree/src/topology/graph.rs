//! Explicit graphs.
use std::ops::Range;

use mser3d_shape::Graph;

use super::{Topology, split_evenly};

impl Topology for Graph {
    fn len(&self) -> usize {
        Graph::len(self)
    }

    fn split(&self, parts: usize) -> Vec<Range<usize>> {
        split_evenly(Graph::len(self), 1, parts)
    }

    fn visit(&self, range: Range<usize>, mut f: impl FnMut(u32, &[u32])) {
        for v in range {
            f(v as u32, self.neighbours(v as u32));
        }
    }
}

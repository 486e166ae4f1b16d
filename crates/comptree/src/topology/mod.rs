//! Who is whose neighbour: explicit graphs, dense grids, and voxel grids with links.
mod dense;
mod graph;
mod voxels;

use std::ops::Range;

pub(crate) use dense::DenseGrid;
pub(crate) use voxels::LinkedVoxels;

use crate::GreyValue;

/// Neighbourhoods of the vertices `0..len()`, visited in ranges that can go to different threads.
pub(crate) trait Topology: Sync {
    fn len(&self) -> usize;

    /// Ranges that cover all vertices in order, about `parts` of them.
    fn split(&self, parts: usize) -> Vec<Range<usize>>;

    /// Calls `f` with each vertex of a range from [`split`](Self::split) and its neighbours.
    fn visit(&self, range: Range<usize>, f: impl FnMut(u32, &[u32]));

    /// Calls `f` with each vertex v of the range, ascending, and the least of v and its neighbours by
    /// value (`DOWN`: the greatest), of equal ones the one with the smallest number.
    fn descend<V: GreyValue, const DOWN: bool>(
        &self,
        range: Range<usize>,
        values: &[V],
        mut f: impl FnMut(u32, u32),
    ) {
        self.visit(range, |v, neighbours| {
            let mut best = v;
            for &w in neighbours {
                let (x, least) = (values[w as usize], values[best as usize]);
                if lower::<V, DOWN>(x, least) || x == least && w < best {
                    best = w;
                }
            }
            f(v, best);
        });
    }

    /// Calls `f` with each edge (v, w), v < w and v in the range, whose ends have different labels.
    fn boundary(&self, range: Range<usize>, labels: &[u32], mut f: impl FnMut(u32, u32)) {
        self.visit(range, |v, neighbours| {
            for &w in neighbours {
                if v < w && labels[v as usize] != labels[w as usize] {
                    f(v, w);
                }
            }
        });
    }
}

/// Whether `a` comes strictly before `b`.
#[inline(always)]
pub(crate) fn lower<V: GreyValue, const DOWN: bool>(a: V, b: V) -> bool {
    if DOWN { a > b } else { a < b }
}

/// `0..n` in about `parts` ranges that start at multiples of `unit`.
pub(crate) fn split_evenly(n: usize, unit: usize, parts: usize) -> Vec<Range<usize>> {
    let unit = unit.max(1);
    let step = n.div_ceil(unit).div_ceil(parts.max(1)).max(1) * unit;
    (0..n).step_by(step).map(|start| start..(start + step).min(n)).collect()
}

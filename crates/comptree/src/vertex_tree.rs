use mser3d_shape::DisjointSets;

use crate::edge_tree::{ascending, check_edges};
use crate::layout::{RawTree, canonical};
use crate::order::NONE;
use crate::{ComponentTree, Polarity, TreeError, Volumes};

impl ComponentTree {
    /// The tree of a graph with a weight on each vertex (min-tree; for superlevel sets max-tree): its
    /// nodes are the components of the vertices with `weight <= level` (`>= level`).
    ///
    /// An edge enters when both its ends are in: at the larger of the two weights. `volumes` is one
    /// number for all vertices or a slice with one for each.
    ///
    /// # Errors
    /// NaN weights, vertices out of range, sizes that differ, volumes that are negative or not finite,
    /// 2^32 - 1 vertices or edges.
    pub fn from_vertex_weights<'v>(
        edges: &[[u32; 2]],
        weights: &[f64],
        volumes: impl Into<Volumes<'v>>,
        polarity: Polarity,
    ) -> Result<Self, TreeError> {
        let volumes = volumes.into();
        check_edges(weights.len(), edges)?;
        volumes.check(weights.len())?;
        let levels = polarity.orient_all(weights, "vertex")?;
        let mut nodes = canonical(merge_tree(edges, levels));
        nodes.altitudes.iter_mut().for_each(|a| *a = polarity.orient(*a));
        Ok(Self::assemble(nodes, volumes, polarity))
    }
}

/// Kruskal's algorithm on edges of level max(f(u), f(v)). A raw node is a vertex: the component at its
/// entry.
fn merge_tree(edges: &[[u32; 2]], levels: Vec<f64>) -> RawTree {
    let n = levels.len() as u32;
    let entry: Vec<f64> = edges.iter().map(|&[u, v]| levels[u as usize].max(levels[v as usize])).collect();
    let mut sets = DisjointSets::new(n as usize);
    let mut top: Vec<u32> = (0..n).collect();
    let mut parents = vec![NONE; n as usize];
    for edge in ascending(&entry) {
        let [u, v] = edges[edge as usize];
        let Some((stays, goes)) = sets.union(u, v) else { continue };
        let (a, b) = (top[stays as usize], top[goes as usize]);
        // The end that enters last is already on top of its component, at the level of the edge.
        let (below, above) = if levels[a as usize] <= levels[b as usize] { (a, b) } else { (b, a) };
        parents[below as usize] = above;
        top[stays as usize] = above;
    }
    RawTree { parents, levels, node_of: (0..n).collect() }
}

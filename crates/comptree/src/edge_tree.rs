use mser3d_shape::DisjointSets;

use crate::layout::{RawTree, canonical};
use crate::order::{NONE, check_count};
use crate::{ComponentTree, Polarity, TreeError, Volumes};

impl ComponentTree {
    /// The tree of a graph of `n` vertices with weighted edges (quasi-flat zones): its nodes are the
    /// components of the edges with `weight <= level` (`>= level` for superlevel sets).
    ///
    /// Loops are ignored; of parallel edges the first to enter counts. `volumes` is one number for all
    /// vertices or a slice with one for each.
    ///
    /// # Errors
    /// NaN weights, vertices out of range, sizes that differ, volumes that are negative or not finite,
    /// 2^32 - 1 vertices or edges.
    pub fn from_edge_weights<'v>(
        n: usize,
        edges: &[[u32; 2]],
        weights: &[f64],
        volumes: impl Into<Volumes<'v>>,
        polarity: Polarity,
    ) -> Result<Self, TreeError> {
        let volumes = volumes.into();
        check_edges(n, edges)?;
        volumes.check(n)?;
        if weights.len() != edges.len() {
            let (found, expected) = (weights.len(), edges.len());
            return Err(TreeError::SizeMismatch { what: "weights of edges", found, expected });
        }
        let levels = polarity.orient_all(weights, "edge")?;
        let mut nodes = canonical(merge_tree(n, edges, &levels));
        nodes.altitudes.iter_mut().for_each(|a| *a = polarity.orient(*a));
        Ok(Self::assemble(nodes, volumes, polarity))
    }
}

pub(crate) fn check_edges(n: usize, edges: &[[u32; 2]]) -> Result<(), TreeError> {
    check_count("vertices", n)?;
    check_count("edges", edges.len())?;
    for (edge, pair) in edges.iter().enumerate() {
        if let Some(&index) = pair.iter().find(|&&v| v as usize >= n) {
            return Err(TreeError::IndexOutOfRange { edge, index, vertices: n });
        }
    }
    Ok(())
}

/// Edge numbers in ascending order of level, equal levels by number.
pub(crate) fn ascending(levels: &[f64]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..levels.len() as u32).collect();
    order.sort_unstable_by(|&a, &b| levels[a as usize].total_cmp(&levels[b as usize]).then(a.cmp(&b)));
    order
}

/// Kruskal's algorithm: one raw node for each edge of the minimum spanning forest.
fn merge_tree(n: usize, edges: &[[u32; 2]], levels: &[f64]) -> RawTree {
    let mut sets = DisjointSets::new(n);
    let mut top = vec![NONE; n];
    let mut raw = RawTree { parents: Vec::new(), levels: Vec::new(), node_of: vec![NONE; n] };
    for edge in ascending(levels) {
        let [u, v] = edges[edge as usize];
        let Some((stays, goes)) = sets.union(u, v) else { continue };
        let node = raw.parents.len() as u32;
        for part in [stays, goes] {
            // A set without a node is a single vertex, its own representative.
            match top[part as usize] {
                NONE => raw.node_of[part as usize] = node,
                below => raw.parents[below as usize] = node,
            }
        }
        top[stays as usize] = node;
        raw.parents.push(NONE);
        raw.levels.push(levels[edge as usize]);
    }
    for v in 0..n {
        if raw.node_of[v] == NONE {
            raw.node_of[v] = raw.parents.len() as u32;
            raw.parents.push(NONE);
            raw.levels.push(f64::NEG_INFINITY);
        }
    }
    raw
}

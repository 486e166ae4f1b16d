//! Trees of weights on edges: quasi-flat zones (Meyer 1998), the paper's edge-weighted trees (section 4.1).
use mser3d_shape::{Connectivity, VoxelGrid};

use super::edge_filtration::EdgeFiltration;
use super::{build, check_edges, parts};
use crate::topology::{DenseGrid, LinkedVoxels, Topology};
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
    /// 2^31 vertices or 2^32 - 1 edges.
    pub fn from_edge_weights<'v>(
        n: usize,
        edges: &[[u32; 2]],
        weights: &[f64],
        volumes: impl Into<Volumes<'v>>,
        polarity: Polarity,
    ) -> Result<Self, TreeError> {
        check_edges(n, edges)?;
        build(&EdgeFiltration::of_list(n, edges, weights, polarity)?, volumes.into(), polarity)
    }

    /// The tree of an image or a volume with a weight for each pair of neighbours, given by a function
    /// of their numbers (x fastest, the smaller first): so that vector-valued volumes have trees too. The
    /// function is called several times for an edge and must always give the same weight. No graph is made.
    /// In a grid of one slice `Six` means the 4 neighbours of a pixel, and `TwentySix` its 8.
    ///
    /// Cost: with cheap weights about 250 ns a voxel on one core, 80 bytes a voxel at the peak.
    ///
    /// ```
    /// use mser3d_comptree::shape::Connectivity;
    /// use mser3d_comptree::{ComponentTree, Polarity};
    ///
    /// let colours = [[0.0, 0.1], [0.0, 0.2], [0.9, 0.2]];
    /// let distance = |u: u32, v: u32| {
    ///     let [a, b] = [colours[u as usize], colours[v as usize]];
    ///     f64::hypot(a[0] - b[0], a[1] - b[1])
    /// };
    /// let tree = ComponentTree::from_grid_edges([3, 1, 1], Connectivity::Six, distance, 1.0, Polarity::Sublevel)?;
    /// assert_eq!(tree.vertices(0), [0, 1]);
    /// # Ok::<(), mser3d_comptree::TreeError>(())
    /// ```
    ///
    /// # Errors
    /// NaN weights, bad volumes, 2^31 voxels.
    pub fn from_grid_edges<'v>(
        dims: [usize; 3],
        connectivity: Connectivity,
        weight: impl Fn(u32, u32) -> f64 + Sync,
        volumes: impl Into<Volumes<'v>>,
        polarity: Polarity,
    ) -> Result<Self, TreeError> {
        edge_tree(&DenseGrid::new(dims, connectivity)?, weight, volumes.into(), polarity)
    }

    /// The tree of a solid with a weight for each pair of linked voxels, given by a function of their
    /// numbers, the smaller first: heat kernels 1/H_t(u, v), for example. The function is called several
    /// times for an edge and must always give the same weight.
    ///
    /// # Errors
    /// As [`from_grid_edges`](Self::from_grid_edges); [`TreeError::DiagonalsUnknown`] when 26 neighbours
    /// are asked of a grid without diagonal links.
    pub fn from_voxel_grid_edges<'v>(
        grid: &VoxelGrid,
        connectivity: Connectivity,
        weight: impl Fn(u32, u32) -> f64 + Sync,
        volumes: impl Into<Volumes<'v>>,
        polarity: Polarity,
    ) -> Result<Self, TreeError> {
        edge_tree(&LinkedVoxels::new(grid, connectivity)?, weight, volumes.into(), polarity)
    }
}

fn edge_tree<T: Topology>(
    topology: &T,
    weight: impl Fn(u32, u32) -> f64 + Sync,
    volumes: Volumes<'_>,
    polarity: Polarity,
) -> Result<ComponentTree, TreeError> {
    let filtration = EdgeFiltration::of_function(topology, weight, polarity, parts(topology.len()))?;
    build(&filtration, volumes, polarity)
}

//! Trees of weights on vertices: min-trees and max-trees (Salembier et al. 1998).
use mser3d_shape::{BitGrid, Connectivity, Frame, Graph, VoxelGrid};

use super::filtration::VertexFiltration;
use super::{build, check_edges, check_limit};
use crate::topology::{DenseGrid, LinkedVoxels, Topology};
use crate::{ComponentTree, GreyValue, Polarity, TreeError, Volumes};

impl ComponentTree {
    /// The tree of a graph with a weight on each vertex (min-tree; for superlevel sets max-tree): its
    /// nodes are the components of the vertices with `weight <= level` (`>= level`).
    ///
    /// An edge enters when both its ends are in: at the larger of the two weights. `volumes` is one
    /// number for all vertices or a slice with one for each.
    ///
    /// # Errors
    /// NaN weights, vertices out of range, sizes that differ, volumes that are negative or not finite,
    /// 2^31 vertices or 2^32 - 1 edges.
    pub fn from_vertex_weights<'v, V: GreyValue>(
        edges: &[[u32; 2]],
        weights: &[V],
        volumes: impl Into<Volumes<'v>>,
        polarity: Polarity,
    ) -> Result<Self, TreeError> {
        check_limit("vertices", weights.len() as u128)?;
        check_edges(weights.len(), edges)?;
        let graph = Graph::from_edges(weights.len(), edges)?;
        vertex_tree(&graph, weights, volumes.into(), polarity)
    }

    /// As [`from_vertex_weights`](Self::from_vertex_weights), of a graph that is there already.
    ///
    /// # Errors
    /// As [`from_vertex_weights`](Self::from_vertex_weights).
    pub fn from_graph<'v, V: GreyValue>(
        graph: &Graph,
        weights: &[V],
        volumes: impl Into<Volumes<'v>>,
        polarity: Polarity,
    ) -> Result<Self, TreeError> {
        vertex_tree(graph, weights, volumes.into(), polarity)
    }

    /// The tree of an image (`dims = [width, height, 1]`) or a volume with a value for each of its
    /// voxels, x fastest. No graph is made.
    ///
    /// In a grid of one slice `Six` means the 4 neighbours of a pixel, and `TwentySix` its 8.
    ///
    /// Vertices are counted into bins by level, so that grey values of few bits cost no sorting.
    ///
    /// Cost: about 35 ns a voxel on one core, of integers of one or two bytes 20; 20 bytes a voxel at the peak beyond
    /// the values.
    ///
    /// ```
    /// use mser3d_comptree::shape::Connectivity::{Six, TwentySix};
    /// use mser3d_comptree::{ComponentTree, Polarity};
    ///
    /// let image: [u8; 6] = [7, 0, 7,
    ///                       0, 7, 7];
    /// let four = ComponentTree::from_grid([3, 2, 1], Six, &image, 1.0, Polarity::Sublevel)?;
    /// let eight = ComponentTree::from_grid([3, 2, 1], TwentySix, &image, 1.0, Polarity::Sublevel)?;
    /// assert_eq!((four.len(), eight.len()), (3, 2)); // the zeros touch at their corners
    /// # Ok::<(), mser3d_comptree::TreeError>(())
    /// ```
    ///
    /// # Errors
    /// NaN values, sizes that differ, bad volumes, 2^31 voxels.
    pub fn from_grid<'v, V: GreyValue>(
        dims: [usize; 3],
        connectivity: Connectivity,
        values: &[V],
        volumes: impl Into<Volumes<'v>>,
        polarity: Polarity,
    ) -> Result<Self, TreeError> {
        vertex_tree(&DenseGrid::new(dims, connectivity)?, values, volumes.into(), polarity)
    }

    /// The tree of a solid with a value for each occupied voxel, in the order of their numbers.
    /// Only linked voxels are neighbours. No graph is made.
    ///
    /// # Errors
    /// As [`from_grid`](Self::from_grid); [`TreeError::DiagonalsUnknown`] when 26 neighbours are asked of
    /// a grid without diagonal links.
    pub fn from_voxel_grid<'v, V: GreyValue>(
        grid: &VoxelGrid,
        connectivity: Connectivity,
        values: &[V],
        volumes: impl Into<Volumes<'v>>,
        polarity: Polarity,
    ) -> Result<Self, TreeError> {
        vertex_tree(&LinkedVoxels::new(grid, connectivity)?, values, volumes.into(), polarity)
    }

    /// The tree of the voxels of a mask with a value for each of them, x fastest; an empty mask gives
    /// the empty tree.
    ///
    /// # Errors
    /// As [`from_grid`](Self::from_grid).
    pub fn from_mask<'v, V: GreyValue>(
        mask: &BitGrid,
        connectivity: Connectivity,
        values: &[V],
        volumes: impl Into<Volumes<'v>>,
        polarity: Polarity,
    ) -> Result<Self, TreeError> {
        let frame = Frame::new(mask.dims(), [0.0; 3], [1.0; 3])?;
        let grid = VoxelGrid::solid(frame, mask.clone())?;
        Self::from_voxel_grid(&grid, connectivity, values, volumes, polarity)
    }
}

fn vertex_tree<T: Topology, V: GreyValue>(
    topology: &T,
    values: &[V],
    volumes: Volumes<'_>,
    polarity: Polarity,
) -> Result<ComponentTree, TreeError> {
    build(&VertexFiltration::new(topology, values, polarity)?, volumes, polarity)
}

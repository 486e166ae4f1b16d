//! Trees of petgraph's graphs, and trees as such graphs.
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::{EdgeRef, IntoEdgeReferences, NodeCompactIndexable};

use crate::tree::NONE;
use crate::{ComponentTree, Polarity, TreeError, Volumes};

impl ComponentTree {
    /// The tree of any petgraph graph with weights on its edges, directions ignored: vertex i is the
    /// node whose index in the graph is i. See [`ComponentTree::from_edge_weights`].
    ///
    /// ```
    /// use mser3d_comptree::{ComponentTree, Polarity};
    /// use petgraph::graph::UnGraph;
    ///
    /// let graph = UnGraph::<(), f64>::from_edges([(0, 1, 0.5), (1, 2, 2.0)]);
    /// let tree = ComponentTree::from_petgraph_edges(&graph, |e| *e.weight(), 1.0, Polarity::Sublevel)?;
    /// assert_eq!(tree.altitudes(), [0.5, 2.0]);
    /// # Ok::<(), mser3d_comptree::TreeError>(())
    /// ```
    ///
    /// # Errors
    /// As [`ComponentTree::from_edge_weights`].
    pub fn from_petgraph_edges<'v, G>(
        graph: G,
        weight: impl FnMut(G::EdgeRef) -> f64,
        volumes: impl Into<Volumes<'v>>,
        polarity: Polarity,
    ) -> Result<Self, TreeError>
    where
        G: IntoEdgeReferences + NodeCompactIndexable,
    {
        crate::build::check_limit("vertices", graph.node_count() as u128)?;
        let weights: Vec<f64> = graph.edge_references().map(weight).collect();
        Self::from_edge_weights(graph.node_count(), &edges(graph), &weights, volumes, polarity)
    }

    /// The tree of any petgraph graph with weights on its vertices, directions ignored: vertex i is the
    /// node whose index in the graph is i. See [`ComponentTree::from_vertex_weights`].
    ///
    /// # Errors
    /// As [`ComponentTree::from_vertex_weights`].
    pub fn from_petgraph_vertices<'v, G>(
        graph: G,
        mut weight: impl FnMut(G::NodeId) -> f64,
        volumes: impl Into<Volumes<'v>>,
        polarity: Polarity,
    ) -> Result<Self, TreeError>
    where
        G: IntoEdgeReferences + NodeCompactIndexable,
    {
        crate::build::check_limit("vertices", graph.node_count() as u128)?;
        let weights: Vec<f64> = (0..graph.node_count()).map(|i| weight(graph.from_index(i))).collect();
        Self::from_vertex_weights(&edges(graph), &weights, volumes, polarity)
    }

    /// The tree as a petgraph graph: node i is node i, weighted by its altitude, with an edge to its
    /// parent.
    pub fn to_petgraph(&self) -> DiGraph<f64, ()> {
        let mut graph = DiGraph::with_capacity(self.len(), self.len());
        self.altitudes.iter().for_each(|&altitude| _ = graph.add_node(altitude));
        for (node, &parent) in self.parents.iter().enumerate().filter(|(_, parent)| **parent != NONE) {
            graph.add_edge(NodeIndex::new(node), NodeIndex::new(parent as usize), ());
        }
        graph
    }
}

fn edges<G: IntoEdgeReferences + NodeCompactIndexable>(graph: G) -> Vec<[u32; 2]> {
    let number = |node| graph.to_index(node) as u32;
    graph.edge_references().map(|e| [number(e.source()), number(e.target())]).collect()
}

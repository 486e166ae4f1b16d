//! The component tree (Jones 1999; max-tree: Salembier et al. 1998), section 4.1 of the paper.
use std::ops::Range;
use std::sync::OnceLock;

use crate::{Polarity, Volumes};

/// No node: the parent of a root.
pub(crate) const NONE: u32 = u32::MAX;

/// The components of all level sets of a weighted graph, ordered by inclusion.
///
/// A node is a connected component together with the *altitude* at which it comes into being: the
/// smallest level (for [`Polarity::Superlevel`] the largest) at which this very set of vertices is a
/// component. Vertices hang below the nodes as leaves: vertex v belongs to [`node_of(v)`](Self::node_of)
/// and to all its ancestors.
///
/// Nodes are numbered in postorder: children before parents, the descendants of a node directly before
/// it, siblings by their smallest vertex. So the descendants of a node are a range of numbers and its
/// vertices a slice of one permutation.
///
/// With vertex weights a vertex enters at its own weight, alone if it is a local minimum. With edge
/// weights two components merge at the weight of the lightest edge between them. A single vertex exists
/// at any level and is not a node, unless it has no edges: then it is a root of altitude -inf (+inf for
/// superlevel sets).
///
/// Memory: 12 bytes a node and 4 a vertex, with 4 more a node unless each has just one vertex; 4 more each
/// once slices and [`node_of`](Self::node_of) are used, and 8 a node with volumes that differ.
#[derive(Clone, Debug)]
pub struct ComponentTree {
    pub(crate) polarity: Polarity,
    pub(crate) parents: Vec<u32>,
    pub(crate) altitudes: Vec<f64>,
    /// End of each node's slice of `vertices`; empty if each has one vertex of its own.
    ends: Vec<u32>,
    /// All vertices by their node, ascending in each.
    pub(crate) vertices: Vec<u32>,
    pub(crate) volumes: NodeVolumes,
    /// The smallest descendant of each node, itself included.
    first_descendants: OnceLock<Vec<u32>>,
    node_of: OnceLock<Vec<u32>>,
}

/// Volumes of the nodes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum NodeVolumes {
    /// The number of vertices times this.
    Uniform(f64),
    Each(Vec<f64>),
}

/// A tree as plain lists, for files and other programs.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeLists {
    /// The parent of each node; `u32::MAX` for a root.
    pub parents: Vec<u32>,
    /// The altitude of each node.
    pub altitudes: Vec<f64>,
    /// The volume of each node.
    pub volumes: Vec<f64>,
    /// The smallest node that contains each vertex.
    pub node_of: Vec<u32>,
}

/// What a builder hands over: nodes in postorder.
pub(crate) struct Nodes {
    pub parents: Vec<u32>,
    pub altitudes: Vec<f64>,
    /// May be empty if each node has one vertex of its own.
    pub ends: Vec<u32>,
    pub vertices: Vec<u32>,
}

impl ComponentTree {
    /// Wraps the nodes and sums volumes, each in the fixed order of its slice.
    pub(crate) fn assemble(nodes: Nodes, volumes: Volumes<'_>, polarity: Polarity) -> Self {
        let Nodes { parents, altitudes, mut ends, vertices } = nodes;
        if ends.len() == vertices.len() && ends.iter().copied().eq(1..=ends.len() as u32) {
            ends = Vec::new();
        }
        let mut tree = Self {
            polarity,
            parents,
            altitudes,
            ends,
            vertices,
            volumes: NodeVolumes::Uniform(1.0),
            first_descendants: OnceLock::new(),
            node_of: OnceLock::new(),
        };
        tree.volumes = match volumes {
            Volumes::Uniform(volume) => NodeVolumes::Uniform(volume),
            Volumes::Each(volumes) => {
                NodeVolumes::Each(tree.accumulate(|v| volumes[v as usize], |sum, more| *sum += more))
            }
        };
        tree
    }

    /// Which way the level moves.
    pub fn polarity(&self) -> Polarity {
        self.polarity
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.parents.len()
    }

    /// Whether there are no nodes, that is, no vertices.
    pub fn is_empty(&self) -> bool {
        self.parents.is_empty()
    }

    /// Number of vertices of the graph.
    pub fn vertex_count(&self) -> usize {
        self.vertices.len()
    }

    /// The weight at which the node comes into being, as it was given (not negated for superlevel sets).
    #[inline]
    pub fn altitude(&self, node: u32) -> f64 {
        self.altitudes[node as usize]
    }

    /// All altitudes, by node.
    pub fn altitudes(&self) -> &[f64] {
        &self.altitudes
    }

    /// The same components, with all altitudes times a factor above 0: weights in another unit.
    pub fn scaled(&self, factor: f64) -> Self {
        let altitudes = self.altitudes.iter().map(|altitude| factor * altitude).collect();
        Self { altitudes, ..self.clone() }
    }

    /// The smallest component that properly contains the node; `None` for a root.
    #[inline]
    pub fn parent(&self, node: u32) -> Option<u32> {
        let parent = self.parents[node as usize];
        (parent != NONE).then_some(parent)
    }

    /// The sum of the volumes of the node's vertices.
    #[inline]
    pub fn volume(&self, node: u32) -> f64 {
        match &self.volumes {
            NodeVolumes::Uniform(volume) => self.slice(node).len() as f64 * volume,
            NodeVolumes::Each(volumes) => volumes[node as usize],
        }
    }

    /// The volume of all vertices: the sum over the roots.
    pub fn total_volume(&self) -> f64 {
        self.roots().map(|root| self.volume(root)).sum()
    }

    /// The roots: one for each component of the graph, by descending number.
    pub fn roots(&self) -> Siblings<'_> {
        let last = self.len() as u32;
        Siblings { tree: self, first: 0, end: last }
    }

    /// The nodes without children, ascending: the local minima (maxima for superlevel sets) of weights on
    /// vertices.
    ///
    /// ```
    /// # use mser3d_comptree::{ComponentTree, Polarity};
    /// let path = [[0, 1], [1, 2], [2, 3], [3, 4]];
    /// let tree = ComponentTree::from_vertex_weights(&path, &[1.0, 5.0, 2.0, 2.0, 9.0], 1.0, Polarity::Sublevel)?;
    /// let minima: Vec<&[u32]> = tree.leaves().map(|leaf| tree.vertices(leaf)).collect();
    /// assert_eq!(minima, [&[0][..], &[2, 3]]);
    /// # Ok::<(), mser3d_comptree::TreeError>(())
    /// ```
    pub fn leaves(&self) -> impl Iterator<Item = u32> + '_ {
        self.first_descendants().iter().zip(0..).filter(|(first, node)| *first == node).map(|(_, node)| node)
    }

    /// The children of a node, by descending number.
    pub fn children(&self, node: u32) -> Siblings<'_> {
        Siblings { tree: self, first: self.first_descendants()[node as usize], end: node }
    }

    /// The node and all that lie below it.
    #[inline]
    pub fn descendants(&self, node: u32) -> Range<u32> {
        self.first_descendants()[node as usize]..node + 1
    }

    /// Whether `ancestor` is `node` or contains it.
    #[inline]
    pub fn contains(&self, ancestor: u32, node: u32) -> bool {
        self.descendants(ancestor).contains(&node)
    }

    /// The vertices of a node, its descendants' first.
    #[inline]
    pub fn vertices(&self, node: u32) -> &[u32] {
        &self.vertices[self.slice(node)]
    }

    /// The vertices of a node that none of its children has, ascending.
    #[inline]
    pub fn own_vertices(&self, node: u32) -> &[u32] {
        &self.vertices[self.start(node)..self.end(node)]
    }

    /// The permutation of the vertices that all nodes are slices of.
    pub fn permutation(&self) -> &[u32] {
        &self.vertices
    }

    /// The same without the rest of the tree.
    pub fn into_permutation(self) -> Vec<u32> {
        self.vertices
    }

    /// The tree as plain lists.
    pub fn into_lists(mut self) -> NodeLists {
        self.nodes_of_vertices();
        let node_of = self.node_of.take().unwrap_or_default();
        let volumes = match std::mem::replace(&mut self.volumes, NodeVolumes::Uniform(0.0)) {
            NodeVolumes::Each(volumes) => volumes,
            uniform @ NodeVolumes::Uniform(_) => {
                self.volumes = uniform;
                (0..self.len() as u32).map(|node| self.volume(node)).collect()
            }
        };
        NodeLists { parents: self.parents, altitudes: self.altitudes, volumes, node_of }
    }

    /// The vertex of a node that enters first, of several the smallest.
    ///
    /// ```
    /// # use mser3d_comptree::{ComponentTree, Polarity};
    /// let path = [[0, 1], [1, 2], [2, 3]];
    /// let tree = ComponentTree::from_vertex_weights(&path, &[5.0, 1.0, 3.0, 1.0], 1.0, Polarity::Sublevel)?;
    /// assert_eq!(tree.first_vertex(tree.node_of(0)), 1);
    /// # Ok::<(), mser3d_comptree::TreeError>(())
    /// ```
    pub fn first_vertex(&self, node: u32) -> u32 {
        let entered = self.descendants(node).filter_map(|below| {
            let first = *self.own_vertices(below).first()?;
            Some((self.polarity.orient(self.altitude(below)), first))
        });
        let first = entered.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        // Each node has a vertex, be it a descendant's.
        first.map_or(NONE, |(_, vertex)| vertex)
    }

    /// The smallest node that contains a vertex.
    #[inline]
    pub fn node_of(&self, vertex: u32) -> u32 {
        self.nodes_of_vertices()[vertex as usize]
    }

    /// The smallest node that contains each vertex. Computed at first use, in one pass.
    pub fn nodes_of_vertices(&self) -> &[u32] {
        self.node_of.get_or_init(|| {
            let mut node_of = vec![NONE; self.vertices.len()];
            for node in 0..self.len() as u32 {
                for &v in self.own_vertices(node) {
                    node_of[v as usize] = node;
                }
            }
            node_of
        })
    }

    /// A value for each node, gathered from its vertices in one pass: each node starts from the value
    /// of its first own vertex or child, and `join` adds the others, children first.
    ///
    /// The order is fixed, so sums have the same bits for any way the tree was built.
    ///
    /// ```
    /// # use mser3d_comptree::{ComponentTree, Polarity};
    /// let tree = ComponentTree::from_vertex_weights(&[[0, 1]], &[0.0, 1.0], 1.0, Polarity::Sublevel)?;
    /// let largest_vertex = tree.accumulate(|vertex| vertex, |most, other| *most = other.max(*most));
    /// assert_eq!(largest_vertex, [0, 1]);
    /// # Ok::<(), mser3d_comptree::TreeError>(())
    /// ```
    pub fn accumulate<T: Clone>(&self, vertex: impl Fn(u32) -> T, join: impl Fn(&mut T, T)) -> Vec<T> {
        let mut values: Vec<T> = Vec::with_capacity(self.len());
        for node in 0..self.len() as u32 {
            // Descending siblings are visited from the last; sums run over them in that order.
            let children = self.children(node).map(|child| values[child as usize].clone());
            let mut parts = children.chain(self.own_vertices(node).iter().map(|&v| vertex(v)));
            // Every node has a vertex of its own or at least two children.
            if let Some(mut value) = parts.next() {
                parts.for_each(|part| join(&mut value, part));
                values.push(value);
            }
        }
        values
    }

    /// Where the vertices of a node are in the [permutation](Self::permutation).
    #[inline]
    pub fn slice(&self, node: u32) -> Range<usize> {
        let first = self.first_descendants()[node as usize];
        self.start(first)..self.end(node)
    }

    /// Where a node's own vertices begin.
    #[inline]
    fn start(&self, node: u32) -> usize {
        if node == 0 { 0 } else { self.end(node - 1) }
    }

    /// Where a node's vertices end.
    #[inline]
    pub(crate) fn end(&self, node: u32) -> usize {
        if self.ends.is_empty() { node as usize + 1 } else { self.ends[node as usize] as usize }
    }

    #[inline]
    fn first_descendants(&self) -> &[u32] {
        self.first_descendants.get_or_init(|| {
            let mut first: Vec<u32> = (0..self.len() as u32).collect();
            for node in 0..self.len() {
                let parent = self.parents[node];
                if parent != NONE {
                    first[parent as usize] = first[parent as usize].min(first[node]);
                }
            }
            first
        })
    }
}

/// Equal trees have the same components at the same altitudes and volumes, in the same numbering.
impl PartialEq for ComponentTree {
    fn eq(&self, other: &Self) -> bool {
        self.polarity == other.polarity
            && self.parents == other.parents
            && self.altitudes == other.altitudes
            && self.ends == other.ends
            && self.vertices == other.vertices
            && self.volumes == other.volumes
    }
}

/// The children of a node or the roots of a forest, by descending number.
#[derive(Clone, Debug)]
pub struct Siblings<'a> {
    tree: &'a ComponentTree,
    first: u32,
    end: u32,
}

impl Iterator for Siblings<'_> {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        if self.end == self.first {
            return None;
        }
        let sibling = self.end - 1;
        self.end = self.tree.first_descendants()[sibling as usize];
        Some(sibling)
    }
}

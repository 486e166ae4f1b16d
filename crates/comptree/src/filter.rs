//! Simplified trees by attribute filters (Salembier et al. 1998; area opening: Vincent 1993), and components
//! at a level.
use crate::numbering::canonical;
use crate::tree::NONE;
use crate::{ComponentTree, Polarity, TreeError, Volumes};

impl ComponentTree {
    /// The tree with only the nodes for which `keep` holds, and all roots. Vertices of a removed node move to
    /// its nearest kept ancestor (the direct rule of attribute filters).
    ///
    /// `volumes` are those the tree was built with.
    ///
    /// ```
    /// use mser3d_comptree::{ComponentTree, Polarity};
    ///
    /// // An area opening: the pit of one vertex is removed, the valley of three is kept.
    /// let heights = [2.0, 9.0, 1.0, 1.0, 1.0];
    /// let path = [[0, 1], [1, 2], [2, 3], [3, 4]];
    /// let tree = ComponentTree::from_vertex_weights(&path, &heights, 1.0, Polarity::Sublevel)?;
    /// let opened = tree.filter(|node| tree.volume(node) >= 2.0, 1.0)?;
    /// assert_eq!(opened.reconstruct(), [9.0, 9.0, 1.0, 1.0, 1.0]);
    /// # Ok::<(), mser3d_comptree::TreeError>(())
    /// ```
    ///
    /// # Errors
    /// Volumes that are negative, not finite, or too few.
    pub fn filter<'v>(
        &self,
        keep: impl Fn(u32) -> bool,
        volumes: impl Into<Volumes<'v>>,
    ) -> Result<Self, TreeError> {
        let volumes = volumes.into();
        volumes.check(self.vertex_count())?;
        // The kept node that stands for each node, and kept nodes renumbered, from the roots down.
        let mut stands = vec![0u32; self.len()];
        let (mut parents, mut altitudes) = (Vec::new(), Vec::new());
        for node in (0..self.len() as u32).rev() {
            let parent = self.parents[node as usize];
            let above = if parent == NONE { NONE } else { stands[parent as usize] };
            stands[node as usize] = if above == NONE || keep(node) {
                parents.push(above);
                altitudes.push(self.altitude(node));
                parents.len() as u32 - 1
            } else {
                above
            };
        }
        let node_of = self.nodes_of_vertices().iter().map(|&node| stands[node as usize]).collect();
        Ok(Self::assemble(canonical(&parents, &altitudes, node_of), volumes, self.polarity()))
    }

    /// The altitude of each vertex's node: the weights of a vertex-weighted tree; after a
    /// [`filter`](Self::filter) the filtered image.
    pub fn reconstruct(&self) -> Vec<f64> {
        self.nodes_of_vertices().iter().map(|&node| self.altitude(node)).collect()
    }

    /// The components at a level: the largest nodes complete there, by ascending number. Vertices that
    /// have not entered belong to none.
    pub fn cut(&self, level: f64) -> Vec<u32> {
        let complete = |node: u32| match self.polarity() {
            Polarity::Sublevel => self.altitude(node) <= level,
            Polarity::Superlevel => self.altitude(node) >= level,
        };
        let grows = |node: u32| self.parent(node).is_none_or(|parent| !complete(parent));
        (0..self.len() as u32).filter(|&node| complete(node) && grows(node)).collect()
    }

    /// For each vertex the place in `nodes` of the smallest of these nodes that contains it.
    pub fn labels(&self, nodes: &[u32]) -> Vec<Option<u32>> {
        let mut label = vec![NONE; self.len()];
        for (place, &node) in nodes.iter().enumerate() {
            label[node as usize] = place as u32;
        }
        for node in (0..self.len()).rev() {
            let parent = self.parents[node];
            if label[node] == NONE && parent != NONE {
                label[node] = label[parent as usize];
            }
        }
        let found = |&node: &u32| Some(label[node as usize]).filter(|&l| l != NONE);
        self.nodes_of_vertices().iter().map(found).collect()
    }
}

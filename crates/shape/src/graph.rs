use crate::ShapeError;

/// An undirected graph in compressed rows: the neighbours of each vertex, ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Graph {
    offsets: Vec<usize>,
    neighbours: Vec<u32>,
}

impl Graph {
    /// The graph of `n` vertices with these edges. Loops are dropped, and an edge given twice counts once.
    ///
    /// # Errors
    /// [`ShapeError::IndexOutOfRange`] when an edge names a vertex `>= n`.
    pub fn from_edges(n: usize, edges: &[[u32; 2]]) -> Result<Self, ShapeError> {
        let mut offsets = vec![0usize; n + 1];
        for (number, edge) in edges.iter().enumerate() {
            for &index in edge {
                if index as usize >= n {
                    return Err(ShapeError::IndexOutOfRange { element: "edge", number, index, vertices: n });
                }
            }
            if edge[0] != edge[1] {
                offsets[edge[0] as usize + 1] += 1;
                offsets[edge[1] as usize + 1] += 1;
            }
        }
        for v in 0..n {
            offsets[v + 1] += offsets[v];
        }
        let mut next = offsets.clone();
        let mut neighbours = vec![0u32; offsets[n]];
        for &[u, v] in edges.iter().filter(|e| e[0] != e[1]) {
            for (from, to) in [(u, v), (v, u)] {
                neighbours[next[from as usize]] = to;
                next[from as usize] += 1;
            }
        }
        // Sort each row and drop repetitions, compacting in place.
        let mut end = 0;
        for v in 0..n {
            let (start, stop) = (offsets[v], offsets[v + 1]);
            offsets[v] = end;
            neighbours[start..stop].sort_unstable();
            let mut last = None;
            for at in start..stop {
                let u = neighbours[at];
                if last != Some(u) {
                    neighbours[end] = u;
                    end += 1;
                    last = Some(u);
                }
            }
        }
        offsets[n] = end;
        neighbours.truncate(end);
        Ok(Self { offsets, neighbours })
    }

    /// The graph of rows of neighbours, ascending, of which each tells of both ends of its edges; and where they begin.
    pub(crate) fn from_rows(offsets: Vec<usize>, neighbours: Vec<u32>) -> Self {
        Self { offsets, neighbours }
    }

    /// Where the neighbours of each vertex begin and the last ones end, and all neighbours, one vertex after the other.
    pub fn into_rows(self) -> (Vec<usize>, Vec<u32>) {
        (self.offsets, self.neighbours)
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Whether there are no vertices.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of edges.
    pub fn edge_count(&self) -> usize {
        self.neighbours.len() / 2
    }

    /// The neighbours of a vertex, ascending.
    #[inline]
    pub fn neighbours(&self, vertex: u32) -> &[u32] {
        &self.neighbours[self.offsets[vertex as usize]..self.offsets[vertex as usize + 1]]
    }

    /// Each edge once as `[u, v]` with `u < v`, in ascending order.
    pub fn edges(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        (0..self.len() as u32)
            .flat_map(move |u| self.neighbours(u).iter().filter(move |&&v| v > u).map(move |&v| [u, v]))
    }

    /// The connected components.
    pub fn components(&self) -> Components {
        let mut labels = vec![u32::MAX; self.len()];
        let (mut sizes, mut stack) = (Vec::new(), Vec::new());
        for seed in 0..self.len() as u32 {
            if labels[seed as usize] != u32::MAX {
                continue;
            }
            let label = sizes.len() as u32;
            labels[seed as usize] = label;
            stack.push(seed);
            let mut size = 0;
            while let Some(u) = stack.pop() {
                size += 1;
                for &v in self.neighbours(u) {
                    if labels[v as usize] == u32::MAX {
                        labels[v as usize] = label;
                        stack.push(v);
                    }
                }
            }
            sizes.push(size);
        }
        Components { labels, sizes }
    }
}

/// Connected components, numbered by their first vertex.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Components {
    /// The component of each vertex.
    pub labels: Vec<u32>,
    /// Vertices in each component.
    pub sizes: Vec<usize>,
}

impl Components {
    /// Number of components.
    pub fn len(&self) -> usize {
        self.sizes.len()
    }

    /// Whether there are no components, that is, no vertices.
    pub fn is_empty(&self) -> bool {
        self.sizes.is_empty()
    }

    /// The component with most vertices; the first of several.
    pub fn largest(&self) -> Option<u32> {
        (0..self.sizes.len()).rev().max_by_key(|&c| self.sizes[c]).map(|c| c as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_sorted_and_free_of_loops_and_repetitions() {
        let graph = Graph::from_edges(4, &[[2, 0], [0, 1], [1, 0], [3, 3], [0, 2]]).unwrap();
        assert_eq!(graph.neighbours(0), [1, 2]);
        assert_eq!(graph.edges().collect::<Vec<_>>(), [[0, 1], [0, 2]]);
        assert_eq!(graph.edge_count(), 2);
        assert!(graph.neighbours(3).is_empty());
    }

    #[test]
    fn components_are_numbered_by_first_vertex_and_the_first_largest_wins() {
        let graph = Graph::from_edges(6, &[[1, 3], [2, 4]]).unwrap();
        let parts = graph.components();
        assert_eq!(parts.labels, [0, 1, 2, 1, 2, 3]);
        assert_eq!(parts.sizes, [1, 2, 2, 1]);
        assert_eq!(parts.largest(), Some(1));
    }

    #[test]
    fn an_edge_to_nowhere_is_named() {
        let error = Graph::from_edges(2, &[[0, 1], [1, 2]]).unwrap_err();
        assert_eq!(error.to_string(), "edge 1 names vertex 2, but there are 2 vertices (numbered from 0)");
    }
}

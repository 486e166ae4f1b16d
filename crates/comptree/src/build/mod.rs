//! How trees are built: without a global sort, and on grids without a graph.
//!
//! After ExTreeM (Lukasczyk et al., *ExTreeM: Scalable Augmented Merge Tree Computation via Extremum
//! Graphs*, 2024), made exact for ties, and carried over to weights on edges:
//!
//! 1. every vertex points to its lowest neighbour by (value, number) or, with weights on edges, along its
//!    lowest edge; following these pointers gives each vertex the minimum it descends to: its *basin*
//!    ([`basins`]);
//! 2. of the edges between basins a minimum spanning forest is found ([`saddles`]), and Kruskal's algorithm
//!    joins the basins along it to *branches*: each goes from a minimum up to where it joins a branch
//!    with at least as many basins ([`branches`]). Nothing lies below more than a logarithmic number of
//!    branches;
//! 3. every vertex climbs from its basin's branch to the one that is there at the level at which it
//!    enters; branches are cut into *segments* where others join, and these into bins by level
//!    ([`segments`]);
//! 4. segments are ordered as the tree wants them ([`placement`]); so each vertex goes straight to its bin's
//!    place in the tree, where bins are sorted ([`sorted_vertices`]);
//! 5. each level of a segment becomes a node ([`nodes`]).
//!
//! What all of this reads is a [`filtration`]: the levels at which vertices and edges enter.
//!
//! Why this is exact: a vertex is joined to its minimum by a path that never rises above the level at
//! which it enters. So two vertices are connected at a level above both if and only if their minima are,
//! and for these only edges between basins matter. Of equal values the order of step 1 only decides which
//! minimum; branches of no length have no vertices and make no nodes.
mod basins;
mod branches;
mod edge_filtration;
mod edge_weights;
mod filtration;
mod nodes;
mod placement;
mod saddles;
mod scale;
mod segments;
mod sorted_vertices;
mod vertex_weights;

use branches::Branches;
use filtration::Filtration;
use sorted_vertices::SortedVertices;

use crate::{ComponentTree, Polarity, TreeError, Volumes};

/// Vertices of a tree: one bit of their numbers is needed.
const MAX_VERTICES: u128 = (1 << 31) - 1;

/// # Errors
/// [`TreeError::TooMany`].
pub(crate) fn check_limit(what: &'static str, count: u128) -> Result<(), TreeError> {
    if count > MAX_VERTICES {
        return Err(TreeError::TooMany { what, count, limit: MAX_VERTICES });
    }
    Ok(())
}

fn build<R: Filtration>(
    filtration: &R,
    volumes: Volumes<'_>,
    polarity: Polarity,
) -> Result<ComponentTree, TreeError> {
    check_limit("vertices", filtration.len() as u128)?;
    volumes.check(filtration.len())?;
    let parts = parts(filtration.len());
    let basins = basins::find(filtration, parts);
    let saddles = saddles::find(filtration, &basins, parts);
    let births = basins.minima.iter().map(|&v| filtration.level(v)).collect();
    let branches = Branches::new(births, &saddles);
    drop(saddles);
    let joined = branches.joined();
    let mut labels = basins.labels;
    let (sorted, placement) = SortedVertices::new(filtration, &mut labels, &branches, &joined, parts);
    let nodes = nodes::write(filtration, &joined, &placement, sorted, labels);
    Ok(ComponentTree::assemble(nodes, volumes, polarity))
}

/// Into how many parts work is divided; small trees are not worth a second thread.
fn parts(n: usize) -> usize {
    if n < 1 << 16 { 1 } else { rayon::current_num_threads() }
}

/// # Errors
/// Too many vertices or edges, and edges that name a vertex that is not there.
fn check_edges(n: usize, edges: &[[u32; 2]]) -> Result<(), TreeError> {
    check_limit("vertices", n as u128)?;
    if edges.len() >= u32::MAX as usize {
        let (count, limit) = (edges.len() as u128, u128::from(u32::MAX) - 1);
        return Err(TreeError::TooMany { what: "edges", count, limit });
    }
    for (edge, pair) in edges.iter().enumerate() {
        if let Some(&index) = pair.iter().find(|&&v| v as usize >= n) {
            return Err(TreeError::IndexOutOfRange { edge, index, vertices: n });
        }
    }
    Ok(())
}

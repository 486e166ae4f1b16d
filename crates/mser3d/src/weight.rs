use mser3d_comptree::{ComponentTree, Polarity};
use mser3d_descriptors::{auto_diffusivity, commute_time, inverse_heat_kernel};
use mser3d_shape::Eigenbasis;

use crate::{Body, Error, Graph, Weight};

/// The component tree of a body over a weight; `t` is the time in length^2, where the weight has one.
pub(crate) fn component_tree(
    body: &Body,
    basis: &Eigenbasis,
    weight: Weight,
    t: f64,
    polarity: Polarity,
) -> Result<ComponentTree, Error> {
    let volumes = basis.mass();
    let values = match weight {
        Weight::Heat => auto_diffusivity(basis, t)?,
        Weight::CommuteTime => commute_time(basis)?,
        Weight::HeatEdge => {
            let edges: Vec<[u32; 2]> = match body.graph() {
                Graph::Voxels { grid, connectivity } => grid.graph(*connectivity)?.edges().collect(),
                Graph::Surface { edges, .. } => edges.edges().collect(),
            };
            let weights = inverse_heat_kernel(basis, t, &edges)?;
            return Ok(ComponentTree::from_edge_weights(body.len(), &edges, &weights, volumes, polarity)?);
        }
    };
    Ok(match body.graph() {
        Graph::Voxels { grid, connectivity } => {
            ComponentTree::from_voxel_grid(grid, *connectivity, &values, volumes, polarity)?
        }
        Graph::Surface { edges, .. } => ComponentTree::from_graph(edges, &values, volumes, polarity)?,
    })
}

use mser3d_comptree::{ComponentTree, Polarity};
use mser3d_descriptors::{auto_diffusivity, commute_time, inverse_heat_kernel};
use mser3d_shape::Eigenbasis;

use crate::{Body, Error, Graph, Weight};

/// What a component tree is built over.
pub(crate) enum Values {
    Vertices(Vec<f64>),
    Edges(Vec<[u32; 2]>, Vec<f64>),
}

impl Values {
    /// A weight on a body; `t` is the time in length^2, where the weight has one.
    pub fn new(body: &Body, basis: &Eigenbasis, weight: Weight, t: f64) -> Result<Self, Error> {
        Ok(match weight {
            Weight::Heat => Self::Vertices(auto_diffusivity(basis, t)?),
            Weight::CommuteTime => Self::Vertices(commute_time(basis)?),
            Weight::HeatEdge => {
                let edges: Vec<[u32; 2]> = match body.graph() {
                    Graph::Voxels { grid, connectivity } => grid.graph(*connectivity)?.edges().collect(),
                    Graph::Surface { edges, .. } => edges.edges().collect(),
                };
                let weights = inverse_heat_kernel(basis, t, &edges)?;
                Self::Edges(edges, weights)
            }
        })
    }

    /// The component tree over them.
    pub fn tree(&self, body: &Body, volumes: &[f64], polarity: Polarity) -> Result<ComponentTree, Error> {
        Ok(match (self, body.graph()) {
            (Self::Edges(edges, weights), _) => {
                ComponentTree::from_edge_weights(body.len(), edges, weights, volumes, polarity)?
            }
            (Self::Vertices(values), Graph::Voxels { grid, connectivity }) => {
                ComponentTree::from_voxel_grid(grid, *connectivity, values, volumes, polarity)?
            }
            (Self::Vertices(values), Graph::Surface { edges, .. }) => {
                ComponentTree::from_graph(edges, values, volumes, polarity)?
            }
        })
    }
}

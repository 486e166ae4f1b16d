use mser3d_comptree::{ComponentTree, Polarity, join_levels};
use mser3d_descriptors::{auto_diffusivity, commute_time, inverse_heat_kernel};
use mser3d_shape::Eigenbasis;

use crate::{DiscreteShape, Elements, Error};

mser3d_shape::choice! {
    /// What the component tree is built on, section 4.3.
    pub enum Weight("weight") {
        /// The heat kernel H_t(v,v) of voxels or vertices: heat that stays
        ///
        /// It is high on protrusions, so its superlevel sets are searched.
        #[default]
        Heat = "heat",
        /// The commute time (eq. 6) of voxels or vertices, which has no time scale
        ///
        /// It is high on protrusions too: superlevel sets.
        Commute = "commute",
        /// 1/H_t(u,v) of neighbours, on the links or edges: where heat passes badly
        ///
        /// It is low where heat passes easily: sublevel sets.
        Edge = "edge",
    }
}

impl Weight {
    /// The polarity that finds protrusions and limbs.
    pub fn polarity(self) -> Polarity {
        match self {
            Self::Heat | Self::Commute => Polarity::Superlevel,
            Self::Edge => Polarity::Sublevel,
        }
    }

    /// Whether it depends on a time scale.
    pub fn has_time_scale(self) -> bool {
        self != Self::Commute
    }
}

/// The values of a weight on a shape: what a component tree is built over.
pub(crate) enum WeightValues {
    Vertices(Vec<f64>),
    Edges(Vec<[u32; 2]>, Vec<f64>),
}

/// Weights that differ by less, relatively, are one level. Eigenfunctions of a symmetric solid are symmetric to 1e-13,
/// and its voxels' weights lie 1e-4 apart.
const ROUNDING: f64 = 1e-9;

fn levels(mut weights: Vec<f64>) -> Vec<f64> {
    join_levels(&mut weights, ROUNDING);
    weights
}

impl WeightValues {
    /// A weight on a shape; `t` is the time in length^2, where the weight has one.
    pub fn new(shape: &DiscreteShape, basis: &Eigenbasis, weight: Weight, t: f64) -> Result<Self, Error> {
        Ok(match weight {
            Weight::Heat => Self::Vertices(levels(auto_diffusivity(basis, t)?)),
            Weight::Commute => Self::Vertices(levels(commute_time(basis)?)),
            Weight::Edge => {
                let edges: Vec<[u32; 2]> = match shape.elements() {
                    Elements::Voxels { grid, connectivity } => grid.graph(*connectivity)?.edges().collect(),
                    Elements::Vertices { edges, .. } => edges.edges().collect(),
                };
                let weights = inverse_heat_kernel(basis, t, &edges)?;
                Self::Edges(edges, levels(weights))
            }
        })
    }

    /// The component tree over them.
    pub fn tree(
        &self,
        shape: &DiscreteShape,
        volumes: &[f64],
        polarity: Polarity,
    ) -> Result<ComponentTree, Error> {
        Ok(match (self, shape.elements()) {
            (Self::Edges(edges, weights), _) => {
                ComponentTree::from_edge_weights(shape.len(), edges, weights, volumes, polarity)?
            }
            (Self::Vertices(values), Elements::Voxels { grid, connectivity }) => {
                ComponentTree::from_voxel_grid(grid, *connectivity, values, volumes, polarity)?
            }
            (Self::Vertices(values), Elements::Vertices { edges, .. }) => {
                ComponentTree::from_graph(edges, values, volumes, polarity)?
            }
        })
    }
}

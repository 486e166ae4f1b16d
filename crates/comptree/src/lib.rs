//! Component trees of weighted graphs, and their maximally stable regions.
//!
//! Take a graph whose vertices or edges carry a weight, and let a level rise: the components of what
//! lies below it appear, grow and merge. The [`ComponentTree`] records all of them. The components
//! that hardly change while the level rises are the *maximally stable* ones: the MSER of images
//! (Matas et al. 2002), the maximally stable volumes of grey-value volumes (Donoser and Bischof 2006),
//! and the volumetric features of Litman, Bronstein and Bronstein (2012), for which this crate was made.
//! Equation numbers in this documentation are those of that paper.
//!
//! What holds, for every way to build a tree:
//!
//! * **Canonical.** Equal altitudes are one node. The tree depends on the weights and the graph only,
//!   not on the order of edges, on the algorithm, or on the number of threads.
//! * **Contiguous.** The vertices of a node are one slice, and its descendants one range of nodes.
//! * **A forest** where the graph is not connected: one root for each component.
//! * NaN is an error; infinite weights are sorted like any other.
//!
//! ```
//! use mser3d_comptree::{ComponentTree, Polarity, StabilityParameters, stable_regions};
//!
//! // A path over two valleys, at heights 1 and 2, of a plain at height 9.
//! let heights = [9.0, 1.0, 1.0, 1.0, 9.0, 9.0, 9.0, 2.0, 2.0, 9.0];
//! let path: Vec<[u32; 2]> = (1..10).map(|v| [v - 1, v]).collect();
//! let tree = ComponentTree::from_vertex_weights(&path, &heights, 1.0, Polarity::Sublevel)?;
//!
//! let root = tree.roots().next().unwrap();
//! assert_eq!((tree.altitude(root), tree.volume(root)), (9.0, 10.0));
//! let valleys: Vec<&[u32]> = tree.children(root).map(|node| tree.vertices(node)).collect();
//! assert_eq!(valleys, [&[7, 8][..], &[1, 2, 3]]);
//!
//! let selection = stable_regions(&tree, &StabilityParameters::default())?;
//! let regions: Vec<&[u32]> = selection.regions.iter().map(|r| tree.vertices(r.node)).collect();
//! assert_eq!(regions, [&[1, 2, 3][..], &[7, 8]]); // largest first
//! # Ok::<(), mser3d_comptree::TreeError>(())
//! ```
//!
//! # Glossary
//!
//! * **Level**: the threshold that moves. What has a weight up to the level has *entered*.
//! * **Polarity**: which way the level moves ([`Polarity`]). Sublevel sets `{ w <= level }` grow while it
//!   rises; superlevel sets `{ w >= level }` grow while it falls.
//! * **Altitude** of a node: the level at which the component comes into being, in units of the weight. For
//!   sublevel sets that is the largest weight in it, for superlevel sets the smallest.
//! * **Altitude scale**: what differences of altitude are measured on, the weight or its logarithm
//!   ([`AltitudeScale`]). Stability, persistence and lifetime are in units of that scale.
//! * **Stability** of a component: its volume divided by the change of its volume with the level
//!   ([`StableRegion::stability`]).
//! * **Real merge**: a node at which at least two children have the minimum volume. Merges with anything
//!   smaller count as growth.
//! * **Branch** (of the windowed rule): the nodes from one real merge up to the next, in each of them the
//!   largest child. With no real merge below, it begins at half of the minimum volume, or where several
//!   children are equally large.
//! * **Lifetime** of a part: the difference of level from the start of its branch to the real merge that ends
//!   it ([`Merge::lifetime`]).
//! * **Persistence** of a component: the difference of level from its first vertex to the merge with a
//!   component that began earlier, or to the root where none did ([`ComponentTree::persistence`]). It knows
//!   no minimum volume: *every* merge counts, and the part that began first goes on through it. So an arm has
//!   a lifetime that ends at the shoulder, while the persistence of the part with the extreme weight of the
//!   whole shape reaches to the root.
//!
//! # Features
//!
//! * `petgraph`: trees of petgraph's graphs, and trees as such graphs.
//! * `serde`: parameters, reports and names of choices for serde; `schema`: their JSON Schema.
#![warn(missing_docs)]

mod ancestors;
mod attributes;
mod build;
mod ellipsoid;
mod error;
mod export;
mod filter;
mod grey_value;
mod levels;
mod msv;
mod numbering;
#[cfg(feature = "petgraph")]
mod petgraph_graphs;
mod polarity;
mod pool;
mod stability;
mod topology;
mod tree;
mod volumes;

pub use ancestors::CommonAncestors;
pub use attributes::{Bounds, Moments};
pub use ellipsoid::Ellipsoid;
pub use error::TreeError;
pub use grey_value::GreyValue;
pub use levels::join_levels;
pub use mser3d_shape as shape;
pub use mser3d_shape::InvalidParameter;
pub use msv::{Contrast, MsvParameters, maximally_stable_volumes};
#[cfg(feature = "petgraph")]
pub use petgraph;
pub use polarity::Polarity;
pub use pool::{PoolParameters, PooledRegion, TreeRegions, pool};
pub use stability::{
    AltitudeScale, Merge, Selection, SelectionReport, StabilityParameters, StabilityRule, StableRegion,
    stability, stable_regions,
};
pub use tree::{ComponentTree, NodeLists, Siblings};
pub use volumes::Volumes;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

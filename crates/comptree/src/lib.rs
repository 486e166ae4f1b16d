//! Component trees of weighted graphs, and their maximally stable regions.
//!
//! Take a graph whose vertices or edges carry a weight, and let a level rise: the components of what
//! lies below it appear, grow and merge. The [`ComponentTree`] records all of them. The components
//! that hardly change while the level rises are the *maximally stable* ones: the MSER of images
//! (Matas et al. 2002), the maximally stable volumes of grey-value volumes (Donoser and Bischof 2006),
//! and the volumetric features of Litman, Bronstein and Bronstein (2012), for which this crate was made.
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
#![warn(missing_docs)]

mod ancestors;
mod attributes;
mod build;
mod ellipsoid;
mod error;
mod export;
mod filter;
mod grey;
mod layout;
mod msv;
mod order;
mod petgraph;
mod pool;
mod stability;
mod topology;
mod tree;

pub use ancestors::CommonAncestors;
pub use attributes::{Bounds, Moments};
pub use ellipsoid::Ellipsoid;
pub use error::TreeError;
pub use grey::GreyValue;
pub use msv::{MsvParameters, maximally_stable_volumes};
pub use order::{Polarity, Volumes};
pub use pool::{PoolParameters, PooledRegion, pool};
pub use stability::{
    AltitudeScale, Merge, Mode, Selection, SelectionReport, StabilityParameters, StableRegion, stability,
    stable_regions,
};
pub use topology::Stencil;
pub use tree::{ComponentTree, Siblings};

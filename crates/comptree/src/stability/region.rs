//! Stable components, and what became of the candidates (section 4.2).

#[cfg(doc)]
use super::{StabilityRule, stability};
#[cfg(doc)]
use crate::ComponentTree;

/// A stable component.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct StableRegion {
    /// Its node in the tree.
    pub node: u32,
    /// The altitude at which it is complete, as the weights were given.
    pub altitude: f64,
    /// `s(l) = vol(l) / (d vol / d l)` (eq. 5): the volume at level l over its derivative, in units of the
    /// altitude on the chosen scale. How the derivative is taken is up to the rule:
    ///
    /// * [`StabilityRule::Windowed`]: `s(l) = vol(l) (above - below) / (vol(above) - vol(below))`, with the
    ///   ends `l - window` and `l + window` of the window clipped to the branch;
    /// * [`StabilityRule::Paper`]: `s = vol (l' - l) / (vol' - vol)`, with the parent's l' and vol'.
    ///
    /// Infinite where the volume does not change between the two levels: nothing is more stable. NaN where it
    /// is not measured: in [`StabilityRule::Baseline`]. ([`stability`], which answers for all nodes, also
    /// gives NaN for roots in [`StabilityRule::Paper`], as they have no parent, and for nodes too small for a
    /// branch.) For [`maximally_stable_volumes`](crate::maximally_stable_volumes) it is 1 / VLFeat's
    /// variation.
    pub stability: f64,
    /// How long the part that the region belongs to stays on its own: from its first vertex to the merge
    /// with a component that began earlier, in units of the altitude on the chosen scale
    /// ([`ComponentTree::persistence`]). Parts that joined it on the way and began later belong to it.
    pub persistence: f64,
    /// The real merge that ends it, if it is the last component before one; only in
    /// [`StabilityRule::Windowed`], which knows them.
    pub merge: Option<Merge>,
    /// The sum of the volumes of its vertices.
    pub volume: f64,
    /// The smallest selected region that contains this one, as a place in [`Selection::regions`].
    pub parent: Option<usize>,
}

/// The real merge before which a region is a part of its own, such as a limb before it joins the body.
///
/// Where such a part ends is decided by the shape, at a saddle of the weight, not by how fast it grows there;
/// so it is found again more surely than a maximum of stability along a branch.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Merge {
    /// How many times larger the merged component is than the region, more than 1. Merges that follow each other within
    /// the minimum lifetime are one. The larger it is, the more sharply the region is cut off; of nearly equal regions [`pool`](crate::pool()) keeps the one
    /// with the largest growth.
    pub growth: f64,
    /// How long the part lasts: the difference of level from the start of its branch (a real merge, or where
    /// it reached half of the minimum volume) to the real merge that ends it, in units of the altitude on the
    /// chosen scale.
    pub lifetime: f64,
}

/// The stable regions of a tree: any two are nested or disjoint.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Selection {
    /// By descending volume; regions of equal volume by ascending node.
    pub regions: Vec<StableRegion>,
    /// What each filter removed.
    pub report: SelectionReport,
}

/// How many regions each filter removed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct SelectionReport {
    /// Nodes of the tree.
    pub nodes: usize,
    /// Nodes that were local maxima of stability (in [`StabilityRule::Baseline`]: that had a larger parent).
    /// The windowed rule follows branches down to half of the minimum volume only, and leaves out those that are no parts.
    pub candidates: usize,
    /// Candidates without a border that is sharper than that of a shape without parts; only in
    /// [`StabilityRule::Windowed`].
    pub blunt: usize,
    /// Candidates below the minimum volume.
    pub too_small: usize,
    /// Candidates above the maximum volume.
    pub too_large: usize,
    /// Candidates below the minimum stability.
    pub unstable: usize,
    /// Candidates that are nearly as large as the nearest kept region that contains them.
    pub overlapping: usize,
    /// Regions that are left.
    pub kept: usize,
}

/// A node that may be a region.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub node: u32,
    pub stability: f64,
    pub merge: Option<Merge>,
}

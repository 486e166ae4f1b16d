//! Maximally stable components (section 4.2 of the paper; MSER of Matas et al. 2002): which nodes of a tree
//! are features.
mod branches;
mod parameters;
mod pointwise;
mod windowed;

pub use parameters::{AltitudeScale, StabilityParameters, StabilityRule};

use crate::{ComponentTree, TreeError};

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
    /// How many times larger the merged component is than the region, more than 1. The larger it is, the
    /// more sharply the region is cut off; of nearly equal regions [`pool`](crate::pool()) keeps the one
    /// with the largest growth.
    pub growth: f64,
    /// How long the part lasts: the difference of level from the start of its branch (a real merge, or where
    /// it reached half of the minimum volume) to the real merge that ends it, in units of the altitude on the
    /// chosen scale. This is the score to rank regions by: the longest lifetime first, regions without a
    /// merge last.
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
    /// The windowed rule follows branches down to half of the minimum volume only.
    pub candidates: usize,
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

/// Selects the maximally stable components of a tree.
///
/// The rule proposes candidates. Then candidates are dropped that are too small or too large, that are
/// below the minimum stability, or, from the largest down, whose nearest kept ancestor is less than
/// `1 / (1 - min_diversity)` times as large.
///
/// Cost: linear in the nodes, plus a sort of the candidates.
///
/// # Errors
/// [`TreeError::InvalidParameter`] from [`StabilityParameters::validate`].
pub fn stable_regions(
    tree: &ComponentTree,
    parameters: &StabilityParameters,
) -> Result<Selection, TreeError> {
    parameters.validate()?;
    let total = parameters.total_volume.unwrap_or_else(|| tree.total_volume());
    let smallest = parameters.min_volume_fraction * total;
    let largest = parameters.max_volume_fraction * total;
    let levels = Levels { tree, scale: parameters.altitude };
    let mut candidates = match parameters.rule {
        StabilityRule::Windowed => windowed::maxima(&levels, parameters.window, smallest),
        StabilityRule::Paper => pointwise::maxima(&levels),
        StabilityRule::Baseline => pointwise::with_larger_parent(tree, parameters.min_diversity),
    };
    let mut report =
        SelectionReport { nodes: tree.len(), candidates: candidates.len(), ..Default::default() };
    let mut filter = |removed: &mut usize, keep: &dyn Fn(&Candidate) -> bool| {
        let before = candidates.len();
        candidates.retain(keep);
        *removed = before - candidates.len();
    };
    filter(&mut report.too_small, &|c| tree.volume(c.node) >= smallest);
    filter(&mut report.too_large, &|c| tree.volume(c.node) <= largest);
    if let Some(least) = parameters.min_stability {
        // A NaN, where a rule measures no stability, is not below it.
        filter(&mut report.unstable, &|c| c.stability.is_nan() || c.stability >= least);
    }
    let before = candidates.len();
    let regions = diverse(&levels, candidates, parameters.min_diversity);
    report.overlapping = before - regions.len();
    report.kept = regions.len();
    Ok(Selection { regions, report })
}

/// The stability of every node, as [`StableRegion::stability`] defines it.
///
/// NaN where it is not measured: for [`StabilityRule::Windowed`] nodes off the branches, below half of the
/// minimum volume; for [`StabilityRule::Paper`] roots; for [`StabilityRule::Baseline`] all nodes.
///
/// # Errors
/// [`TreeError::InvalidParameter`] from [`StabilityParameters::validate`].
pub fn stability(tree: &ComponentTree, parameters: &StabilityParameters) -> Result<Vec<f64>, TreeError> {
    parameters.validate()?;
    let total = parameters.total_volume.unwrap_or_else(|| tree.total_volume());
    let levels = Levels { tree, scale: parameters.altitude };
    Ok(match parameters.rule {
        StabilityRule::Windowed => {
            windowed::stability(&levels, parameters.window, parameters.min_volume_fraction * total)
        }
        StabilityRule::Paper => {
            (0..tree.len() as u32).map(|node| pointwise::stability(&levels, node)).collect()
        }
        StabilityRule::Baseline => vec![f64::NAN; tree.len()],
    })
}

/// Drops each candidate whose nearest kept ancestor is nearly as large, and orders the rest.
fn diverse(levels: &Levels<'_>, candidates: Vec<Candidate>, min_diversity: f64) -> Vec<StableRegion> {
    nest(levels, candidates, |volume, larger| volume > (1.0 - min_diversity) * larger)
}

/// Regions from nodes that are all kept, on the linear scale.
pub(crate) fn regions_of(tree: &ComponentTree, nodes: Vec<Candidate>) -> Vec<StableRegion> {
    nest(&Levels { tree, scale: AltitudeScale::Linear }, nodes, |_, _| false)
}

/// Regions with their parents, by descending volume. A candidate is left out if `drops` says so of its volume
/// and that of its nearest kept ancestor.
fn nest(
    levels: &Levels<'_>,
    mut candidates: Vec<Candidate>,
    drops: impl Fn(f64, f64) -> bool,
) -> Vec<StableRegion> {
    // In descending order of nodes ancestors come before descendants, and what lies between a node and
    // an ancestor on the stack descends from that ancestor too.
    candidates.sort_unstable_by_key(|c| std::cmp::Reverse(c.node));
    let tree = levels.tree;
    let persistence = tree.persistence_of(|node| levels.of(node));
    let mut regions: Vec<StableRegion> = Vec::new();
    let mut ancestors: Vec<usize> = Vec::new();
    for Candidate { node, stability, merge } in candidates {
        while ancestors.pop_if(|&mut a| !tree.contains(regions[a].node, node)).is_some() {}
        let parent = ancestors.last().copied();
        let volume = tree.volume(node);
        if parent.is_some_and(|p| drops(volume, regions[p].volume)) {
            continue;
        }
        ancestors.push(regions.len());
        let (altitude, persistence) = (tree.altitude(node), persistence[node as usize]);
        regions.push(StableRegion { node, altitude, stability, persistence, merge, volume, parent });
    }
    let mut order: Vec<usize> = (0..regions.len()).collect();
    order.sort_unstable_by(|&a, &b| {
        let (a, b) = (&regions[a], &regions[b]);
        b.volume.total_cmp(&a.volume).then(a.node.cmp(&b.node))
    });
    let mut place = vec![0; regions.len()];
    order.iter().enumerate().for_each(|(new, &old)| place[old] = new);
    let moved = |&old: &usize| {
        let region = regions[old];
        StableRegion { parent: region.parent.map(|p| place[p]), ..region }
    };
    order.iter().map(moved).collect()
}

/// Altitudes on the scale that stability is measured on, rising towards the root, all finite.
struct Levels<'a> {
    tree: &'a ComponentTree,
    scale: AltitudeScale,
}

impl Levels<'_> {
    #[inline]
    fn of(&self, node: u32) -> f64 {
        let altitude = self.tree.altitude(node);
        let level = match self.scale {
            AltitudeScale::Log => altitude.clamp(1e-300, 1e300).ln(),
            AltitudeScale::Linear => altitude.clamp(-1e300, 1e300),
        };
        self.tree.polarity().orient(level)
    }
}

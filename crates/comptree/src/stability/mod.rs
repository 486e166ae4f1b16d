//! Maximally stable components: which nodes of a tree are features.
mod branches;
mod parameters;
mod pointwise;
mod windowed;

pub use parameters::{AltitudeScale, Mode, StabilityParameters};

use crate::{ComponentTree, TreeError};

/// A stable component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StableRegion {
    /// Its node in the tree.
    pub node: u32,
    /// The altitude at which it is complete, as the weights were given.
    pub altitude: f64,
    /// `volume / (d volume / d altitude)` (eq. 5), in units of the altitude on the chosen scale;
    /// infinite for a region that does not change over the window. NaN in [`Mode::Baseline`], which
    /// knows none.
    pub stability: f64,
    /// How long the part that the region belongs to stays on its own: from its first vertex to the merge
    /// with a component that began earlier, in units of the altitude on the chosen scale
    /// ([`ComponentTree::persistence`]). What joined it on the way counts as it.
    pub persistence: f64,
    /// The real merge that ends it, if it is the last component before one; only in
    /// [`Mode::Windowed`], which knows them.
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
pub struct Merge {
    /// How many times larger the merged component is, more than 1. Of several nearly equal regions, the one
    /// with the largest is cut off the most sharply; [`pool`](crate::pool()) keeps that.
    pub growth: f64,
    /// How long the part lasts: from the real merge it came from (or from where it had half of the minimum
    /// volume) to the one that ends it, in units of the altitude on the chosen scale. The score to rank
    /// regions by: those that last longest first, then those without a merge.
    pub lifetime: f64,
}

/// The stable regions of a tree: any two are nested or disjoint.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    /// By descending volume; of equal ones the one whose node has the smaller number first.
    pub regions: Vec<StableRegion>,
    /// What each filter removed.
    pub report: SelectionReport,
}

/// How many regions each filter removed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SelectionReport {
    /// Nodes of the tree.
    pub nodes: usize,
    /// Nodes that were local maxima of stability (in [`Mode::Baseline`]: that had a larger parent).
    /// The windowed mode follows branches down to half of the minimum volume only.
    pub candidates: usize,
    /// Candidates below the minimum volume.
    pub too_small: usize,
    /// Candidates above the maximum volume.
    pub too_large: usize,
    /// Candidates below the minimum stability.
    pub unstable: usize,
    /// Candidates too like the nearest surviving region that contains them.
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
/// The mode proposes candidates; then those go that are too small or too large, those below the
/// minimum stability, and, from the largest down, those whose nearest surviving ancestor is less than
/// `1 / (1 - min_diversity)` times their volume.
///
/// Cost: linear in the nodes, plus a sort of the candidates.
///
/// # Errors
/// [`TreeError::BadParameter`] from [`StabilityParameters::validate`].
pub fn stable_regions(
    tree: &ComponentTree,
    parameters: &StabilityParameters,
) -> Result<Selection, TreeError> {
    parameters.validate()?;
    let total = parameters.total_volume.unwrap_or_else(|| tree.total_volume());
    let smallest = parameters.min_volume_fraction * total;
    let largest = parameters.max_volume_fraction * total;
    let levels = Levels { tree, scale: parameters.scale };
    let mut candidates = match parameters.mode {
        Mode::Windowed { window } => windowed::maxima(&levels, window, smallest),
        Mode::Paper => pointwise::maxima(&levels),
        Mode::Baseline => pointwise::with_larger_parent(tree, parameters.min_diversity),
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
        // A NaN, where a mode measures no stability, is not below it.
        filter(&mut report.unstable, &|c| c.stability.is_nan() || c.stability >= least);
    }
    let before = candidates.len();
    let regions = diverse(&levels, candidates, parameters.min_diversity);
    report.overlapping = before - regions.len();
    report.kept = regions.len();
    Ok(Selection { regions, report })
}

/// The stability of every node: `1 / instability` on the branches of the windowed mode, eq. 5 for
/// [`Mode::Paper`]. NaN where it is not measured: below half of the minimum volume, and for
/// [`Mode::Baseline`].
///
/// # Errors
/// [`TreeError::BadParameter`] from [`StabilityParameters::validate`].
pub fn stability(tree: &ComponentTree, parameters: &StabilityParameters) -> Result<Vec<f64>, TreeError> {
    parameters.validate()?;
    let total = parameters.total_volume.unwrap_or_else(|| tree.total_volume());
    let levels = Levels { tree, scale: parameters.scale };
    Ok(match parameters.mode {
        Mode::Windowed { window } => {
            windowed::stability(&levels, window, parameters.min_volume_fraction * total)
        }
        Mode::Paper => (0..tree.len() as u32).map(|node| pointwise::stability(&levels, node)).collect(),
        Mode::Baseline => vec![f64::NAN; tree.len()],
    })
}

/// Drops each candidate whose nearest surviving ancestor is nearly as large, and orders the rest.
fn diverse(levels: &Levels<'_>, candidates: Vec<Candidate>, min_diversity: f64) -> Vec<StableRegion> {
    nest(levels, candidates, |volume, larger| volume > (1.0 - min_diversity) * larger)
}

/// Regions from nodes that all stay, on the linear scale.
pub(crate) fn arrange(tree: &ComponentTree, nodes: Vec<Candidate>) -> Vec<StableRegion> {
    nest(&Levels { tree, scale: AltitudeScale::Linear }, nodes, |_, _| false)
}

/// Regions with their parents, by descending volume, but for those that `goes` drops for their volume
/// and that of the nearest ancestor that stays.
fn nest(
    levels: &Levels<'_>,
    mut candidates: Vec<Candidate>,
    goes: impl Fn(f64, f64) -> bool,
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
        if parent.is_some_and(|p| goes(volume, regions[p].volume)) {
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

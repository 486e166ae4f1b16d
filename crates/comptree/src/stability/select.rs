//! Which candidates of a rule are regions (section 4.2).

use super::levels::Levels;
use super::parameters::{AltitudeScale, StabilityParameters, StabilityRule};
use super::region::{Candidate, Selection, SelectionReport, StableRegion};
use super::{pointwise, windowed};
use crate::{ComponentTree, TreeError};

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
    let (mut candidates, blunt) = match parameters.rule {
        StabilityRule::Windowed => windowed::maxima(&levels, parameters, smallest),
        StabilityRule::Paper => (pointwise::maxima(&levels), 0),
        StabilityRule::Baseline => (pointwise::with_larger_parent(tree, parameters.min_diversity), 0),
    };
    let mut report = SelectionReport {
        nodes: tree.len(),
        candidates: candidates.len() + blunt,
        blunt,
        ..Default::default()
    };
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
            windowed::stability(&levels, parameters, parameters.min_volume_fraction * total)
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

//! Eq. 5 as published, node by node; and the baseline without any stability.
use super::levels::Levels;
use super::region::Candidate;
use crate::ComponentTree;

/// The nodes whose stability (eq. 5, the derivative as the difference to the parent) is not exceeded
/// by that of the parent or of a child. Roots grow no more and are not measured.
///
/// Neighbours that tie are one maximum, represented by the largest.
pub(super) fn maxima(levels: &Levels<'_>) -> Vec<Candidate> {
    let tree = levels.tree;
    // Roots are not measured; nothing may lose against them.
    let measured = |node| Some(stability(levels, node)).filter(|s| !s.is_nan()).unwrap_or(f64::NEG_INFINITY);
    let stability: Vec<f64> = (0..tree.len() as u32).map(measured).collect();
    let mut best_child = vec![f64::NEG_INFINITY; tree.len()];
    for node in 0..tree.len() as u32 {
        if let Some(parent) = tree.parent(node) {
            let best = &mut best_child[parent as usize];
            *best = best.max(stability[node as usize]);
        }
    }
    // Whether a plateau is exceeded from below is carried up to its largest node, from above down.
    let mut below: Vec<bool> = (0..tree.len()).map(|i| best_child[i] > stability[i]).collect();
    for node in 0..tree.len() {
        if let Some(parent) = tree.parent(node as u32).map(|p| p as usize)
            && stability[parent] == stability[node]
        {
            below[parent] |= below[node];
        }
    }
    let exceeds_parent = |node: u32| match tree.parent(node) {
        Some(parent) => stability[node as usize] > stability[parent as usize],
        None => false,
    };
    (0..tree.len() as u32)
        .filter(|&node| exceeds_parent(node) && !below[node as usize])
        .map(|node| Candidate { node, stability: stability[node as usize], merge: None })
        .collect()
}

/// `vol (l' - l) / (vol' - vol)` with the parent's l' and vol'; NaN for a root.
pub(super) fn stability(levels: &Levels<'_>, node: u32) -> f64 {
    let tree = levels.tree;
    match tree.parent(node) {
        None => f64::NAN,
        Some(parent) => {
            let volume = tree.volume(node);
            let growth = tree.volume(parent) - volume;
            if growth > 0.0 { volume * (levels.of(parent) - levels.of(node)) / growth } else { f64::INFINITY }
        }
    }
}

/// The nodes whose parent is larger by the factor 1 + `by` or more; and roots, which nothing contains.
pub(super) fn with_larger_parent(tree: &ComponentTree, by: f64) -> Vec<Candidate> {
    let kept = |&node: &u32| {
        tree.parent(node).is_none_or(|parent| tree.volume(parent) >= (1.0 + by) * tree.volume(node))
    };
    (0..tree.len() as u32)
        .filter(kept)
        .map(|node| Candidate { node, stability: f64::NAN, merge: None })
        .collect()
}

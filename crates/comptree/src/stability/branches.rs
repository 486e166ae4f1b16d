//! Chains of nodes between real merges: branch decomposition (Pascucci et al. 2004) with a minimum volume.
use super::levels::Levels;
use super::region::Merge;
use crate::ComponentTree;

/// A chain of nodes between two real merges, from the smallest up, with strictly rising levels.
#[derive(Debug, Default)]
pub(super) struct Branch {
    pub nodes: Vec<u32>,
    pub levels: Vec<f64>,
    pub volumes: Vec<f64>,
    /// The level of the merge that ends it; for a root's branch its last level.
    pub end: f64,
    /// The real merge that ends it; none where the whole tree ends.
    pub merge: Option<Merge>,
}

/// Visits each branch whose top has at least the volume `smallest`.
///
/// A branch is followed down from its top to the largest child. It starts at a real merge (two children of
/// at least `smallest`), where the largest child is below half of `smallest`, or where several children
/// are equally large.
pub(super) fn for_each(levels: &Levels<'_>, smallest: f64, mut visit: impl FnMut(&Branch)) {
    let tree = levels.tree;
    let mut tops: Vec<u32> = tree.roots().filter(|&root| tree.volume(root) >= smallest).collect();
    let mut branch = Branch::default();
    while let Some(top) = tops.pop() {
        branch.nodes.clear();
        let mut node = Some(top);
        while let Some(at) = node {
            branch.nodes.push(at);
            let fork = Fork::of(tree, at, smallest, &mut tops);
            node = fork.main.filter(|_| !fork.cut).filter(|&c| tree.volume(c) >= smallest / 2.0);
        }
        branch.nodes.reverse();
        // Different altitudes can have the same level at the ends of the scale: the largest node counts.
        branch.levels.clear();
        let mut kept = 0;
        for at in 0..branch.nodes.len() {
            let (node, level) = (branch.nodes[at], levels.of(branch.nodes[at]));
            if branch.levels.last() == Some(&level) {
                kept -= 1;
                branch.levels.pop();
            }
            branch.nodes[kept] = node;
            branch.levels.push(level);
            kept += 1;
        }
        branch.nodes.truncate(kept);
        branch.volumes.clear();
        branch.volumes.extend(branch.nodes.iter().map(|&node| tree.volume(node)));
        let parent = tree.parent(top);
        branch.end = parent.map_or(branch.levels[kept - 1], |p| levels.of(p));
        branch.merge = parent.map(|p| Merge {
            growth: tree.volume(p) / tree.volume(top),
            lifetime: branch.end - branch.levels[0],
        });
        visit(&branch);
    }
}

/// What joins at a node.
struct Fork {
    /// The largest child, unless several are.
    main: Option<u32>,
    /// Whether at least two children have the minimum volume.
    cut: bool,
}

impl Fork {
    /// Children that begin branches of their own are added to `tops`.
    fn of(tree: &ComponentTree, node: u32, smallest: f64, tops: &mut Vec<u32>) -> Self {
        let (mut main, mut most, mut tie) = (None, f64::NEG_INFINITY, false);
        let known = tops.len();
        for child in tree.children(node) {
            let volume = tree.volume(child);
            if volume > most {
                (main, most, tie) = (Some(child), volume, false);
            } else if volume == most {
                tie = true;
            }
            if volume >= smallest {
                tops.push(child);
            }
        }
        let cut = tops.len() - known >= 2;
        if !cut {
            // The only large child continues the branch.
            tops.truncate(known);
        }
        Self { main: main.filter(|_| !tie), cut }
    }
}

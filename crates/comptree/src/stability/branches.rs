//! Chains of nodes between real merges: branch decomposition (Pascucci et al. 2004) with a minimum volume and a
//! minimum lifetime.
use super::levels::Levels;
use crate::ComponentTree;

/// Parts whose volumes differ by less than this fraction are taken for copies of each other.
const LIKE: f64 = 0.1;

/// A chain of nodes between two real merges, from the smallest up, with strictly rising levels.
#[derive(Debug, Default)]
pub(super) struct Branch {
    pub nodes: Vec<u32>,
    pub levels: Vec<f64>,
    pub volumes: Vec<f64>,
    /// The level of the merge that ends it; for a root's branch its last level.
    pub end: f64,
    /// The merge that ends it; none where the whole tree ends.
    pub merge: Option<BranchMerge>,
    /// The branch that this merge begins, an earlier one.
    parent: Option<usize>,
    /// Whether it begins at a real merge.
    forked: bool,
}

/// The real merge that ends a branch, together with those that follow within the minimum lifetime.
#[derive(Clone, Copy, Debug)]
pub(super) struct BranchMerge {
    /// The volume of what they make.
    pub volume: f64,
    /// Whether the parts that they join all have the same volume. Then the branch ends where it meets copies of itself.
    pub copies: bool,
}

/// The branches of a tree whose top has at least the volume `smallest`, parents before children.
///
/// A branch is followed down from its top to the largest child. It starts at a real merge (two children of at least
/// `smallest`), where the largest child is below half of `smallest`, or where several children are equally large.
///
/// A branch that does not last for `min_lifetime` is no part:
///
/// * If it begins at no real merge it is a bump. A merge of one part with bumps is not real: the part's branch goes on.
/// * If it begins at a real merge, that merge and the one that ends it are nearly simultaneous. In which order their
///   parts joined is an accident, so they count as one merge of all of them.
pub(super) fn branches(levels: &Levels<'_>, smallest: f64, min_lifetime: f64) -> Vec<Branch> {
    let mut branches = without_bumps(all(levels, smallest), min_lifetime);
    join_merges(&mut branches, min_lifetime);
    branches
}

/// All branches, parents before children.
fn all(levels: &Levels<'_>, smallest: f64) -> Vec<Branch> {
    let tree = levels.tree;
    let mut tops: Vec<(u32, Option<usize>)> =
        tree.roots().filter(|&root| tree.volume(root) >= smallest).map(|root| (root, None)).collect();
    let mut branches: Vec<Branch> = Vec::new();
    while let Some((top, parent)) = tops.pop() {
        let mut branch = Branch { parent, ..Default::default() };
        let mut node = Some(top);
        while let Some(at) = node {
            branch.nodes.push(at);
            let fork = Fork::of(tree, at, smallest);
            branch.forked = fork.large >= 2;
            if branch.forked {
                let large = tree.children(at).filter(|&child| tree.volume(child) >= smallest);
                tops.extend(large.map(|child| (child, Some(branches.len()))));
            }
            node = fork.main.filter(|&c| !branch.forked && tree.volume(c) >= smallest / 2.0);
        }
        branch.nodes.reverse();
        branch.nodes.shrink_to_fit();
        branch.measure(levels);
        if let Some(merged) = tree.parent(top) {
            branch.end = levels.of(merged);
            branch.merge = Some(BranchMerge { volume: tree.volume(merged), copies: false });
        }
        branches.push(branch);
    }
    branches
}

impl Branch {
    /// How far the level moves along it.
    pub fn lifetime(&self) -> f64 {
        self.end - self.levels[0]
    }

    /// Whether it is a part. A root's branch lasts for ever.
    pub fn lasts(&self, min_lifetime: f64) -> bool {
        self.merge.is_none() || self.lifetime() >= min_lifetime
    }

    /// The volume of its last node.
    fn volume(&self) -> f64 {
        self.volumes.last().copied().unwrap_or(0.0)
    }

    /// Levels and volumes of its nodes. Different altitudes can have the same level at the ends of the scale: the
    /// largest node counts.
    fn measure(&mut self, levels: &Levels<'_>) {
        let mut kept = 0;
        self.levels.reserve_exact(self.nodes.len());
        for at in 0..self.nodes.len() {
            let (node, level) = (self.nodes[at], levels.of(self.nodes[at]));
            if self.levels.last() == Some(&level) {
                kept -= 1;
                self.levels.pop();
            }
            self.nodes[kept] = node;
            self.levels.push(level);
            kept += 1;
        }
        self.nodes.truncate(kept);
        self.volumes = self.nodes.iter().map(|&node| levels.tree.volume(node)).collect();
        self.end = self.levels[kept - 1];
    }
}

/// What becomes of a branch when bumps go.
#[derive(Clone, Copy, PartialEq)]
enum Fate {
    Stays,
    /// It continues the branch above it.
    JoinsParent,
    /// It is a bump on that branch.
    Goes,
}

/// Drops bumps and joins what they cut: a branch above a merge of one part with bumps goes on in that part, or in the
/// largest bump where all are bumps, unless several are equally large.
fn without_bumps(mut branches: Vec<Branch>, min_lifetime: f64) -> Vec<Branch> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); branches.len()];
    let mut fates = vec![Fate::Stays; branches.len()];
    // Where each begins, once it has been joined to what it goes on in.
    let mut starts: Vec<f64> = branches.iter().map(|branch| branch.levels[0]).collect();
    for at in (0..branches.len()).rev() {
        let joined = std::mem::take(&mut children[at]);
        let is_bump = |&c: &usize| !branches[c].forked && branches[c].end - starts[c] < min_lifetime;
        let mut parts = joined.iter().copied().filter(|c| !is_bump(c));
        let (first, second) = (parts.next(), parts.next());
        if branches[at].forked && second.is_none() {
            let most = joined.iter().map(|&c| branches[c].volume()).fold(0.0, f64::max);
            let mut largest = joined.iter().copied().filter(|&c| branches[c].volume() == most);
            let (bump, equal) = (largest.next(), largest.next());
            let main = first.or(bump.filter(|_| equal.is_none()));
            joined.iter().for_each(|&c| fates[c] = Fate::Goes);
            branches[at].forked = main.is_some_and(|c| branches[c].forked);
            if let Some(main) = main {
                fates[main] = Fate::JoinsParent;
                starts[at] = starts[main];
            }
        }
        if let Some(parent) = branches[at].parent {
            children[parent].push(at);
        }
    }
    // The branch that each became a part of; none for bumps.
    let mut owners: Vec<Option<usize>> = Vec::with_capacity(branches.len());
    let mut kept: Vec<Branch> = Vec::new();
    for (branch, fate) in branches.into_iter().zip(fates) {
        let above = branch.parent.and_then(|parent| owners[parent]);
        let owner = match (fate, above) {
            (Fate::JoinsParent, Some(owner)) => {
                // From the top down, as parents come first: turned round below.
                let whole = &mut kept[owner];
                whole.nodes.extend(branch.nodes.into_iter().rev());
                whole.levels.extend(branch.levels.into_iter().rev());
                whole.volumes.extend(branch.volumes.into_iter().rev());
                Some(owner)
            }
            (Fate::Stays, _) if branch.parent.is_none() || above.is_some() => {
                let mut branch = Branch { parent: above, ..branch };
                branch.turn();
                kept.push(branch);
                Some(kept.len() - 1)
            }
            _ => None,
        };
        owners.push(owner);
    }
    kept.iter_mut().for_each(Branch::turn);
    kept
}

impl Branch {
    fn turn(&mut self) {
        self.nodes.reverse();
        self.levels.reverse();
        self.volumes.reverse();
    }
}

/// Makes one merge of those that follow each other within the minimum lifetime.
fn join_merges(branches: &mut [Branch], min_lifetime: f64) {
    // The branch that the last of a run of merges begins, and the least and largest volume of the parts that join in it.
    let mut begun: Vec<usize> = Vec::with_capacity(branches.len());
    let mut joined = vec![(f64::INFINITY, 0.0_f64); branches.len()];
    for (at, branch) in branches.iter().enumerate() {
        let run = branch.parent.map_or(at, |p| if branches[p].lasts(min_lifetime) { p } else { begun[p] });
        begun.push(run);
        if branch.parent.is_some() && branch.lasts(min_lifetime) {
            let (least, most) = &mut joined[run];
            (*least, *most) = (least.min(branch.volume()), most.max(branch.volume()));
        }
    }
    for at in 0..branches.len() {
        let ((least, most), volume) = (joined[begun[at]], branches[begun[at]].volumes[0]);
        if let Some(merge) = &mut branches[at].merge {
            *merge = BranchMerge { volume, copies: most - least <= LIKE * most };
        }
    }
}

/// What joins at a node.
struct Fork {
    /// The largest child, unless several are.
    main: Option<u32>,
    /// How many children have at least the minimum volume.
    large: usize,
}

impl Fork {
    fn of(tree: &ComponentTree, node: u32, smallest: f64) -> Self {
        let (mut main, mut most, mut tie) = (None, f64::NEG_INFINITY, false);
        let mut large = 0;
        for child in tree.children(node) {
            let volume = tree.volume(child);
            if volume > most {
                (main, most, tie) = (Some(child), volume, false);
            } else if volume == most {
                tie = true;
            }
            large += usize::from(volume >= smallest);
        }
        Self { main: main.filter(|_| !tie), large }
    }
}

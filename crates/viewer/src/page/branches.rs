use super::data::{PageRegion, PageTree};

/// Components smaller than this share of the whole are not drawn as branches of their own.
const SMALLEST: f64 = 0.002;

/// A component tree thinned out for the eye: nodes between two real merges are one branch, and
/// levels are given by how much of the shape has entered by then, so that a slider moves evenly.
#[derive(Debug)]
pub(crate) struct Branches {
    /// Branch into which each merges; itself for a root. Parents come first.
    pub parents: Vec<u32>,
    /// Share of the elements that have entered when the branch begins.
    pub starts: Vec<f32>,
    /// The same when it merges into its parent; 1 for a root.
    pub ends: Vec<f32>,
    /// Share of the whole volume in the branch just before it merges.
    pub volumes: Vec<f32>,
    /// For each element, the branch it enters.
    pub branch: Vec<u32>,
    /// For each element, the share of the elements that have entered with it.
    pub entered: Vec<f32>,
    /// Altitudes at which 0/256, 1/256, ... 256/256 of the elements have entered.
    pub quantiles: Vec<f64>,
    /// For each region, its branch and share entered; `None` if it is of another tree.
    pub regions: Vec<Option<(u32, f32)>>,
}

impl Branches {
    /// Thins a checked tree; `number` is its place among the shape's trees. Cost: one sort of the elements.
    pub fn new(tree: &PageTree<'_>, number: usize, regions: &[PageRegion<'_>]) -> Self {
        let nodes = tree.parents.len();
        let sign = if tree.superlevel { -1.0 } else { 1.0 };
        let level = |node: u32| sign * tree.altitudes[node as usize];
        let mut sorted: Vec<f64> = tree.entry.iter().map(|&node| level(node)).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let count = sorted.len().max(1) as f64;
        let entered = |node: u32| (sorted.partition_point(|&l| l <= level(node)) as f64 / count) as f32;

        let roots = || (0..nodes).filter(|&n| tree.parents[n] == u32::MAX);
        let total: f64 = roots().map(|n| tree.volumes[n]).sum();
        let mut kept: Vec<bool> = tree.volumes.iter().map(|&v| v >= SMALLEST * total).collect();
        let own = |r: &PageRegion<'_>| r.node.filter(|n| n[0] as usize == number).map(|n| n[1]);
        regions.iter().filter_map(own).for_each(|node| kept[node as usize] = true);
        roots().for_each(|n| kept[n] = true);
        let mut kept_children = vec![0u32; nodes];
        for n in 0..nodes {
            if let Some(parent) = tree.parents.get(n).filter(|p| kept[n] && **p != u32::MAX) {
                kept[*parent as usize] = true;
                kept_children[*parent as usize] += 1;
            }
        }

        let mut branches = Self {
            parents: Vec::new(),
            starts: Vec::new(),
            ends: Vec::new(),
            volumes: Vec::new(),
            branch: Vec::new(),
            entered: Vec::new(),
            quantiles: Vec::new(),
            regions: Vec::new(),
        };
        let mut branch_of = vec![0u32; nodes];
        for n in (0..nodes).rev() {
            let parent = tree.parents[n];
            let goes_on = parent != u32::MAX && (!kept[n] || kept_children[parent as usize] == 1);
            branch_of[n] = if goes_on {
                branch_of[parent as usize]
            } else {
                let next = branches.parents.len() as u32;
                let root = parent == u32::MAX;
                branches.parents.push(if root { next } else { branch_of[parent as usize] });
                branches.ends.push(if root { 1.0 } else { entered(parent) });
                branches.volumes.push((tree.volumes[n] / total.max(f64::MIN_POSITIVE)) as f32);
                branches.starts.push(1.0);
                next
            };
            // Descendants come later in this order: the last kept one is where the branch begins.
            if kept[n] {
                branches.starts[branch_of[n] as usize] = entered(n as u32);
            }
        }
        branches.branch = tree.entry.iter().map(|&n| branch_of[n as usize]).collect();
        branches.entered = tree.entry.iter().map(|&n| entered(n)).collect();
        branches.regions =
            regions.iter().map(|r| own(r).map(|n| (branch_of[n as usize], entered(n)))).collect();
        let last = sorted.len().saturating_sub(1);
        let quantile = |i: usize| sorted.get((i * last).div_ceil(256)).map_or(0.0, |l| sign * l);
        branches.quantiles = (0..=256).map(quantile).collect();
        branches
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rgb;

    fn region(node: u32) -> PageRegion<'static> {
        PageRegion {
            colour: Rgb::WHITE,
            parent: None,
            altitude: 0.0,
            stability: 1.0,
            reliability: None,
            lifetime: None,
            twin: None,
            side: None,
            volume: 1.0,
            volume_fraction: 0.1,
            vertices: &[],
            voxels: &[],
            node: Some([0, node]),
        }
    }

    /// Two chains, nodes 0-1 and 2-3, that merge at node 4, whose chain goes on to the root 5.
    const TREE: PageTree<'static> = PageTree {
        name: String::new(),
        superlevel: true,
        parents: &[1, 4, 3, 4, 5, u32::MAX],
        altitudes: &[9.0, 8.0, 7.0, 6.0, 5.0, 1.0],
        volumes: &[1.0, 3.0, 1.0, 2.0, 6.0, 10.0],
        entry: &[0, 1, 1, 2, 3, 4, 5, 5, 5, 5],
    };

    #[test]
    fn chains_become_branches_that_end_at_merges() {
        let b = Branches::new(&TREE, 0, &[region(3)]);
        assert_eq!(b.parents, [0, 0, 0]);
        assert_eq!(b.starts, [0.6, 0.4, 0.1]);
        assert_eq!(b.ends, [1.0, 0.6, 0.6]);
        assert_eq!(b.volumes, [1.0, 0.2, 0.3]);
        assert_eq!(b.branch, [2, 2, 2, 1, 1, 0, 0, 0, 0, 0]);
        assert_eq!(b.entered, [0.1, 0.3, 0.3, 0.4, 0.5, 0.6, 1.0, 1.0, 1.0, 1.0]);
        assert_eq!(b.regions, [Some((1, 0.5))]);
        assert_eq!((b.quantiles[0], b.quantiles[256]), (9.0, 1.0));
    }

    #[test]
    fn small_components_are_part_of_the_branch_they_join() {
        let volumes = [0.001, 0.003, 1.0, 2.0, 6.0, 10.0];
        let b = Branches::new(&PageTree { volumes: &volumes, ..TREE }, 0, &[]);
        assert_eq!(b.parents, [0]);
        assert!(b.branch.iter().all(|&x| x == 0));
        // A region is kept, however small.
        assert_eq!(Branches::new(&PageTree { volumes: &volumes, ..TREE }, 0, &[region(1)]).parents.len(), 3);
    }
}

//! Facts about stable regions.
use mser3d_comptree::{
    AltitudeScale, ComponentTree, Merge, Polarity, PoolParameters, Selection, StabilityParameters,
    StabilityRule, TreeError, TreeRegions, pool, stability, stable_regions,
};
use proptest::prelude::*;

fn path(n: usize) -> Vec<[u32; 2]> {
    (1..n as u32).map(|v| [v - 1, v]).collect()
}

fn tree(heights: &[f64]) -> ComponentTree {
    ComponentTree::from_vertex_weights(&path(heights.len()), heights, 1.0, Polarity::Sublevel).unwrap()
}

/// Linear altitude, no filters: what the measure alone proposes.
fn open(rule: StabilityRule) -> StabilityParameters {
    StabilityParameters {
        rule,
        altitude: AltitudeScale::Linear,
        min_volume_fraction: 0.0,
        max_volume_fraction: 1.0,
        min_diversity: 0.0,
        ..Default::default()
    }
}

/// The same with a window.
fn with_window(window: f64) -> StabilityParameters {
    StabilityParameters { window, ..open(StabilityRule::Windowed) }
}

fn sets(tree: &ComponentTree, selection: &Selection) -> Vec<Vec<u32>> {
    let sorted = |node| {
        let mut set = tree.vertices(node).to_vec();
        set.sort_unstable();
        set
    };
    selection.regions.iter().map(|r| sorted(r.node)).collect()
}

/// Two flat-bottomed valleys of ten vertices with steep walls, a high pass between them.
fn two_valleys() -> Vec<f64> {
    let mut heights = Vec::new();
    for floor in [1.0, 1.5] {
        heights.extend([9.0, 8.0]);
        heights.extend([floor; 10]);
        heights.extend([8.0, 9.0]);
    }
    heights
}

#[test]
fn the_floors_of_two_valleys_are_stable() {
    let tree = tree(&two_valleys());
    let parameters =
        StabilityParameters { min_volume_fraction: 0.2, max_volume_fraction: 0.5, ..with_window(2.0) };
    let selection = stable_regions(&tree, &parameters).unwrap();
    let floors: Vec<Vec<u32>> = vec![(2..12).collect(), (16..26).collect()];
    let mut found = sets(&tree, &selection);
    found.sort();
    assert!(floors.iter().all(|floor| found.contains(floor)), "{found:?}");
    // Nothing joins a floor within the window: it does not change.
    assert!(selection.regions.iter().filter(|r| r.volume == 10.0).all(|r| r.stability == f64::INFINITY));
}

#[test]
fn the_component_just_before_a_real_merge_is_a_candidate() {
    // A leg of slowly rising weight that joins an equal one at 5: it grows at a steady relative rate, so
    // only the end of its branch can be a maximum.
    let leg: Vec<f64> = (0..40).map(|i| 1.0 + f64::from(i) * 0.1).collect();
    let heights: Vec<f64> = leg.iter().copied().chain([5.0]).chain(leg.iter().rev().copied()).collect();
    let tree = tree(&heights);
    let parameters =
        StabilityParameters { min_volume_fraction: 0.1, max_volume_fraction: 0.6, ..with_window(0.5) };
    let selection = stable_regions(&tree, &parameters).unwrap();
    let legs: Vec<Vec<u32>> = vec![(0..40).collect(), (41..81).collect()];
    let found = sets(&tree, &selection);
    assert!(legs.iter().all(|leg| found.contains(leg)), "{found:?}");
}

#[test]
fn the_component_before_a_merge_counts_though_one_beside_it_is_more_stable() {
    // A leg that flares where it joins an equal one: it grows by 10 vertices on its last step of 0.1, so
    // the maximum of stability is before the flare. Both are regions.
    let leg: Vec<f64> = (0..30).map(|i| 1.0 + f64::from(i) * 0.1).chain([4.0; 10]).collect();
    let heights: Vec<f64> = leg.iter().copied().chain([4.1]).chain(leg.iter().rev().copied()).collect();
    let tree = tree(&heights);
    let parameters = StabilityParameters { min_volume_fraction: 0.1, ..with_window(0.5) };
    let Selection { regions, .. } = stable_regions(&tree, &parameters).unwrap();
    let whole_legs: Vec<_> = regions.iter().filter(|r| r.volume == 40.0).collect();
    assert_eq!(whole_legs.len(), 2);
    let steadier = |leg: u32| regions.iter().any(|r| r.volume < 40.0 && tree.contains(leg, r.node));
    assert!(whole_legs.iter().all(|leg| steadier(leg.node)), "{regions:?}");
    // Both legs begin at 1 and meet at 4.1; of equal ones the first goes on to the root at 4.1.
    assert!(whole_legs.iter().all(|leg| (leg.persistence - 3.1).abs() < 1e-12));
    // Each is followed down to half of the minimum volume of 8.1, five vertices at 1.4; the root has 81.
    for Merge { growth, lifetime, .. } in whole_legs.iter().filter_map(|leg| leg.merge) {
        assert!((growth - 81.0 / 40.0).abs() < 1e-12 && (lifetime - (4.1 - 1.4)).abs() < 1e-12);
    }
    assert!(regions.iter().all(|r| r.merge.is_some() == (r.volume == 40.0)), "{regions:?}");
}

#[test]
fn persistence_is_measured_on_the_scale_of_stability() {
    let tree = tree(&[1.0, 8.0, 2.0]);
    let parameters = StabilityParameters { altitude: AltitudeScale::Log, ..open(StabilityRule::Baseline) };
    let regions = stable_regions(&tree, &parameters).unwrap().regions;
    let persistence: Vec<f64> = regions.iter().map(|r| r.persistence).collect();
    // The root and the deeper valley: ln 8; the other one: ln 8 - ln 2.
    assert_eq!(persistence, [8f64.ln(), 8f64.ln(), 8f64.ln() - 2f64.ln()]);
}

#[test]
fn a_speck_that_joins_does_not_end_a_branch_but_a_real_part_does() {
    // A large part, 1 to 20, and a second one that joins at 10: as a speck and as a real part.
    let joined = |second: usize| {
        let mut heights: Vec<f64> = (0..20).map(|i| 1.0 + 0.1 * f64::from(i)).collect();
        heights.push(10.0);
        heights.extend(vec![2.0; second]);
        let tree = tree(&heights);
        let parameters = StabilityParameters { min_volume_fraction: 0.2, ..with_window(20.0) };
        let selection = stable_regions(&tree, &parameters).unwrap();
        sets(&tree, &selection).contains(&(0..20).collect())
    };
    // The window covers everything: on an undivided branch only the root does not change.
    assert!(joined(15), "the component before the merge of two real parts");
    assert!(!joined(1), "before a speck joins nothing special happens");
}

#[test]
fn a_plateau_is_represented_by_its_largest_node() {
    // Each level doubles the component: 1, 2, 4, ... 64 vertices at levels 0, 1, 2, ... 6.
    let heights: Vec<f64> = (0..64u32).map(|i| f64::from(u32::BITS - i.leading_zeros())).collect();
    let tree = tree(&heights);
    // vol / (vol' - vol) is 1 for all but the root.
    let paper = stable_regions(&tree, &open(StabilityRule::Paper)).unwrap();
    assert_eq!(paper.regions.iter().map(|r| (r.volume, r.stability)).collect::<Vec<_>>(), [(32.0, 1.0)]);
    // A window that reaches one node to either side sees a change of 3/2 of the volume (1/2 of it from
    // below, 1 from above) over 2; where the branch starts and ends only one side: both ends count.
    let windowed = stable_regions(&tree, &with_window(1.0)).unwrap();
    assert_eq!(windowed.regions.iter().map(|r| (r.volume, r.stability)).collect::<Vec<_>>(), [(64.0, 2.0)]);
    // In a window too narrow to reach a neighbour above, the first node does not change at all.
    let narrow = stable_regions(&tree, &with_window(0.5)).unwrap();
    assert_eq!(
        narrow.regions.iter().map(|r| (r.volume, r.stability)).collect::<Vec<_>>(),
        [(1.0, f64::INFINITY)]
    );
}

#[test]
fn regions_have_the_stability_of_their_nodes() {
    let heights: Vec<f64> =
        (0..200).map(|i| 2.0 + (f64::from(i) * 0.7).sin() + 0.01 * f64::from(i)).collect();
    let tree = tree(&heights);
    for rule in [StabilityRule::Windowed, StabilityRule::Paper] {
        let parameters = StabilityParameters { rule, window: 0.1, ..Default::default() };
        let of_nodes = stability(&tree, &parameters).unwrap();
        assert_eq!(of_nodes.len(), tree.len());
        let selection = stable_regions(&tree, &parameters).unwrap();
        assert!(!selection.regions.is_empty());
        assert!(selection.regions.iter().all(|r| r.stability == of_nodes[r.node as usize]));
        // Eq. 5 has no parent to compare a root with.
        let root = tree.roots().next().unwrap();
        assert_eq!(of_nodes[root as usize].is_nan(), rule == StabilityRule::Paper);
    }
}

#[test]
fn filters_are_honoured_and_counted() {
    let heights: Vec<f64> =
        (0..200).map(|i| 2.0 + (f64::from(i) * 0.7).sin() + 0.01 * f64::from(i)).collect();
    let tree = tree(&heights);
    for rule in [StabilityRule::Windowed, StabilityRule::Paper, StabilityRule::Baseline] {
        let parameters = StabilityParameters {
            rule,
            window: 0.1,
            min_volume_fraction: 0.02,
            max_volume_fraction: 0.5,
            min_diversity: 0.3,
            min_stability: Some(0.5),
            ..Default::default()
        };
        let Selection { regions, report, .. } = stable_regions(&tree, &parameters).unwrap();
        assert_eq!(report.nodes, tree.len());
        let removed =
            report.blunt + report.too_small + report.too_large + report.unstable + report.overlapping;
        assert_eq!(report.candidates, removed + report.kept);
        assert_eq!(report.kept, regions.len());
        assert!(!regions.is_empty(), "{rule:?}");
        for region in &regions {
            assert!((4.0..=100.0).contains(&region.volume));
            assert!(region.stability.is_nan() || region.stability >= 0.5);
            if let Some(parent) = region.parent {
                let parent = regions[parent];
                assert!(tree.contains(parent.node, region.node));
                assert!(region.volume <= 0.7 * parent.volume);
            }
        }
    }
    let halved =
        StabilityParameters { total_volume: Some(400.0), max_volume_fraction: 0.1, ..Default::default() };
    let regions = stable_regions(&tree, &halved).unwrap().regions;
    assert!(regions.iter().all(|r| (4.0..=40.0).contains(&r.volume)));
}

#[test]
fn parameters_out_of_range_are_named() {
    let tree = tree(&[1.0, 2.0]);
    let check = |parameters: StabilityParameters, text: &str| {
        let error = stable_regions(&tree, &parameters).unwrap_err();
        assert!(
            matches!(error, TreeError::InvalidParameter(_)) && error.to_string().contains(text),
            "{error}"
        );
    };
    let default = StabilityParameters::default();
    check(StabilityParameters { window: 0.0, ..default }, "window is 0");
    check(StabilityParameters { min_volume_fraction: -0.1, ..default }, "min_volume_fraction is -0.1");
    check(StabilityParameters { max_volume_fraction: f64::NAN, ..default }, "max_volume_fraction is NaN");
    check(StabilityParameters { min_diversity: 1.5, ..default }, "between 0 and 1");
    check(StabilityParameters { total_volume: Some(0.0), ..default }, "total_volume is 0");
}

#[test]
fn degenerate_trees_have_defined_selections() {
    let empty = ComponentTree::from_vertex_weights::<f64>(&[], &[], 1.0, Polarity::Sublevel).unwrap();
    assert!(stable_regions(&empty, &StabilityParameters::default()).unwrap().regions.is_empty());
    // One component is the whole shape, larger than the maximum volume.
    assert!(stable_regions(&tree(&[1.0; 5]), &StabilityParameters::default()).unwrap().regions.is_empty());
    // Of a forest every tree's root is a component that never changes.
    let forest = ComponentTree::from_edge_weights(4, &[[0, 1]], &[-1.0], 1.0, Polarity::Superlevel).unwrap();
    let regions = stable_regions(&forest, &StabilityParameters::default()).unwrap().regions;
    assert_eq!(regions.len(), 3);
    assert!(regions.iter().all(|r| r.stability.is_infinite() && r.parent.is_none()));
}

#[test]
fn log_stability_does_not_depend_on_the_unit_of_the_weight() {
    let heights: Vec<f64> =
        (0..300).map(|i| 2.0 + (f64::from(i) * 0.2).sin() + (f64::from(i) * 0.017).cos()).collect();
    let scaled: Vec<f64> = heights.iter().map(|h| h * 1024.0).collect();
    let (a, b) = (tree(&heights), tree(&scaled));
    let (a, b) =
        (stable_regions(&a, &Default::default()).unwrap(), stable_regions(&b, &Default::default()).unwrap());
    assert!(a.regions.len() > 3);
    assert_eq!(a.report, b.report);
    assert!(a.regions.iter().zip(&b.regions).all(|(a, b)| a.node == b.node));
}

#[test]
fn superlevel_sets_of_a_weight_are_sublevel_sets_of_its_inverse() {
    let heat: Vec<f64> =
        (0..300).map(|i| 2.0 + (f64::from(i) * 0.2).sin() + (f64::from(i) * 0.017).cos()).collect();
    let inverse: Vec<f64> = heat.iter().map(|h| 1.0 / h).collect();
    let up = ComponentTree::from_vertex_weights(&path(300), &heat, 1.0, Polarity::Superlevel).unwrap();
    let down = tree(&inverse);
    let nodes = |tree: &ComponentTree| -> Vec<u32> {
        stable_regions(tree, &Default::default()).unwrap().regions.iter().map(|r| r.node).collect()
    };
    assert!(nodes(&up).len() > 3);
    assert_eq!(nodes(&up), nodes(&down));
}

#[test]
fn pooled_regions_hold_no_duplicates_and_know_their_origin() {
    let field = |phase: f64| -> Vec<f64> {
        (0..400).map(|i| 2.0 + (f64::from(i) * 0.05 + phase).sin() + 0.002 * f64::from(i)).collect()
    };
    let trees: Vec<ComponentTree> = [0.0, 0.1, 1.0].iter().map(|&p| tree(&field(p))).collect();
    let selections: Vec<Selection> =
        trees.iter().map(|t| stable_regions(t, &Default::default()).unwrap()).collect();
    let sources: Vec<_> = trees.iter().zip(&selections).map(|(t, s)| TreeRegions::of(t, s)).collect();
    let all: usize = selections.iter().map(|s| s.regions.len()).sum();
    let pooled = pool(&sources, 0.5, &PoolParameters::default()).unwrap();
    assert!(pooled.len() < all && pooled.len() >= selections[0].regions.len());
    let count = |a: &[u32], b: &[u32]| a.iter().filter(|v| b.binary_search(v).is_ok()).count();
    for (i, region) in pooled.iter().enumerate() {
        let mut expected =
            trees[region.tree].vertices(selections[region.tree].regions[region.region].node).to_vec();
        expected.sort_unstable();
        assert_eq!(region.vertices, expected);
        assert_eq!(region.volume, 0.5 * expected.len() as f64);
        assert!(i == 0 || pooled[i - 1].volume >= region.volume);
        let mut smallest = None;
        for (j, other) in pooled[..i].iter().enumerate() {
            let common = count(&region.vertices, &other.vertices);
            let union = region.vertices.len() + other.vertices.len() - common;
            assert!((common as f64) < PoolParameters::default().duplicate_overlap * union as f64);
            if common == region.vertices.len() && other.volume > region.volume {
                smallest = Some(j);
            }
        }
        assert_eq!(region.parent, smallest);
    }
    let everything = pool(&sources, 0.5, &PoolParameters { duplicate_overlap: 1.1 }).unwrap();
    assert_eq!(everything.len(), all);
    let other = tree(&[1.0, 2.0]);
    let mut none = selections[0].clone();
    none.regions.clear();
    assert!(
        pool(&[sources[0].clone(), TreeRegions::of(&other, &none)], 1.0, &PoolParameters::default()).is_err()
    );
}

#[test]
fn among_near_duplicates_the_one_with_the_sharpest_merge_is_kept() {
    // Two legs meet at 9. In the first tree 22 vertices are a leg, in the second 20, in the third 21 that
    // nothing ends: they are only stable.
    let leg = |n: usize| {
        let mut heights = vec![9.0; 61];
        heights[..n].fill(1.0);
        heights[31..31 + n].fill(1.0);
        heights
    };
    let trees = [tree(&leg(22)), tree(&leg(20)), tree(&leg(21))];
    let parameters = with_window(1.0);
    let mut selections = trees.each_ref().map(|tree| {
        stable_regions(tree, &StabilityParameters { max_volume_fraction: 0.5, ..parameters }).unwrap()
    });
    selections[2].regions.iter_mut().for_each(|region| region.merge = None);
    let sizes = |which: &[usize]| -> Vec<usize> {
        let sources: Vec<_> = which.iter().map(|&i| TreeRegions::of(&trees[i], &selections[i])).collect();
        let pooled = pool(&sources, 1.0, &PoolParameters::default()).unwrap();
        pooled.iter().map(|region| region.vertices.len()).collect()
    };
    assert_eq!(sizes(&[0, 1, 2]), [20, 20]);
    assert_eq!(sizes(&[2, 0]), [22, 22]);
    assert_eq!(sizes(&[2]), [21, 21]);
}

proptest! {
    #[test]
    fn regions_are_nested_or_disjoint_and_diverse(weights in prop::collection::vec(0.5f64..9.0, 30..120)) {
        let tree = tree(&weights);
        for rule in [StabilityRule::Windowed, StabilityRule::Paper, StabilityRule::Baseline] {
            let parameters = StabilityParameters { rule, window: 0.3, ..Default::default() };
            let selection = stable_regions(&tree, &parameters).unwrap();
            for (i, a) in selection.regions.iter().enumerate() {
                for b in &selection.regions[i + 1..] {
                    let nested = tree.contains(a.node, b.node);
                    prop_assert!(nested || !tree.contains(b.node, a.node));
                    prop_assert!(!nested || b.volume <= 0.8 * a.volume);
                }
            }
        }
    }
}

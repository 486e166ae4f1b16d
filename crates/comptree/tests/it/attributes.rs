//! What a tree tells about its nodes, and what can be made of it.
use super::common::check_structure;
use mser3d_comptree::{CommonAncestors, ComponentTree, Polarity};
use proptest::prelude::*;

fn path(n: usize) -> Vec<[u32; 2]> {
    (1..n as u32).map(|v| [v - 1, v]).collect()
}

/// Trees of paths, some of them broken into a forest, with and without ties.
fn trees() -> impl Strategy<Value = ComponentTree> {
    let heights = prop_oneof![
        prop::collection::vec((0u8..6).prop_map(f64::from), 1..40),
        prop::collection::vec(-5.0f64..5.0, 1..40),
    ];
    (heights, 2usize..50, any::<bool>()).prop_map(|(heights, gap, up)| {
        let edges: Vec<[u32; 2]> =
            path(heights.len()).into_iter().filter(|e| !(e[1] as usize).is_multiple_of(gap)).collect();
        let polarity = if up { Polarity::Superlevel } else { Polarity::Sublevel };
        ComponentTree::from_vertex_weights(&edges, &heights, 1.0, polarity).unwrap()
    })
}

fn position(v: u32) -> [f64; 3] {
    let v = f64::from(v);
    [v, (v * 1.7).sin(), 0.25 * v * v]
}

proptest! {
    #[test]
    fn a_common_ancestor_is_the_first_that_contains_both(tree in trees()) {
        let ancestors = CommonAncestors::new(&tree);
        for a in 0..tree.len() as u32 {
            for b in 0..tree.len() as u32 {
                let climbed = std::iter::successors(Some(a), |&n| tree.parent(n)).find(|&n| tree.contains(n, b));
                prop_assert_eq!(ancestors.of(a, b), climbed);
            }
        }
    }

    #[test]
    fn moments_and_boxes_are_those_of_the_vertices(tree in trees()) {
        let volume = |v: u32| 1.0 + f64::from(v % 3);
        let volumes: Vec<f64> = (0..tree.vertex_count() as u32).map(volume).collect();
        let moments = tree.moments(position, &volumes);
        let boxes = tree.bounding_boxes(position);
        for node in 0..tree.len() as u32 {
            let vertices = tree.vertices(node);
            let total: f64 = vertices.iter().map(|&v| volume(v)).sum();
            let mean: [f64; 3] = std::array::from_fn(|i| vertices.iter().map(|&v| volume(v) * position(v)[i]).sum::<f64>() / total);
            let found = moments[node as usize];
            prop_assert!((found.volume - total).abs() < 1e-9);
            for i in 0..3 {
                prop_assert!((found.centroid[i] - mean[i]).abs() < 1e-9);
                let least = vertices.iter().map(|&v| position(v)[i]).fold(f64::INFINITY, f64::min);
                let most = vertices.iter().map(|&v| position(v)[i]).fold(f64::NEG_INFINITY, f64::max);
                prop_assert_eq!((boxes[node as usize].min[i], boxes[node as usize].max[i]), (least, most));
                for j in 0..3 {
                    let product = |v: u32| volume(v) * (position(v)[i] - mean[i]) * (position(v)[j] - mean[j]);
                    let expected = vertices.iter().map(|&v| product(v)).sum::<f64>() / total;
                    prop_assert!((found.matrix()[i][j] - expected).abs() < 1e-7 * (1.0 + expected.abs()));
                }
            }
        }
    }

    #[test]
    fn persistence_is_what_climbing_to_a_lower_minimum_costs(tree in trees()) {
        let level = |n: u32| if tree.polarity() == Polarity::Sublevel { tree.altitude(n) } else { -tree.altitude(n) };
        // Lowest level, then the smallest vertex of the component next to the merge.
        let lowest = |n: u32| tree.descendants(n).map(level).fold(f64::INFINITY, f64::min);
        let persistence = tree.persistence();
        for node in 0..tree.len() as u32 {
            let (mut at, mut expected) = (node, None);
            while let Some(parent) = tree.parent(at) {
                let loses = tree.children(parent).any(|other| {
                    let key = |n: u32| (lowest(n), tree.vertices(n).iter().min().copied());
                    other != at && key(other) < key(at)
                });
                if loses {
                    expected = Some(level(parent) - lowest(node));
                    break;
                }
                at = parent;
            }
            prop_assert_eq!(persistence[node as usize], expected.unwrap_or(level(at) - lowest(node)));
        }
    }

    #[test]
    fn a_filtered_tree_keeps_what_it_should(tree in trees(), keep in prop::collection::vec(any::<bool>(), 40)) {
        let kept = |n: u32| keep[n as usize % keep.len()];
        let filtered = tree.filter(kept, 1.0).unwrap();
        check_structure(&filtered);
        let sets = |tree: &ComponentTree, keep: &dyn Fn(u32) -> bool| {
            let set = |n: u32| {
                let mut set = tree.vertices(n).to_vec();
                set.sort_unstable();
                (set, tree.altitude(n).to_bits(), tree.volume(n).to_bits())
            };
            let mut sets: Vec<_> = (0..tree.len() as u32).filter(|&n| keep(n)).map(set).collect();
            sets.sort();
            sets
        };
        prop_assert_eq!(sets(&filtered, &|_| true), sets(&tree, &|n| kept(n) || tree.parent(n).is_none()));
        prop_assert_eq!(&tree.filter(|_| true, 1.0).unwrap(), &tree);
    }

    #[test]
    fn a_cut_is_the_threshold_graph(tree in trees(), level in -6.0f64..6.0) {
        let weights = tree.reconstruct();
        let inside = |v: usize| if tree.polarity() == Polarity::Sublevel { weights[v] <= level } else { weights[v] >= level };
        let nodes = tree.cut(level);
        let labels = tree.labels(&nodes);
        for v in 0..weights.len() {
            prop_assert_eq!(labels[v].is_some(), inside(v));
        }
        for (place, &node) in nodes.iter().enumerate() {
            prop_assert!(tree.vertices(node).iter().all(|&v| labels[v as usize] == Some(place as u32)));
        }
    }

    #[test]
    fn a_saved_tree_comes_back_and_a_damaged_one_does_not_panic(tree in trees(), at in any::<usize>(), bit in 0u8..8) {
        let mut bytes = Vec::new();
        tree.save(&mut bytes).unwrap();
        prop_assert_eq!(&ComponentTree::load(&bytes[..]).unwrap(), &tree);
        prop_assert!(ComponentTree::load(&bytes[..bytes.len() - 1]).is_err());
        let at = at % bytes.len();
        bytes[at] ^= 1 << bit;
        if let Ok(damaged) = ComponentTree::load(&bytes[..]) {
            for node in 0..damaged.len() as u32 {
                let _ = (damaged.vertices(node).len(), damaged.volume(node), damaged.children(node).count());
            }
        }
    }
}

#[test]
fn volumes_that_differ_are_saved() {
    let tree = ComponentTree::from_vertex_weights(
        &path(3),
        &[1.0, 2.0, 0.5],
        &vec![1.0, 2.0, 3.0],
        Polarity::Sublevel,
    )
    .unwrap();
    let mut bytes = Vec::new();
    tree.save(&mut bytes).unwrap();
    let back = ComponentTree::load(&bytes[..]).unwrap();
    assert_eq!((back.total_volume(), &back), (6.0, &tree));
}

#[test]
fn labels_name_the_innermost_region() {
    let tree =
        ComponentTree::from_vertex_weights(&path(4), &[1.0, 2.0, 3.0, 4.0], 1.0, Polarity::Sublevel).unwrap();
    assert_eq!(tree.labels(&[2, 0]), [Some(1), Some(0), Some(0), None]);
}

#[test]
fn a_tree_as_a_graph_has_an_edge_to_each_parent() {
    let tree =
        ComponentTree::from_vertex_weights(&path(3), &[1.0, 5.0, 2.0], 1.0, Polarity::Sublevel).unwrap();
    let graph = tree.to_petgraph();
    assert_eq!((graph.node_count(), graph.edge_count()), (3, 2));
    assert!(!petgraph::algo::is_cyclic_directed(&graph));
    let dot = tree.dot().to_string();
    assert!(
        dot.starts_with("digraph {")
            && dot.contains("2 -> 0")
            && dot.contains("2 -> 1")
            && dot.ends_with('}')
    );
}

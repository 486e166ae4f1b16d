//! Trees against their definition: the components of threshold graphs.
use super::common::{check_structure, components_by_threshold, components_of};
use mser3d_comptree::{ComponentTree, Polarity, TreeError};
use proptest::prelude::*;

/// A graph with few distinct weights, so that ties abound; often not connected.
fn graph() -> impl Strategy<Value = (usize, Vec<([u32; 2], f64)>, Vec<f64>)> {
    (1usize..12).prop_flat_map(|n| {
        let vertex = 0..n as u32;
        let edge = ([vertex.clone(), vertex], 0u8..6).prop_map(|(e, w)| (e, f64::from(w) - 2.0));
        (Just(n), prop::collection::vec(edge, 0..20), prop::collection::vec((0u8..5).prop_map(f64::from), n))
    })
}

fn polarity() -> impl Strategy<Value = Polarity> {
    prop_oneof![Just(Polarity::Sublevel), Just(Polarity::Superlevel)]
}

fn edge_tree(n: usize, edges: &[([u32; 2], f64)], polarity: Polarity) -> ComponentTree {
    let (pairs, weights): (Vec<_>, Vec<_>) = edges.iter().copied().unzip();
    ComponentTree::from_edge_weights(n, &pairs, &weights, 1.0, polarity).unwrap()
}

proptest! {
    #[test]
    fn an_edge_tree_has_the_components_of_all_threshold_graphs((n, edges, _) in graph(), polarity in polarity()) {
        let tree = edge_tree(n, &edges, polarity);
        check_structure(&tree);
        prop_assert_eq!(components_of(&tree), components_by_threshold(n, None, &edges, polarity));
    }

    #[test]
    fn a_vertex_tree_has_the_components_of_all_threshold_graphs((n, edges, weights) in graph(), polarity in polarity()) {
        let pairs: Vec<[u32; 2]> = edges.iter().map(|e| e.0).collect();
        let tree = ComponentTree::from_vertex_weights(&pairs, &weights, 1.0, polarity).unwrap();
        check_structure(&tree);
        let always: Vec<([u32; 2], f64)> = pairs
            .iter()
            .map(|&[u, v]| {
                let (a, b) = (weights[u as usize], weights[v as usize]);
                ([u, v], if polarity == Polarity::Sublevel { a.max(b) } else { a.min(b) })
            })
            .collect();
        prop_assert_eq!(components_of(&tree), components_by_threshold(n, Some(&weights), &always, polarity));
    }

    #[test]
    fn a_monotone_transform_keeps_the_sets((n, edges, weights) in graph()) {
        let steep = |w: f64| (0.7 * w).exp() - 5.0;
        let transformed: Vec<_> = edges.iter().map(|&(e, w)| (e, steep(w))).collect();
        let (a, b) = (edge_tree(n, &edges, Polarity::Sublevel), edge_tree(n, &transformed, Polarity::Sublevel));
        prop_assert_eq!(a.permutation(), b.permutation());
        for node in 0..a.len() as u32 {
            prop_assert_eq!(a.vertices(node), b.vertices(node));
        }
        // A decreasing transform with the polarity reversed does too.
        let pairs: Vec<[u32; 2]> = edges.iter().map(|e| e.0).collect();
        let negative: Vec<f64> = weights.iter().map(|w| -w).collect();
        let a = ComponentTree::from_vertex_weights(&pairs, &weights, 1.0, Polarity::Sublevel).unwrap();
        let b = ComponentTree::from_vertex_weights(&pairs, &negative, 1.0, Polarity::Superlevel).unwrap();
        prop_assert_eq!(a.permutation(), b.permutation());
        prop_assert!((0..a.len() as u32).all(|i| a.altitude(i) == -b.altitude(i) && a.vertices(i) == b.vertices(i)));
    }

    #[test]
    fn the_order_of_edges_does_not_matter((n, edges, weights) in graph(), seed in any::<u64>()) {
        let mut shuffled = edges.clone();
        shuffled.sort_by_key(|(e, _)| (u64::from(e[0] * 31 + e[1])).wrapping_mul(seed | 1).rotate_left(17));
        shuffled.iter_mut().for_each(|(e, _)| e.reverse());
        prop_assert_eq!(edge_tree(n, &edges, Polarity::Sublevel), edge_tree(n, &shuffled, Polarity::Sublevel));
        let pairs = |edges: &[([u32; 2], f64)]| edges.iter().map(|e| e.0).collect::<Vec<_>>();
        let of = |pairs: &[[u32; 2]]| ComponentTree::from_vertex_weights(pairs, &weights, 1.0, Polarity::Sublevel).unwrap();
        prop_assert_eq!(of(&pairs(&edges)), of(&pairs(&shuffled)));
    }

    #[test]
    fn relabelling_the_vertices_relabels_the_sets((n, edges, _) in graph(), shift in 0u32..12) {
        let to = |v: u32| (v * 7 + shift) % n as u32; // a bijection unless 7 divides n
        prop_assume!(n % 7 != 0);
        let moved: Vec<_> = edges.iter().map(|&(e, w)| (e.map(to), w)).collect();
        let relabelled = |tree: &ComponentTree| {
            let mut sets: Vec<_> = components_of(tree)
                .into_iter()
                .map(|(set, level)| {
                    let mut set: Vec<u32> = set.into_iter().map(to).collect();
                    set.sort_unstable();
                    (set, level)
                })
                .collect();
            sets.sort_by(|a, b| a.0.cmp(&b.0));
            sets
        };
        let tree = edge_tree(n, &edges, Polarity::Sublevel);
        prop_assert_eq!(relabelled(&tree), components_of(&edge_tree(n, &moved, Polarity::Sublevel)));
    }

    #[test]
    fn volumes_are_sums_over_the_slices((n, edges, volumes) in graph()) {
        let (pairs, weights): (Vec<_>, Vec<_>) = edges.iter().copied().unzip();
        let tree = ComponentTree::from_edge_weights(n, &pairs, &weights, &volumes, Polarity::Sublevel).unwrap();
        for node in 0..tree.len() as u32 {
            let sum: f64 = tree.vertices(node).iter().map(|&v| volumes[v as usize]).sum();
            prop_assert_eq!(tree.volume(node), sum); // small integers: exact in any order
        }
        prop_assert_eq!(tree.total_volume(), volumes.iter().sum::<f64>());
    }

    #[test]
    fn merges_have_the_weights_of_petgraphs_minimum_spanning_forest((n, edges, _) in graph()) {
        use petgraph::algo::min_spanning_tree;
        use petgraph::graph::UnGraph;
        let mut graph = UnGraph::<(), f64>::default();
        let nodes: Vec<_> = (0..n).map(|_| graph.add_node(())).collect();
        for &([u, v], w) in &edges {
            graph.add_edge(nodes[u as usize], nodes[v as usize], w);
        }
        let mut forest: Vec<f64> = min_spanning_tree(&graph)
            .filter_map(|element| match element {
                petgraph::data::Element::Edge { weight, .. } => Some(weight),
                petgraph::data::Element::Node { .. } => None,
            })
            .collect();
        forest.sort_by(f64::total_cmp);
        // A node at which p parts join stands for p - 1 edges of any minimum spanning forest.
        let tree = edge_tree(n, &edges, Polarity::Sublevel);
        let merges = |i: u32| tree.children(i).count() + tree.own_vertices(i).len() - 1;
        let mut altitudes: Vec<f64> = (0..tree.len() as u32)
            .flat_map(|i| std::iter::repeat_n(tree.altitude(i), merges(i)))
            .collect();
        altitudes.sort_by(f64::total_cmp);
        prop_assert_eq!(altitudes, forest);
    }
}

#[test]
fn all_equal_weights_are_one_node() {
    let edges: Vec<([u32; 2], f64)> = (0..9).map(|i| ([i, i + 1], 3.0)).collect();
    let tree = edge_tree(10, &edges, Polarity::Sublevel);
    assert_eq!((tree.len(), tree.altitude(0), tree.vertices(0).len()), (1, 3.0, 10));
    let pairs: Vec<[u32; 2]> = edges.iter().map(|e| e.0).collect();
    let tree = ComponentTree::from_vertex_weights(&pairs, &[3.0; 10], 1.0, Polarity::Superlevel).unwrap();
    assert_eq!((tree.len(), tree.altitude(0), tree.own_vertices(0).len()), (1, 3.0, 10));
}

#[test]
fn both_zeros_are_one_altitude() {
    let tree = ComponentTree::from_vertex_weights(&[[0, 1]], &[0.0, -0.0], 1.0, Polarity::Sublevel).unwrap();
    assert_eq!(tree.len(), 1);
    let tree =
        ComponentTree::from_vertex_weights(&[[0, 1]], &[-0.0, 0.0], 1.0, Polarity::Superlevel).unwrap();
    assert_eq!((tree.len(), tree.altitude(0).is_sign_positive()), (1, true));
}

#[test]
fn nothing_one_vertex_and_a_vertex_without_edges() {
    let none = ComponentTree::from_vertex_weights::<f64>(&[], &[], 1.0, Polarity::Sublevel).unwrap();
    assert!(none.is_empty() && none.roots().next().is_none() && none.total_volume() == 0.0);
    let one = ComponentTree::from_vertex_weights(&[], &[7.0], 2.5, Polarity::Sublevel).unwrap();
    assert_eq!((one.len(), one.altitude(0), one.volume(0), one.parent(0)), (1, 7.0, 2.5, None));
    let alone = edge_tree(3, &[([0, 2], 1.0)], Polarity::Superlevel);
    let roots: Vec<(f64, &[u32])> = alone.roots().map(|r| (alone.altitude(r), alone.vertices(r))).collect();
    assert_eq!(roots, [(f64::INFINITY, &[1][..]), (1.0, &[0, 2][..])]);
}

#[test]
fn infinite_weights_enter_last() {
    let tree = edge_tree(3, &[([0, 1], f64::INFINITY), ([1, 2], 1e300)], Polarity::Sublevel);
    let root = tree.roots().next().unwrap();
    assert_eq!((tree.altitude(root), tree.len()), (f64::INFINITY, 2));
}

#[test]
fn bad_input_is_named() {
    let error = |weights: &[f64], volumes: &[f64]| {
        ComponentTree::from_vertex_weights(&[[0, 1]], weights, volumes, Polarity::Sublevel).unwrap_err()
    };
    assert_eq!(error(&[0.0, f64::NAN], &[1.0; 2]), TreeError::NotANumber { what: "vertex", index: 1 });
    assert_eq!(error(&[0.0; 2], &[1.0, -1.0]), TreeError::BadVolume { vertex: 1, volume: -1.0 });
    assert!(matches!(error(&[0.0; 2], &[1.0]), TreeError::SizeMismatch { found: 1, expected: 2, .. }));
    assert_eq!(error(&[0.0], &[1.0]), TreeError::IndexOutOfRange { edge: 0, index: 1, vertices: 1 });
    let nan =
        ComponentTree::from_edge_weights(2, &[[0, 1]], &[f64::NAN], 1.0, Polarity::Sublevel).unwrap_err();
    assert!(nan.to_string().contains("the weight of edge 0 is NaN"));
}

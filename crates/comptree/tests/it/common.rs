//! The definition of a component tree, followed literally.
use std::collections::BTreeSet;

use mser3d_comptree::{ComponentTree, Polarity};

/// A component: sorted vertices, and the first level at which this very set is a component.
pub type Component = (Vec<u32>, f64);

/// All components with at least one edge or vertex entered, by thresholding at each level.
pub fn components_by_threshold(
    n: usize,
    vertex_levels: Option<&[f64]>,
    edges: &[([u32; 2], f64)],
    polarity: Polarity,
) -> Vec<Component> {
    let below = |w: f64, level: f64| match polarity {
        Polarity::Sublevel => w <= level,
        Polarity::Superlevel => w >= level,
    };
    let lowest = match polarity {
        Polarity::Sublevel => f64::NEG_INFINITY,
        Polarity::Superlevel => f64::INFINITY,
    };
    let mut levels: Vec<f64> =
        edges.iter().map(|e| e.1).chain(vertex_levels.into_iter().flatten().copied()).collect();
    levels.push(lowest);
    levels.sort_by(|a, b| a.partial_cmp(b).unwrap());
    levels.dedup();
    if polarity == Polarity::Superlevel {
        levels.reverse();
    }
    let mut known = BTreeSet::new();
    let mut found = Vec::new();
    for level in levels {
        let inside = |v: usize| vertex_levels.is_none_or(|w| below(w[v], level));
        let mut label: Vec<usize> = (0..n).collect();
        loop {
            let before = label.clone();
            for &([u, v], w) in edges {
                let (u, v) = (u as usize, v as usize);
                if below(w, level) && inside(u) && inside(v) {
                    let least = label[u].min(label[v]);
                    (label[u], label[v]) = (least, least);
                }
            }
            if label == before {
                break;
            }
        }
        for root in 0..n {
            let set: Vec<u32> = (0..n).filter(|&v| inside(v) && label[v] == root).map(|v| v as u32).collect();
            // Single vertices are no nodes of an edge-weighted tree unless nothing ever joins them.
            let alone = vertex_levels.is_none() && set.len() == 1;
            let joined = alone && edges.iter().any(|(e, _)| e.contains(&set[0]) && e[0] != e[1]);
            if !set.is_empty() && !joined && known.insert(set.clone()) {
                found.push((set, level));
            }
        }
    }
    found.sort_by(|a, b| a.0.cmp(&b.0));
    found
}

/// The components of a tree in the same form.
pub fn components_of(tree: &ComponentTree) -> Vec<Component> {
    let sorted = |node: u32| {
        let mut set = tree.vertices(node).to_vec();
        set.sort_unstable();
        (set, tree.altitude(node))
    };
    let mut found: Vec<Component> = (0..tree.len() as u32).map(sorted).collect();
    found.sort_by(|a, b| a.0.cmp(&b.0));
    found
}

/// What must hold in every tree, whatever it was built from.
pub fn check_structure(tree: &ComponentTree) {
    let mut permutation = tree.permutation().to_vec();
    permutation.sort_unstable();
    assert!(permutation.iter().enumerate().all(|(i, &v)| i as u32 == v), "a permutation");
    let childless = (0..tree.len() as u32).filter(|&node| tree.children(node).next().is_none());
    assert!(tree.leaves().eq(childless));
    for node in 0..tree.len() as u32 {
        let set: BTreeSet<u32> = tree.vertices(node).iter().copied().collect();
        if let Some(parent) = tree.parent(node) {
            assert!(parent > node && tree.contains(parent, node) && !tree.contains(node, parent));
            let rises = match tree.polarity() {
                Polarity::Sublevel => tree.altitude(parent) > tree.altitude(node),
                Polarity::Superlevel => tree.altitude(parent) < tree.altitude(node),
            };
            assert!(rises, "altitudes differ from node to parent");
            assert!(tree.children(parent).any(|c| c == node));
        } else {
            assert!(tree.roots().any(|r| r == node));
        }
        // The children's slices and the own vertices, end to end.
        let mut children: Vec<u32> = tree.children(node).collect();
        children.reverse();
        let parts: Vec<u32> =
            children.iter().flat_map(|&c| tree.vertices(c)).chain(tree.own_vertices(node)).copied().collect();
        assert_eq!(parts, tree.vertices(node));
        assert!(
            children.len() != 1 || !tree.own_vertices(node).is_empty(),
            "no node repeats its child's set"
        );
        let least: Vec<u32> = children.iter().map(|&c| *tree.vertices(c).iter().min().unwrap()).collect();
        assert!(least.is_sorted(), "siblings by smallest vertex");
        assert!(tree.own_vertices(node).is_sorted());
        for v in 0..tree.vertex_count() as u32 {
            assert_eq!(tree.contains(node, tree.node_of(v)), set.contains(&v));
        }
    }
}

/// A component told by its number of vertices, the sum of their squares, and the bits of its altitude.
pub type Fact = (usize, u128, u64);

/// Kruskal's algorithm without any cleverness: the facts of all components of more than one vertex.
pub fn facts_by_kruskal(n: usize, edges: &[[u32; 2]], weights: &[f64]) -> Vec<Fact> {
    let mut order: Vec<usize> = (0..edges.len()).collect();
    order.sort_by(|&a, &b| weights[a].total_cmp(&weights[b]));
    let mut sets = mser3d_shape::DisjointSets::new(n);
    let mut size = vec![1; n];
    let mut squares: Vec<u128> = (0..n as u128).map(|v| v * v).collect();
    let mut facts = Vec::new();
    for level in order.chunk_by(|&a, &b| weights[a] == weights[b]) {
        let mut changed = BTreeSet::new();
        for &edge in level {
            if let Some((stays, goes)) = sets.union(edges[edge][0], edges[edge][1]) {
                size[stays as usize] += size[goes as usize];
                squares[stays as usize] += squares[goes as usize];
                changed.insert(stays);
            }
        }
        for set in changed {
            if sets.find(set) == set {
                facts.push((size[set as usize], squares[set as usize], (weights[level[0]] + 0.0).to_bits()));
            }
        }
    }
    facts.sort_unstable();
    facts
}

/// The same of a tree.
pub fn facts_of(tree: &ComponentTree) -> Vec<Fact> {
    let squares = tree.accumulate(|v| u128::from(v).pow(2), |a, b| *a += b);
    let fact = |i: u32| (tree.vertices(i).len(), squares[i as usize], tree.altitude(i).to_bits());
    let mut facts: Vec<Fact> = (0..tree.len() as u32).map(fact).filter(|f| f.0 > 1).collect();
    facts.sort_unstable();
    facts
}

//! Higra's answers on small fields (Perret et al. 2019), with ties, masks and all stencils: its min-trees and
//! quasi-flat zones have the same nodes. `experiments/peers/tree.py fixtures` asked it.
use mser3d_comptree::{ComponentTree, Polarity};
use mser3d_shape::{BitGrid, Connectivity, Frame, VoxelGrid};

const ANSWERS: &str = include_str!("data/higra.txt");

/// Altitude and number of vertices of a node, and of its parent; a root is its own.
type Node = [f64; 4];

struct Case {
    edge: bool,
    /// 4, 8, 6, 18 or 26.
    neighbours: usize,
    dims: [usize; 3],
    /// Of all voxels.
    values: Vec<f64>,
    mask: Vec<bool>,
    /// Sorted.
    nodes: Vec<Node>,
    /// Altitude and number of vertices of the smallest node that contains each vertex.
    smallest: Vec<[f64; 2]>,
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|number| number.parse().unwrap()).collect()
}

fn cases() -> Vec<Case> {
    let lines: Vec<&str> = ANSWERS.lines().skip(1).collect();
    let case = |lines: &[&str]| {
        let field = |i: usize, name: &str| lines[i].strip_prefix(name).unwrap();
        let head: Vec<&str> = field(0, "case ").split(' ').collect();
        let dims: Vec<usize> = head[2..].iter().map(|n| n.parse().unwrap()).collect();
        Case {
            edge: head[0] == "edge",
            neighbours: head[1].parse().unwrap(),
            dims: dims.try_into().unwrap(),
            values: numbers(field(1, "values ")),
            mask: field(2, "mask ").bytes().map(|b| b == b'1').collect(),
            nodes: numbers(field(3, "nodes ")).as_chunks().0.to_vec(),
            smallest: numbers(field(4, "smallest ")).as_chunks().0.to_vec(),
        }
    };
    lines.chunks(5).map(case).collect()
}

/// Pairs of voxels that share a face or an edge.
fn edges_of_18(dims: [usize; 3]) -> Vec<[u32; 2]> {
    let at = |v: usize| [v % dims[0], v / dims[0] % dims[1], v / dims[0] / dims[1]];
    let near = |u: usize, v: usize| {
        let apart: [usize; 3] = std::array::from_fn(|a| at(u)[a].abs_diff(at(v)[a]));
        apart.iter().all(|&d| d <= 1) && (1..=2).contains(&apart.iter().sum::<usize>())
    };
    let n = dims.iter().product();
    let pairs = (0..n).flat_map(|u| (u + 1..n).map(move |v| [u, v]));
    pairs.filter(|&[u, v]| near(u, v)).map(|pair| pair.map(|v| v as u32)).collect()
}

/// The tree by the implicit grid for what it is, a box or a mask; of 18 neighbours by a list of edges.
fn tree(case: &Case, values: &[f64], polarity: Polarity) -> ComponentTree {
    let Case { edge, neighbours, dims, mask, .. } = case;
    // In one slice six neighbours are four, and 26 are eight.
    let connectivity = if [4, 6].contains(neighbours) { Connectivity::Six } else { Connectivity::TwentySix };
    let difference = |values: &[f64], u: u32, v: u32| {
        polarity_sign(polarity) * (values[u as usize] - values[v as usize]).abs()
    };
    let built = if *neighbours == 18 {
        let edges = edges_of_18(*dims);
        if *edge {
            let weights: Vec<f64> = edges.iter().map(|&[u, v]| difference(values, u, v)).collect();
            ComponentTree::from_edge_weights(values.len(), &edges, &weights, 1.0, polarity)
        } else {
            ComponentTree::from_vertex_weights(&edges, values, 1.0, polarity)
        }
    } else if mask.iter().all(|&inside| inside) {
        if *edge {
            ComponentTree::from_grid_edges(
                *dims,
                connectivity,
                |u, v| difference(values, u, v),
                1.0,
                polarity,
            )
        } else {
            ComponentTree::from_grid(*dims, connectivity, values, 1.0, polarity)
        }
    } else {
        let mut bits = BitGrid::empty(*dims).unwrap();
        for (v, &inside) in mask.iter().enumerate() {
            let position = [v % dims[0], v / dims[0] % dims[1], v / dims[0] / dims[1]];
            bits.set(position.map(|c| c as u32), inside);
        }
        let inside: Vec<f64> =
            values.iter().zip(mask).filter(|(_, inside)| **inside).map(|(v, _)| *v).collect();
        if *edge {
            let frame = Frame::new(*dims, [0.0; 3], [1.0; 3]).unwrap();
            let grid = VoxelGrid::solid(frame, bits).unwrap();
            let weight = |u, v| difference(&inside, u, v);
            ComponentTree::from_voxel_grid_edges(&grid, connectivity, weight, 1.0, polarity)
        } else {
            ComponentTree::from_mask(&bits, connectivity, &inside, 1.0, polarity)
        }
    };
    built.unwrap()
}

fn polarity_sign(polarity: Polarity) -> f64 {
    if polarity == Polarity::Sublevel { 1.0 } else { -1.0 }
}

fn check(case: &Case, tree: &ComponentTree, sign: f64) {
    let own = |node: u32| [sign * tree.altitude(node) + 0.0, tree.volume(node)];
    let with_parent = |node: u32| {
        let ([a, n], [b, m]) = (own(node), own(tree.parent(node).unwrap_or(node)));
        [a, n, b, m]
    };
    let mut nodes: Vec<Node> = (0..tree.len() as u32).map(with_parent).collect();
    nodes.sort_by(|a, b| a.partial_cmp(b).unwrap());
    assert_eq!(nodes, case.nodes);
    let smallest: Vec<[f64; 2]> = tree.nodes_of_vertices().iter().map(|&node| own(node)).collect();
    assert_eq!(smallest, case.smallest);
}

#[test]
fn nodes_parents_and_the_place_of_each_vertex_are_higras() {
    let cases = cases();
    assert_eq!(cases.len(), 28);
    for case in &cases {
        check(case, &tree(case, &case.values, Polarity::Sublevel), 1.0);
        // The same upside down.
        let negative: Vec<f64> = case.values.iter().map(|v| -v).collect();
        check(case, &tree(case, &negative, Polarity::Superlevel), -1.0);
    }
}

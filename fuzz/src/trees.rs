//! Component trees beside their definition: the components of all threshold graphs, counted out.

use arbitrary::Unstructured;
use mser3d_comptree::{ComponentTree, Polarity};
use mser3d_shape::{BitGrid, Connectivity, Frame, VoxelGrid};

#[allow(dead_code)]
#[path = "../../crates/comptree/tests/it/common.rs"]
mod common;

use common::{check_structure, components_by_threshold, components_of};

pub fn run(input: &[u8]) {
    let mut input = Unstructured::new(input);
    let _ = match input.arbitrary::<bool>() {
        Ok(true) => graphs(&mut input),
        Ok(false) => grids(&mut input),
        Err(error) => Err(error),
    };
}

fn polarity(input: &mut Unstructured) -> arbitrary::Result<Polarity> {
    Ok(if input.arbitrary()? { Polarity::Sublevel } else { Polarity::Superlevel })
}

/// Few different weights, so that ties abound, and both zeros.
fn weight(input: &mut Unstructured) -> arbitrary::Result<f64> {
    Ok(*input.choose(&[-2.0, -1.0, -0.0, 0.0, 0.5, 1.0, 3.0, 1e300])?)
}

/// What enters with its two ends.
fn of_ends(pairs: &[[u32; 2]], weights: &[f64], polarity: Polarity) -> Vec<([u32; 2], f64)> {
    let later = |[u, v]: [u32; 2]| match polarity {
        Polarity::Sublevel => weights[u as usize].max(weights[v as usize]),
        Polarity::Superlevel => weights[u as usize].min(weights[v as usize]),
    };
    pairs.iter().map(|&pair| (pair, later(pair))).collect()
}

fn compare(tree: &ComponentTree, n: usize, weights: Option<&[f64]>, edges: &[([u32; 2], f64)]) {
    check_structure(tree);
    assert_eq!(components_of(tree), components_by_threshold(n, weights, edges, tree.polarity()));
}

fn graphs(input: &mut Unstructured) -> arbitrary::Result<()> {
    let n = input.int_in_range(1..=12usize)?;
    let polarity = polarity(input)?;
    let mut edges = Vec::new();
    for _ in 0..input.int_in_range(0..=20)? {
        let ends = [input.int_in_range(0..=n as u32 - 1)?, input.int_in_range(0..=n as u32 - 1)?];
        edges.push((ends, weight(input)?));
    }
    let weights: Vec<f64> = (0..n).map(|_| weight(input)).collect::<Result<_, _>>()?;
    let pairs: Vec<[u32; 2]> = edges.iter().map(|edge| edge.0).collect();
    let values: Vec<f64> = edges.iter().map(|edge| edge.1).collect();
    let tree = ComponentTree::from_edge_weights(n, &pairs, &values, 1.0, polarity);
    compare(&tree.unwrap_or_else(|error| panic!("{error}")), n, None, &edges);
    let tree = ComponentTree::from_vertex_weights(&pairs, &weights, 1.0, polarity);
    let tree = tree.unwrap_or_else(|error| panic!("{error}"));
    compare(&tree, n, Some(&weights), &of_ends(&pairs, &weights, polarity));
    Ok(())
}

/// Voxels with cut links, whose trees are built without a graph.
fn grids(input: &mut Unstructured) -> arbitrary::Result<()> {
    let polarity = polarity(input)?;
    let dims = [input.int_in_range(1..=4)?, input.int_in_range(1..=3)?, input.int_in_range(1..=3)?];
    let frame = Frame::new(dims, [0.0; 3], [1.0; 3]).unwrap_or_else(|error| panic!("{error}"));
    let mut inside = BitGrid::empty(dims).unwrap_or_else(|error| panic!("{error}"));
    let places: Vec<[u32; 3]> = (0..dims.iter().product::<usize>())
        .map(|v| [v % dims[0], v / dims[0] % dims[1], v / dims[0] / dims[1]].map(|x| x as u32))
        .collect();
    for &place in &places {
        inside.set(place, input.ratio(4, 5)?);
    }
    let mut grid = VoxelGrid::solid(frame, inside).unwrap_or_else(|error| panic!("{error}"));
    for axis in 0..3 {
        let mut cut = Vec::new();
        for &place in &places {
            if input.ratio(1, 8)? {
                cut.push(place);
            }
        }
        grid = grid.with_cut_links(axis, &cut).0;
    }
    if grid.is_empty() {
        return Ok(());
    }
    let weights: Vec<f64> = (0..grid.len()).map(|_| weight(input)).collect::<Result<_, _>>()?;
    let tree = ComponentTree::from_voxel_grid(&grid, Connectivity::Six, &weights, 1.0, polarity);
    let tree = tree.unwrap_or_else(|error| panic!("{error}"));
    let pairs: Vec<[u32; 2]> = (0..3).flat_map(|axis| grid.linked_pairs(axis)).collect();
    compare(&tree, grid.len(), Some(&weights), &of_ends(&pairs, &weights, polarity));
    Ok(())
}

pub fn seeds() -> Vec<Vec<u8>> {
    (0..16u8).map(|kind| (0..80u8).map(|i| i.wrapping_mul(kind | 1).wrapping_add(kind)).collect()).collect()
}

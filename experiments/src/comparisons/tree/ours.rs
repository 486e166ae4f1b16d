//! Our trees, in a process of their own.

use std::error::Error;
use std::hint::black_box;
use std::path::Path;

use mser3d::comptree::{ComponentTree, GreyValue, Polarity, TreeError};
use mser3d::shape::{Connectivity, SplitMix64};
use serde_json::json;

use super::field::Numbers;
use crate::comparisons::resources::{Stopwatch, resident};

/// Builds the tree of a field and prints what it took and what came out, as JSON. A small one is built many
/// times: processor time comes in steps of a hundredth of a second.
pub fn build_and_print(
    weights: &str,
    path: &Path,
    numbers: &str,
    dims: [usize; 3],
) -> Result<(), Box<dyn Error>> {
    let bytes = std::fs::read(path)?;
    match Numbers::of_name(numbers).ok_or("no such type of numbers")? {
        Numbers::F64 => print(
            weights,
            &bytes.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect::<Vec<_>>(),
            dims,
        ),
        Numbers::U16 => print(
            weights,
            &bytes.as_chunks().0.iter().map(|b| u16::from_le_bytes(*b)).collect::<Vec<_>>(),
            dims,
        ),
        Numbers::U8 => print(weights, &bytes, dims),
    }
}

fn print<V: GreyValue>(weights: &str, values: &[V], dims: [usize; 3]) -> Result<(), Box<dyn Error>> {
    let build = || -> Result<ComponentTree, TreeError> {
        let value = |v: u32| -> f64 { values[v as usize].into() };
        let difference = |u: u32, v: u32| (value(u) - value(v)).abs();
        match weights {
            "edge" => {
                ComponentTree::from_grid_edges(dims, Connectivity::Six, difference, 1.0, Polarity::Sublevel)
            }
            _ => {
                ComponentTree::from_grid(dims, Connectivity::Six, black_box(values), 1.0, Polarity::Sublevel)
            }
        }
    };
    let before = resident();
    let whole = Stopwatch::start();
    let (mut wall, mut count, mut spent) = (f64::INFINITY, 0, 0.0);
    let tree = loop {
        let start = std::time::Instant::now();
        let tree = build()?;
        let seconds = start.elapsed().as_secs_f64();
        (wall, count, spent) = (wall.min(seconds), count + 1, spent + seconds);
        if spent > 1.0 {
            break tree;
        }
    };
    let usage = whole.stop();
    let (digest, nodes) = digest(&tree);
    let answer = json!({
        "cpu": usage.cpu / f64::from(count),
        "wall": wall,
        "memory": usage.peak - before,
        "digest": format!("{digest:016x}"),
        "nodes": nodes,
    });
    println!("{answer}");
    Ok(())
}

/// A number that trees share when their nodes of more than one vertex do: the sum of a hash of each node's
/// altitude and number of vertices and its parent's. And how many these nodes are.
fn digest(tree: &ComponentTree) -> (u64, usize) {
    const FACTORS: [u64; 4] =
        [0x9E37_79B9_7F4A_7C15, 0xC2B2_AE3D_27D4_EB4F, 0x1656_67B1_9E37_79F9, 0x27D4_EB2F_1656_67C5];
    let pair = |node: u32| [tree.altitude(node).to_bits(), tree.vertices(node).len() as u64];
    let hash = |node: u32| {
        let ([a, n], [b, m]) = (pair(node), pair(tree.parent(node).unwrap_or(node)));
        let sum = [a, n, b, m].into_iter().zip(FACTORS).map(|(x, factor)| x.wrapping_mul(factor));
        SplitMix64::mix(sum.fold(0, u64::wrapping_add))
    };
    let large = (0..tree.len() as u32).filter(|&node| tree.vertices(node).len() > 1);
    large.fold((0, 0), |(sum, count), node| (sum.wrapping_add(hash(node)), count + 1))
}

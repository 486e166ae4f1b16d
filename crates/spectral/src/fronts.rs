//! How long and how thin a body is, as heat sees it: which solver its shape suits.

use mser3d_shape::{Connectivity, DisjointSets, Graph, VoxelGrid};

use crate::SpectralError;

/// From this `sqrt(lambda_max / lambda_k)` on the inverse is faster on thin rods: the filter's work grows with it, that of the inverse does
/// not. Measured, as what follows, by `tests/it/choice.rs`.
const RANGE: f64 = 30.0;
/// By how much it is more for each voxel of a front: thick factors take longer.
const RANGE_PER_VOXEL: f64 = 1.0;

/// The fronts of a walk through the body from one of its ends: the voxels that are so many links away and hang together there. A tube
/// has one for each step along it, a body with many limbs one in each.
struct Fronts {
    /// How many there are: the length of all tubes together, in voxels.
    count: usize,
    /// Voxels in the front of a voxel, on average.
    mean_size: f64,
}

impl Fronts {
    fn of(graph: &Graph) -> Self {
        let n = graph.len();
        let level = levels(graph, *levels_order(graph, 0).last().unwrap_or(&0));
        let mut sets = DisjointSets::new(n);
        for v in 0..n as u32 {
            // Those on one side of a voxel hang together.
            for side in [level[v as usize].wrapping_sub(1), level[v as usize] + 1] {
                let mut first = None;
                for &u in graph.neighbours(v).iter().filter(|&&u| level[u as usize] == side) {
                    sets.union(u, *first.get_or_insert(u));
                }
            }
        }
        let mut sizes = vec![0u32; n];
        (0..n as u32).for_each(|v| sizes[sets.find(v) as usize] += 1);
        let squares: f64 = sizes.iter().map(|&size| f64::from(size).powi(2)).sum();
        Self { count: sizes.iter().filter(|&&size| size > 0).count(), mean_size: squares / n as f64 }
    }
}

/// Whether a connected grid is so long and thin that its first `k` eigenpairs are found faster by the inverse than by the filter.
///
/// Along tubes of the total length L the k-th eigenvalue is about `(pi k / L)^2`: the filter's polynomials grow with L / k. The factor of
/// a tube is as thin as the tube.
pub(crate) fn suits_inverse(grid: &VoxelGrid, k: usize) -> Result<bool, SpectralError> {
    let graph = grid.graph(Connectivity::Six).map_err(|_| SpectralError::Overflow)?;
    let Fronts { count, mean_size } = Fronts::of(&graph);
    let spacing = grid.frame().spacing();
    let links: [usize; 3] = std::array::from_fn(|axis| grid.linked_pairs(axis).count());
    let step = links.iter().zip(spacing).map(|(&links, h)| links as f64 * h).sum::<f64>()
        / links.iter().sum::<usize>().max(1) as f64;
    let length = count as f64 * step;
    let largest = 2.0 * spacing.iter().map(|h| 1.0 / (h * h)).sum::<f64>().sqrt();
    let smallest = std::f64::consts::PI * k as f64 / length;
    Ok(largest / smallest > RANGE + RANGE_PER_VOXEL * mean_size)
}

/// All vertices by their distance from one; of a connected graph.
fn levels_order(graph: &Graph, from: u32) -> Vec<u32> {
    let mut seen = vec![false; graph.len()];
    let mut order = Vec::with_capacity(graph.len());
    if graph.is_empty() {
        return order;
    }
    seen[from as usize] = true;
    order.push(from);
    let mut next = 0;
    while let Some(&v) = order.get(next) {
        next += 1;
        for &u in graph.neighbours(v) {
            if !std::mem::replace(&mut seen[u as usize], true) {
                order.push(u);
            }
        }
    }
    order
}

/// How many links each vertex is away from one.
fn levels(graph: &Graph, from: u32) -> Vec<u32> {
    let mut level = vec![u32::MAX - 1; graph.len()];
    let order = levels_order(graph, from);
    if let Some(&first) = order.first() {
        level[first as usize] = 0;
    }
    for v in order {
        for &u in graph.neighbours(v) {
            level[u as usize] = level[u as usize].min(level[v as usize] + 1);
        }
    }
    level
}

#[cfg(test)]
mod tests {
    use super::*;
    use mser3d_shape::{BitGrid, Frame};

    fn fronts(dims: [usize; 3], inside: impl Fn([u32; 3]) -> bool) -> Fronts {
        let mut bits = BitGrid::empty(dims).unwrap();
        BitGrid::full(dims).unwrap().ones().for_each(|v| bits.set(v, inside(v)));
        let frame = Frame::new(dims, [0.0; 3], [1.0; 3]).unwrap();
        Fronts::of(&VoxelGrid::solid(frame, bits).unwrap().graph(Connectivity::Six).unwrap())
    }

    #[test]
    fn fronts_are_as_many_as_a_body_is_long_and_as_large_as_it_is_thick() {
        let rod = fronts([1, 1, 100], |_| true);
        assert_eq!((rod.count, rod.mean_size), (100, 1.0));
        // From corner to corner.
        let plank = fronts([3, 2, 100], |_| true);
        assert_eq!(plank.count, 103);
        assert!((4.0..6.0).contains(&plank.mean_size), "{}", plank.mean_size);
        // Three arms of 50 that meet: from the end of one, through the others at once, whose first voxels are one front.
        let star = fronts([101, 51, 1], |[x, y, _]| y == 0 || x == 50);
        assert_eq!((star.count, star.mean_size), (150, 153.0 / 151.0));
    }
}

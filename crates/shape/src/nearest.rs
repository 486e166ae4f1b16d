use std::sync::OnceLock;

use crate::VoxelGrid;
use crate::word_tree::{Best, WordTree};

/// Shells of voxels around a point that are looked through one by one before the tree is asked. Surface vertices
/// have their voxel in the first two.
const SHELLS: i64 = 2;

/// Finds the occupied voxel nearest to points. Made by [`VoxelGrid::nearest`]; threads may share it.
///
/// A point near the solid costs a look at the voxels around it. Any other costs a search in a tree over the grid's
/// words of 64 voxels, which is made when the first such point comes: logarithmic in the number of voxels,
/// however far the point lies. The tree takes about 60 bytes for each word of the grid that has voxels in it.
#[derive(Debug)]
pub struct NearestVoxels<'g> {
    grid: &'g VoxelGrid,
    tree: OnceLock<WordTree>,
}

impl VoxelGrid {
    /// What finds the nearest voxels of many points.
    pub fn nearest(&self) -> NearestVoxels<'_> {
        NearestVoxels { grid: self, tree: OnceLock::new() }
    }

    /// The occupied voxel whose centre is nearest to each point; of several, the one with the
    /// smallest number. Empty for an empty grid.
    ///
    /// For the cost, and for points that come one by one, see [`NearestVoxels`].
    pub fn nearest_voxels(&self, points: &[[f64; 3]]) -> Vec<u32> {
        let nearest = self.nearest();
        points.iter().filter_map(|&point| nearest.voxel(point)).collect()
    }
}

impl NearestVoxels<'_> {
    /// The occupied voxel whose centre is nearest to a point; of several, the one with the smallest number. `None`
    /// for an empty grid. The lengths of the voxels along the three axes count.
    pub fn voxel(&self, point: [f64; 3]) -> Option<u32> {
        self.voxel_within(point, f64::INFINITY).map(|(voxel, _)| voxel)
    }

    /// The nearest occupied voxel, and the distance of its centre, if that is at most `distance`.
    pub fn voxel_within(&self, point: [f64; 3], distance: f64) -> Option<(u32, f64)> {
        if self.grid.is_empty() {
            return None;
        }
        // No number is as near as infinity, so a point that is none gets voxel 0.
        let at = self.grid.frame().locate(point).map(|x| if x.is_nan() { f64::INFINITY } else { x });
        let (mut best, found) = self.look_around(at);
        if !found {
            self.tree.get_or_init(|| WordTree::new(self.grid)).search(self.grid, at, &mut best);
        }
        let away = best.square.sqrt();
        (away <= distance).then_some((best.voxel, away))
    }

    /// The nearest voxel of a few shells of voxels around a point (in units of voxels), and whether it is the
    /// nearest of all.
    fn look_around(&self, at: [f64; 3]) -> (Best, bool) {
        let grid = self.grid;
        let (dims, spacing) = (grid.frame().dims(), grid.frame().spacing());
        let finest = spacing.iter().copied().fold(f64::INFINITY, f64::min);
        // The voxel of the box that is closest to the point; distances are measured from the point.
        let start: [i64; 3] = std::array::from_fn(|a| (at[a].floor() as i64).clamp(0, dims[a] as i64 - 1));
        let mut best = Best::default();
        for radius in 0..=SHELLS + 1 {
            // Any centre in this shell or beyond lies at least (radius - 1/2) voxels from the point.
            let bound = (radius as f64 - 0.5).max(0.0) * finest;
            if bound * bound > best.square {
                return (best, true);
            }
            if radius > SHELLS {
                break;
            }
            let low: [i64; 3] = std::array::from_fn(|a| (start[a] - radius).max(0));
            let high: [i64; 3] = std::array::from_fn(|a| (start[a] + radius).min(dims[a] as i64 - 1));
            for k in low[2]..=high[2] {
                for j in low[1]..=high[1] {
                    let face = (k - start[2]).abs() == radius || (j - start[1]).abs() == radius;
                    let step = if face { 1 } else { (2 * radius).max(1) };
                    let first = if face { low[0] } else { start[0] - radius };
                    let mut i = first;
                    while i <= high[0] {
                        if i >= 0
                            && let Some(v) = grid.index([i as u32, j as u32, k as u32])
                        {
                            best.take(at, spacing, [i, j, k].map(|x| x as f64), || v);
                        }
                        i += step;
                    }
                }
            }
        }
        (best, false)
    }
}

#[cfg(test)]
mod tests {
    use crate::{BitGrid, Frame, SplitMix64, VoxelGrid};

    /// Voxels strewn over a box, or in two clumps at its ends.
    fn strewn(dims: [usize; 3], spacing: [f64; 3], voxels: usize, clumps: bool, seed: u64) -> VoxelGrid {
        let mut random = SplitMix64::new(seed);
        let mut inside = BitGrid::empty(dims).unwrap();
        for _ in 0..voxels {
            let end = random.uniform() < 0.5;
            inside.set(
                std::array::from_fn(|a| {
                    let x = random.uniform();
                    let x = if !clumps { x } else { (0.1 * x) + if end { 0.9 } else { 0.0 } };
                    (x * dims[a] as f64) as u32
                }),
                true,
            );
        }
        VoxelGrid::solid(Frame::new(dims, [-1.0, 2.0, 0.0], spacing).unwrap(), inside).unwrap()
    }

    /// Squares of distances as rounded in units of voxels, so that ties are ties.
    fn by_looking_at_all(grid: &VoxelGrid, point: [f64; 3]) -> u32 {
        let (at, spacing) = (grid.frame().locate(point), grid.frame().spacing());
        let square = |voxel: [u32; 3]| -> f64 {
            (0..3).map(|a| ((f64::from(voxel[a]) + 0.5 - at[a]) * spacing[a]).powi(2)).sum()
        };
        let mut best = (f64::INFINITY, 0);
        for (number, voxel) in (0..).zip(grid.voxels()) {
            if square(voxel) < best.0 {
                best = (square(voxel), number);
            }
        }
        best.1
    }

    #[test]
    fn agrees_with_a_search_of_all_voxels() {
        let mut random = SplitMix64::new(1);
        for (dims, voxels, clumps) in [
            ([9, 7, 8], 12, false),
            ([9, 7, 8], 1, false),
            ([150, 70, 90], 40, false),
            ([150, 130, 90], 3000, true),
            ([64, 64, 1], 3, false),
            ([1, 1, 300], 9, true),
        ] {
            for spacing in [[1.0; 3], [0.5, 1.0, 3.0], [4.0, 0.25, 1.0]] {
                let grid = strewn(dims, spacing, voxels, clumps, voxels as u64);
                let length = |a: usize| dims[a] as f64 * spacing[a];
                let points: Vec<[f64; 3]> = (0..300)
                    .map(|i| {
                        // Some on corners and centres of voxels, where several voxels are equally near.
                        std::array::from_fn(|a| {
                            let x = (3.0 * random.uniform() - 1.0) * length(a);
                            let step = spacing[a] / 2.0;
                            [-1.0, 2.0, 0.0][a] + if i % 2 == 0 { x } else { (x / step).round() * step }
                        })
                    })
                    .collect();
                let expected: Vec<u32> = points.iter().map(|&p| by_looking_at_all(&grid, p)).collect();
                assert_eq!(grid.nearest_voxels(&points), expected, "{dims:?} {spacing:?}");
            }
        }
    }

    #[test]
    fn a_point_far_away_or_nowhere_has_a_voxel_too() {
        let grid = strewn([40, 40, 40], [1.0; 3], 200, false, 7);
        let last = grid.len() as u32 - 1;
        assert_eq!(grid.nearest_voxels(&[[20.0, 20.0, 1e9]]).len(), 1);
        assert_eq!(grid.nearest_voxels(&[[1e300; 3], [f64::NAN; 3], [f64::INFINITY; 3]]).len(), 3);
        assert!(grid.nearest().voxel([-1e9, -1e9, -1e9]).unwrap() < last);
        let empty = strewn([4, 4, 4], [1.0; 3], 0, false, 7);
        assert_eq!(empty.nearest_voxels(&[[0.0; 3]]), [0u32; 0]);
        assert_eq!(empty.nearest().voxel([0.0; 3]), None);
    }

    #[test]
    fn within_a_distance_there_may_be_none() {
        let mut inside = BitGrid::empty([9, 1, 1]).unwrap();
        inside.set([1, 0, 0], true);
        let grid = VoxelGrid::solid(Frame::new([9, 1, 1], [0.0; 3], [2.0; 3]).unwrap(), inside).unwrap();
        let nearest = grid.nearest();
        assert_eq!(nearest.voxel_within([13.0, 1.0, 1.0], 10.0), Some((0, 10.0)));
        assert_eq!(nearest.voxel_within([13.0, 1.0, 1.0], 9.9), None);
    }
}

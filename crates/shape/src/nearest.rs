use crate::VoxelGrid;

impl VoxelGrid {
    /// The occupied voxel whose centre is nearest to each point; of several, the one with the
    /// smallest number. Empty for an empty grid.
    ///
    /// This carries regions from voxels to a surface: each vertex takes its nearest voxel.
    /// Cost: a search in growing cubes, a few dozen voxels for points near the solid.
    pub fn nearest_voxels(&self, points: &[[f64; 3]]) -> Vec<u32> {
        if self.is_empty() {
            return Vec::new();
        }
        points.iter().map(|&p| self.nearest_voxel(p)).collect()
    }

    fn nearest_voxel(&self, point: [f64; 3]) -> u32 {
        let dims = self.frame().dims();
        let spacing = self.frame().spacing();
        let finest = spacing.iter().copied().fold(f64::INFINITY, f64::min);
        let at = self.frame().locate(point);
        // The voxel of the box that is closest to the point; distances are measured from the point.
        let start: [i64; 3] = std::array::from_fn(|a| (at[a].floor() as i64).clamp(0, dims[a] as i64 - 1));
        let (mut best, mut nearest) = (f64::INFINITY, u32::MAX);
        for radius in 0..=*dims.iter().max().unwrap_or(&0) as i64 {
            // Any centre in this shell or beyond lies at least (radius - 1/2) voxels from the point.
            let bound = (radius as f64 - 0.5).max(0.0) * finest;
            if bound * bound > best {
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
                            && let Some(v) = self.index([i as u32, j as u32, k as u32])
                        {
                            let centre = [i, j, k].map(|x| x as f64 + 0.5);
                            let d: f64 = (0..3).map(|a| ((centre[a] - at[a]) * spacing[a]).powi(2)).sum();
                            if d < best || d == best && v < nearest {
                                (best, nearest) = (d, v);
                            }
                        }
                        i += step;
                    }
                }
            }
        }
        nearest
    }
}

#[cfg(test)]
mod tests {
    use crate::{BitGrid, Frame, VoxelGrid};

    #[test]
    fn agrees_with_a_search_of_all_voxels() {
        let dims = [9, 7, 8];
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as f64 / (1u64 << 31) as f64
        };
        for spacing in [[1.0; 3], [0.5, 1.0, 3.0]] {
            let mut inside = BitGrid::empty(dims).unwrap();
            for _ in 0..12 {
                inside.set(std::array::from_fn(|a| (random() * dims[a] as f64) as u32), true);
            }
            let frame = Frame::new(dims, [-1.0, 2.0, 0.0], spacing).unwrap();
            let grid = VoxelGrid::solid(frame, inside).unwrap();
            let centres: Vec<_> = grid.voxels().map(|v| frame.centre(v)).collect();
            let points: Vec<[f64; 3]> =
                (0..200).map(|_| std::array::from_fn(|_| random() * 40.0 - 15.0)).collect();
            for (point, found) in points.iter().zip(grid.nearest_voxels(&points)) {
                let distance = |c: &[f64; 3]| (0..3).map(|a| (c[a] - point[a]).powi(2)).sum::<f64>().sqrt();
                let best = centres.iter().map(distance).fold(f64::INFINITY, f64::min);
                assert!((distance(&centres[found as usize]) - best).abs() < 1e-12);
            }
        }
    }
}

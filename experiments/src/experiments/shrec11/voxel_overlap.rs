//! Overlaps in voxels, where a map of space says which voxel of a transform a voxel came to be.

use mser3d::shape::VoxelGrid;
use mser3d_evaluation::shrec::SpaceMap;

/// For each region of a transform the greatest |A and B| / |A or B| with a region of the null shape,
/// counted over the null shape's voxels: each stands for the transform's voxel that its centre is
/// mapped into, or for none. Regions list their voxels. No mirror images here.
pub fn best_overlaps(
    null: &VoxelGrid,
    null_regions: &[&[u32]],
    map: &SpaceMap,
    transformed: &VoxelGrid,
    regions: &[&[u32]],
) -> Vec<f64> {
    let frame = transformed.frame();
    let counterpart: Vec<Option<u32>> = null
        .voxels()
        .map(|voxel| {
            let place = frame.locate(map(null.frame().centre(voxel))).map(f64::floor);
            let inside = (0..3).all(|a| place[a] >= 0.0 && place[a] < frame.dims()[a] as f64);
            inside.then(|| transformed.index(place.map(|x| x as u32))).flatten()
        })
        .collect();
    let mut best = Vec::with_capacity(regions.len());
    for region in regions {
        let mut members = vec![false; transformed.len()];
        region.iter().for_each(|&e| members[e as usize] = true);
        let carried: Vec<bool> = counterpart.iter().map(|c| c.is_some_and(|c| members[c as usize])).collect();
        let size = carried.iter().filter(|c| **c).count();
        let overlap = |null: &&[u32]| {
            let both = null.iter().filter(|e| carried[**e as usize]).count();
            both as f64 / (size + null.len() - both) as f64
        };
        best.push(null_regions.iter().map(overlap).fold(0.0, f64::max));
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use mser3d::shape::{BitGrid, Frame};

    fn rod(length: usize, pitch: f64) -> VoxelGrid {
        let dims = [length, 1, 1];
        let frame = Frame::new(dims, [0.0; 3], [pitch; 3]).unwrap();
        VoxelGrid::solid(frame, BitGrid::full(dims).unwrap()).unwrap()
    }

    fn region(voxels: std::ops::Range<u32>) -> Vec<u32> {
        voxels.collect()
    }

    #[test]
    fn overlaps_worked_out_by_hand() {
        let twice: SpaceMap = Box::new(|p| p.map(|x| 2.0 * x));
        // Voxels 0 to 5 of ten became 0 to 5 of ten that are twice as large.
        let (null, found) = (region(0..6), [region(0..5), region(4..10)]);
        let found = [&found[0][..], &found[1]];
        let overlaps = best_overlaps(&rod(10, 1.0), &[&null], &twice, &rod(10, 2.0), &found);
        assert_eq!(overlaps, [5.0 / 6.0, 2.0 / 10.0]);
        // Ten of half the length reach as far as the first five, once they are as thin.
        let thin: SpaceMap = Box::new(|[x, y, z]| [x, 0.5 * y, 0.5 * z]);
        let overlaps =
            best_overlaps(&rod(10, 1.0), &[&region(0..4)], &thin, &rod(10, 0.5), &[&region(0..10)]);
        assert_eq!(overlaps, [4.0 / 5.0]);
    }
}

//! Whether the regions of a coarse result are in a finer one of the same shape.

use std::error::Error;
use std::path::Path;

use mser3d::shape::{BitGrid, Frame, VoxelGrid};
use mser3d_fileio::{NpyValues, NpzReader};
use mser3d_results::Record;

/// The voxels and regions of a result. Trees and descriptors are not read: of a hundred million voxels they take most.
pub struct Regions {
    frame: Frame,
    voxels: Vec<[u32; 3]>,
    regions: Vec<Vec<u32>>,
}

impl Regions {
    /// Reads them from a folder of `mser3d detect`.
    pub fn load(folder: &Path) -> Result<Self, Box<dyn Error>> {
        let grid = Record::load(folder)?.grid.ok_or("the result is no volume's")?;
        let mut file = NpzReader::open(&folder.join("features.npz"))?;
        let mut numbers = |name: &str| -> Result<Vec<u32>, Box<dyn Error>> {
            let values = file.read(name)?.ok_or_else(|| format!("there is no array {name}"))?.into_values();
            let numbers: Result<Vec<u32>, _> = match values {
                NpyValues::I32(values) => values.iter().map(|&v| u32::try_from(v)).collect(),
                NpyValues::U32(values) => Ok(values.into_owned()),
                NpyValues::I64(values) => values.iter().map(|&v| u32::try_from(v)).collect(),
                _ => return Err(format!("array {name} holds no numbers of voxels").into()),
            };
            Ok(numbers?)
        };
        let (starts, all) = (numbers("region_voxels_start")?, numbers("region_voxels")?);
        let regions =
            starts.windows(2).map(|ends| all[ends[0] as usize..ends[1] as usize].to_vec()).collect();
        let voxels = numbers("voxel_index")?.as_chunks().0.to_vec();
        Ok(Self { frame: Frame::placed(grid.dims, &grid.affine)?, voxels, regions })
    }

    /// For each region the largest overlap, as intersection over union of volumes, with one of a finer result. Volumes are counted in
    /// the finer voxels, each of which lies in the coarse one that has its centre.
    pub fn found_again(&self, finer: &Self) -> Result<Vec<f64>, Box<dyn Error>> {
        let dims = self.frame.dims();
        let mut inside = BitGrid::empty(dims)?;
        self.voxels.iter().for_each(|&voxel| inside.set(voxel, true));
        let grid = VoxelGrid::solid(self.frame, inside)?;
        let coarse = |&voxel: &[u32; 3]| {
            let place = self.frame.locate(finer.frame.centre(voxel)).map(|at| at.floor());
            let beyond = (0..3).any(|axis| place[axis] < 0.0 || place[axis] >= dims[axis] as f64);
            if beyond { None } else { grid.index(place.map(|at| at as u32)) }
        };
        let to: Vec<Option<u32>> = finer.voxels.iter().map(coarse).collect();
        // How many of a set of finer voxels are in each coarse one, and how many of these are in each region.
        let in_regions = |set: &mut dyn Iterator<Item = u32>| -> Vec<f64> {
            let mut count = vec![0u32; grid.len()];
            set.filter_map(|voxel| to[voxel as usize]).for_each(|at| count[at as usize] += 1);
            let sum = |region: &Vec<u32>| region.iter().map(|&at| f64::from(count[at as usize])).sum();
            self.regions.iter().map(sum).collect()
        };
        let whole = in_regions(&mut (0..finer.voxels.len() as u32));
        let mut best = vec![0f64; self.regions.len()];
        for region in &finer.regions {
            let both = in_regions(&mut region.iter().copied());
            for ((best, both), whole) in best.iter_mut().zip(both).zip(&whole) {
                *best = best.max(both / (whole + region.len() as f64 - both));
            }
        }
        Ok(best)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bar of unit cross section with regions from one share of its length to another.
    fn bar(voxels: usize, regions: &[[f64; 2]]) -> Regions {
        let frame = Frame::new([voxels, 1, 1], [3.0; 3], [1.0 / voxels as f64, 1.0, 1.0]).unwrap();
        let of = |ends: &[f64; 2]| {
            let [low, high] = ends.map(|end| (end * voxels as f64).round() as u32);
            (low..high).collect()
        };
        let voxels = (0..voxels as u32).map(|x| [x, 0, 0]).collect();
        Regions { frame, voxels, regions: regions.iter().map(of).collect() }
    }

    #[test]
    fn overlaps_are_of_volumes() {
        let coarse = bar(100, &[[0.0, 0.5], [0.2, 0.3], [0.9, 1.0]]);
        let fine = bar(300, &[[0.0, 0.4], [0.1, 0.3], [0.2, 0.29]]);
        let best = coarse.found_again(&fine).unwrap();
        let expected = [0.8, 0.9, 0.0];
        assert!(best.iter().zip(expected).all(|(found, wanted)| (found - wanted).abs() < 1e-12), "{best:?}");
    }
}

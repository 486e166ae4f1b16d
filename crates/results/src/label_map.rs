use std::path::Path;

use mser3d_volumeio::{Volume, write_nifti};

use crate::check::afford;
use crate::{Results, ResultsError};

/// The regions of one or more results on the grid that they share, as a label map in NIfTI.
///
/// A voxel has 1 + the number of its innermost region; 0 is outside of all regions.
pub struct LabelMap {
    volume: Volume,
    /// Voxels that several results claim.
    pub contested: usize,
}

impl LabelMap {
    /// Puts results with the numbers of their first regions on one grid. Where bodies overlap, the later one stays.
    ///
    /// # Errors
    /// [`ResultsError::OtherGrid`] when they are not on one grid, or are on none; [`ResultsError::TooLarge`].
    pub fn new(results: &[(&Results, u32)]) -> Result<Self, ResultsError> {
        let none = || ResultsError::OtherGrid;
        let grid = results.first().and_then(|r| r.0.record.grid).ok_or_else(none)?;
        let [nx, ny, nz] = grid.dims;
        let voxels = grid.dims.iter().fold(1u128, |all, &n| all.saturating_mul(n as u128));
        // As 32 bits each, and again as the type of the file.
        let path = Path::new(&results[0].0.record.input.path);
        afford(path, format!("a label map of {nx} x {ny} x {nz} voxels"), 8 * voxels)?;
        let mut labels = vec![0i32; nx * ny * nz];
        let mut contested = 0;
        for (results, first) in results {
            let (Some(own), Some(voxels)) = (results.record.grid, &results.grid) else { return Err(none()) };
            if own != grid {
                return Err(none());
            }
            for ([i, j, k], region) in voxels.voxels().zip(results.voxel_region()) {
                if region >= 0 {
                    let place = (k as usize * ny + j as usize) * nx + i as usize;
                    contested += usize::from(labels[place] != 0);
                    labels[place] = *first as i32 + region + 1;
                }
            }
        }
        // The smallest type that other programs take for labels.
        let most = labels.iter().copied().max().unwrap_or(0);
        let volume = match most {
            0..=255 => {
                Volume::new(grid.dims, 1, grid.affine, labels.iter().map(|&l| l as u8).collect::<Vec<_>>())?
            }
            256..=32_767 => {
                Volume::new(grid.dims, 1, grid.affine, labels.iter().map(|&l| l as i16).collect::<Vec<_>>())?
            }
            _ => Volume::new(grid.dims, 1, grid.affine, labels)?,
        };
        Ok(Self { volume, contested })
    }

    /// Writes it.
    ///
    /// # Errors
    /// [`ResultsError::Volume`], naming the file.
    pub fn write(&self, path: &Path) -> Result<(), ResultsError> {
        Ok(write_nifti(path, &self.volume)?)
    }
}

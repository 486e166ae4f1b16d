//! Grey values to a mask: writes a scan, reads it back, keeps what is bright, and saves the mask with its
//! place.

use mser3d_shape::BitGrid;
use mser3d_volumeio::{Affine, Volume, read_volume, write_nifti};
use std::error::Error;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::temp_dir().join(format!("mser3d-scan-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;

    // A bright ball in the dark, in slices 2 mm apart.
    let dims = [32, 32, 16];
    let grey = (0..dims.iter().product::<usize>()).map(|v| {
        let [x, y, z] = [v % 32, v / 32 % 32, v / 1024].map(|i| i as f32);
        let r2 = (x - 15.5).powi(2) + (y - 15.5).powi(2) + (2.0 * z - 15.0).powi(2);
        1000.0 * (-r2 / 150.0).exp()
    });
    let affine = Affine::along_axes([0.0; 3], [1.0, 1.0, 2.0])?;
    let scan = Volume::new(dims, 1, affine, grey.collect::<Vec<f32>>())?;
    write_nifti(&folder.join("scan.nii.gz"), &scan)?;

    let scan = read_volume(&folder.join("scan.nii.gz"), &Default::default())?.volume;
    let mut mask = BitGrid::empty(scan.dims())?;
    let [nx, ny, _] = scan.dims();
    for (v, grey) in scan.samples().to_f64().into_iter().enumerate() {
        mask.set([v % nx, v / nx % ny, v / (nx * ny)].map(|i| i as u32), grey > 400.0);
    }
    let voxel = scan.frame()?.voxel_volume();
    println!("{} bright voxels, {} mm^3", mask.count_ones(), mask.count_ones() as f64 * voxel);
    write_nifti(&folder.join("mask.nii.gz"), &Volume::from_mask(&mask, *scan.affine())?)?;
    std::fs::remove_dir_all(&folder)?;
    Ok(())
}

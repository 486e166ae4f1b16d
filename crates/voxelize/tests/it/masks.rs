//! Masks with an entry for each voxel of the box.

use crate::common::*;
use mser3d_voxelize::*;

#[test]
fn a_dense_mask_has_a_one_for_each_voxel() {
    let solid = voxelize(&torus(20, 10), &VoxelizeParameters::default()).unwrap();
    let mask = dense_mask(solid.grid.occupancy());
    assert_eq!(mask.iter().map(|&m| usize::from(m)).sum::<usize>(), solid.grid.len());
    let [nx, ny, _] = solid.grid.frame().dims();
    for v in solid.grid.voxels() {
        let [x, y, z] = v.map(|i| i as usize);
        assert_eq!(mask[(z * ny + y) * nx + x], 1);
    }
}

#[cfg(feature = "ndarray")]
#[test]
fn arrays_and_dense_masks_hold_the_same_voxels() {
    let solid = voxelize(&torus(20, 10), &VoxelizeParameters::default()).unwrap();
    let bits = solid.grid.occupancy();
    let [nx, ny, nz] = bits.dims();
    let (mask, array) = (dense_mask(bits), mask_array(bits));
    assert_eq!(array.dim(), (nx, ny, nz));
    for ((x, y, z), &inside) in array.indexed_iter() {
        assert_eq!(u8::from(inside), mask[(z * ny + y) * nx + x]);
    }
}

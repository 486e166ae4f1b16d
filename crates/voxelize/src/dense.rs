//! Bits as arrays with an entry for each voxel of the box.

use mser3d_shape::BitGrid;

/// The voxels of a box as one byte each, 1 where they are set and 0 elsewhere: x runs fastest, then y, then
/// z, so that voxel (i, j, k) of a box of nx x ny x nz is entry `(k * ny + j) * nx + i`.
///
/// Eight times the memory of the bits.
///
/// ```
/// use mser3d_shape::BitGrid;
/// use mser3d_voxelize::dense_mask;
/// let mut bits = BitGrid::empty([3, 2, 1])?;
/// bits.set([2, 0, 0], true);
/// bits.set([0, 1, 0], true);
/// assert_eq!(dense_mask(&bits), [0, 0, 1, 1, 0, 0]);
/// # Ok::<(), mser3d_shape::ShapeError>(())
/// ```
pub fn dense_mask(bits: &BitGrid) -> Vec<u8> {
    let [nx, ny, nz] = bits.dims();
    let mut mask = vec![0; nx * ny * nz];
    for [i, j, k] in bits.ones() {
        mask[(k as usize * ny + j as usize) * nx + i as usize] = 1;
    }
    mask
}

/// The voxels of a box as an array indexed by `[x, y, z]`. Needs the feature `ndarray`.
///
/// In the standard layout of ndarray and NumPy the last index runs fastest, here z: not the order of
/// [`dense_mask`].
///
/// ```
/// use mser3d_shape::BitGrid;
/// use mser3d_voxelize::mask_array;
/// let mut bits = BitGrid::empty([3, 2, 1])?;
/// bits.set([2, 0, 0], true);
/// let array = mask_array(&bits);
/// assert_eq!(array.dim(), (3, 2, 1));
/// assert!(array[[2, 0, 0]] && !array[[0, 1, 0]]);
/// # Ok::<(), mser3d_shape::ShapeError>(())
/// ```
#[cfg(feature = "ndarray")]
pub fn mask_array(bits: &BitGrid) -> ndarray::Array3<bool> {
    let [nx, ny, nz] = bits.dims();
    let mut array = ndarray::Array3::from_elem((nx, ny, nz), false);
    for [i, j, k] in bits.ones() {
        array[[i as usize, j as usize, k as usize]] = true;
    }
    array
}

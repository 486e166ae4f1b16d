//! Links between the voxels of a solid.

use mser3d_shape::{BitGrid, Frame, ShapeError, VoxelGrid};

/// Links all neighbours inside but those that are cut; also the number of links cut.
pub(crate) fn link(
    frame: Frame,
    occupancy: BitGrid,
    cuts: &[Vec<[u32; 3]>; 3],
) -> Result<(VoxelGrid, usize), ShapeError> {
    let mut grid = VoxelGrid::solid(frame, occupancy)?;
    let mut total = 0;
    for axis in 0..3 {
        let (with_cuts, count) = grid.with_cut_links(axis, &cuts[axis]);
        (grid, total) = (with_cuts, total + count);
    }
    Ok((grid, total))
}

/// The largest linked component, and how many components and voxels were dropped.
pub(crate) fn largest_component(grid: VoxelGrid) -> (VoxelGrid, usize, usize) {
    let parts = grid.components();
    match parts.largest() {
        Some(largest) if parts.len() > 1 => {
            let kept = grid.restrict(|v| parts.labels[v as usize] == largest);
            let dropped = grid.len() - kept.len();
            (kept, parts.len() - 1, dropped)
        }
        _ => (grid, 0, 0),
    }
}

//! Links between the voxels of a solid.

use crate::solid::Solid;
use mser3d_shape::{Frame, ShapeError, VoxelGrid};

/// Links all neighbours inside but those that are cut; also the number of links cut.
pub(crate) fn link(frame: &Frame, solid: &Solid) -> Result<(VoxelGrid, usize), ShapeError> {
    let full = VoxelGrid::solid(*frame, solid.occupancy.clone())?;
    if solid.cuts.iter().all(Vec::is_empty) {
        return Ok((full, 0));
    }
    let mut links = full.links().clone();
    let mut cut = 0;
    for axis in 0..3 {
        for &voxel in &solid.cuts[axis] {
            if links[axis].get(voxel) {
                links[axis].set(voxel, false);
                cut += 1;
            }
        }
    }
    Ok((VoxelGrid::new(*frame, solid.occupancy.clone(), links)?, cut))
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

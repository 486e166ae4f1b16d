use mser3d_shape::{Domain, VoxelGrid};
use sprs::CsMat;

use crate::{Operator, stencil::face_neighbours};

/// The 6-neighbour Laplacian of a voxel grid with Neumann boundary, section 3.2.
///
/// In the paper's form L_uv = -1/h_a^2 for voxels linked along axis a; here W = M L with
/// M = (voxel volume) I, so W_uv = -(voxel volume)/h_a^2 (for cubes -h) and the diagonal is minus
/// the sum of the row's other entries. Only *linked* neighbours count.
///
/// Cost: at most 16 numbers a voxel, linear time.
pub fn grid_laplacian(grid: &VoxelGrid) -> Operator {
    let n = grid.len();
    let volume = grid.frame().voxel_volume();
    let weight = grid.frame().spacing().map(|h| volume / (h * h));
    let neighbours = face_neighbours(grid);
    let (mut starts, mut rows, mut values) = (Vec::with_capacity(n + 1), Vec::new(), Vec::new());
    starts.push(0usize);
    for (v, around) in neighbours.iter().enumerate() {
        let linked = |slot: &usize| around[*slot] != v as u32;
        let axis = |slot: usize| if slot < 3 { 2 - slot } else { slot - 3 };
        let diagonal: f64 = (0..6).filter(linked).map(|slot| weight[axis(slot)]).sum();
        // -z, -y, -x, the voxel itself, +x, +y, +z: ascending voxel numbers.
        for slot in (0..3).filter(linked) {
            rows.push(around[slot] as usize);
            values.push(-weight[axis(slot)]);
        }
        rows.push(v);
        values.push(diagonal);
        for slot in (3..6).filter(linked) {
            rows.push(around[slot] as usize);
            values.push(-weight[axis(slot)]);
        }
        starts.push(rows.len());
    }
    Operator::assembled(Domain::Volume, CsMat::new_csc((n, n), starts, rows, values), vec![volume; n])
}

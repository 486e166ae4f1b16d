//! Through a voxel grid and back.

use std::collections::BTreeMap;

use mser3d_shape::vector::{add, scale};
use mser3d_shape::{TriangleMesh, VoxelGrid};
use mser3d_voxelize::{Bvh, Overlap, Pitch, VoxelizeParameters, voxelize};

use super::transformed::Transformed;
use crate::{EvaluationError, SurfacePoint};

/// The surface of the null shape's voxels, with the nearest point of the null shape for each vertex.
/// Parts closer than a voxel are glued: that is what rasterization does.
pub(super) fn rasterize(null: &TriangleMesh, pitch: f64) -> Result<Transformed, EvaluationError> {
    let parameters = VoxelizeParameters {
        pitch: Pitch::Size(pitch),
        overlap: Overlap::Join,
        cut_links: false,
        ..Default::default()
    };
    let grid = voxelize(null, &parameters)?.grid;
    let mesh = boundary(&grid)?;
    let surface = Bvh::new(null);
    let nearest = |p: &[f64; 3]| {
        let nearest = surface.nearest(*p)?;
        Some(SurfacePoint::at(null, nearest.triangle, nearest.point))
    };
    let points = mesh.vertices().iter().map(nearest).collect();
    Ok(Transformed { mesh, points })
}

/// Surface nets (Gibson 1998) of a binary mask: between eight voxels not all alike lies one vertex,
/// the mean of the middles of the edges between unlike voxels.
fn boundary(grid: &VoxelGrid) -> Result<TriangleMesh, EvaluationError> {
    let frame = grid.frame();
    let (origin, spacing) = (frame.origin(), frame.spacing());
    let inside = |v: [i64; 3]| v.iter().all(|x| *x >= 0) && grid.occupancy().get(v.map(|x| x as u32));
    // Cell (i, j, k) has the centres of voxels (i-1, j-1, k-1) to (i, j, k) as corners.
    let mut number: BTreeMap<[i64; 3], u32> = BTreeMap::new();
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    let step =
        |v: [i64; 3], axis: usize, by: i64| std::array::from_fn(|a| v[a] + if a == axis { by } else { 0 });
    let mut vertex = |cell: [i64; 3]| {
        *number.entry(cell).or_insert_with(|| {
            let (mut sum, mut count) = ([0.0; 3], 0.0);
            for axis in 0..3 {
                for (du, dv) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                    let low = step(step(step(cell, axis, -1), u, -du), v, -dv);
                    if inside(low) != inside(step(low, axis, 1)) {
                        let middle = low.map(|x| x as f64 + 0.5);
                        sum =
                            add(sum, std::array::from_fn(|a| middle[a] + if a == axis { 0.5 } else { 0.0 }));
                        count += 1.0;
                    }
                }
            }
            let mean = scale(sum, 1.0 / count);
            vertices.push(std::array::from_fn(|a| origin[a] + spacing[a] * mean[a]));
            vertices.len() as u32 - 1
        })
    };
    for v in grid.voxels().map(|v| v.map(i64::from)) {
        for axis in 0..3 {
            for outward in [1, -1] {
                if inside(step(v, axis, outward)) {
                    continue;
                }
                // The four cells around the edge from this voxel to its empty neighbour.
                let (u, w) = ((axis + 1) % 3, (axis + 2) % 3);
                let base = if outward == 1 { step(v, axis, 1) } else { v };
                let corner = [base, step(base, u, 1), step(step(base, u, 1), w, 1), step(base, w, 1)];
                let mut q = corner.map(&mut vertex);
                if outward == -1 {
                    q.reverse();
                }
                triangles.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
            }
        }
    }
    Ok(TriangleMesh::new(vertices, triangles)?)
}

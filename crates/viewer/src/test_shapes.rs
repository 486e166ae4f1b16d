//! Small closed meshes and grids for tests.

use mser3d_shape::{BitGrid, Frame, TriangleMesh, VoxelGrid};

pub(crate) fn cube() -> TriangleMesh {
    let corners = (0..8u32).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriangleMesh::new(corners, triangles).unwrap()
}

/// The unit sphere, +y at the pole.
pub(crate) fn sphere(rings: u32, sectors: u32) -> TriangleMesh {
    let mut points = vec![[0.0, 1.0, 0.0]];
    for r in 1..rings {
        let (sin, cos) = (std::f64::consts::PI * f64::from(r) / f64::from(rings)).sin_cos();
        for s in 0..sectors {
            let (x, z) = (std::f64::consts::TAU * f64::from(s) / f64::from(sectors)).sin_cos();
            points.push([sin * x, cos, sin * z]);
        }
    }
    points.push([0.0, -1.0, 0.0]);
    let last = points.len() as u32 - 1;
    let at = |r: u32, s: u32| 1 + (r - 1) * sectors + s % sectors;
    let mut triangles = Vec::new();
    for s in 0..sectors {
        triangles.push([0, at(1, s), at(1, s + 1)]);
        for r in 1..rings - 1 {
            triangles.push([at(r, s), at(r + 1, s), at(r + 1, s + 1)]);
            triangles.push([at(r, s), at(r + 1, s + 1), at(r, s + 1)]);
        }
        triangles.push([at(rings - 1, s), last, at(rings - 1, s + 1)]);
    }
    TriangleMesh::new(points, triangles).unwrap()
}

/// A ball of `n` voxels across, inside the box from -1 to 1.
pub(crate) fn ball(n: u32) -> VoxelGrid {
    let dims = [n as usize; 3];
    let frame = Frame::new(dims, [-1.0; 3], [2.0 / f64::from(n); 3]).unwrap();
    let mut inside = BitGrid::empty(dims).unwrap();
    for v in BitGrid::full(dims).unwrap().ones() {
        inside.set(v, frame.centre(v).iter().map(|x| x * x).sum::<f64>() < 1.0);
    }
    VoxelGrid::solid(frame, inside).unwrap()
}

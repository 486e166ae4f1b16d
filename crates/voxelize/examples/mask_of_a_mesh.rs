//! A mesh with holes as a mask for other programs: its diagnosis, its voxels, and one layer of them as text.

use mser3d_shape::TriangleMesh;
use mser3d_voxelize::{Pitch, VoxelizeParameters, dense_mask, diagnose, voxelize};
use std::error::Error;
use std::f64::consts::TAU;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let mesh = open_sphere(48, 24)?;
    let diagnosis = diagnose(&mesh);
    println!("{} boundary edges in {} loops", diagnosis.boundary_edges, diagnosis.boundary_loops);
    println!("inside test: {} ({})", diagnosis.inside, diagnosis.reason);

    let parameters = VoxelizeParameters { pitch: Pitch::Resolution(24), ..Default::default() };
    let solid = voxelize(&mesh, &parameters)?;
    for warning in &solid.warnings {
        println!("warning: {warning}");
    }

    let mask = dense_mask(solid.grid.occupancy());
    let [nx, ny, nz] = solid.grid.frame().dims();
    println!("{} voxels in a box of {nx} x {ny} x {nz}; the middle layer:", solid.grid.len());
    let layer = &mask[nz / 2 * nx * ny..][..nx * ny];
    for row in layer.chunks(nx) {
        println!("{}", row.iter().map(|&inside| if inside == 1 { '#' } else { '.' }).collect::<String>());
    }
    Ok(())
}

/// A unit sphere of `around` x `down` quadrangles, open at both poles.
fn open_sphere(around: u32, down: u32) -> Result<TriangleMesh, Box<dyn Error>> {
    let point = |i: u32, j: u32| {
        let (u, v) =
            (TAU * f64::from(i) / f64::from(around), TAU * (0.05 + 0.4 * f64::from(j) / f64::from(down)));
        [v.sin() * u.cos(), v.sin() * u.sin(), v.cos()]
    };
    let vertices = (0..=down).flat_map(|j| (0..around).map(move |i| point(i, j))).collect();
    let at = |i: u32, j: u32| j * around + i % around;
    let quads = (0..down)
        .flat_map(|j| (0..around).map(move |i| [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]));
    let triangles = quads.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Ok(TriangleMesh::new(vertices, triangles)?)
}

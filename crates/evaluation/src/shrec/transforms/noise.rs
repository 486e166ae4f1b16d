//! Noise along the vertex normals.

use mser3d_shape::TriangleMesh;
use mser3d_shape::vector::{Vec3, add, scale, unit};

use super::random::Random;
use super::transformed::Transformed;
use crate::EvaluationError;
use crate::surface_point::normal;

/// Every vertex displaced by a normally distributed length of this deviation.
pub(super) fn noise(
    null: &TriangleMesh,
    deviation: f64,
    random: &mut Random,
) -> Result<Transformed, EvaluationError> {
    displaced(null, |random| deviation * random.normal(), random)
}

/// This share of the vertices displaced, in or out, by `length` / 2 to 3 `length` / 2.
pub(super) fn shotnoise(
    null: &TriangleMesh,
    share: f64,
    length: f64,
    random: &mut Random,
) -> Result<Transformed, EvaluationError> {
    let shot = |random: &mut Random| {
        let (hit, side, size) = (random.uniform() < share, random.uniform(), random.between(0.5, 1.5));
        if hit { (if side < 0.5 { -size } else { size }) * length } else { 0.0 }
    };
    displaced(null, shot, random)
}

fn displaced(
    null: &TriangleMesh,
    length: impl Fn(&mut Random) -> f64,
    random: &mut Random,
) -> Result<Transformed, EvaluationError> {
    let moved = null.vertices().iter().zip(vertex_normals(null));
    Transformed::moved(null, moved.map(|(&p, n)| add(p, scale(n, length(random)))).collect())
}

/// Unit normals, weighted by area; zero where there are no triangles.
pub(super) fn vertex_normals(mesh: &TriangleMesh) -> Vec<Vec3> {
    let mut normals = vec![[0.0; 3]; mesh.vertices().len()];
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        let n = normal(mesh.corners(t));
        for &v in triangle {
            normals[v as usize] = add(normals[v as usize], n);
        }
    }
    normals.into_iter().map(unit).collect()
}

//! Smooth normals that keep creases.

use mser3d_shape::TriangleMesh;
use mser3d_shape::vector::{Vec3, add, cross, dot, scale, sub, unit};

/// Normals of a mesh for shading.
pub(crate) struct Normals {
    /// At the corners of each triangle; they differ across creases.
    pub corners: Vec<[[f32; 3]; 3]>,
    /// At each vertex, over all triangles around it.
    pub vertices: Vec<Vec3>,
}

/// Faces that meet at a sharper angle (cosine below this: 50 degrees) keep a crease between them.
const CREASE_COSINE: f64 = 0.64;

/// Area-weighted mean normals. A closed mesh that encloses a negative volume is turned outside first.
pub(crate) fn smooth(mesh: &TriangleMesh) -> Normals {
    let outward = if mesh.signed_volume() < 0.0 { -1.0 } else { 1.0 };
    let faces: Vec<Vec3> = (0..mesh.triangles().len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t);
            scale(cross(sub(b, a), sub(c, a)), outward)
        })
        .collect();
    let around = triangles_around(mesh);
    let n = mesh.vertices().len();
    let vertices = (0..n)
        .map(|v| unit(around.of(v).iter().fold([0.0; 3], |sum, &t| add(sum, faces[t as usize]))))
        .collect();
    let corner = |v: u32, face: Vec3| {
        let direction = unit(face);
        let alike = |t: &&u32| dot(unit(faces[**t as usize]), direction) > CREASE_COSINE;
        let sum =
            around.of(v as usize).iter().filter(alike).fold(face, |sum, &t| add(sum, faces[t as usize]));
        unit(sum).map(|x| x as f32)
    };
    let corners = mesh.triangles().iter().zip(&faces).map(|(t, &face)| t.map(|v| corner(v, face))).collect();
    Normals { corners, vertices }
}

/// The triangles around each vertex, in compressed rows.
struct Around {
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Around {
    fn of(&self, vertex: usize) -> &[u32] {
        &self.triangles[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}

fn triangles_around(mesh: &TriangleMesh) -> Around {
    let mut starts = vec![0u32; mesh.vertices().len() + 1];
    for &v in mesh.triangles().iter().flatten() {
        starts[v as usize + 1] += 1;
    }
    for v in 1..starts.len() {
        starts[v] += starts[v - 1];
    }
    let mut next = starts.clone();
    let mut triangles = vec![0; 3 * mesh.triangles().len()];
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        for &v in triangle {
            triangles[next[v as usize] as usize] = t as u32;
            next[v as usize] += 1;
        }
    }
    Around { starts, triangles }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_shapes;

    #[test]
    fn a_cube_keeps_its_edges_and_a_sphere_is_smooth() {
        let cube = test_shapes::cube();
        for (t, corners) in smooth(&cube).corners.iter().enumerate() {
            let [a, b, c] = cube.corners(t);
            let face = unit(cross(sub(b, a), sub(c, a)));
            for n in corners {
                assert!(dot(face, n.map(f64::from)) > 0.999);
            }
        }
        let sphere = test_shapes::sphere(12, 24);
        for (n, p) in smooth(&sphere).vertices.iter().zip(sphere.vertices()) {
            assert!(dot(*n, *p) > 0.98);
        }
    }

    #[test]
    fn inside_out_makes_no_difference() {
        let sphere = test_shapes::sphere(8, 16);
        let flipped = sphere.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
        let flipped = TriangleMesh::new(sphere.vertices().to_vec(), flipped).unwrap();
        for (a, b) in smooth(&sphere).vertices.iter().zip(&smooth(&flipped).vertices) {
            assert!(dot(*a, *b) > 0.999_999);
        }
    }
}

//! The meshes that are voxelized.

use std::error::Error;

use mser3d::shape::TriangleMesh;

/// A ball pulled out into eight limbs: 32,768 triangles.
pub fn figure() -> Result<TriangleMesh, Box<dyn Error>> {
    let mut vertices: Vec<[f64; 3]> =
        vec![[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..6 {
        let mut middles = std::collections::HashMap::new();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for [a, b, c] in triangles {
            let mut middle = |u: u32, v: u32| {
                *middles.entry((u.min(v), u.max(v))).or_insert_with(|| {
                    let (p, q) = (vertices[u as usize], vertices[v as usize]);
                    let sum: [f64; 3] = std::array::from_fn(|i| p[i] + q[i]);
                    let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
                    vertices.push(sum.map(|x| x / length));
                    vertices.len() as u32 - 1
                })
            };
            let (d, e, f) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]);
        }
        triangles = finer;
    }
    let pulled = |p: &[f64; 3]| p.map(|x| x * (1.0 + 160.0 * (p[0] * p[1] * p[2]).powi(2)) + 0.01);
    Ok(TriangleMesh::new(vertices.iter().map(pulled).collect(), triangles)?)
}

/// The same without each hundredth triangle or so.
pub fn with_holes(mesh: &TriangleMesh) -> Result<TriangleMesh, Box<dyn Error>> {
    let kept = mesh.triangles().iter().enumerate().filter(|(i, _)| i * 2_654_435_761 % 1000 >= 10);
    Ok(TriangleMesh::new(mesh.vertices().to_vec(), kept.map(|t| *t.1).collect())?)
}

/// 28 copies side by side, 917,504 triangles.
pub fn crowd(mesh: &TriangleMesh) -> Result<TriangleMesh, Box<dyn Error>> {
    let extent = mesh.bounding_box().ok_or("no triangles")?.extent();
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for copy in 0..28u32 {
        let place = [copy % 4, copy / 4 % 4, copy / 16];
        let first = vertices.len() as u32;
        let shift: [f64; 3] = std::array::from_fn(|a| f64::from(place[a]) * extent[a] * 1.03);
        vertices.extend(mesh.vertices().iter().map(|p| [p[0] + shift[0], p[1] + shift[1], p[2] + shift[2]]));
        triangles.extend(mesh.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    Ok(TriangleMesh::new(vertices, triangles)?)
}

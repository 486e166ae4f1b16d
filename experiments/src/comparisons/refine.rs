//! Finer meshes of the same surface.

use std::collections::BTreeMap;
use std::error::Error;

use mser3d::shape::TriangleMesh;

/// Halves the longest edges until there are `vertices` vertices. The surface stays where it is.
pub fn refined(mesh: &TriangleMesh, vertices: usize) -> Result<TriangleMesh, Box<dyn Error>> {
    let mut points = mesh.vertices().to_vec();
    let mut triangles = mesh.triangles().to_vec();
    while points.len() < vertices {
        let mut sides: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
        for (t, &[a, b, c]) in triangles.iter().enumerate() {
            for [u, v] in [[a, b], [b, c], [c, a]] {
                sides.entry([u.min(v), u.max(v)]).or_default().push(t);
            }
        }
        let length = |[u, v]: [u32; 2]| -> f64 {
            let (p, q) = (points[u as usize], points[v as usize]);
            (0..3).map(|a| (p[a] - q[a]).powi(2)).sum()
        };
        let mut edges: Vec<(f64, [u32; 2])> = sides.keys().map(|&edge| (length(edge), edge)).collect();
        edges.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        // A triangle is halved once a round, and only edges within a factor of two of the longest.
        let longest = edges.first().map_or(0.0, |edge| edge.0);
        let mut halved = vec![false; triangles.len()];
        for (_, edge) in edges.iter().take_while(|(length, _)| *length >= 0.25 * longest) {
            let around = &sides[edge];
            if points.len() == vertices || around.iter().any(|&t| halved[t]) {
                continue;
            }
            let middle = points.len() as u32;
            let [p, q] = edge.map(|v| points[v as usize]);
            points.push(std::array::from_fn(|a| 0.5 * (p[a] + q[a])));
            for &t in around {
                halved[t] = true;
                let replace = |from: u32| triangles[t].map(|v| if v == from { middle } else { v });
                let (first, second) = (replace(edge[0]), replace(edge[1]));
                triangles[t] = first;
                triangles.push(second);
            }
        }
    }
    Ok(TriangleMesh::new(points, triangles)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finer_mesh_is_the_same_surface() {
        let points = vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]];
        let tetrahedron =
            TriangleMesh::new(points, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]).unwrap();
        let fine = refined(&tetrahedron, 500).unwrap();
        assert_eq!(fine.vertices().len(), 500);
        // Euler: a closed surface of genus 0 has 2 V - 4 triangles.
        assert_eq!(fine.triangles().len(), 996);
        assert!((fine.area() / tetrahedron.area() - 1.0).abs() < 1e-12);
        assert!((fine.signed_volume() / tetrahedron.signed_volume() - 1.0).abs() < 1e-12);
    }
}

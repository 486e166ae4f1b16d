use std::collections::HashMap;

use mser3d_shape::TriangleMesh;
use mser3d_shape::vector::{add, cross, dot, norm, scale, sub};

use crate::{LaplaceError, cotangent_laplacian};

/// The mean curvature H of a surface at each vertex, in length^-1: 1/r on a sphere, 1/2r on a cylinder. n values.
///
/// The Laplacian of the positions is the mean curvature normal, `-Delta x = 2 H n` (Meyer, Desbrun, Schröder & Barr 2003): the
/// cotangent stiffness W gives `H(v) = n(v) . (W x)(v) / 2 A(v)`, with the area A of the part of the surface that is
/// nearest to v (its Voronoi cell, mixed where triangles are obtuse) and the mean normal n of the triangles around v. The
/// masses of [`cotangent_laplacian`] are not used here: where the number of triangles around a vertex is another, they are
/// wrong by up to a half.
///
/// H is positive where the surface bulges and negative where it is hollow, if triangles turn counter-clockwise seen from
/// outside. A closed mesh that encloses a negative volume is taken to be turned inside out. Vertices on a border get the mean
/// of their neighbours that are on none, vertices without area get 0. At the edges and corners of a body like a cube H grows as
/// triangles get smaller: what stays is its integral.
///
/// ```
/// use mser3d_laplace::mean_curvature;
/// use mser3d_shape::TriangleMesh;
///
/// // An octahedron around the unit sphere's centre: by symmetry the same everywhere, and the cells share out the area.
/// let tips = [[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
/// let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
/// let curvature = mean_curvature(&TriangleMesh::new(tips.to_vec(), faces.to_vec())?)?;
/// assert!(curvature.iter().all(|h| (h - 1.0).abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LaplaceError::NoArea`] when every triangle is degenerate.
pub fn mean_curvature(mesh: &TriangleMesh) -> Result<Vec<f64>, LaplaceError> {
    let operator = cotangent_laplacian(mesh)?;
    let positions = mesh.vertices();
    let n = positions.len();
    let (areas, normals) = cells(mesh);
    let on_border = on_border(mesh);
    let inside_out = !on_border.contains(&true) && mesh.signed_volume() < 0.0;
    let mut curvature: Vec<Option<f64>> = (0..n)
        .map(|v| {
            if on_border[v] {
                return None;
            }
            let row = operator.stiffness().outer_view(v)?;
            // Relative to the vertex: far from the origin the terms would cancel.
            let flow =
                row.iter().map(|(u, &w)| scale(sub(positions[u], positions[v]), w)).fold([0.0; 3], add);
            let h = dot(flow, normals[v]) / norm(normals[v]) / (2.0 * areas[v]);
            h.is_finite().then_some(if inside_out { -h } else { h })
        })
        .collect();
    let inner = curvature.clone();
    let graph = mesh.edge_graph();
    for v in (0..n).filter(|&v| on_border[v]) {
        let around: Vec<f64> = graph.neighbours(v as u32).iter().filter_map(|&u| inner[u as usize]).collect();
        curvature[v] = (!around.is_empty()).then(|| around.iter().sum::<f64>() / around.len() as f64);
    }
    Ok(curvature.into_iter().map(Option::unwrap_or_default).collect())
}

/// The area of the mixed Voronoi cell of each vertex, and the sum of the normals around it, by area.
fn cells(mesh: &TriangleMesh) -> (Vec<f64>, Vec<[f64; 3]>) {
    let n = mesh.vertices().len();
    let (mut areas, mut normals) = (vec![0.0; n], vec![[0.0; 3]; n]);
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        let corners = mesh.corners(t);
        let edge = |from: usize, to: usize| sub(corners[to % 3], corners[from % 3]);
        let normal = cross(edge(0, 1), edge(0, 2));
        let twice = norm(normal);
        // At each corner, twice the area times its angle's cotangent.
        let dots: [f64; 3] = std::array::from_fn(|i| dot(edge(i, i + 1), edge(i, i + 2)));
        let obtuse = dots.iter().position(|&d| d < 0.0);
        for (i, &v) in triangle.iter().enumerate() {
            let v = v as usize;
            normals[v] = add(normals[v], normal);
            areas[v] += match obtuse {
                Some(corner) if corner == i => twice / 4.0,
                Some(_) => twice / 8.0,
                None if twice > 0.0 => {
                    let half = |a: usize, b: usize| dot(edge(i, a), edge(i, a)) * dots[b % 3];
                    (half(i + 1, i + 2) + half(i + 2, i + 1)) / (8.0 * twice)
                }
                None => 0.0,
            };
        }
    }
    (areas, normals)
}

/// Whether each vertex is on an edge that only one triangle has.
fn on_border(mesh: &TriangleMesh) -> Vec<bool> {
    let mut triangles: HashMap<[u32; 2], u32> = HashMap::new();
    let edges = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]].map(|[u, v]| [u.min(v), u.max(v)]);
    for edge in mesh.triangles().iter().flat_map(edges).filter(|[u, v]| u != v) {
        *triangles.entry(edge).or_default() += 1;
    }
    let mut on_border = vec![false; mesh.vertices().len()];
    for (edge, _) in triangles.iter().filter(|(_, count)| **count == 1) {
        edge.iter().for_each(|&v| on_border[v as usize] = true);
    }
    on_border
}

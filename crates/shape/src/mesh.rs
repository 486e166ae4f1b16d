use crate::{Graph, ShapeError};

/// A triangle mesh: vertices in the order of their file, triangles that index them.
///
/// Degenerate, repeated and unreferenced elements are allowed: the mesh is never silently repaired.
///
/// ```
/// # use mser3d_shape::TriangleMesh;
/// let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
/// let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])?;
/// assert!((mesh.signed_volume() - 1.0 / 6.0).abs() < 1e-15);
/// # Ok::<(), mser3d_shape::ShapeError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleMesh {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// A mesh from vertex positions and triples of vertex numbers (from 0).
    ///
    /// # Errors
    /// [`ShapeError::NotFinite`] or [`ShapeError::IndexOutOfRange`], each naming the first culprit.
    pub fn new(vertices: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Result<Self, ShapeError> {
        if vertices.len() > u32::MAX as usize || triangles.len() > u32::MAX as usize {
            let count = vertices.len().max(triangles.len()) as u128;
            return Err(ShapeError::TooMany { what: "vertices or triangles", count, limit: u32::MAX.into() });
        }
        if let Some(vertex) = vertices.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(ShapeError::NotFinite { vertex });
        }
        for (number, triangle) in triangles.iter().enumerate() {
            if let Some(&index) = triangle.iter().find(|&&v| v as usize >= vertices.len()) {
                let vertices = vertices.len();
                return Err(ShapeError::IndexOutOfRange { element: "triangle", number, index, vertices });
            }
        }
        Ok(Self { vertices, triangles })
    }

    /// Positions, in file order.
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }

    /// Triples of vertex numbers.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The positions of a triangle's corners.
    #[inline]
    pub fn corners(&self, triangle: usize) -> [[f64; 3]; 3] {
        self.triangles[triangle].map(|v| self.vertices[v as usize])
    }

    /// The same triangles over other positions: another pose, a noisy copy.
    ///
    /// # Errors
    /// [`ShapeError::SizeMismatch`] or [`ShapeError::NotFinite`].
    pub fn with_vertices(&self, vertices: Vec<[f64; 3]>) -> Result<Self, ShapeError> {
        if vertices.len() != self.vertices.len() {
            let (found, expected) = (vertices.len(), self.vertices.len());
            return Err(ShapeError::SizeMismatch { what: "vertices", found, expected });
        }
        Self::new(vertices, self.triangles.clone())
    }

    /// The box around the vertices that triangles use; `None` without triangles.
    pub fn bounding_box(&self) -> Option<BoundingBox> {
        let used = self.triangles.iter().flatten().map(|&v| self.vertices[v as usize]);
        BoundingBox::around(used)
    }

    /// Area of a triangle, in length^2.
    pub fn triangle_area(&self, triangle: usize) -> f64 {
        let [a, b, c] = self.corners(triangle);
        0.5 * norm(cross(sub(b, a), sub(c, a)))
    }

    /// Total area, in length^2.
    pub fn area(&self) -> f64 {
        (0..self.triangles.len()).map(|t| self.triangle_area(t)).sum()
    }

    /// A third of the area of the triangles around each vertex, in length^2.
    pub fn vertex_areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.vertices.len()];
        for (t, triangle) in self.triangles.iter().enumerate() {
            let third = self.triangle_area(t) / 3.0;
            for &v in triangle {
                areas[v as usize] += third;
            }
        }
        areas
    }

    /// Volume enclosed, in length^3, by the divergence theorem: positive when the triangles turn
    /// counter-clockwise seen from outside. Meaningful for closed meshes only.
    pub fn signed_volume(&self) -> f64 {
        // Relative to the first vertex: far from the origin the terms would cancel.
        let Some(&origin) = self.vertices.first() else { return 0.0 };
        let volume = |t: usize| {
            let [a, b, c] = self.corners(t).map(|p| sub(p, origin));
            dot(a, cross(b, c)) / 6.0
        };
        (0..self.triangles.len()).map(volume).sum()
    }

    /// The graph of vertices and triangle edges.
    pub fn edge_graph(&self) -> Graph {
        let edges: Vec<[u32; 2]> =
            self.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        Graph::from_edges(self.vertices.len(), &edges).expect("triangles were checked when the mesh was made")
    }
}

/// An axis-parallel box.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BoundingBox {
    /// Lowest corner.
    pub min: [f64; 3],
    /// Highest corner.
    pub max: [f64; 3],
}

impl BoundingBox {
    /// The box around some points; `None` without points.
    pub fn around(points: impl IntoIterator<Item = [f64; 3]>) -> Option<Self> {
        let mut points = points.into_iter();
        let first = points.next()?;
        let mut bounds = Self { min: first, max: first };
        for p in points {
            for a in 0..3 {
                bounds.min[a] = bounds.min[a].min(p[a]);
                bounds.max[a] = bounds.max[a].max(p[a]);
            }
        }
        Some(bounds)
    }

    /// Length along x, y and z.
    pub fn extent(&self) -> [f64; 3] {
        sub(self.max, self.min)
    }

    /// Length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        norm(self.extent())
    }
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron(shift: f64) -> TriangleMesh {
        let vertices = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [9., 9., 9.]];
        let vertices = vertices.iter().map(|p| p.map(|x| x + shift)).collect();
        TriangleMesh::new(vertices, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]).unwrap()
    }

    #[test]
    fn volume_and_area_of_a_tetrahedron() {
        let mesh = tetrahedron(0.0);
        assert!((mesh.signed_volume() - 1.0 / 6.0).abs() < 1e-15);
        assert!((mesh.area() - (1.5 + 3f64.sqrt() / 2.0)).abs() < 1e-15);
        assert!((mesh.vertex_areas().iter().sum::<f64>() - mesh.area()).abs() < 1e-15);
        assert!((tetrahedron(1e6).signed_volume() - 1.0 / 6.0).abs() < 1e-9);
    }

    #[test]
    fn the_box_is_around_used_vertices_only() {
        assert_eq!(tetrahedron(0.0).bounding_box().unwrap().max, [1.0; 3]);
    }

    #[test]
    fn wrong_triangles_and_coordinates_are_named() {
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, f64::NAN, 0.0]];
        assert_eq!(TriangleMesh::new(points, vec![]), Err(ShapeError::NotFinite { vertex: 2 }));
        let error = TriangleMesh::new(vec![[0.0; 3]; 3], vec![[0, 1, 2], [0, 1, 3]]).unwrap_err();
        assert!(error.to_string().starts_with("triangle 1 names vertex 3"));
    }
}

//! A transformed shape, vertex by vertex from the null shape.

use mser3d_shape::TriangleMesh;

use crate::{EvaluationError, SurfacePoint};

/// A transformed shape, with the point of the null shape that each vertex comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Transformed {
    /// The transformed surface. It may be open, and need not have the null shape's vertices.
    pub mesh: TriangleMesh,
    /// One point per vertex; `None` for a vertex that no triangle of the null shape uses.
    pub points: Vec<Option<SurfacePoint>>,
}

impl Transformed {
    /// The null shape's triangles over moved vertices.
    pub(super) fn moved(null: &TriangleMesh, vertices: Vec<[f64; 3]>) -> Result<Self, EvaluationError> {
        Ok(Self { mesh: null.with_vertices(vertices)?, points: SurfacePoint::vertices_of(null) })
    }

    /// Some of the null shape's triangles, and the vertices that these use, in the same order.
    pub(super) fn kept(null: &TriangleMesh, keep: impl Fn(usize) -> bool) -> Result<Self, EvaluationError> {
        let triangles = (0..null.triangles().len()).filter(|&t| keep(t)).map(|t| null.triangles()[t]);
        Self::over_null_vertices(null, null.vertices(), triangles.collect())
    }

    /// Any triangles over the null shape's vertices; the vertices that they use, in the same order.
    pub(super) fn over_null_vertices(
        null: &TriangleMesh,
        places: &[[f64; 3]],
        mut triangles: Vec<[u32; 3]>,
    ) -> Result<Self, EvaluationError> {
        let mut used = vec![false; places.len()];
        triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
        let origin = SurfacePoint::vertices_of(null);
        let (mut vertices, mut points, mut number) = (Vec::new(), Vec::new(), vec![0; places.len()]);
        for v in (0..places.len()).filter(|&v| used[v]) {
            number[v] = vertices.len() as u32;
            vertices.push(places[v]);
            points.push(origin[v]);
        }
        triangles.iter_mut().flatten().for_each(|v| *v = number[*v as usize]);
        Ok(Self { mesh: TriangleMesh::new(vertices, triangles)?, points })
    }
}

use mser3d_shape::TriangleMesh;
use mser3d_shape::vector::{Vec3, cross, dot, norm, sub};

use crate::EvaluationError;

/// A point of a triangle mesh: a triangle and barycentric weights of its three corners.
///
/// A ground truth is one point of the null shape for each vertex of the transformed shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Number of the triangle, from 0.
    pub triangle: u32,
    /// Weights of the triangle's corners, which sum to 1.
    pub weights: [f64; 3],
}

impl SurfacePoint {
    /// The point of corner `corner` (0, 1 or 2) of a triangle.
    pub fn corner(triangle: u32, corner: usize) -> Self {
        Self { triangle, weights: std::array::from_fn(|c| if c == corner { 1.0 } else { 0.0 }) }
    }

    /// A place on a triangle, as weights of its corners; the nearest corner on one without area.
    pub fn at(mesh: &TriangleMesh, triangle: u32, place: [f64; 3]) -> Self {
        let corners = mesh.corners(triangle as usize);
        let n = normal(corners);
        let square = dot(n, n);
        let away = |c: &usize| norm(sub(corners[*c], place));
        if square == 0.0 {
            let nearest = (0..3).min_by(|a, b| away(a).total_cmp(&away(b)));
            return Self::corner(triangle, nearest.unwrap_or(0));
        }
        let weight = |c: usize| {
            let (p, q) = (corners[(c + 1) % 3], corners[(c + 2) % 3]);
            (dot(cross(sub(q, p), sub(place, p)), n) / square).clamp(0.0, 1.0)
        };
        let weights = [weight(0), weight(1), weight(2)];
        let sum: f64 = weights.iter().sum();
        Self { triangle, weights: weights.map(|w| w / sum) }
    }

    /// For each vertex of a mesh, the vertex itself as a point of a triangle; `None` for a vertex
    /// that no triangle uses.
    pub fn vertices_of(mesh: &TriangleMesh) -> Vec<Option<Self>> {
        let mut points = vec![None; mesh.vertices().len()];
        for (t, triangle) in mesh.triangles().iter().enumerate() {
            for (corner, &v) in triangle.iter().enumerate() {
                points[v as usize].get_or_insert(Self::corner(t as u32, corner));
            }
        }
        points
    }

    /// Where the point lies, for a mesh that has the triangle.
    pub fn position(&self, mesh: &TriangleMesh) -> [f64; 3] {
        let corners = mesh.corners(self.triangle as usize);
        std::array::from_fn(|a| (0..3).map(|c| self.weights[c] * corners[c][a]).sum())
    }

    /// Checks a ground truth against the null shape.
    ///
    /// # Errors
    /// [`EvaluationError::OutOfRange`] or [`EvaluationError::NotFinite`] with the first vertex whose point is
    /// not on the null shape.
    pub fn check(points: &[Option<Self>], null: &TriangleMesh) -> Result<(), EvaluationError> {
        let count = null.triangles().len();
        for (number, point) in points.iter().enumerate() {
            let Some(point) = point else { continue };
            if point.triangle as usize >= count {
                let (what, index) = ("correspondence of vertex", point.triangle.into());
                return Err(EvaluationError::OutOfRange { what, number, index, count });
            }
            if point.weights.iter().any(|w| !w.is_finite()) {
                return Err(EvaluationError::NotFinite { what: "barycentric weight of vertex", number });
            }
        }
        Ok(())
    }
}

/// Twice a triangle's area times its unit normal.
pub(crate) fn normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    cross(sub(b, a), sub(c, a))
}

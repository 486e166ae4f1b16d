use std::cmp::Reverse;
use std::collections::BinaryHeap;

use mser3d_shape::{IndexSet, TriangleMesh};

use crate::{EvaluationError, SurfacePoint};

/// The ground-truth correspondence: carries regions from a transformed shape to the null shape.
///
/// Each vertex of the null shape takes the transformed vertex whose corresponding point is nearest
/// along the edges of the null shape; of several, the one with the smallest number. It takes none
/// when that point is farther away than the longest edge of the transformed shape at that vertex,
/// measured between corresponding points on the null shape: there the surface is missing.
#[derive(Clone, Debug, PartialEq)]
pub struct Correspondence {
    /// Per null vertex, the transformed vertex it takes, or `NONE`.
    source: Vec<u32>,
    /// How many vertices the transformed shape has.
    transformed: usize,
}

const NONE: u32 = u32::MAX;

impl Correspondence {
    /// Between shapes with the same vertices: vertex v takes vertex v.
    pub fn identity(vertices: usize) -> Self {
        Self { source: (0..vertices as u32).collect(), transformed: vertices }
    }

    /// From the null shape, the transformed shape, and for each vertex of the latter its point on
    /// the former (`None`: unknown). Cost: Dijkstra's algorithm from all points at once.
    ///
    /// # Errors
    /// [`EvaluationError::SizeMismatch`] when there is not one point per transformed vertex; otherwise
    /// as [`SurfacePoint::check`].
    pub fn new(
        null: &TriangleMesh,
        transformed: &TriangleMesh,
        points: &[Option<SurfacePoint>],
    ) -> Result<Self, EvaluationError> {
        let count = transformed.vertices().len();
        if points.len() != count {
            let (found, expected) = (points.len(), count);
            return Err(EvaluationError::SizeMismatch { what: "corresponding points", found, expected });
        }
        SurfacePoint::check(points, null)?;
        let places: Vec<_> = points.iter().map(|p| p.map(|p| p.position(null))).collect();
        let reach = longest_edges(transformed, &places);

        // Distances are not negative, so their bits sort as they do.
        let mut queue = BinaryHeap::new();
        let mut nearest = vec![(f64::INFINITY, NONE); null.vertices().len()];
        for (v, (point, place)) in points.iter().zip(&places).enumerate() {
            let (Some(point), Some(place)) = (point, place) else { continue };
            for &corner in &null.triangles()[point.triangle as usize] {
                let way = distance(*place, null.vertices()[corner as usize]);
                queue.push(Reverse((way.to_bits(), v as u32, corner)));
            }
        }
        let graph = null.edge_graph();
        while let Some(Reverse((bits, source, at))) = queue.pop() {
            if nearest[at as usize].1 != NONE {
                continue;
            }
            let way = f64::from_bits(bits);
            nearest[at as usize] = (way, source);
            for &next in graph.neighbours(at) {
                if nearest[next as usize].1 == NONE {
                    let edge = distance(null.vertices()[at as usize], null.vertices()[next as usize]);
                    queue.push(Reverse(((way + edge).to_bits(), source, next)));
                }
            }
        }
        let within = |(way, source): (f64, u32)| {
            if source != NONE && way <= reach[source as usize] { source } else { NONE }
        };
        Ok(Self { source: nearest.into_iter().map(within).collect(), transformed: count })
    }

    /// The null vertices that have a counterpart on the transformed shape.
    pub fn covered(&self) -> IndexSet {
        IndexSet::from_fn(self.source.len(), |v| self.source[v] != NONE)
    }

    /// The image of a region of the transformed shape: the null vertices whose counterpart lies in it.
    ///
    /// # Errors
    /// [`EvaluationError::SizeMismatch`] for a region of another shape.
    pub fn carry(&self, region: &IndexSet) -> Result<IndexSet, EvaluationError> {
        if region.universe() != self.transformed {
            let (found, expected) = (region.universe(), self.transformed);
            let what = "vertices of the shape that a transformed region is on";
            return Err(EvaluationError::SizeMismatch { what, found, expected });
        }
        // NONE lies beyond any region.
        Ok(IndexSet::from_fn(self.source.len(), |v| region.contains(self.source[v] as usize)))
    }
}

/// Per transformed vertex, its longest edge, measured between points on the null shape.
fn longest_edges(transformed: &TriangleMesh, places: &[Option<[f64; 3]>]) -> Vec<f64> {
    let mut longest = vec![0.0f64; places.len()];
    for t in transformed.triangles() {
        for side in 0..3 {
            let (a, b) = (t[side] as usize, t[(side + 1) % 3] as usize);
            if let (Some(p), Some(q)) = (places[a], places[b]) {
                let length = distance(p, q);
                longest[a] = longest[a].max(length);
                longest[b] = longest[b].max(length);
            }
        }
    }
    longest
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of n squares of side 1 along x, vertices 2i and 2i + 1 at x = i.
    fn strip(n: usize) -> TriangleMesh {
        let vertices = (0..=n).flat_map(|i| [[i as f64, 0.0, 0.0], [i as f64, 1.0, 0.0]]).collect();
        let square = |i: u32| [[2 * i, 2 * i + 2, 2 * i + 1], [2 * i + 2, 2 * i + 3, 2 * i + 1]];
        TriangleMesh::new(vertices, (0..n as u32).flat_map(square).collect()).unwrap()
    }

    #[test]
    fn equal_shapes_give_the_identity() {
        let mesh = strip(5);
        let points = SurfacePoint::vertices_of(&mesh);
        let identity = Correspondence::identity(mesh.vertices().len());
        assert_eq!(Correspondence::new(&mesh, &mesh, &points).unwrap(), identity);
    }

    #[test]
    fn a_coarse_shape_covers_all_of_a_fine_one() {
        // Squares of side 1 against one square of side 4: its left corners take x = 0, 1, 2.
        let (fine, coarse) = (strip(4), strip(1));
        let corner = |v: usize| SurfacePoint::vertices_of(&fine)[v];
        let correspondence =
            Correspondence::new(&fine, &coarse, &[corner(0), corner(1), corner(8), corner(9)]).unwrap();
        let left = correspondence.carry(&IndexSet::from_members(4, [0, 1]).unwrap()).unwrap();
        assert_eq!(left.members().collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5]);
        assert_eq!(correspondence.covered().len(), 10);
    }

    #[test]
    fn where_the_surface_is_missing_nothing_is_carried() {
        // Only the first of four squares is left: one edge beyond it counts, the rest does not.
        let (null, part) = (strip(4), strip(1));
        let points = &SurfacePoint::vertices_of(&null)[..4];
        let correspondence = Correspondence::new(&null, &part, points).unwrap();
        let all = correspondence.carry(&IndexSet::from_fn(4, |_| true)).unwrap();
        assert_eq!(all, correspondence.covered());
        assert!(all.members().eq(0..6), "{:?}", all.members().collect::<Vec<_>>());
    }

    #[test]
    fn points_off_the_null_shape_are_refused() {
        let mesh = strip(1);
        let mut points = SurfacePoint::vertices_of(&mesh);
        points[2] = Some(SurfacePoint::corner(2, 0));
        let error = Correspondence::new(&mesh, &mesh, &points).unwrap_err();
        assert_eq!(
            error.to_string(),
            "correspondence of vertex 2 names 2, but there are only 2 (numbered from 0)"
        );
        assert!(Correspondence::new(&mesh, &mesh, &points[..3]).is_err());
    }
}

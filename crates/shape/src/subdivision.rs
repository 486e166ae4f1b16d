//! A mesh divided into smaller triangles.

use std::collections::HashMap;

use crate::vector::{norm, sub};
use crate::{InvalidParameter, ShapeError, TriangleMesh};

/// A mesh whose edges were split in the middle until none was longer than asked: the same surface in smaller triangles. Both triangles of an
/// edge are split together, so that no gap opens.
///
/// ```
/// use mser3d_shape::{Subdivision, TriangleMesh};
///
/// let mesh = TriangleMesh::new(vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let fine = Subdivision::new(&mesh, 1.2, usize::MAX)?;
/// // The edges of 2 and of 2.24 were too long.
/// assert_eq!(fine.mesh().triangles().len(), 3);
/// assert_eq!(fine.mesh().vertices()[4], [1.0, 0.5, 0.0]);
/// assert_eq!(fine.places()[4], (0, [0.0, 0.5, 0.5]));
/// # Ok::<(), mser3d_shape::ShapeError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Subdivision {
    mesh: TriangleMesh,
    places: Vec<(u32, [f64; 3])>,
    pieces: Vec<(u32, [[f64; 3]; 3])>,
}

/// The corner of a piece: a vertex, and its place in the triangle that it is a piece of.
#[derive(Clone, Copy)]
struct Corner {
    vertex: u32,
    weights: [f64; 3],
}

/// A piece of a triangle of the mesh.
struct Piece {
    triangle: u32,
    corners: [Corner; 3],
}

impl Subdivision {
    /// Splits edges until none is longer than `longest`, in the unit of the coordinates, or there are `most` triangles or more.
    ///
    /// # Errors
    /// [`ShapeError::InvalidParameter`] unless `longest` is more than 0; [`ShapeError::NotFinite`] for coordinates so large that the middle
    /// of an edge is not finite.
    pub fn new(mesh: &TriangleMesh, longest: f64, most: usize) -> Result<Self, ShapeError> {
        InvalidParameter::unless(longest > 0.0, "longest", longest, "more than 0")?;
        let mut vertices = mesh.vertices().to_vec();
        let mut places = vec![(0, [1.0, 0.0, 0.0]); vertices.len()];
        let whole = |(triangle, corners): (u32, &[u32; 3])| {
            let corner =
                |i: usize| Corner { vertex: corners[i], weights: std::array::from_fn(|j| f64::from(i == j)) };
            Piece { triangle, corners: [corner(0), corner(1), corner(2)] }
        };
        let mut pieces: Vec<Piece> = (0..).zip(mesh.triangles()).map(whole).collect();
        for piece in &pieces {
            piece.corners.iter().for_each(|c| places[c.vertex as usize] = (piece.triangle, c.weights));
        }
        while pieces.len() < most {
            let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
            let mut finer = Vec::with_capacity(pieces.len());
            for piece in &pieces {
                let mut middle = |a: Corner, b: Corner| {
                    let ends = [a, b].map(|corner| vertices[corner.vertex as usize]);
                    if norm(sub(ends[0], ends[1])) <= longest {
                        return None;
                    }
                    let weights = std::array::from_fn(|i| 0.5 * (a.weights[i] + b.weights[i]));
                    let edge = [a.vertex.min(b.vertex), a.vertex.max(b.vertex)];
                    let vertex = *middles.entry(edge).or_insert_with(|| {
                        vertices.push(std::array::from_fn(|i| 0.5 * (ends[0][i] + ends[1][i])));
                        places.push((piece.triangle, weights));
                        vertices.len() as u32 - 1
                    });
                    Some(Corner { vertex, weights })
                };
                let [a, b, c] = piece.corners;
                let parts = match [middle(a, b), middle(b, c), middle(c, a)] {
                    [None, None, None] => vec![[a, b, c]],
                    [Some(p), None, None] => vec![[a, p, c], [p, b, c]],
                    [None, Some(p), None] => vec![[b, p, a], [p, c, a]],
                    [None, None, Some(p)] => vec![[c, p, b], [p, a, b]],
                    [Some(p), Some(q), None] => vec![[p, b, q], [a, p, q], [a, q, c]],
                    [None, Some(p), Some(q)] => vec![[p, c, q], [b, p, q], [b, q, a]],
                    [Some(q), None, Some(p)] => vec![[p, a, q], [c, p, q], [c, q, b]],
                    [Some(p), Some(q), Some(r)] => vec![[a, p, r], [p, b, q], [r, q, c], [p, q, r]],
                };
                let triangle = piece.triangle;
                finer.extend(parts.into_iter().map(|corners| Piece { triangle, corners }));
            }
            pieces = finer;
            if middles.is_empty() {
                break;
            }
        }
        let triangles = pieces.iter().map(|piece| piece.corners.map(|corner| corner.vertex)).collect();
        let mesh = TriangleMesh::new(vertices, triangles)?;
        let pieces =
            pieces.into_iter().map(|p| (p.triangle, p.corners.map(|corner| corner.weights))).collect();
        Ok(Self { mesh, places, pieces })
    }

    /// The divided mesh. The vertices of the one that it was made of come first.
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// The divided mesh alone.
    pub fn into_mesh(self) -> TriangleMesh {
        self.mesh
    }

    /// Where each vertex is on the mesh that it was made of: in which triangle, and how much its corners count (barycentric coordinates). Of
    /// a vertex of several triangles one of them; `(0, [1, 0, 0])` of one that no triangle uses.
    pub fn places(&self) -> &[(u32, [f64; 3])] {
        &self.places
    }

    /// Of each triangle, the one that it is a piece of, and of each of its corners how much the corners of that one count.
    pub fn pieces(&self) -> &[(u32, [[f64; 3]; 3])] {
        &self.pieces
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A long brick: 12 triangles with edges of 1 to 8.
    fn brick() -> TriangleMesh {
        let corner = |i: u32| {
            [8.0, 1.0, 1.0].map(|x: f64| x).into_iter().enumerate().fold([0.0; 3], |mut p, (a, x)| {
                p[a] = if i >> a & 1 == 0 { 0.0 } else { x };
                p
            })
        };
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        TriangleMesh::new((0..8).map(corner).collect(), triangles).unwrap()
    }

    #[test]
    fn edges_are_split_until_they_are_short_and_no_gap_opens() {
        let mesh = brick();
        let divided = Subdivision::new(&mesh, 0.3, usize::MAX).unwrap();
        let (fine, places) = (divided.mesh(), divided.places());
        for t in 0..fine.triangles().len() {
            let [a, b, c] = fine.corners(t);
            assert!([(a, b), (b, c), (c, a)].iter().all(|(p, q)| norm(sub(*p, *q)) <= 0.3));
        }
        assert!((fine.signed_volume() - mesh.signed_volume()).abs() < 1e-12);
        assert!((fine.signed_volume() - 8.0).abs() < 1e-12);
        // Each edge has a triangle on either side, in opposite directions.
        let mut edges = std::collections::BTreeSet::new();
        for &[a, b, c] in fine.triangles() {
            assert!([[a, b], [b, c], [c, a]].into_iter().all(|edge| edges.insert(edge)));
        }
        assert!(edges.iter().all(|&[a, b]| edges.contains(&[b, a])));
        // Places lead to the vertices.
        for (vertex, (triangle, weights)) in fine.vertices().iter().zip(places) {
            let corners = mesh.corners(*triangle as usize);
            let at: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| weights[j] * corners[j][i]).sum());
            assert!(norm(sub(at, *vertex)) < 1e-12);
        }
        assert_eq!(&fine.vertices()[..8], mesh.vertices());
        // So do the corners of pieces.
        for (piece, (triangle, corners)) in fine.triangles().iter().zip(divided.pieces()) {
            let whole = mesh.corners(*triangle as usize);
            for (vertex, weights) in piece.iter().zip(corners) {
                let at: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| weights[j] * whole[j][i]).sum());
                assert!(norm(sub(at, fine.vertices()[*vertex as usize])) < 1e-12);
            }
        }
        assert!(Subdivision::new(&mesh, 0.01, 1000).unwrap().mesh().triangles().len() < 5000);
    }

    #[test]
    fn no_length_at_all_is_refused() {
        for longest in [0.0, -1.0, f64::NAN] {
            let error = Subdivision::new(&brick(), longest, usize::MAX).unwrap_err();
            assert_eq!(error.to_string(), format!("longest is {longest}: it must be more than 0"));
        }
    }
}

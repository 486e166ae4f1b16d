//! The surface with triangles no larger than a voxel: borders of regions don't depend on the mesh.

use std::collections::HashMap;
use std::path::Path;

use mser3d::SurfacePoints;
use mser3d_meshio::write_ply;
use mser3d_shape::TriangleMesh;
use mser3d_shape::vector::{norm, sub};

use crate::{Results, ResultsError};

/// Triangles beyond which edges are not split any more.
const MOST_TRIANGLES: usize = 4_000_000;

/// The corner of a triangle: a vertex, and its place in the triangle of the mesh that it is a piece of.
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

impl Results {
    /// The surface with edges no longer than a voxel, and for each vertex the innermost region that holds the voxel that it sees, -1 for none.
    /// The vertices of the mesh come first, with the regions that they have there. `path` is what errors are about.
    ///
    /// # Errors
    /// [`ResultsError::Export`] without voxels or without a mesh.
    pub fn fine_surface(&self, path: &Path) -> Result<(TriangleMesh, Vec<i32>), ResultsError> {
        let refuse = |reason| ResultsError::Export { path: path.to_owned(), reason };
        let grid = self.grid.as_ref().ok_or_else(|| {
            refuse("the regions were found on a surface, whose vertices are all there is; write .ply")
        })?;
        if self.mesh_of_voxels {
            return Err(refuse("the input is voxels, whose faces are as fine as can be; write .ply"));
        }
        let longest = grid.frame().spacing().into_iter().fold(0.0, f64::max);
        let (mesh, places) = refined(&self.mesh, longest, MOST_TRIANGLES)?;
        let points = SurfacePoints::at(places[self.mesh.vertices().len()..].to_vec());
        let voxel_region = self.voxel_region();
        let mut labels = self.vertex_region();
        let of_voxel = |voxel: Option<u32>| voxel.map_or(-1, |voxel| voxel_region[voxel as usize]);
        let voxels = points.voxels(&self.mesh, grid).map_err(|error| match error {
            mser3d::Error::Shape(error) => ResultsError::Shape(error),
            _ => refuse("the voxels that its places see were not found"),
        })?;
        labels.extend(voxels.into_iter().map(of_voxel));
        Ok((mesh, labels))
    }

    /// Writes [`Results::fine_surface`] with colour and region of each vertex.
    pub(crate) fn write_fine_surface(&self, path: &Path) -> Result<(), ResultsError> {
        let (mesh, labels) = self.fine_surface(path)?;
        Ok(self.with_labels(&labels, |attributes| write_ply(path, &mesh, attributes))?)
    }
}

/// Splits edges in the middle until none is longer, or there are too many triangles; both triangles of an edge together, so that no
/// gap opens. Also for each vertex its place in a triangle of the mesh: the triangle, and how much its corners count.
fn refined(
    mesh: &TriangleMesh,
    longest: f64,
    most: usize,
) -> Result<(TriangleMesh, Vec<(u32, [f64; 3])>), ResultsError> {
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
    Ok((TriangleMesh::new(vertices, triangles)?, places))
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
        let (fine, places) = refined(&mesh, 0.3, usize::MAX).unwrap();
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
        for (vertex, (triangle, weights)) in fine.vertices().iter().zip(&places) {
            let corners = mesh.corners(*triangle as usize);
            let at: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| weights[j] * corners[j][i]).sum());
            assert!(norm(sub(at, *vertex)) < 1e-12);
        }
        assert_eq!(&fine.vertices()[..8], mesh.vertices());
        assert!(refined(&mesh, 0.01, 1000).unwrap().0.triangles().len() < 5000);
    }
}

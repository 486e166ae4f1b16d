use mser3d_shape::vector::{Vec3, cross, sub};
use mser3d_shape::{TriangleMesh, VoxelGrid};

use crate::Error;
use crate::progress::NO_PROGRESS;
use crate::sight::seen_by_points;
use crate::solid::by_chunks;

/// How far, in voxels, a point may be from the voxel that it takes.
const REACH: f64 = 2.0;

/// Points spread evenly over a surface, each bound to its place in a triangle: places of the body that can be found again on
/// every mesh with the same triangles, however coarse these are.
///
/// ```
/// use mser3d::SurfacePoints;
/// use mser3d::shape::TriangleMesh;
///
/// let corners = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]];
/// let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])?;
/// let points = SurfacePoints::spread(&mesh, 600);
/// // One triangle has the area 2 of 2 + 1 + 1 + sqrt(6).
/// let bottom = points.positions(&mesh).iter().filter(|p| p[2] == 0.0).count() as f64;
/// assert!((bottom / 600.0 - 2.0 / (4.0 + 6.0_f64.sqrt())).abs() < 0.01);
/// # Ok::<(), mser3d::shape::ShapeError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SurfacePoints {
    /// The triangle of each, and how much each of its corners counts.
    places: Vec<(u32, [f64; 3])>,
}

impl SurfacePoints {
    /// So many points, each for an equal share of the area; none on a mesh without area.
    pub fn spread(mesh: &TriangleMesh, count: usize) -> Self {
        let areas: Vec<f64> = (0..mesh.triangles().len()).map(|t| mesh.triangle_area(t)).collect();
        let share = areas.iter().sum::<f64>() / count as f64;
        if !(share > 0.0 && share.is_finite()) {
            return Self { places: Vec::new() };
        }
        let mut places = Vec::with_capacity(count);
        let mut area = 0.0;
        for (triangle, own) in (0u32..).zip(&areas) {
            area += own;
            while places.len() < count && (places.len() as f64 + 0.5) * share < area {
                places.push((triangle, within_triangle(places.len())));
            }
        }
        Self { places }
    }

    /// Points at places of one's own: of each its triangle, and how much each of its corners counts (barycentric coordinates).
    pub fn at(places: Vec<(u32, [f64; 3])>) -> Self {
        Self { places }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Where they are on a mesh with the triangles of the one that they were spread on.
    pub fn positions(&self, mesh: &TriangleMesh) -> Vec<[f64; 3]> {
        self.places.iter().map(|place| position(mesh, place)).collect()
    }

    /// The vertex that is nearest to each within its triangle.
    pub fn vertices(&self, mesh: &TriangleMesh) -> Vec<u32> {
        let nearest = |&(triangle, weights): &(u32, [f64; 3])| {
            let largest = (0..3).fold(0, |best, i| if weights[i] > weights[best] { i } else { best });
            mesh.triangles()[triangle as usize][largest]
        };
        self.places.iter().map(nearest).collect()
    }

    /// The voxel of each in the solid inside a mesh: as a vertex takes it, the nearest that it sees from inside. None where
    /// no voxel is within two. The mesh has the triangles of the one that the points were spread on.
    ///
    /// # Errors
    /// [`Error::Shape`]: in theory, for a mesh without those triangles.
    pub fn voxels(&self, mesh: &TriangleMesh, grid: &VoxelGrid) -> Result<Vec<Option<u32>>, Error> {
        let outwards = if mesh.signed_volume() < 0.0 { -1.0 } else { 1.0 };
        let nearest = grid.nearest();
        let reach = REACH * grid.frame().spacing().into_iter().fold(0.0, f64::max);
        let found = by_chunks(&self.places, 0.0..1.0, NO_PROGRESS, |place| {
            let point = position(mesh, place);
            let [a, b, c] = mesh.corners(place.0 as usize);
            let normal: Vec3 = cross(sub(b, a), sub(c, a)).map(|x| outwards * x);
            (point, normal, nearest.voxel_within(point, reach).map(|found| found.0))
        })?;
        seen_by_points(mesh, grid, &found, NO_PROGRESS)
    }
}

fn position(mesh: &TriangleMesh, &(triangle, weights): &(u32, [f64; 3])) -> [f64; 3] {
    let corners = mesh.corners(triangle as usize);
    std::array::from_fn(|axis| (0..3).map(|i| weights[i] * corners[i][axis]).sum())
}

/// Barycentric coordinates number `i` of a sequence that fills the triangle evenly: the R2 sequence (Roberts 2018), folded
/// from the square.
fn within_triangle(i: usize) -> [f64; 3] {
    let [u, v] =
        [0.754_877_666_246_692_7, 0.569_840_290_998_053_2].map(|step| (0.5 + step * i as f64).fract());
    let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
    [1.0 - u - v, u, v]
}

#[cfg(test)]
mod tests {
    use super::*;
    use mser3d_shape::{BitGrid, Frame};

    /// Two plates of thickness 1, the upper one 0.2 above the lower one.
    fn plates() -> (TriangleMesh, VoxelGrid) {
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for low in [0.0, 1.2] {
            let first = vertices.len() as u32;
            vertices.extend((0..8u32).map(|i| {
                let side = |bit: u32| if i >> bit & 1 == 0 { 0.0 } else { 4.0 };
                [side(0), side(1), if i < 4 { low } else { low + 1.0 }]
            }));
            for [a, b, c, d] in
                [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
            {
                triangles.extend([[a, b, c], [a, c, d]].map(|t: [u32; 3]| t.map(|v| v + first)));
            }
        }
        let frame = Frame::new([8, 8, 4], [0.25, 0.25, 0.25], [0.5, 0.5, 0.6]).unwrap();
        let solid = VoxelGrid::solid(frame, BitGrid::full([8, 8, 4]).unwrap()).unwrap();
        (TriangleMesh::new(vertices, triangles).unwrap(), solid)
    }

    #[test]
    fn points_take_voxels_on_their_own_side_of_the_surface() {
        let (mesh, grid) = plates();
        let points = SurfacePoints::spread(&mesh, 2000);
        assert_eq!(points.len(), 2000);
        let places = points.positions(&mesh);
        let voxels = points.voxels(&mesh, &grid).unwrap();
        let centres: Vec<[f64; 3]> = grid.voxels().map(|v| grid.frame().centre(v)).collect();
        let height = |number: usize| voxels[number].map(|v| centres[v as usize][2]);
        for (number, place) in places.iter().enumerate() {
            let is_low = place[2] <= 1.0;
            assert_eq!(height(number).map(|z| z < 1.1), Some(is_low), "{place:?} {:?}", height(number));
        }
        // Every part has its share: half of the area is on each plate.
        assert_eq!(places.iter().filter(|p| p[2] <= 1.0).count(), 1000);
    }

    #[test]
    fn points_move_with_their_triangles() {
        let (mesh, _) = plates();
        let points = SurfacePoints::spread(&mesh, 100);
        let moved = |p: &[f64; 3]| [2.0 * p[0], p[1] - p[2], p[2] + 1.0];
        let other = mesh.with_vertices(mesh.vertices().iter().map(moved).collect()).unwrap();
        for (a, b) in points.positions(&mesh).iter().map(moved).zip(points.positions(&other)) {
            assert!((0..3).all(|axis| (a[axis] - b[axis]).abs() < 1e-12));
        }
        let flat = TriangleMesh::new(vec![[0.0; 3]; 3], vec![[0, 1, 2]]).unwrap();
        assert!(SurfacePoints::spread(&flat, 10).is_empty());
    }
}

//! What a solid shows: its voxels' faces from outside, and its inside where a plane cuts it.

use std::collections::BTreeMap;

use mser3d_shape::vector::{Vec3, add, cross, dot, scale, sub, unit};
use mser3d_shape::{TriangleMesh, VoxelGrid};

use crate::ViewerError;
use crate::cut::Cut;

/// A flat convex polygon that belongs to a voxel.
pub(crate) struct Face<Corners = Vec<Vec3>> {
    pub voxel: u32,
    pub normal: Vec3,
    /// Counter-clockwise around `normal`.
    pub corners: Corners,
}

/// Half of a voxel's edge along each axis of the grid.
fn half_edges(grid: &VoxelGrid) -> [Vec3; 3] {
    let frame = grid.frame();
    std::array::from_fn(|a| scale(frame.directions()[a], 0.5 * frame.spacing()[a]))
}

/// The faces between a voxel that is there and a place where none is.
pub(crate) fn exposed_faces(grid: &VoxelGrid, cut: Option<&Cut>) -> Vec<Face<[Vec3; 4]>> {
    let frame = grid.frame();
    let halves = half_edges(grid);
    let kept =
        |v: [u32; 3]| grid.occupancy().get(v) && cut.is_none_or(|cut| cut.beyond(frame.centre(v)) <= 0.0);
    let mut faces = Vec::new();
    for (number, voxel) in grid.voxels().enumerate().filter(|(_, v)| kept(*v)) {
        let centre = frame.centre(voxel);
        for axis in 0..3 {
            for side in [-1i32, 1] {
                let mut beside = voxel;
                // A step below zero wraps to a coordinate outside any box.
                beside[axis] = beside[axis].wrapping_add_signed(side);
                if kept(beside) {
                    continue;
                }
                let side = f64::from(side);
                // Counter-clockwise from outside, also where the grid is a mirror image.
                let turn = if frame.is_left_handed() { -side } else { side };
                let (u, v) = (scale(halves[(axis + 1) % 3], turn), halves[(axis + 2) % 3]);
                let middle = add(centre, scale(halves[axis], side));
                let corner = |p: f64, q: f64| add(middle, add(scale(u, p), scale(v, q)));
                faces.push(Face {
                    voxel: number as u32,
                    normal: unit(scale(halves[axis], side)),
                    corners: [corner(-1., -1.), corner(1., -1.), corner(1., 1.), corner(-1., 1.)],
                });
            }
        }
    }
    faces
}

/// The outer faces of a grid's voxels as a closed mesh that faces outwards, two triangles a face.
/// Corners are shared wherever faces meet, so voxels that touch along an edge make it non-manifold.
///
/// # Errors
/// [`ViewerError::Empty`] for an empty grid, [`ViewerError::Shape`] beyond 2^32 vertices.
///
/// ```
/// use mser3d_shape::{BitGrid, Frame, VoxelGrid};
/// let frame = Frame::new([3, 2, 1], [0.0; 3], [0.5; 3])?;
/// let grid = VoxelGrid::solid(frame, BitGrid::full([3, 2, 1])?)?;
/// let mesh = mser3d_viewer::voxel_surface(&grid)?;
/// assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (24, 44));
/// assert_eq!(mesh.signed_volume(), grid.volume());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn voxel_surface(grid: &VoxelGrid) -> Result<TriangleMesh, ViewerError> {
    if grid.is_empty() {
        return Err(ViewerError::Empty { reason: "no voxel is occupied" });
    }
    let frame = grid.frame();
    let mut numbers = BTreeMap::new();
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for face in exposed_faces(grid, None) {
        let corners = face.corners.map(|corner| {
            let lattice = frame.locate(corner).map(|x| x.round() as i64);
            *numbers.entry(lattice).or_insert_with(|| {
                vertices.push(corner);
                vertices.len() as u32 - 1
            })
        });
        let [a, b, c, d] = corners;
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    Ok(TriangleMesh::new(vertices, triangles)?)
}

/// The polygons in which a plane cuts the voxels, seen from the side that is taken away.
pub(crate) fn cut_face(grid: &VoxelGrid, cut: &Cut) -> Vec<Face> {
    let frame = grid.frame();
    let halves = half_edges(grid);
    let normal = unit(cut.normal);
    let across = unit(cross(normal, if normal[0].abs() < 0.9 { [1., 0., 0.] } else { [0., 1., 0.] }));
    let along = cross(normal, across);
    let mut faces = Vec::new();
    for (number, voxel) in grid.voxels().enumerate() {
        let centre = frame.centre(voxel);
        let reach: f64 = halves.iter().map(|&half| dot(cut.normal, half).abs()).sum();
        // Half-open, so that a plane between two layers cuts one of them.
        let depth = cut.beyond(centre);
        if !(-reach < depth && depth <= reach) {
            continue;
        }
        let corner = |i: usize| -> Vec3 {
            (0..3).fold(centre, |p, a| add(p, scale(halves[a], if i >> a & 1 == 1 { 1.0 } else { -1.0 })))
        };
        let mut corners: Vec<Vec3> = Vec::new();
        for i in 0..8usize {
            for j in [i | 1, i | 2, i | 4].into_iter().filter(|&j| j != i) {
                let (p, q) = (corner(i), corner(j));
                let (dp, dq) = (cut.beyond(p), cut.beyond(q));
                if (dp <= 0.0) != (dq <= 0.0) {
                    corners.push(add(p, scale(sub(q, p), dp / (dp - dq))));
                }
            }
        }
        if corners.len() < 3 {
            continue;
        }
        let middle = scale(corners.iter().fold([0.0; 3], |s, &p| add(s, p)), 1.0 / corners.len() as f64);
        let angle = |p: &Vec3| dot(sub(*p, middle), along).atan2(dot(sub(*p, middle), across));
        corners.sort_by(|p, q| angle(p).total_cmp(&angle(q)));
        faces.push(Face { voxel: number as u32, normal, corners });
    }
    faces
}

/// Coloured voxels that fill a closed surface where it is cut.
#[derive(Clone, Debug)]
pub(crate) struct Filling {
    pub grid: VoxelGrid,
    /// Index of each voxel into the model's colours.
    pub paint: Vec<u32>,
}

impl Filling {
    /// The colour that prevails at a point: each of the eight voxels around it votes with its
    /// trilinear weight, which turns the steps between colours into slanted lines. Where none of the
    /// eight is inside, the nearest voxel decides.
    pub fn paint_at(&self, point: Vec3) -> u32 {
        let at = self.grid.frame().locate(point).map(|x| x - 0.5);
        let low = at.map(f64::floor);
        let mut votes: [(u32, f64); 8] = [(u32::MAX, 0.0); 8];
        for i in 0..8usize {
            let mut weight = 1.0;
            let voxel: [Option<u32>; 3] = std::array::from_fn(|a| {
                let high = i >> a & 1 == 1;
                let share = at[a] - low[a];
                weight *= if high { share } else { 1.0 - share };
                let index = low[a] + f64::from(u8::from(high));
                (0.0..f64::from(u32::MAX)).contains(&index).then_some(index as u32)
            });
            let [Some(x), Some(y), Some(z)] = voxel else { continue };
            let Some(number) = self.grid.index([x, y, z]) else { continue };
            let paint = self.paint[number as usize];
            if let Some(vote) = votes.iter_mut().find(|v| v.0 == paint || v.0 == u32::MAX) {
                *vote = (paint, vote.1 + weight);
            }
        }
        let best = votes.iter().fold((u32::MAX, 0.0), |best, v| if v.1 > best.1 { *v } else { best });
        if best.0 != u32::MAX {
            return best.0;
        }
        self.grid.nearest_voxels(&[point]).first().map_or(0, |&v| self.paint[v as usize])
    }
}

/// Whether each edge has as many triangles on one side as on the other: such a surface has an inside.
pub(crate) fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let mut edges: Vec<(u32, u32, i32)> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .map(|(a, b)| (a.min(b), a.max(b), if a < b { 1 } else { -1 }))
        .collect();
    edges.sort_unstable();
    edges.chunk_by(|p, q| (p.0, p.1) == (q.0, q.1)).all(|same| same.iter().map(|e| e.2).sum::<i32>() == 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_shapes;
    use mser3d_shape::{Affine, Frame};

    #[test]
    fn a_sphere_is_closed_until_a_triangle_is_gone_or_flipped() {
        let sphere = test_shapes::sphere(6, 8);
        assert!(is_closed(sphere.triangles()));
        let mut triangles = sphere.triangles().to_vec();
        triangles[3].swap(0, 1);
        assert!(!is_closed(&triangles));
        triangles.swap_remove(3);
        assert!(!is_closed(&triangles));
    }

    #[test]
    fn the_filling_takes_the_prevailing_voxel() {
        let grid = test_shapes::ball(10);
        let paint = grid.voxels().map(|v| u32::from(v[0] >= 5)).collect();
        let filling = Filling { grid, paint };
        assert_eq!(filling.paint_at([-0.01, 0.2, 0.1]), 0);
        assert_eq!(filling.paint_at([0.01, 0.2, 0.1]), 1);
        // Far outside the nearest voxel counts.
        assert_eq!(filling.paint_at([-9.0, 0.0, 0.0]), 0);
    }

    #[test]
    fn turned_and_mirrored_solids_face_outwards() {
        let (s, c) = 0.4f64.sin_cos();
        for steps in [[[0., 0., -2.], [1., 0., 0.], [0., 3., 0.]], [[-c, -s, 0.], [-s, c, 0.], [0., 0., 2.]]]
        {
            let affine = Affine::from_steps([5., 6., 7.], steps).unwrap();
            let frame = Frame::placed([9, 9, 9], &affine).unwrap();
            let grid = VoxelGrid::solid(frame, test_shapes::ball(9).occupancy().clone()).unwrap();
            let mesh = voxel_surface(&grid).unwrap();
            assert!((mesh.signed_volume() - grid.volume()).abs() < 1e-9 * grid.volume());
            let cut =
                Cut { normal: [0.6, -0.8, 0.0], offset: dot([0.6, -0.8, 0.0], frame.position([4.5; 3])) };
            let faces = exposed_faces(&grid, None);
            assert!(faces.iter().all(|f| area(f) > 0.0));
            let section: f64 = cut_face(&grid, &cut).iter().map(area).sum();
            assert!(section > 0.0 && cut_face(&grid, &cut).iter().all(|f| area(f) > 0.0));
        }
    }

    fn area<C: AsRef<[Vec3]>>(face: &Face<C>) -> f64 {
        let corners = face.corners.as_ref();
        let first = corners[0];
        let pairs = corners[1..].windows(2);
        pairs.map(|w| 0.5 * dot(face.normal, cross(sub(w[0], first), sub(w[1], first)))).sum()
    }

    #[test]
    fn exposed_faces_close_the_solid() {
        // Divergence theorem over the faces: their flux of p / 3 is the volume.
        let grid = test_shapes::ball(9);
        let faces = exposed_faces(&grid, None);
        let flux: f64 = faces.iter().map(|f| area(f) * dot(f.normal, f.corners[0]) / 3.0).sum();
        assert!((flux - grid.volume()).abs() < 1e-12);
    }

    #[test]
    fn cutting_drops_the_voxels_beyond() {
        let grid = test_shapes::ball(8);
        let cut = Cut { normal: [0., 0., 1.], offset: 0.0 };
        let faces = exposed_faces(&grid, Some(&cut));
        assert!(faces.iter().flat_map(|f| &f.corners).all(|p| p[2] <= 1e-12));
        let flux: f64 = faces.iter().map(|f| area(f) * dot(f.normal, f.corners[0]) / 3.0).sum();
        assert!((flux - grid.volume() / 2.0).abs() < 1e-12);
    }

    #[test]
    fn the_cut_face_has_the_area_of_the_cross_section() {
        let grid = test_shapes::ball(40);
        for normal in [[0., 0., 1.], [1., 2., -0.5], [-3., 0., 0.]] {
            let total: f64 = cut_face(&grid, &Cut { normal, offset: 0.013 }).iter().map(area).sum();
            assert!((total - std::f64::consts::PI).abs() < 0.05, "{normal:?} {total}");
        }
        // A plane exactly between two layers cuts one of them.
        let between: f64 = cut_face(&grid, &Cut { normal: [1., 0., 0.], offset: 0.0 }).iter().map(area).sum();
        assert!((between - std::f64::consts::PI).abs() < 0.05, "{between}");
    }
}

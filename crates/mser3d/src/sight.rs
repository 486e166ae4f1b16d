//! From voxels back to the surface: the voxel of each vertex is the nearest that it sees from inside.
//!
//! The nearest voxel alone may be one of another limb: of the hip where a hand lies on it, of the other thigh in a crease. There
//! the surface runs between the vertex and that voxel.

use mser3d_shape::{TriangleMesh, VoxelGrid};
use mser3d_voxelize::Bvh;

use crate::Error;
use crate::progress::ProgressFn;
use crate::solid::{PLACED, by_chunks};

/// How far inside the surface lines of sight begin, in voxels.
const INSIDE: f64 = 1e-3;

/// How many voxels away along each axis a vertex looks.
const REACH: f64 = 2.0;

/// Puts voxels that their vertices see in place of those that they do not.
///
/// `voxels` holds the nearest voxel of each vertex, numbered as in `grid`; vertices that have none keep none.
/// `normals` point outwards, of any length; without them nothing changes. A vertex that sees no voxel within two takes that of
/// the neighbour along the shortest edge that has one; if none has, it keeps its nearest.
pub(crate) fn seen_from_inside(
    mesh: &TriangleMesh,
    normals: &[[f64; 3]],
    grid: &VoxelGrid,
    voxels: Vec<Option<u32>>,
    progress: ProgressFn,
) -> Result<Vec<Option<u32>>, Error> {
    if normals.is_empty() {
        return Ok(voxels);
    }
    let sight = Sight::new(mesh, grid);
    let vertices: Vec<([f64; 3], [f64; 3], Option<u32>)> =
        (mesh.vertices().iter().zip(normals).zip(voxels)).map(|((p, n), voxel)| (*p, *n, voxel)).collect();
    let found = by_chunks(&vertices, PLACED..1.0, progress, |&(p, normal, nearest)| {
        nearest.map(|nearest| sight.voxel(p, normal, nearest))
    })?;
    Ok(carried_along_edges(mesh, found))
}

/// The same for points of the surface with normals: one that sees no voxel keeps its nearest.
pub(crate) fn seen_by_points(
    mesh: &TriangleMesh,
    grid: &VoxelGrid,
    points: &[([f64; 3], [f64; 3], Option<u32>)],
    progress: ProgressFn,
) -> Result<Vec<Option<u32>>, Error> {
    let sight = Sight::new(mesh, grid);
    by_chunks(points, PLACED..1.0, progress, |&(point, normal, nearest)| {
        nearest.map(|nearest| match sight.voxel(point, normal, nearest) {
            Place::Seen(voxel) | Place::Hidden(voxel) => voxel,
        })
    })
}

/// Where a vertex belongs.
#[derive(Clone, Copy)]
enum Place {
    Seen(u32),
    /// The vertex sees no voxel; this one is the nearest.
    Hidden(u32),
}

struct Sight<'a> {
    surface: Bvh,
    /// Of the voxels.
    centres: Vec<[f64; 3]>,
    grid: &'a VoxelGrid,
    pitch: f64,
}

impl<'a> Sight<'a> {
    fn new(mesh: &TriangleMesh, grid: &'a VoxelGrid) -> Self {
        Self {
            centres: grid.voxels().map(|voxel| grid.frame().centre(voxel)).collect(),
            surface: Bvh::new(mesh),
            grid,
            pitch: grid.frame().spacing().into_iter().fold(0.0, f64::max),
        }
    }

    /// The nearest voxel that a point of the surface sees from inside; of several, the one with the smallest number.
    fn voxel(&self, point: [f64; 3], normal: [f64; 3], nearest: u32) -> Place {
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length.is_nan() || length <= 0.0 {
            return Place::Hidden(nearest);
        }
        let eye = std::array::from_fn(|a| point[a] - INSIDE * self.pitch * normal[a] / length);
        let sees = |voxel: u32| self.surface.crossings(eye, self.centres[voxel as usize]) == 0;
        // Most see the nearest of all.
        if sees(nearest) {
            return Place::Seen(nearest);
        }
        let mut around = self.around(point);
        around.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let seen = around.into_iter().find(|&(_, voxel)| sees(voxel));
        seen.map_or(Place::Hidden(nearest), |(_, voxel)| Place::Seen(voxel))
    }

    /// The voxels within two of a point, and the squares of their distances.
    fn around(&self, point: [f64; 3]) -> Vec<(f64, u32)> {
        let frame = self.grid.frame();
        let at = frame.locate(point).map(|x| x.floor());
        let limits = |a: usize| {
            let last = frame.dims()[a] as f64 - 1.0;
            let [low, high] = [at[a] - REACH, at[a] + REACH];
            // Nothing where the point is no number.
            if low <= last && high >= 0.0 { low.max(0.0) as u32..high.min(last) as u32 + 1 } else { 0..0 }
        };
        let [xs, ys, zs] = [0, 1, 2].map(limits);
        let mut found = Vec::new();
        for z in zs {
            for y in ys.clone() {
                for voxel in xs.clone().filter_map(|x| self.grid.index([x, y, z])) {
                    let centre = self.centres[voxel as usize];
                    let square: f64 = (0..3).map(|a| (centre[a] - point[a]).powi(2)).sum();
                    if square <= (REACH * self.pitch).powi(2) {
                        found.push((square, voxel));
                    }
                }
            }
        }
        found
    }
}

/// Round by round each hidden vertex takes the voxel of the neighbour along the shortest edge that has one.
fn carried_along_edges(mesh: &TriangleMesh, found: Vec<Option<Place>>) -> Vec<Option<u32>> {
    let seen = |place: &Option<Place>| match place {
        Some(Place::Seen(voxel)) => Some(*voxel),
        Some(Place::Hidden(_)) | None => None,
    };
    let mut voxels: Vec<Option<u32>> = found.iter().map(seen).collect();
    let is_hidden = |&vertex: &u32| matches!(found[vertex as usize], Some(Place::Hidden(_)));
    let mut hidden: Vec<u32> = (0..found.len() as u32).filter(is_hidden).collect();
    if !hidden.is_empty() {
        let edges = mesh.edge_graph();
        let point = |vertex: u32| mesh.vertices()[vertex as usize];
        let length = |a: u32, b: u32| -> f64 { (0..3).map(|i| (point(a)[i] - point(b)[i]).powi(2)).sum() };
        loop {
            let nearest = |&vertex: &u32| {
                let around = edges.neighbours(vertex).iter();
                let known =
                    around.filter_map(|&other| Some((length(vertex, other), voxels[other as usize]?)));
                Some((vertex, known.min_by(|a, b| a.0.total_cmp(&b.0))?.1))
            };
            let round: Vec<(u32, u32)> = hidden.iter().filter_map(nearest).collect();
            if round.is_empty() {
                break;
            }
            for (vertex, voxel) in round {
                voxels[vertex as usize] = Some(voxel);
            }
            hidden.retain(|&vertex| voxels[vertex as usize].is_none());
        }
    }
    for (voxel, place) in voxels.iter_mut().zip(found) {
        if let (None, Some(Place::Hidden(nearest))) = (*voxel, place) {
            *voxel = Some(nearest);
        }
    }
    voxels
}

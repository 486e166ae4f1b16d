//! Changes of topology: parts glued together, and tunnels through the solid.

use std::collections::BTreeMap;

use mser3d_shape::TriangleMesh;
use mser3d_shape::vector::{Vec3, add, norm, scale, sub};
use mser3d_voxelize::{Bvh, Hit};

use super::holes::{SurfaceSampler, disc};
use super::noise::vertex_normals;
use super::random::Random;
use super::transformed::Transformed;
use crate::EvaluationError;

/// How far apart parts may be that are glued, in radii of a tube.
const REACH: f64 = 12.0;
/// How far apart along the surface tubes and their ends are, in radii.
const APART: f64 = 4.0;
/// Random vertices tried for each tube.
const TRIES: usize = 400;

/// Tubes between parts that face each other through the air, each in place of two discs of a
/// radius; when none is found, through the solid. Every tube adds a handle and no vertex.
pub(super) fn topology(
    null: &TriangleMesh,
    count: usize,
    radius: f64,
    random: &mut Random,
) -> Result<Transformed, EvaluationError> {
    let normals = vertex_normals(null);
    let graph = null.edge_graph();
    let bvh = Bvh::new(null);
    let places = SurfaceSampler::new(null);
    let mut triangles: Vec<Option<[u32; 3]>> = null.triangles().iter().map(|&t| Some(t)).collect();
    let mut tubes = Vec::new();
    let mut taken = vec![false; null.vertices().len()];
    for _ in 0..count {
        let air = (0..TRIES).map(|n| (n, 1.0)).chain((0..TRIES).map(|n| (n, -1.0)));
        for (_, side) in air {
            let start = places.vertex(random);
            let direction = scale(normals[start as usize], side);
            let Some(end) = facing(null, &bvh, start, direction, side, REACH * radius) else { continue };
            let discs = [start, end].map(|centre| disc(null, &graph, centre, radius));
            let near = |v: &u32| taken[*v as usize];
            if discs.iter().flatten().any(near) || discs[0].iter().any(|v| discs[1].binary_search(v).is_ok())
            {
                continue;
            }
            let [Some(a), Some(b)] = [&discs[0], &discs[1]].map(|d| rim(null, d)) else { continue };
            for (d, centre) in discs.iter().zip([start, end]) {
                for t in triangles.iter_mut().filter(|t| t.is_some_and(|t| inside(&t, d))) {
                    *t = None;
                }
                for v in disc(null, &graph, centre, APART * radius) {
                    taken[v as usize] = true;
                }
            }
            tubes.extend(zip_up(null, &a, &b));
            break;
        }
    }
    Transformed::over_null_vertices(
        null,
        null.vertices(),
        triangles.into_iter().flatten().chain(tubes).collect(),
    )
}

fn inside(triangle: &[u32; 3], disc: &[u32]) -> bool {
    triangle.iter().all(|v| disc.binary_search(v).is_ok())
}

/// The nearest corner of the first triangle that a ray from a vertex meets, if within reach and if
/// the ray meets the side of the surface that it left: 1 for the outside, -1 for the inside.
fn facing(mesh: &TriangleMesh, bvh: &Bvh, start: u32, direction: Vec3, side: f64, reach: f64) -> Option<u32> {
    let hits = bvh.all_hits(mesh.vertices()[start as usize], direction, reach);
    let elsewhere = |hit: &&Hit| !mesh.triangles()[hit.triangle as usize].contains(&start);
    let hit = hits.iter().find(elsewhere).filter(|hit| hit.front == (side > 0.0))?;
    let place = add(mesh.vertices()[start as usize], scale(direction, hit.t));
    let away = |v: u32| norm(sub(mesh.vertices()[v as usize], place));
    mesh.triangles()[hit.triangle as usize].into_iter().min_by(|&a, &b| away(a).total_cmp(&away(b)))
}

/// The border of a disc's triangles as a loop of vertices, in the direction in which the disc's own
/// triangles run; `None` unless it is one simple loop.
fn rim(mesh: &TriangleMesh, disc: &[u32]) -> Option<Vec<u32>> {
    let mut next = BTreeMap::new();
    let sides = || {
        let inner = mesh.triangles().iter().filter(|t| inside(t, disc));
        inner.flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
    };
    let all: std::collections::BTreeSet<_> = sides().collect();
    for (a, b) in sides().filter(|&(a, b)| !all.contains(&(b, a))) {
        if next.insert(a, b).is_some() {
            return None;
        }
    }
    let first = *next.keys().next()?;
    let mut rim = vec![first];
    while let Some(&v) = next.get(rim.last()?)
        && v != first
        && rim.len() <= next.len()
    {
        rim.push(v);
    }
    (rim.len() == next.len() && rim.len() >= 3).then_some(rim)
}

/// Triangles between two rims, one taken backwards, starting where they are close and going around
/// both at the same pace.
fn zip_up(mesh: &TriangleMesh, a: &[u32], b: &[u32]) -> Vec<[u32; 3]> {
    let away = |v: u32, w: u32| norm(sub(mesh.vertices()[v as usize], mesh.vertices()[w as usize]));
    let backwards: Vec<u32> = b.iter().rev().copied().collect();
    let closer = |x: &usize, y: &usize| away(a[0], backwards[*x]).total_cmp(&away(a[0], backwards[*y]));
    let start = (0..b.len()).min_by(closer).unwrap_or(0);
    let on_a = |i: usize| a[i % a.len()];
    let on_b = |j: usize| backwards[(start + j) % b.len()];
    let (mut i, mut j, mut triangles) = (0, 0, Vec::new());
    while i < a.len() || j < b.len() {
        if (i + 1) * b.len() <= (j + 1) * a.len() {
            triangles.push([on_a(i), on_a(i + 1), on_b(j)]);
            i += 1;
        } else {
            triangles.push([on_a(i), on_b(j + 1), on_b(j)]);
            j += 1;
        }
    }
    triangles
}

//! Fewer vertices for the eye: a mesh as fine as a picture can show.

use std::collections::HashMap;

use mser3d_shape::vector::{add, dot, scale, sub};
use mser3d_shape::{DisjointSets, TriangleMesh};

/// A mesh thinned out.
pub(crate) struct Thinned {
    /// Fewer vertices, and triangles between them.
    pub mesh: TriangleMesh,
    /// For each of its vertices, the nearest of those in the whole mesh that it stands for.
    pub kept: Vec<u32>,
}

/// Cells are made larger at most this often.
const ROUNDS: usize = 16;

/// At most about `most` of a mesh's vertices; `None` if it has no more, or nothing would be left of it.
///
/// Clustering on a grid (Rossignac and Borrel 1993), along the surface: vertices of one kind in one cell that edges connect there
/// become one at their mean, so sheets that lie close do not merge. What was closed stays closed: each
/// edge still has as many triangles on one side as on the other. Cost: a few passes over the triangles. The same input gives the
/// same mesh.
pub(crate) fn thin(mesh: &TriangleMesh, kinds: &[u32], most: usize) -> Option<Thinned> {
    let points = mesh.vertices();
    let bounds = mesh.bounding_box().filter(|_| points.len() > most)?;
    let area = mesh.area();
    // A surface meets about 1.5 cells for each square of a cell's size.
    let first = (1.5 * area / most as f64).sqrt().max(bounds.diagonal() / 1e6);
    let (mut size, mut cluster) = (first, Vec::new());
    let (mut loose, mut before) = (false, usize::MAX);
    for _ in 0..ROUNDS {
        let cell: Vec<[i32; 3]> =
            points.iter().map(|p| [0, 1, 2].map(|a| ((p[a] - bounds.min[a]) / size) as i32)).collect();
        cluster = clusters(mesh, kinds, &cell, loose);
        let count = 1 + cluster.iter().filter(|&&c| c != u32::MAX).max().copied().unwrap_or(0) as usize;
        if count <= most {
            break;
        }
        if !loose && count as f64 > 0.9 * before as f64 {
            // A heap of loose triangles has little that is connected to merge.
            (loose, size) = (true, first);
        } else {
            size *= (count as f64 / most as f64).sqrt().max(1.05);
        }
        before = count;
    }
    merged(mesh, &cluster)
}

/// The cluster of each vertex, numbered in the order of their first vertices; `u32::MAX` for those without a triangle.
fn clusters(mesh: &TriangleMesh, kinds: &[u32], cell: &[[i32; 3]], loose: bool) -> Vec<u32> {
    let n = mesh.vertices().len();
    let mut sets = DisjointSets::new(n);
    let mut used = vec![false; n];
    for &[a, b, c] in mesh.triangles() {
        for (u, v) in [(a, b), (b, c), (c, a)] {
            used[u as usize] = true;
            let alike = |i: u32| (cell[i as usize], kinds[i as usize]);
            if alike(u) == alike(v) {
                sets.union(u, v);
            }
        }
    }
    if loose {
        let mut first = HashMap::new();
        for v in (0..n as u32).filter(|&v| used[v as usize]) {
            sets.union(*first.entry((cell[v as usize], kinds[v as usize])).or_insert(v), v);
        }
    }
    let mut number = vec![u32::MAX; n];
    let mut next = 0;
    let mut cluster = |v: u32| {
        let root = sets.find(v) as usize;
        if number[root] == u32::MAX {
            number[root] = next;
            next += 1;
        }
        number[root]
    };
    (0..n as u32).map(|v| if used[v as usize] { cluster(v) } else { u32::MAX }).collect()
}

/// Each cluster as a vertex at the mean of its vertices; `None` if no triangle is left.
fn merged(mesh: &TriangleMesh, cluster: &[u32]) -> Option<Thinned> {
    let points = mesh.vertices();
    let members = || (0u32..).zip(cluster).filter(|(_, c)| **c != u32::MAX).map(|(v, &c)| (v, c as usize));
    let count = members().map(|(_, c)| c + 1).max().unwrap_or(0);
    let mut sum = vec![([0.0; 3], 0.0); count];
    for (v, c) in members() {
        sum[c] = (add(sum[c].0, points[v as usize]), sum[c].1 + 1.0);
    }
    let mut nearest = vec![(f64::INFINITY, 0u32); count];
    for (v, c) in members() {
        let gap = sub(points[v as usize], scale(sum[c].0, 1.0 / sum[c].1));
        if dot(gap, gap) < nearest[c].0 {
            nearest[c] = (dot(gap, gap), v);
        }
    }
    let kept: Vec<u32> = nearest.iter().map(|n| n.1).collect();
    let triangles = mesh.triangles().iter().map(|t| t.map(|v| cluster[v as usize]));
    let triangles = triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    // At the means fewer triangles fold over than at vertices.
    let vertices = sum.iter().map(|&(sum, count)| scale(sum, 1.0 / count)).collect();
    // Its vertices are finite, and its triangles' numbers are theirs.
    let mesh = TriangleMesh::new(vertices, triangles).ok()?;
    (!mesh.triangles().is_empty()).then_some(Thinned { mesh, kept })
}

#[cfg(test)]
mod tests {
    use mser3d_shape::vector::cross;

    use super::*;
    use crate::section::is_closed;
    use crate::test_shapes;

    #[test]
    fn a_sphere_stays_a_closed_sphere() {
        let sphere = test_shapes::sphere(100, 200);
        let kinds = vec![0; sphere.vertices().len()];
        let thinned = thin(&sphere, &kinds, 2000).unwrap();
        let count = thinned.mesh.vertices().len();
        assert!((1000..=2000).contains(&count), "{count}");
        assert!(is_closed(thinned.mesh.triangles()));
        let volume = thinned.mesh.signed_volume() / sphere.signed_volume();
        assert!((0.97..1.0).contains(&volume), "{volume}");
        for (&p, &v) in thinned.mesh.vertices().iter().zip(&thinned.kept) {
            let gap = sub(p, sphere.vertices()[v as usize]);
            assert!(dot(gap, gap).sqrt() < 0.05, "{gap:?}");
        }
        // The sphere is about the origin: nearly all triangles still face outwards.
        let mesh = &thinned.mesh;
        let outwards = |t: &usize| {
            let [a, b, c] = mesh.corners(*t);
            dot(cross(sub(b, a), sub(c, a)), a) > 0.0
        };
        let all = mesh.triangles().len();
        assert!((0..all).filter(outwards).count() as f64 > 0.98 * all as f64);
        assert!(thin(&sphere, &kinds, kinds.len()).is_none());
    }

    #[test]
    fn borders_of_kinds_stay_and_close_sheets_stay_apart() {
        // Two spheres, one just inside the other, each in two halves.
        let sphere = test_shapes::sphere(60, 120);
        let n = sphere.vertices().len() as u32;
        let inner = sphere.vertices().iter().map(|&p| scale(p, 0.999));
        let vertices: Vec<[f64; 3]> = sphere.vertices().iter().copied().chain(inner).collect();
        let more = sphere.triangles().iter().map(|t| t.map(|v| v + n));
        let mesh =
            TriangleMesh::new(vertices, sphere.triangles().iter().copied().chain(more).collect()).unwrap();
        let kinds: Vec<u32> = mesh.vertices().iter().map(|p| u32::from(p[0] > 0.1)).collect();
        let thinned = thin(&mesh, &kinds, 1500).unwrap();
        let outside = |v: u32| v < n;
        for t in thinned.mesh.triangles() {
            let [a, b, c] = t.map(|v| outside(thinned.kept[v as usize]));
            assert!(a == b && b == c);
        }
        // Both halves of both spheres are there to the border.
        for (kind, sheet) in [(0, true), (1, true), (0, false), (1, false)] {
            let near = |&&v: &&u32| {
                let x = mesh.vertices()[v as usize][0];
                kinds[v as usize] == kind && outside(v) == sheet && (x - 0.1).abs() < 0.12
            };
            assert!(thinned.kept.iter().filter(near).count() > 10, "{kind} {sheet}");
        }
    }

    #[test]
    fn loose_triangles_and_points_are_thinned_too() {
        let corner = [[0.0, 0.0], [0.9, 0.0], [0.0, 0.9]];
        let at = |i: u32| {
            let [x, y] = corner[i as usize % 3];
            [f64::from(i / 3 % 40) + x, f64::from(i / 120) + y, 0.0]
        };
        let vertices: Vec<[f64; 3]> = (0..6000).map(at).collect();
        let triangles = (0..1500).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let mesh = TriangleMesh::new(vertices, triangles).unwrap();
        let thinned = thin(&mesh, &vec![0; 6000], 500).unwrap();
        assert!(
            thinned.kept.len() <= 500 && thinned.kept.iter().all(|&v| v < 4500),
            "{}",
            thinned.kept.len()
        );
    }
}

//! From the triangles of a file to an oriented surface: what is wrong with a mesh, and which reading
//! of it makes most sense. Nothing here moves a vertex.

use crate::mesh_edges::{
    EdgeCounts, Edges, Side, consistent_orientation, duplicates, manifold_components, weld,
};
use crate::triangle_geometry::area_vector;
use mser3d_shape::vector::{Vec3, cross, dot, norm, scale, sub};
use mser3d_shape::{DisjointSets, TriangleMesh};
use std::borrow::Cow;

/// A mesh read as a surface: vertices merged by position where that closes it, repeated triangles
/// counted once where that makes it simpler, neighbours oriented alike.
pub(crate) struct MeshAnalysis<'m> {
    /// The edges of the file's own triangles.
    pub file: EdgeCounts,
    /// The edges of `triangles`.
    pub counts: EdgeCounts,
    /// Whether vertices were merged by position.
    pub welded: bool,
    /// Triangles that repeat another one's vertices.
    pub duplicates: Vec<usize>,
    /// Whether the repetitions are left out.
    pub dropped_duplicates: bool,
    /// Triangles turned over to agree with their neighbours.
    pub turned: usize,
    /// Components that cannot be oriented.
    pub one_sided: usize,
    /// The triangles read in this way, in the file's order.
    pub triangles: Cow<'m, [[u32; 3]]>,
    pub edges: Edges,
    /// Vertices of the file.
    vertices: usize,
}

impl<'m> MeshAnalysis<'m> {
    pub fn new(mesh: &'m TriangleMesh) -> Self {
        let vertices = mesh.vertices().len();
        let mut triangles = Cow::Borrowed(mesh.triangles());
        let mut edges = Edges::new(vertices, &triangles, |_| true);
        let file = EdgeCounts::of(&edges);
        let mut counts = file.clone();
        let mut welded = false;
        if counts.boundary > 0
            && let Some(first) = weld(mesh.vertices())
        {
            let merged: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|v| first[v as usize])).collect();
            let merged_edges = Edges::new(vertices, &merged, |_| true);
            let merged_counts = EdgeCounts::of(&merged_edges);
            if merged_counts.boundary < counts.boundary {
                (triangles, edges, counts, welded) = (Cow::Owned(merged), merged_edges, merged_counts, true);
            }
        }
        let repeated = duplicates(&triangles, &edges);
        let mut dropped_duplicates = false;
        if !repeated.is_empty() {
            let once = Edges::new(vertices, &triangles, |t| repeated.binary_search(&t).is_err());
            let once_counts = EdgeCounts::of(&once);
            let all_twice = 2 * repeated.len() >= triangles.len();
            // Not where boxes share a wall: without its second face their edges would be odd.
            let simpler = once_counts.non_manifold < counts.non_manifold
                && once_counts.odd <= counts.odd
                && once_counts.boundary <= counts.boundary;
            if once_counts.odd < counts.odd || all_twice || simpler {
                let mut kept = triangles.into_owned();
                let mut t = 0;
                kept.retain(|_| {
                    t += 1;
                    repeated.binary_search(&(t - 1)).is_err()
                });
                triangles = Cow::Owned(kept);
                edges = Edges::new(vertices, &triangles, |_| true);
                (counts, dropped_duplicates) = (once_counts, true);
            }
        }
        let (mut turned, mut one_sided) = (0, 0);
        if counts.inconsistent > 0 {
            let positions = mesh.vertices();
            let area = |t: usize| norm(area_vector(&triangles[t].map(|v| positions[v as usize])));
            let (flip, unorientable) = consistent_orientation(triangles.len(), &edges, area);
            one_sided = unorientable;
            turned = flip.iter().filter(|f| **f).count();
            if turned > 0 {
                for (triangle, _) in triangles.to_mut().iter_mut().zip(&flip).filter(|(_, flip)| **flip) {
                    triangle.swap(1, 2);
                }
                edges = Edges::new(vertices, &triangles, |_| true);
                counts = EdgeCounts::of(&edges);
            }
        }
        Self {
            file,
            counts,
            welded,
            duplicates: repeated,
            dropped_duplicates,
            turned,
            one_sided,
            triangles,
            edges,
            vertices,
        }
    }

    /// A mesh taken as it is, without a look at its edges.
    pub fn unexamined(mesh: &'m TriangleMesh) -> Self {
        Self {
            file: EdgeCounts::default(),
            counts: EdgeCounts::default(),
            welded: false,
            duplicates: Vec::new(),
            dropped_duplicates: false,
            turned: 0,
            one_sided: 0,
            triangles: Cow::Borrowed(mesh.triangles()),
            edges: Edges::new(0, &[], |_| true),
            vertices: mesh.vertices().len(),
        }
    }

    /// V - E + F of a closed manifold surface.
    pub fn euler_characteristic(&self) -> Option<i64> {
        let counts = &self.counts;
        if counts.total == 0 || counts.boundary > 0 || counts.non_manifold > 0 {
            return None;
        }
        let mut used = vec![false; self.vertices];
        self.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
        let vertices = used.iter().filter(|u| **u).count();
        let triangles = self.triangles.iter().filter(|[a, b, c]| a != b && b != c && c != a).count();
        Some(vertices as i64 - counts.total as i64 + triangles as i64)
    }

    /// Which triangles form a shell: those joined across edges with two sides. Where more than two sides
    /// meet, components that are not balanced at the edge without each other join in pairs that have the
    /// inside between them; all of them where there are no such pairs.
    pub fn shells(&self, positions: &[Vec3]) -> DisjointSets {
        let mut sets = manifold_components(self.triangles.len(), &self.edges);
        if self.counts.non_manifold == 0 {
            return sets;
        }
        let mut joined = sets.clone();
        self.edges.for_each(|low, high, sides| {
            if sides.len() > 2 {
                let mut parts: Vec<(u32, i32)> = Vec::new();
                for (_, side) in sides {
                    let part = sets.find(side.triangle() as u32);
                    match parts.iter_mut().find(|p| p.0 == part) {
                        Some(p) => p.1 += side.direction(),
                        None => parts.push((part, side.direction())),
                    }
                }
                parts.retain(|p| p.1 != 0);
                let mut part_of = |side: &Side| sets.find(side.triangle() as u32);
                let open: Vec<(u32, Side)> = sides
                    .iter()
                    .map(|(_, side)| (part_of(side), *side))
                    .filter(|(part, _)| parts.iter().any(|p| p.0 == *part))
                    .collect();
                match self.wedges([low, high], &open, positions) {
                    Some(pairs) => pairs.into_iter().for_each(|[a, b]| {
                        joined.union(a, b);
                    }),
                    None => parts.windows(2).for_each(|pair| {
                        joined.union(pair[0].0, pair[1].0);
                    }),
                }
            }
        });
        joined
    }

    /// The sides around an edge in pairs with the inside between them, as components; `None` if they do not
    /// alternate so.
    fn wedges(
        &self,
        [low, high]: [u32; 2],
        sides: &[(u32, Side)],
        positions: &[Vec3],
    ) -> Option<Vec<[u32; 2]>> {
        let start = positions[low as usize];
        let axis = sub(positions[high as usize], start);
        let across = |side: &Side| {
            let apex = self.triangles[side.triangle()].into_iter().find(|v| ![low, high].contains(v));
            let arm = sub(positions[apex.unwrap_or(low) as usize], start);
            sub(arm, scale(axis, dot(arm, axis) / dot(axis, axis)))
        };
        let first = across(&sides.first()?.1);
        let third = cross(axis, first);
        let turn = |side: &Side| {
            let arm = across(side);
            // Of one length, as `third` is longer than `first` by that of the axis.
            let angle = dot(arm, third).atan2(dot(arm, first) * norm(axis));
            // Faces in contact lie at one angle, up to rounding.
            ((angle / 1e-9).round() as i64).rem_euclid((std::f64::consts::TAU / 1e-9) as i64)
        };
        // Turning about the edge, a triangle that runs along it ends an inside, the others begin one.
        let mut around: Vec<(i64, bool, u32)> =
            sides.iter().map(|(part, side)| (turn(side), side.direction() < 0, *part)).collect();
        around.sort_unstable();
        let (mut begun, mut pairs) = (Vec::new(), Vec::new());
        let mut done = vec![false; around.len()];
        for i in (0..around.len()).chain(0..around.len()) {
            let (_, begins, part) = around[i];
            if begins && !done[i] && !begun.contains(&i) {
                begun.push(i);
            } else if !begins
                && !done[i]
                && let Some(other) = begun.pop()
            {
                (done[i], done[other]) = (true, true);
                pairs.push([part, around[other].2]);
            }
        }
        done.iter().all(|d| *d).then_some(pairs)
    }
}

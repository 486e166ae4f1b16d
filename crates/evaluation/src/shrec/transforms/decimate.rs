//! Coarser samplings of the same surface.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use mser3d_shape::TriangleMesh;
use mser3d_shape::vector::{Vec3, cross, dot, norm, sub, unit};

use super::transformed::Transformed;
use crate::EvaluationError;
use crate::surface_point::normal;

/// Decimates to a share of the vertices by half-edge collapses in the order of their quadric error
/// (Garland and Heckbert 1997). Vertices are only removed, never moved, so that each one left *is*
/// a vertex of the null shape. Stops early where no collapse keeps the surface a manifold with its
/// faces up.
pub(super) fn sampling(null: &TriangleMesh, share: f64) -> Result<Transformed, EvaluationError> {
    let mut mesh = Collapsing::new(null);
    let target = (share * null.vertices().len() as f64).round() as usize;
    let mut left = null.vertices().len();
    let mut queue = BinaryHeap::new();
    for v in 0..null.vertices().len() as u32 {
        mesh.enqueue(v, &mut queue);
    }
    while left > target
        && let Some(Reverse((_, from, to, stamp))) = queue.pop()
    {
        if stamp != mesh.stamp(from, to) || !mesh.can_collapse(from, to) {
            continue;
        }
        mesh.collapse(from, to, &mut queue);
        left -= 1;
    }
    let triangles = mesh.triangles.iter().flatten().copied().collect();
    Transformed::over_null_vertices(null, null.vertices(), triangles)
}

/// Cost (the bits of a number that is not negative), the vertex to remove, the one it goes to, and
/// how often both had changed when the cost was computed.
type Queue = BinaryHeap<Reverse<(u64, u32, u32, u64)>>;

struct Collapsing<'m> {
    places: &'m [Vec3],
    triangles: Vec<Option<[u32; 3]>>,
    around: Vec<Vec<u32>>,
    quadrics: Vec<Quadric>,
    boundary: Vec<bool>,
    changes: Vec<u64>,
}

impl<'m> Collapsing<'m> {
    fn new(mesh: &'m TriangleMesh) -> Self {
        let n = mesh.vertices().len();
        let (mut around, mut quadrics) = (vec![Vec::new(); n], vec![Quadric::default(); n]);
        for (t, triangle) in mesh.triangles().iter().enumerate() {
            let plane = Quadric::of_plane(mesh.corners(t));
            for &v in triangle {
                around[v as usize].push(t as u32);
                quadrics[v as usize].add(&plane);
            }
        }
        let triangles = mesh.triangles().iter().map(|&t| Some(t)).collect();
        let mut this = Self {
            places: mesh.vertices(),
            triangles,
            around,
            quadrics,
            boundary: vec![false; n],
            changes: vec![0; n],
        };
        for v in 0..n as u32 {
            // A vertex whose triangles do not close a fan stays: borders and non-manifold places.
            this.boundary[v as usize] = this.neighbours(v).len() != this.around[v as usize].len();
        }
        this
    }

    fn live(&self, v: u32) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.around[v as usize].iter().filter_map(|&t| self.triangles[t as usize])
    }

    fn neighbours(&self, v: u32) -> BTreeSet<u32> {
        self.live(v).flatten().filter(|&w| w != v).collect()
    }

    fn stamp(&self, from: u32, to: u32) -> u64 {
        self.changes[from as usize] + self.changes[to as usize]
    }

    fn enqueue(&self, v: u32, queue: &mut Queue) {
        for w in self.neighbours(v) {
            for (from, to) in [(v, w), (w, v)] {
                if !self.boundary[from as usize] {
                    let cost = self.cost(from, to);
                    queue.push(Reverse((cost.to_bits(), from, to, self.stamp(from, to))));
                }
            }
        }
    }

    /// The quadric error, and a little of the edge's length to the fourth, so that flat places are
    /// thinned evenly.
    fn cost(&self, from: u32, to: u32) -> f64 {
        let (p, q) = (self.places[from as usize], self.places[to as usize]);
        let mut quadric = self.quadrics[from as usize].clone();
        quadric.add(&self.quadrics[to as usize]);
        let edge = sub(p, q);
        quadric.error(q).max(0.0) + 1e-3 * dot(edge, edge) * dot(edge, edge)
    }

    /// The link condition (the ends share exactly two neighbours), and no face turns by more than
    /// about 75 degrees or loses its area.
    fn can_collapse(&self, from: u32, to: u32) -> bool {
        let (a, b) = (self.neighbours(from), self.neighbours(to));
        if !a.contains(&to) || a.intersection(&b).count() != 2 || a.len() + b.len() < 8 {
            return false;
        }
        self.live(from).filter(|t| !t.contains(&to)).all(|t| {
            let corners = t.map(|v| self.places[v as usize]);
            let moved = t.map(|v| self.places[if v == from { to } else { v } as usize]);
            let (before, after) = (normal(corners), normal(moved));
            let longest = (0..3).map(|i| norm(sub(moved[i], moved[(i + 1) % 3]))).fold(0.0, f64::max);
            norm(after) > 0.05 * longest * longest && dot(unit(before), unit(after)) > 0.25
        })
    }

    fn collapse(&mut self, from: u32, to: u32, queue: &mut Queue) {
        for t in std::mem::take(&mut self.around[from as usize]) {
            let Some(mut triangle) = self.triangles[t as usize] else { continue };
            if triangle.contains(&to) {
                self.triangles[t as usize] = None;
                continue;
            }
            triangle.iter_mut().filter(|v| **v == from).for_each(|v| *v = to);
            self.triangles[t as usize] = Some(triangle);
            self.around[to as usize].push(t);
        }
        let triangles = &self.triangles;
        self.around[to as usize].retain(|&t| triangles[t as usize].is_some());
        let gone = self.quadrics[from as usize].clone();
        self.quadrics[to as usize].add(&gone);
        self.changes[from as usize] += 1;
        self.changes[to as usize] += 1;
        self.enqueue(to, queue);
        // Faces of the neighbours changed: what was refused there may now be allowed.
        for v in self.neighbours(to) {
            self.changes[v as usize] += 1;
        }
        for v in self.neighbours(to) {
            self.enqueue(v, queue);
        }
    }
}

/// The sum of squared distances from planes, weighted by area, as the upper triangle of a symmetric
/// 4 x 4 matrix.
#[derive(Clone, Default)]
struct Quadric([f64; 10]);

impl Quadric {
    fn of_plane(corners: [Vec3; 3]) -> Self {
        let n = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
        let (weight, n) = (norm(n) / 2.0, unit(n));
        let p = [n[0], n[1], n[2], -dot(n, corners[0])];
        let mut q = [0.0; 10];
        let mut slot = 0;
        for i in 0..4 {
            for j in i..4 {
                q[slot] = weight * p[i] * p[j];
                slot += 1;
            }
        }
        Self(q)
    }

    fn add(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(a, b)| *a += b);
    }

    fn error(&self, p: Vec3) -> f64 {
        let p = [p[0], p[1], p[2], 1.0];
        let mut slot = 0;
        let mut sum = 0.0;
        for i in 0..4 {
            for j in i..4 {
                sum += if i == j { 1.0 } else { 2.0 } * self.0[slot] * p[i] * p[j];
                slot += 1;
            }
        }
        sum
    }
}

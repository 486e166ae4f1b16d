//! The surface that is swept: oriented bodies, their holes coned off, coordinates in a safe range.

use crate::analysis::Analysis;
use crate::vector::{Vec3, add, area_vector, cross, dot, norm, scaled, solid_angle, sub};
use mser3d_shape::{BoundingBox, DisjointSets, TriangleMesh};
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::HashMap;

/// Triangles that belong together.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    /// Volume enclosed by the body and its caps, in scaled units; negative for a cavity.
    pub volume: f64,
    /// Area of the body and its caps, in scaled units.
    pub area: f64,
    /// Whether each edge runs as often one way as the other: winding numbers are integers.
    pub closed: bool,
    /// So much of it is boundary that caps would outnumber the triangles: its winding number is
    /// summed over the triangles themselves.
    pub scattered: bool,
}

/// Bodies and caps. With its caps each body that is not scattered is a closed chain, so its winding
/// number is an integer, found by counting crossings; less the caps' own winding number, it is that of the mesh.
pub(crate) struct Surface<'m> {
    pub vertices: Cow<'m, [Vec3]>,
    /// The triangles of the mesh, oriented, then the caps.
    pub triangles: Cow<'m, [[u32; 3]]>,
    /// Triangles before the caps.
    pub caps: usize,
    /// Triangles before the caps of larger holes. Small holes are patched: their caps part neighbours
    /// like the surface that is missing there.
    pub patched: usize,
    pub bodies: Vec<Body>,
    /// The body of each triangle and cap; empty with a single body.
    pub body_of: Vec<u32>,
    /// Power of two that coordinates were multiplied with.
    pub scale: f64,
    /// The box around the mesh, in its own units.
    pub bounds: BoundingBox,
    /// Largest absolute value of a scaled coordinate.
    pub reach: f64,
    /// Bodies turned inside out to face outwards.
    pub inverted: usize,
}

/// Bodies with holes that are looked at on their own; all others count as one.
const MAX_OPEN_BODIES: usize = 16;
/// A body is nearly closed when the vectors of its triangles' areas add up to less than this part of its area.
const NEARLY_CLOSED: f64 = 0.1;

/// A hole with at most so many edges is small.
const SMALL_HOLE: f64 = 16.0;

/// A closed body whose volume is less than this part of its area to the power of 3/2 is flat.
const FLAT: f64 = 1e-9;

impl Body {
    /// Whether it is closed and encloses nothing, like a sheet of two faces back to back.
    pub fn is_flat(&self) -> bool {
        self.closed && self.volume.abs() <= FLAT * self.area.powf(1.5)
    }
}

impl<'m> Surface<'m> {
    /// Oriented bodies with caps.
    pub fn oriented(mesh: &'m TriangleMesh, analysis: &Analysis<'m>) -> Self {
        let mut surface = Self::new(mesh, analysis.triangles.clone());
        surface.find_bodies(analysis);
        surface.face_outwards();
        surface
    }

    /// The triangles alone, as one body: for counting crossings without regard to orientation.
    pub fn plain(mesh: &'m TriangleMesh, triangles: Cow<'m, [[u32; 3]]>) -> Self {
        let mut surface = Self::new(mesh, triangles);
        surface.bodies = vec![Body { volume: 0.0, area: 0.0, closed: true, scattered: false }];
        surface
    }

    fn new(mesh: &'m TriangleMesh, triangles: Cow<'m, [[u32; 3]]>) -> Self {
        let bounds = bounds(mesh);
        let reach = bounds.min.iter().chain(&bounds.max).fold(0.0f64, |m, x| m.max(x.abs()));
        // Products of five coordinates must neither overflow nor vanish.
        let exponent = if reach > 0.0 { reach.log2().floor() } else { 0.0 };
        let scale = if exponent.abs() > 100.0 { (-exponent).clamp(-1000.0, 1000.0).exp2() } else { 1.0 };
        let vertices = if scale == 1.0 {
            Cow::Borrowed(mesh.vertices())
        } else {
            Cow::Owned(mesh.vertices().iter().map(|p| p.map(|x| x * scale)).collect())
        };
        let caps = triangles.len();
        Self {
            vertices,
            triangles,
            caps,
            patched: caps,
            bodies: Vec::new(),
            body_of: Vec::new(),
            scale,
            bounds,
            reach: reach * scale,
            inverted: 0,
        }
    }

    #[inline]
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|v| self.vertices[v as usize])
    }

    #[inline]
    pub fn body_of(&self, triangle: usize) -> usize {
        if self.body_of.is_empty() { 0 } else { self.body_of[triangle] as usize }
    }

    /// Whether each body is a closed chain without caps.
    pub fn closed(&self) -> bool {
        self.bodies.iter().all(|b| b.closed)
    }

    /// Whether the winding number of some body is summed over its triangles.
    pub fn scattered(&self) -> bool {
        self.bodies.iter().any(|b| b.scattered)
    }

    /// Volume enclosed by all bodies and caps, in scaled units.
    pub fn volume(&self) -> f64 {
        self.bodies.iter().map(|b| b.volume).sum()
    }

    fn find_bodies(&mut self, analysis: &Analysis) {
        let mut sets = analysis.bodies();
        let mut number = vec![u32::MAX; self.triangles.len()];
        let mut of: Vec<u32> = Vec::with_capacity(self.triangles.len());
        let mut found = 0;
        for t in 0..self.triangles.len() as u32 {
            let root = sets.find(t) as usize;
            if number[root] == u32::MAX {
                number[root] = found;
                found += 1;
            }
            of.push(number[root]);
        }
        drop(number);
        let mut boundary = boundary_sides(analysis, &of);
        if !boundary.is_empty() {
            let merged = self.merge_fragments(found as usize, &of, &boundary);
            of.iter_mut().for_each(|b| *b = merged[*b as usize]);
            found = merged.iter().max().map_or(0, |m| m + 1);
            boundary = boundary_sides(analysis, &of);
        }
        self.bodies = vec![Body { volume: 0.0, area: 0.0, closed: true, scattered: false }; found as usize];
        self.body_of = of;
        self.cap(boundary);
        let origin = self.vertices.first().copied().unwrap_or_default();
        for t in 0..self.triangles.len() {
            let corners = self.corners(t);
            let body = &mut self.bodies[self.body_of[t] as usize];
            let [a, b, c] = corners.map(|p| sub(p, origin));
            body.volume += dot(a, cross(b, c)) / 6.0;
            body.area += norm(area_vector(&[a, b, c]));
        }
        if self.bodies.len() == 1 {
            self.body_of = Vec::new();
        }
    }

    /// New numbers of the bodies: patches and fragments, whose winding number means little alone,
    /// become one body.
    fn merge_fragments(&self, found: usize, of: &[u32], boundary: &[BoundarySide]) -> Vec<u32> {
        let mut open = vec![false; found];
        boundary.iter().for_each(|side| open[side.body as usize] = true);
        let mut sums = vec![([0.0; 3], 0.0); found];
        for (t, &body) in of.iter().enumerate() {
            let area = area_vector(&self.corners(t));
            let sum = &mut sums[body as usize];
            *sum = (add(sum.0, area), sum.1 + norm(area));
        }
        let nearly_closed = |b: &usize| open[*b] && norm(sums[*b].0) < NEARLY_CLOSED * sums[*b].1;
        let mut own: Vec<usize> = (0..found).filter(nearly_closed).collect();
        own.sort_by(|&a, &b| sums[b].1.total_cmp(&sums[a].1).then(a.cmp(&b)));
        own.truncate(MAX_OPEN_BODIES);
        let (mut next, mut rest) = (0, None);
        (0..found)
            .map(|b| {
                let mut fresh = || {
                    next += 1;
                    next - 1
                };
                if !open[b] || own.contains(&b) { fresh() } else { *rest.get_or_insert_with(fresh) }
            })
            .collect()
    }

    /// Closes each body's boundary by cones over its loops, apex in the middle of the loop.
    fn cap(&mut self, boundary: Vec<BoundarySide>) {
        if boundary.is_empty() {
            return;
        }
        let mut sides = vec![0usize; self.bodies.len()];
        for side in &boundary {
            sides[side.body as usize] += 1;
            self.bodies[side.body as usize].closed = false;
        }
        let mut triangles = vec![0usize; self.bodies.len()];
        self.body_of.iter().for_each(|&b| triangles[b as usize] += 1);
        for (b, body) in self.bodies.iter_mut().enumerate() {
            body.scattered = sides[b] >= triangles[b];
        }
        let mut loops = DisjointSets::new(self.vertices.len());
        for side in &boundary {
            loops.union(side.from, side.to);
        }
        let mut sums: HashMap<(u32, u32), (Vec3, f64, u32)> = HashMap::new();
        let mut apexes = Vec::new();
        for side in &boundary {
            let key = (side.body, loops.find(side.from));
            let entry = sums.entry(key).or_insert_with(|| {
                apexes.push(key);
                ([0.0; 3], 0.0, (apexes.len() - 1) as u32)
            });
            entry.0 = add(entry.0, self.vertices[side.from as usize]);
            entry.1 += 1.0;
        }
        let first = self.vertices.len() as u32;
        self.vertices.to_mut().extend(apexes.iter().map(|key| scaled(sums[key].0, 1.0 / sums[key].1)));
        for small in [true, false] {
            for side in &boundary {
                let (_, sides, apex) = sums[&(side.body, loops.find(side.from))];
                if !self.bodies[side.body as usize].scattered && small == (sides <= SMALL_HOLE) {
                    self.triangles.to_mut().push([side.to, side.from, first + apex]);
                    self.body_of.push(side.body);
                }
            }
            if small {
                self.patched = self.triangles.len();
            }
        }
    }

    /// Turns bodies of negative volume over, unless another body surrounds them: those are cavities.
    fn face_outwards(&mut self) {
        let everything = self.volume() < 0.0;
        let mut turn = vec![everything; self.bodies.len()];
        let sign = |turn: bool| if turn { -1.0 } else { 1.0 };
        let negative: Vec<usize> = (0..self.bodies.len())
            .filter(|&b| !self.bodies[b].scattered && self.bodies[b].volume * sign(everything) < 0.0)
            .collect();
        if self.bodies.len() > 1 {
            for &b in negative.iter().take(MAX_CONTAINMENT_TESTS) {
                let Some(t) = self.body_of.iter().position(|&of| of as usize == b) else { continue };
                let point = self.corners(t)[0];
                let winding: f64 = (0..self.triangles.len())
                    .filter(|&t| self.body_of(t) != b)
                    .map(|t| solid_angle(&self.corners(t), point))
                    .sum();
                if winding * sign(everything) < 0.5 {
                    turn[b] = !turn[b];
                }
            }
        }
        self.inverted = turn.iter().filter(|t| **t).count();
        if self.inverted == 0 {
            return;
        }
        for t in 0..self.triangles.len() {
            if turn[self.body_of(t)] {
                self.triangles.to_mut()[t].swap(1, 2);
            }
        }
        for (body, turn) in self.bodies.iter_mut().zip(&turn) {
            body.volume *= sign(*turn);
        }
    }
}

/// The box around all triangles; without triangles a box turned inside out.
fn bounds(mesh: &TriangleMesh) -> BoundingBox {
    let nothing = || ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let least = |a: Vec3, b: Vec3| std::array::from_fn(|i| if b[i] < a[i] { b[i] } else { a[i] });
    let most = |a: Vec3, b: Vec3| std::array::from_fn(|i| if b[i] > a[i] { b[i] } else { a[i] });
    let (min, max) = mesh
        .triangles()
        .par_chunks(1 << 14)
        .map(|chunk| {
            chunk.iter().flatten().fold(nothing(), |(low, high), &v| {
                let p = mesh.vertices()[v as usize];
                (least(low, p), most(high, p))
            })
        })
        .reduce(nothing, |a, b| (least(a.0, b.0), most(a.1, b.1)));
    BoundingBox { min, max }
}

/// Bodies of negative volume that are tested for being cavities; further ones are taken for cavities.
const MAX_CONTAINMENT_TESTS: usize = 64;

/// A side of a triangle that no other side of its body runs against.
struct BoundarySide {
    from: u32,
    to: u32,
    body: u32,
}

fn boundary_sides(analysis: &Analysis, body_of: &[u32]) -> Vec<BoundarySide> {
    let mut boundary = Vec::new();
    if analysis.counts.unbalanced == 0 && analysis.counts.non_manifold == 0 {
        return boundary;
    }
    let mut net: Vec<(u32, i32)> = Vec::new();
    analysis.edges.for_each(|low, high, sides| {
        net.clear();
        for (_, side) in sides {
            let body = body_of[side.triangle()];
            match net.iter_mut().find(|n| n.0 == body) {
                Some(n) => n.1 += side.direction(),
                None => net.push((body, side.direction())),
            }
        }
        for &(body, count) in &net {
            let (from, to) = if count > 0 { (low, high) } else { (high, low) };
            boundary.extend((0..count.abs()).map(|_| BoundarySide { from, to, body }));
        }
    });
    boundary
}

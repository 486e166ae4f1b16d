//! From oriented triangles to shells: which belong together, how their holes are closed, which way they face.

use crate::boundary_loops::{BoundarySide, loops};
use crate::mesh_analysis::MeshAnalysis;
use crate::surface::{Shell, Surface};
use crate::triangle_geometry::{area_vector, solid_angle};
use mser3d_shape::TriangleMesh;
use mser3d_shape::vector::{Vec3, add, cross, dot, norm, scale, sub};

/// The most shells with holes that are treated one by one; all further ones count as a single shell.
const MAX_OPEN_SHELLS: usize = 16;
/// A shell is nearly closed when the vectors of its triangles' areas add up to less than this part of its
/// area.
const NEARLY_CLOSED: f64 = 0.1;

/// A hole with at most so many edges is small.
const SMALL_HOLE: f64 = 16.0;

/// Shells of negative volume that are tested for being cavities; further ones are taken for cavities.
const MAX_CONTAINMENT_TESTS: usize = 64;

impl<'m> Surface<'m> {
    /// Oriented shells with caps.
    pub fn oriented(mesh: &'m TriangleMesh, analysis: &MeshAnalysis<'m>) -> Self {
        let mut surface = Self::new(mesh, analysis.triangles.clone());
        surface.find_shells(analysis);
        surface.face_outwards();
        surface
    }

    /// Finds the shells of the oriented triangles, and closes their holes.
    fn find_shells(&mut self, analysis: &MeshAnalysis) {
        let mut sets = analysis.shells(&self.vertices);
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
        self.shells = vec![Shell { volume: 0.0, area: 0.0, closed: true, scattered: false }; found as usize];
        self.shell_of = of;
        self.cap(boundary);
        let origin = self.vertices.first().copied().unwrap_or_default();
        for t in 0..self.triangles.len() {
            let corners = self.corners(t);
            let shell = &mut self.shells[self.shell_of[t] as usize];
            let [a, b, c] = corners.map(|p| sub(p, origin));
            shell.volume += dot(a, cross(b, c)) / 6.0;
            shell.area += norm(area_vector(&[a, b, c]));
        }
        if self.shells.len() == 1 {
            self.shell_of = Vec::new();
        }
    }

    /// New numbers of the shells. Patches and fragments, whose own winding number means little, become
    /// one shell.
    fn merge_fragments(&self, found: usize, of: &[u32], boundary: &[BoundarySide]) -> Vec<u32> {
        let mut open = vec![false; found];
        boundary.iter().for_each(|side| open[side.shell as usize] = true);
        let mut sums = vec![([0.0; 3], 0.0); found];
        for (t, &shell) in of.iter().enumerate() {
            let area = area_vector(&self.corners(t));
            let sum = &mut sums[shell as usize];
            *sum = (add(sum.0, area), sum.1 + norm(area));
        }
        let nearly_closed = |b: &usize| open[*b] && norm(sums[*b].0) < NEARLY_CLOSED * sums[*b].1;
        let mut own: Vec<usize> = (0..found).filter(nearly_closed).collect();
        own.sort_by(|&a, &b| sums[b].1.total_cmp(&sums[a].1).then(a.cmp(&b)));
        own.truncate(MAX_OPEN_SHELLS);
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

    /// Closes each shell's boundary by cones over its loops, apex in the middle of the loop.
    fn cap(&mut self, boundary: Vec<BoundarySide>) {
        if boundary.is_empty() {
            return;
        }
        self.boundary_sides = boundary.len();
        let mut sides = vec![0usize; self.shells.len()];
        for side in &boundary {
            sides[side.shell as usize] += 1;
            self.shells[side.shell as usize].closed = false;
        }
        let mut triangles = vec![0usize; self.shells.len()];
        self.shell_of.iter().for_each(|&b| triangles[b as usize] += 1);
        for (b, shell) in self.shells.iter_mut().enumerate() {
            shell.scattered = sides[b] >= triangles[b];
        }
        let (loop_of, count) = loops(self.vertices.len(), &boundary);
        let mut sums = vec![([0.0; 3], 0.0); count as usize];
        for (side, &number) in boundary.iter().zip(&loop_of) {
            let sum: &mut (Vec3, f64) = &mut sums[number as usize];
            *sum = (add(sum.0, self.vertices[side.from as usize]), sum.1 + 1.0);
        }
        let first = self.vertices.len() as u32;
        self.vertices.to_mut().extend(sums.iter().map(|&(sum, sides)| scale(sum, 1.0 / sides)));
        for small in [true, false] {
            for (side, &number) in boundary.iter().zip(&loop_of) {
                let sides = sums[number as usize].1;
                if !self.shells[side.shell as usize].scattered && small == (sides <= SMALL_HOLE) {
                    self.triangles.to_mut().push([side.to, side.from, first + number]);
                    self.shell_of.push(side.shell);
                }
            }
            if small {
                self.patched = self.triangles.len();
            }
        }
    }

    /// Turns shells of negative volume over, unless another shell surrounds them: those are cavities.
    fn face_outwards(&mut self) {
        let everything = self.volume() < 0.0;
        let mut turn = vec![everything; self.shells.len()];
        let sign = |turn: bool| if turn { -1.0 } else { 1.0 };
        let negative: Vec<usize> = (0..self.shells.len())
            .filter(|&b| !self.shells[b].scattered && self.shells[b].volume * sign(everything) < 0.0)
            .collect();
        if self.shells.len() > 1 {
            for &b in negative.iter().take(MAX_CONTAINMENT_TESTS) {
                let Some(t) = self.shell_of.iter().position(|&of| of as usize == b) else { continue };
                let point = self.corners(t)[0];
                let winding: f64 = (0..self.triangles.len())
                    .filter(|&t| self.shell_of(t) != b)
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
            if turn[self.shell_of(t)] {
                self.triangles.to_mut()[t].swap(1, 2);
            }
        }
        for (shell, turn) in self.shells.iter_mut().zip(&turn) {
            shell.volume *= sign(*turn);
        }
    }
}

fn boundary_sides(analysis: &MeshAnalysis, shell_of: &[u32]) -> Vec<BoundarySide> {
    let mut boundary = Vec::new();
    if analysis.counts.unbalanced == 0 && analysis.counts.non_manifold == 0 {
        return boundary;
    }
    let mut net: Vec<(u32, i32)> = Vec::new();
    analysis.edges.for_each(|low, high, sides| {
        net.clear();
        for (_, side) in sides {
            let shell = shell_of[side.triangle()];
            match net.iter_mut().find(|n| n.0 == shell) {
                Some(n) => n.1 += side.direction(),
                None => net.push((shell, side.direction())),
            }
        }
        for &(shell, count) in &net {
            let (from, to) = if count > 0 { (low, high) } else { (high, low) };
            boundary.extend((0..count.abs()).map(|_| BoundarySide { from, to, shell }));
        }
    });
    boundary
}

//! The surface that is swept: oriented shells, their holes coned off, coordinates in a safe range.

use crate::mesh_edges::weld;
use mser3d_shape::vector::{Vec3, add, cross, sub};
use mser3d_shape::{BoundingBox, TriangleMesh};
use rayon::prelude::*;
use std::borrow::Cow;

/// A component of the surface: triangles that are joined across edges, with the caps over their holes.
#[derive(Clone, Debug)]
pub(crate) struct Shell {
    /// Volume enclosed by the shell and its caps, in scaled units; negative for a cavity.
    pub volume: f64,
    /// Area of the shell and its caps, in scaled units.
    pub area: f64,
    /// Whether each edge runs as often one way as the other: winding numbers are integers.
    pub closed: bool,
    /// So much of it is boundary that caps would outnumber the triangles: its winding number is
    /// summed over the triangles themselves.
    pub scattered: bool,
}

/// A closed shell whose volume is less than this part of its area to the power of 3/2 is flat.
const FLAT: f64 = 1e-9;

/// So many boundary sides a triangle are many: a surface with every tenth triangle missing has fewer.
const TANGLED: f64 = 0.4;

impl Shell {
    /// Whether it is closed and encloses nothing, like a sheet of two faces back to back.
    pub fn is_flat(&self) -> bool {
        self.closed && self.volume.abs() <= FLAT * self.area.powf(1.5)
    }
}

/// Shells and caps. With its caps each shell that is not scattered is a closed chain, so its winding number
/// is an integer, found by counting crossings; less the caps' own winding number, it is that of the mesh.
pub(crate) struct Surface<'m> {
    pub vertices: Cow<'m, [Vec3]>,
    /// The triangles of the mesh, oriented, then the caps.
    pub triangles: Cow<'m, [[u32; 3]]>,
    /// Triangles before the caps.
    pub caps: usize,
    /// Triangles before the caps of larger holes. Small holes are patched: their caps part neighbours
    /// like the surface that is missing there.
    pub patched: usize,
    pub shells: Vec<Shell>,
    /// The shell of each triangle and cap; empty with a single shell.
    pub shell_of: Vec<u32>,
    /// Sides of triangles that no other side of their shell runs against.
    pub boundary_sides: usize,
    /// Power of two that coordinates were multiplied with.
    pub scale: f64,
    /// The box around the mesh, in its own units.
    pub bounds: BoundingBox,
    /// Largest absolute value of a scaled coordinate.
    pub reach: f64,
    /// Shells turned inside out to face outwards.
    pub inverted: usize,
}

impl<'m> Surface<'m> {
    /// The triangles alone, as one shell: for counting crossings without regard to orientation.
    pub fn plain(mesh: &'m TriangleMesh, triangles: Cow<'m, [[u32; 3]]>) -> Self {
        let mut surface = Self::new(mesh, triangles);
        surface.shells = vec![Shell { volume: 0.0, area: 0.0, closed: true, scattered: false }];
        surface
    }

    /// The triangles as they are; shells are not found yet.
    pub fn new(mesh: &'m TriangleMesh, triangles: Cow<'m, [[u32; 3]]>) -> Self {
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
            shells: Vec::new(),
            shell_of: Vec::new(),
            boundary_sides: 0,
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
    pub fn shell_of(&self, triangle: usize) -> usize {
        if self.shell_of.is_empty() { 0 } else { self.shell_of[triangle] as usize }
    }

    /// Whether each shell is a closed chain without caps.
    pub fn closed(&self) -> bool {
        self.shells.iter().all(|b| b.closed)
    }

    /// Whether the winding number of some shell is summed over its triangles.
    pub fn scattered(&self) -> bool {
        self.shells.iter().any(|b| b.scattered)
    }

    /// Whether much of the surface is boundary.
    pub fn tangled(&self) -> bool {
        self.boundary_sides as f64 > TANGLED * self.caps as f64
    }

    /// For each vertex of the mesh twice the sum of the area vectors of the triangles around, without caps, in the mesh's
    /// own units. Vertices at one place have one sum, if triangles were welded there.
    pub fn vertex_normals(&self, mesh: &TriangleMesh, welded: bool) -> Vec<Vec3> {
        let mut normals = vec![[0.0; 3]; mesh.vertices().len()];
        for triangle in &self.triangles[..self.caps] {
            let [a, b, c] = triangle.map(|v| mesh.vertices()[v as usize]);
            let normal = cross(sub(b, a), sub(c, a));
            triangle.iter().for_each(|&v| normals[v as usize] = add(normals[v as usize], normal));
        }
        match welded.then(|| weld(mesh.vertices())).flatten() {
            Some(first) => first.iter().map(|&v| normals[v as usize]).collect(),
            None => normals,
        }
    }

    /// Volume enclosed by all shells and caps, in scaled units.
    pub fn volume(&self) -> f64 {
        self.shells.iter().map(|b| b.volume).sum()
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

//! Cells as meshes for simulations have them: volumes, which become the surface around them, and
//! polygons.

use crate::boundary::{Boundary, boundary};
use crate::error::Fault;
use crate::polygon::Faces;
use crate::read::{Parsed, note};
use std::collections::BTreeSet;

/// The shape of a cell, with its corners in VTK's order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Shape {
    /// Nothing, which some programs leave where a cell was.
    Empty,
    Point,
    Line,
    Polygon,
    /// A quadrilateral in rows.
    Pixel,
    /// Triangles that share an edge with the next.
    Strip,
    Tetrahedron,
    Hexahedron,
    /// A hexahedron in rows.
    Voxel,
    Wedge,
    Pyramid,
}

/// A kind of cell: its shape, how many corners it has (`None` for any number), and whether nodes that
/// bend it follow its corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kind {
    pub shape: Shape,
    pub corners: Option<usize>,
    pub curved: bool,
}

impl Kind {
    pub(crate) const fn new(shape: Shape, corners: usize) -> Self {
        Self { shape, corners: Some(corners), curved: false }
    }

    pub(crate) const fn any(shape: Shape) -> Self {
        Self { shape, corners: None, curved: false }
    }

    pub(crate) const fn curved(shape: Shape, corners: usize) -> Self {
        Self { shape, corners: Some(corners), curved: true }
    }
}

/// A cell of a solid; the corners that it does not have are `NONE`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solid {
    pub shape: Shape,
    pub corners: [u32; 8],
}

/// No vertex.
pub(crate) const NONE: u32 = u32::MAX;

/// The cells of a file, as they come.
#[derive(Default)]
pub(crate) struct Cells {
    solids: Vec<Solid>,
    /// Corners of all polygons, and where each ends.
    corners: Vec<u32>,
    ends: Vec<usize>,
    /// The parts that cells of solids belong to.
    parts: BTreeSet<i64>,
    points: usize,
    lines: usize,
    curved: usize,
    /// What else a user should know.
    pub notes: Vec<String>,
}

impl Cells {
    /// Adds a cell with its nodes, numbers of vertices, and the part that it belongs to, if one is given.
    #[inline]
    pub(crate) fn push(&mut self, kind: Kind, nodes: &[u32], part: Option<i64>) -> Result<(), String> {
        let needed = kind.corners.unwrap_or(nodes.len());
        if nodes.len() < needed || (!kind.curved && nodes.len() > needed) {
            return Err(format!("a cell has {} nodes, but its type has {needed}", nodes.len()));
        }
        let corners = &nodes[..needed];
        match kind.shape {
            Shape::Empty => return Ok(()),
            Shape::Point => {
                self.points += 1;
                return Ok(());
            }
            Shape::Line => {
                self.lines += 1;
                return Ok(());
            }
            Shape::Polygon => self.polygon(corners),
            Shape::Pixel => self.polygon(&[corners[0], corners[1], corners[3], corners[2]]),
            Shape::Strip => {
                for (i, w) in corners.windows(3).enumerate() {
                    let triangle = if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
                    // Strips repeat vertices to jump; such triangles are not part of the surface.
                    if triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0]
                    {
                        self.polygon(&triangle);
                    }
                }
            }
            shape => {
                let mut eight = [NONE; 8];
                eight[..needed].copy_from_slice(corners);
                let shape = match shape {
                    Shape::Voxel => {
                        eight.swap(2, 3);
                        eight.swap(6, 7);
                        Shape::Hexahedron
                    }
                    shape => shape,
                };
                self.solids.push(Solid { shape, corners: eight });
                self.parts.extend(part);
            }
        }
        self.curved += usize::from(kind.curved && nodes.len() > needed);
        Ok(())
    }

    fn polygon(&mut self, corners: &[u32]) {
        self.corners.extend_from_slice(corners);
        self.ends.push(self.corners.len());
    }

    /// The mesh: the boundary of the volume cells if there are any, else the polygons.
    pub(crate) fn into_mesh(self, vertices: Vec<[f64; 3]>) -> Result<Parsed, Fault> {
        let Self { mut solids, corners, ends, parts, points, lines, curved, mut notes } = self;
        let mut faces = Faces::default();
        if solids.is_empty() {
            let mut start = 0;
            for &end in &ends {
                faces.push(&corners[start..end], &vertices);
                start = end;
            }
        } else {
            let cells = solids.len();
            let found = boundary(&vertices, &mut solids);
            found.faces.iter().for_each(|face| faces.push(face.corners(), &vertices));
            notes.push(format!("the mesh is the boundary of {cells} volume cells"));
            if parts.len() > 1 {
                notes.push(format!("cells of {} parts are one solid", parts.len()));
            }
            notes.extend(note(ends.len(), "triangles or polygons beside the volume cells left out"));
            notes.extend(found_notes(&found));
            if faces.triangles.is_empty() {
                return Err(Fault::new(
                    "the volume cells have no boundary (they have no volume, or each is there twice); export the mesh again",
                ));
            }
        }
        notes.extend(note(curved, "cells with nodes between their corners taken as straight"));
        notes.extend(note(faces.skipped, "faces of fewer than three corners left out"));
        notes.extend(note(lines, "lines left out"));
        notes.extend(note(points, "points left out"));
        Ok(Parsed { vertices, triangles: faces.triangles, weld: None, polygons: faces.polygons, notes })
    }
}

fn found_notes(found: &Boundary) -> impl Iterator<Item = String> {
    [
        note(found.joined, "vertices at the place of an earlier one joined with it"),
        note(found.repeated, "volume cells that repeat an earlier one left out"),
        note(found.flat, "volume cells have no volume"),
        note(found.crowded, "faces belong to more than two cells: the cells overlap there; repair the mesh"),
        note(
            found.same_side,
            "faces have both of their cells on one side: the cells overlap there; repair the mesh",
        ),
    ]
    .into_iter()
    .flatten()
}

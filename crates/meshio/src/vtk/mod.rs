//! VTK's files of cells: XML (`.vtu`, `.vtp`) and the older ones (`.vtk`).

mod array;
mod base64;
pub(crate) mod legacy;
mod tags;
pub(crate) mod xml;

use crate::cells::{Cells, Kind, Shape};
use crate::error::Fault;

/// The kind of a cell by its number in VTK (vtkCellType.h); nodes after the corners of quadratic and higher
/// ones bend edges and faces.
fn kind(number: i64) -> Result<Kind, String> {
    use Shape::*;
    Ok(match number {
        0 => Kind::any(Empty),
        1 => Kind::new(Point, 1),
        2 => Kind::any(Point),
        3 => Kind::new(Line, 2),
        4 => Kind::any(Line),
        5 => Kind::new(Polygon, 3),
        6 => Kind::any(Strip),
        7 => Kind::any(Polygon),
        8 => Kind::new(Pixel, 4),
        9 => Kind::new(Polygon, 4),
        10 => Kind::new(Tetrahedron, 4),
        11 => Kind::new(Voxel, 8),
        12 => Kind::new(Hexahedron, 8),
        13 => Kind::new(Wedge, 6),
        14 => Kind::new(Pyramid, 5),
        21 | 35 | 68 | 75 => Kind::curved(Line, 2),
        22 | 34 | 69 | 76 => Kind::curved(Polygon, 3),
        23 | 28 | 30 | 70 | 77 => Kind::curved(Polygon, 4),
        24 | 71 | 78 => Kind::curved(Tetrahedron, 4),
        25 | 29 | 33 | 72 | 79 => Kind::curved(Hexahedron, 8),
        26 | 31 | 32 | 73 | 80 => Kind::curved(Wedge, 6),
        27 | 37 | 74 | 81 => Kind::curved(Pyramid, 5),
        36 => Kind::any(Polygon), // Corners, then as many nodes between them; see `Sink::push`.
        _ => {
            let name = match number {
                15 => " (pentagonal prism)",
                16 => " (hexagonal prism)",
                41 => " (convex point set)",
                42 => " (polyhedron)",
                _ => "",
            };
            return Err(format!(
                "cells of VTK's type {number}{name} are not supported; cut them into tetrahedra (ParaView: Tetrahedralize)"
            ));
        }
    })
}

/// A quadratic polygon.
const QUADRATIC_POLYGON: i64 = 36;

/// Cells on their way from lists of node numbers, which are checked.
struct Sink<'a> {
    cells: &'a mut Cells,
    /// The number of the first vertex that this part of the file may name, and how many it may.
    first: usize,
    vertices: usize,
    nodes: Vec<u32>,
}

impl<'a> Sink<'a> {
    fn new(cells: &'a mut Cells, first: usize, vertices: usize) -> Self {
        Self { cells, first, vertices, nodes: Vec::new() }
    }

    #[inline]
    fn push(&mut self, number: i64, nodes: &[i64], part: Option<i64>) -> Result<(), Fault> {
        self.nodes.clear();
        for &node in nodes {
            if node < 0 || node >= self.vertices as i64 {
                return Err(Fault::new(format!(
                    "a cell names point {node}, but there are {} points (numbered from 0)",
                    self.vertices
                )));
            }
            self.nodes.push((self.first + node as usize) as u32);
        }
        let kind = kind(number).map_err(|reason| Fault::unsupported(None, reason))?;
        if number == QUADRATIC_POLYGON {
            self.nodes.truncate(nodes.len() / 2);
        }
        self.cells.push(kind, &self.nodes, part).map_err(Fault::new)
    }

    /// Cells of one type, each ending in the list of nodes where `ends` says.
    fn push_all(&mut self, number: i64, nodes: &[i64], ends: &[i64]) -> Result<(), Fault> {
        let mut start = 0;
        for &end in ends {
            self.push(number, span(nodes, start, end)?, None)?;
            start = end;
        }
        Ok(())
    }
}

/// Part of a list of nodes.
fn span(nodes: &[i64], start: i64, end: i64) -> Result<&[i64], Fault> {
    let range = usize::try_from(start).ok().zip(usize::try_from(end).ok());
    range.and_then(|(start, end)| nodes.get(start..end)).ok_or_else(|| {
        Fault::new(format!(
            "a cell has the nodes {start} to {end} of a list of {}; the file is damaged; export it again",
            nodes.len()
        ))
    })
}

/// Names under which programs store the part that a cell belongs to: physical groups, references, materials.
fn names_parts(name: &str) -> bool {
    const NAMES: &[&str] = &[
        "gmsh:physical",
        "medit:ref",
        "cellentityids",
        "cell_tags",
        "physical",
        "entity",
        "domain",
        "subdomain",
        "zone",
        "tissue",
        "material",
        "materials",
        "materialid",
        "materialids",
        "material_id",
        "matid",
        "mat_id",
        "region",
        "regions",
        "regionid",
        "region_id",
        "label",
        "labels",
        "part",
        "parts",
        "partid",
        "part_id",
        "block",
        "blockid",
        "elementblockids",
    ];
    NAMES.iter().any(|n| n.eq_ignore_ascii_case(name))
}

//! Medit's files (`.mesh`): `Vertices`, `Tetrahedra` and the like, each with a count and as many rows, whose
//! last number is a reference.

use crate::cells::{Cells, Kind, Shape};
use crate::error::Fault;
use crate::read::Parsed;
use crate::text::{Tokens, show};

/// The word that such a file begins with.
pub(crate) const HEADER: &[u8] = b"MeshVersionFormatted";

/// More kinds of sections than Medit has.
const MAX_NAMES: usize = 40;

pub(crate) fn parse(bytes: &[u8]) -> Result<Parsed, Fault> {
    let mut tokens = Tokens::new(bytes);
    if tokens.next() != Some(HEADER) {
        return Err(Fault::at(1, "a .mesh file of Medit begins with MeshVersionFormatted; this one doesn't"));
    }
    tokens.whole::<u32>("the version")?;
    let mut vertices: Option<Vec<[f64; 3]>> = None;
    let mut cells = Cells::default();
    let mut left_out = Vec::new();
    while let Some(word) = tokens.next() {
        match word {
            b"Dimension" => {
                let dimension = tokens.whole::<u32>("the dimension")?;
                if dimension != 3 {
                    return Err(Fault::unsupported(
                        Some(tokens.line()),
                        format!("a mesh of dimension {dimension}; three are needed"),
                    ));
                }
            }
            b"Vertices" => {
                // Elements that were read name those of the first.
                if vertices.is_some() {
                    return Err(tokens.fault("Vertices come a second time; a file holds one mesh"));
                }
                let count = count(&mut tokens, 4)?;
                let mut positions = Vec::with_capacity(count);
                for _ in 0..count {
                    let position = [
                        tokens.number("coordinate x")?,
                        tokens.number("coordinate y")?,
                        tokens.number("coordinate z")?,
                    ];
                    positions.push(position);
                    tokens.number("the vertex's reference")?;
                }
                vertices = Some(positions);
            }
            b"End" => break,
            word => match kind(word) {
                Some((kind, nodes)) => {
                    let known = vertices.as_ref().map(Vec::len);
                    let known =
                        known.ok_or_else(|| tokens.fault(format!("{} come before Vertices", show(word))))?;
                    elements(&mut tokens, kind, nodes, known, &mut cells)?;
                }
                // What else there is are marks of vertices and edges, tangents, normals and settings.
                None => {
                    let name = show(word);
                    if !left_out.contains(&name) && left_out.len() < MAX_NAMES {
                        left_out.push(name);
                    }
                    skip(&mut tokens);
                }
            },
        }
    }
    let vertices = vertices.ok_or_else(|| tokens.fault("the file has no Vertices; export the mesh again"))?;
    let more = if left_out.len() == MAX_NAMES { " and perhaps more" } else { "" };
    let left_out = left_out.join(", ") + more;
    if !left_out.is_empty() {
        cells.notes.push(format!("{left_out} left out"));
    }
    let mesh = cells.into_mesh(vertices)?;
    if mesh.triangles.is_empty() && !left_out.is_empty() {
        return Err(Fault::unsupported(
            None,
            format!(
                "the file has no faces or cells that are read, only {left_out}; save it with elements of order 1 or 2"
            ),
        ));
    }
    Ok(mesh)
}

/// The kind of the elements that a word announces, and how many nodes each has.
fn kind(word: &[u8]) -> Option<(Kind, usize)> {
    use Shape::*;
    let (shape, corners, nodes) = match word {
        b"Edges" => (Line, 2, 2),
        b"EdgesP2" => (Line, 2, 3),
        b"EdgesP3" => (Line, 2, 4),
        b"Triangles" => (Polygon, 3, 3),
        b"TrianglesP2" => (Polygon, 3, 6),
        b"TrianglesP3" => (Polygon, 3, 10),
        b"Quadrilaterals" => (Polygon, 4, 4),
        b"QuadrilateralsQ2" => (Polygon, 4, 9),
        b"Tetrahedra" => (Tetrahedron, 4, 4),
        b"TetrahedraP2" => (Tetrahedron, 4, 10),
        b"TetrahedraP3" => (Tetrahedron, 4, 20),
        b"Hexahedra" | b"Hexaedra" => (Hexahedron, 8, 8),
        b"HexahedraQ2" => (Hexahedron, 8, 27),
        b"Prisms" | b"Pentahedra" | b"Wedges" => (Wedge, 6, 6),
        b"Pyramids" => (Pyramid, 5, 5),
        _ => return None,
    };
    let kind = if nodes > corners { Kind::curved(shape, corners) } else { Kind::new(shape, corners) };
    Some((kind, nodes))
}

fn elements(
    tokens: &mut Tokens,
    kind: Kind,
    nodes: usize,
    vertices: usize,
    cells: &mut Cells,
) -> Result<(), Fault> {
    let mut corners = Vec::with_capacity(nodes);
    for _ in 0..count(tokens, nodes as u64 + 1)? {
        corners.clear();
        for _ in 0..nodes {
            let node = tokens.whole::<u64>("an element's vertex")?;
            if node == 0 || node > vertices as u64 {
                return Err(tokens.fault(format!(
                    "an element names vertex {node}, but there are {vertices} vertices, numbered from 1"
                )));
            }
            corners.push((node - 1) as u32);
        }
        let reference = tokens.whole("the element's reference")?;
        cells.push(kind, &corners, Some(reference)).map_err(|reason| tokens.fault(reason))?;
    }
    Ok(())
}

/// How many rows of so many numbers follow.
fn count(tokens: &mut Tokens, numbers: u64) -> Result<usize, Fault> {
    let count = tokens.whole::<u64>("the number of rows")?;
    if count.saturating_mul(2 * numbers) > tokens.rest().len() as u64 + 1 || count > u32::MAX.into() {
        return Err(tokens.fault(format!(
            "{count} rows are declared, more than the rest of the file holds; it is truncated or the count is wrong; copy or export it again"
        )));
    }
    Ok(count as usize)
}

/// Moves to the next word that is no number.
fn skip(tokens: &mut Tokens) {
    loop {
        let mut ahead = tokens.clone();
        match ahead.next() {
            Some(word) if !word[0].is_ascii_alphabetic() => *tokens = ahead,
            _ => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: &str =
        "MeshVersionFormatted 2\nDimension\n3\nVertices\n5\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n9 9 9 1\n";

    #[test]
    fn tetrahedra_are_a_solid() {
        let text = format!(
            "{START}Corners 2\n1\n2\nTriangles\n1\n1 2 3 7\n# c\nTetrahedra 1\n1 3 2 4 5\nRequiredVertices\n1\n1\nEnd\n"
        );
        let parsed = parse(text.as_bytes()).unwrap();
        assert_eq!(parsed.vertices.len(), 5);
        let mesh = mser3d_shape::TriangleMesh::new(parsed.vertices, parsed.triangles).unwrap();
        assert!((mesh.signed_volume() - 1.0 / 6.0).abs() < 1e-15);
        assert_eq!(parsed.notes[0], "\"Corners\", \"RequiredVertices\" left out");
    }

    #[test]
    fn what_is_wrong_is_named_by_its_line() {
        let message = |rest: &str| {
            let parsed = parse(format!("{START}{rest}").as_bytes()).map(|_| ());
            parsed.unwrap_err().in_file("a.mesh".as_ref()).to_string()
        };
        assert!(message("Tetrahedra 1\n1 3 2 6 5\n").starts_with("a.mesh:12: an element names vertex 6"));
        assert!(message("Tetrahedra 9999999\n1 3 2 4 5\n").contains("9999999 rows are declared"));
        let twice = message("Tetrahedra 1\n1 3 2 4 5\nVertices 1\n0 0 0 1\n");
        assert!(twice.starts_with("a.mesh:13: Vertices come a second time"), "{twice}");
        assert!(message("HexahedraQ9 1\n1 2 3\n").contains("only \"HexahedraQ9\"; save it"));
        assert!(message("Triangles 1\n1 2 3      ").contains("the file ends before the element's reference"));
    }
}

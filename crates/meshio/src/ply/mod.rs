//! PLY: a header that declares elements and their properties, then the elements one after another.

mod header;
mod values;

use crate::error::Fault;
use crate::polygon::Faces;
use crate::read::{Parsed, note};
use header::{Element, Encoding, Header, Kind};
use values::{AsciiValues, BinaryValues, Values, WordValues};

pub(crate) fn parse(bytes: &[u8]) -> Result<Parsed, Fault> {
    let (header, lines) = Header::parse(bytes)?;
    match header.encoding {
        // The format asks for a line for each element; a file that has not may still work out to its last word.
        Encoding::Ascii => body(&header, &mut AsciiValues::new(lines.clone())).or_else(|fault| {
            let mut words = WordValues::new(lines.rest());
            body(&header, &mut words).ok().filter(|_| words.is_done()).ok_or(fault)
        }),
        Encoding::LittleEndian => body(&header, &mut BinaryValues::new(lines.rest(), false)),
        Encoding::BigEndian => body(&header, &mut BinaryValues::new(lines.rest(), true)),
    }
}

fn body(header: &Header, values: &mut impl Values) -> Result<Parsed, Fault> {
    let vertex_count = header.elements.iter().find(|e| e.name == "vertex").map_or(0, |e| e.count);
    let mut vertices = Vec::new();
    let mut polygons = Polygons::default();
    for element in &header.elements {
        let smallest = element.properties.iter().map(|p| values.smallest(p.kind)).sum::<u64>();
        if element.count.saturating_mul(smallest.max(1)) > values.left() {
            return Err(Fault::at(
                element.line,
                format!(
                    "{} elements \"{}\" are declared, more than the rest of the file holds ({} bytes); \
                     it is truncated or the count is wrong; copy or export it again",
                    element.count,
                    element.name,
                    values.left()
                ),
            ));
        }
        match element.name.as_str() {
            "vertex" => read_vertices(element, values, &mut vertices)?,
            "face" => read_lists(element, values, vertex_count, Lists::Faces, &mut polygons)?,
            "tristrips" => {
                let mut strips = Polygons::default();
                read_lists(element, values, vertex_count, Lists::Strips, &mut strips)?;
                let mut start = 0;
                for &end in &strips.ends {
                    strip(&strips.corners[start..end], &mut polygons);
                    start = end;
                }
            }
            _ => {
                for number in 0..element.count {
                    values.begin(element, number)?;
                    for property in &element.properties {
                        values.skip(property.kind)?;
                    }
                }
            }
        }
    }
    let mut faces = Faces::default();
    let mut start = 0;
    for &end in &polygons.ends {
        faces.push(&polygons.corners[start..end], &vertices);
        start = end;
    }
    let notes = note(faces.skipped, "faces of fewer than three corners left out").into_iter().collect();
    Ok(Parsed { vertices, triangles: faces.triangles, weld: None, polygons: faces.polygons, notes })
}

/// Corners of all faces, and where each face's corners end.
#[derive(Default)]
struct Polygons {
    corners: Vec<u32>,
    ends: Vec<usize>,
}

fn read_vertices(element: &Element, values: &mut impl Values, out: &mut Vec<[f64; 3]>) -> Result<(), Fault> {
    let axis = |name: &str| ["x", "y", "z"].iter().position(|&axis| axis == name);
    let roles: Vec<_> = element.properties.iter().map(|p| (p.kind, axis(&p.name))).collect();
    for (a, name) in ["x", "y", "z"].iter().enumerate() {
        if !roles.iter().any(|r| r.1 == Some(a) && matches!(r.0, Kind::Scalar(_))) {
            return Err(Fault::at(element.line, format!("vertices have no property \"{name}\"")));
        }
    }
    out.reserve_exact(element.count as usize);
    for number in 0..element.count {
        values.begin(element, number)?;
        let mut position = [0.0; 3];
        for &(kind, axis) in &roles {
            match (kind, axis) {
                (Kind::Scalar(scalar), Some(a)) => position[a] = values.scalar(scalar)?,
                _ => values.skip(kind)?,
            }
        }
        if position.iter().any(|x| !x.is_finite()) {
            return Err(
                values.fault(format!("vertex {number} has a coordinate that is NaN or infinite; repair it"))
            );
        }
        out.push(position);
    }
    Ok(())
}

/// What the lists of an element are.
#[derive(Clone, Copy, PartialEq)]
enum Lists {
    Faces,
    /// Triangle strips, one after another; -1 begins a new one.
    Strips,
}

/// Stands for -1 in a strip.
const RESTART: u32 = u32::MAX;

/// The triangles of strips: each corner from the third on makes one with the two before it, turned at every
/// second.
fn strip(corners: &[u32], out: &mut Polygons) {
    for strip in corners.split(|&v| v == RESTART) {
        for (i, w) in strip.windows(3).enumerate() {
            let triangle = if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
            // Strips repeat vertices to jump; such triangles are not part of the surface.
            if triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0] {
                out.corners.extend(triangle);
                out.ends.push(out.corners.len());
            }
        }
    }
}

fn read_lists(
    element: &Element,
    values: &mut impl Values,
    vertices: u64,
    lists: Lists,
    out: &mut Polygons,
) -> Result<(), Fault> {
    let what = if lists == Lists::Strips { "strip" } else { "face" };
    let corners = |name: &str| name == "vertex_indices" || name == "vertex_index";
    let list = element.properties.iter().position(|p| corners(&p.name));
    let Some(list) = list.filter(|&i| matches!(element.properties[i].kind, Kind::List { .. })) else {
        return Err(Fault::at(element.line, format!("{what}s have no list property \"vertex_indices\"")));
    };
    out.ends.reserve_exact(element.count as usize);
    for number in 0..element.count {
        values.begin(element, number)?;
        for (i, property) in element.properties.iter().enumerate() {
            let Kind::List { count, item } = property.kind else {
                values.skip(property.kind)?;
                continue;
            };
            if i != list {
                values.skip(property.kind)?;
                continue;
            }
            for _ in 0..values.list_length(count)? {
                let index = values.scalar(item)?;
                // -1, also as an unsigned number.
                if lists == Lists::Strips && (index == -1.0 || index == f64::from(u32::MAX)) {
                    out.corners.push(RESTART);
                    continue;
                }
                if !(index >= 0.0 && index < vertices as f64 && index.fract() == 0.0) {
                    return Err(values.fault(format!(
                        "{what} {number} names vertex {index}, but there are {vertices} vertices (numbered from 0)"
                    )));
                }
                out.corners.push(index as u32);
            }
        }
        out.ends.push(out.corners.len());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "comment c\nelement vertex 5\nproperty float nx\nproperty double x\nproperty float y\n\
        property short z\nproperty list uchar float extra\nelement edge 1\nproperty int vertex1\n\
        element face 2\nproperty uchar red\nproperty list uchar int vertex_indices\nend_header\n";
    const VERTICES: [[f64; 3]; 5] = [[0.1, 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.], [7., 7., -7.]];
    const FACES: [&[u32]; 2] = [&[0, 1, 2, 3], &[0, 2, 1]];

    fn ascii() -> Vec<u8> {
        let mut text = format!("ply\nformat ascii 1.0\n{HEADER}");
        for [x, y, z] in VERTICES {
            text += &format!("nan {x} {y} {z} 2 0.5 0.5\n");
        }
        text += "3\n";
        for face in FACES {
            let corners: Vec<_> = face.iter().map(u32::to_string).collect();
            text += &format!("255 {} {}\n", face.len(), corners.join(" "));
        }
        text.into()
    }

    fn binary(big: bool) -> Vec<u8> {
        let order = |bytes: &mut [u8]| {
            if big {
                bytes.reverse()
            }
        };
        let name = if big { "big" } else { "little" };
        let mut out = format!("ply\r\nformat binary_{name}_endian 1.0\r\n{HEADER}").into_bytes();
        let mut put = |bytes: &mut [u8]| {
            order(bytes);
            out.extend_from_slice(bytes);
        };
        for [x, y, z] in VERTICES {
            put(&mut f32::NAN.to_le_bytes());
            put(&mut x.to_le_bytes());
            put(&mut (y as f32).to_le_bytes());
            put(&mut (z as i16).to_le_bytes());
            put(&mut [1]);
            put(&mut 0.5f32.to_le_bytes());
        }
        put(&mut 3i32.to_le_bytes());
        for face in FACES {
            put(&mut [255]);
            put(&mut [face.len() as u8]);
            for v in face {
                put(&mut v.to_le_bytes());
            }
        }
        out
    }

    #[test]
    fn three_encodings_hold_the_same_mesh() {
        for bytes in [ascii(), binary(false), binary(true)] {
            let parsed = parse(&bytes).unwrap();
            assert_eq!(parsed.vertices, VERTICES);
            assert_eq!(parsed.triangles, [[0, 1, 2], [0, 2, 3], [0, 2, 1]]);
            assert_eq!(parsed.polygons, 1);
        }
    }

    #[test]
    fn lines_of_text_may_end_anywhere() {
        let text = String::from_utf8(ascii()).unwrap();
        let (header, body) = text.split_once("end_header\n").unwrap();
        let words: Vec<&str> = body.split_whitespace().collect();
        for width in [1, 4, 7, 1000] {
            let lines: Vec<String> = words.chunks(width).map(|w| w.join(" ")).collect();
            let parsed = parse(format!("{header}end_header\n{}", lines.join("\n")).as_bytes()).unwrap();
            assert_eq!((parsed.vertices, parsed.triangles.len()), (VERTICES.to_vec(), 3));
        }
        // A value that is missing is not borrowed from the next line.
        let missing = text.replacen("nan 1 0 0", "nan 1 0", 1);
        let fault = format!("{:?}", parse(missing.as_bytes()).map(|_| ()).unwrap_err());
        assert!(fault.contains("line: Some(17)"), "{fault}");
    }

    #[test]
    fn strips_turn_at_every_second_triangle_and_restart() {
        let header = "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
            element tristrips 1\nproperty list int int vertex_indices\n";
        let vertices = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n";
        // The last strip jumps over a vertex that is repeated.
        let ascii = format!(
            "ply\nformat ascii 1.0\n{header}end_header\n{vertices}15 0 1 2 3 4 -1 1 3 2 -1 0 1 2 2 3\n"
        );
        let expected = [[0, 1, 2], [2, 1, 3], [2, 3, 4], [1, 3, 2], [0, 1, 2]];
        assert_eq!(parse(ascii.as_bytes()).unwrap().triangles, expected);
        let mut binary = format!("ply\nformat binary_big_endian 1.0\n{header}end_header\n").into_bytes();
        for x in vertices.split_whitespace() {
            binary.extend(x.parse::<f32>().unwrap().to_be_bytes());
        }
        for x in [15, 0, 1, 2, 3, 4, -1, 1, 3, 2, -1, 0, 1, 2, 2, 3i32] {
            binary.extend(x.to_be_bytes());
        }
        let read = parse(&binary).unwrap();
        assert_eq!((read.triangles, read.notes.len()), (expected.to_vec(), 0));
        // Beside faces, and with a corner that is not there.
        let both = format!(
            "ply\nformat ascii 1.0\n{header}element face 1\nproperty list uchar int vertex_index\nend_header\n{vertices}3 0 1 2\n3 1 3 2\n"
        );
        assert_eq!(parse(both.as_bytes()).unwrap().triangles, [[0, 1, 2], [1, 3, 2]]);
        let fault = parse(both.replace("3 0 1 2\n", "3 0 1 5\n").as_bytes()).map(|_| ()).unwrap_err();
        assert!(fault.into_reason().starts_with("strip 0 names vertex 5, but there are 5"));
    }

    #[test]
    fn every_truncation_is_an_error() {
        for bytes in [ascii(), binary(false), binary(true)] {
            // The last byte of the ASCII file is a line end, which it can do without.
            for end in 0..bytes.len() - 1 {
                assert!(parse(&bytes[..end]).is_err(), "{end} of {} bytes", bytes.len());
            }
        }
    }
}

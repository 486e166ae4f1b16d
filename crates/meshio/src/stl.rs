//! STL: triangles without shared vertices, ASCII or binary; equal positions are welded.

use crate::error::Fault;
use crate::read::{Parsed, note};
use crate::text::{Lines, show};
use crate::weld::{Weld, collapse};

/// An 80-byte comment and the number of triangles.
const HEADER: usize = 84;
/// Normal, three corners, two bytes of attributes.
const RECORD: usize = 50;

/// How many triangles a binary STL declares.
fn declared(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..HEADER)?.try_into().ok()?;
    Some(u32::from_le_bytes(count).into())
}

/// Whether a file has exactly the size that it would declare as a binary STL.
pub(crate) fn is_binary(bytes: &[u8]) -> bool {
    declared(bytes).is_some_and(|n| n > 0 && HEADER as u64 + n * RECORD as u64 == bytes.len() as u64)
}

pub(crate) fn parse(bytes: &[u8]) -> Result<Parsed, Fault> {
    let mut soup = Soup::default();
    // Some binary files begin with "solid" too; their size shows what they are.
    if !is_binary(bytes) && begins_solid(bytes) && is_text(bytes) {
        ascii(bytes, &mut soup)?;
    } else {
        binary(bytes, &mut soup)?;
    }
    let corners = (0..soup.weld.map.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    let (triangles, dropped) = collapse(corners, &soup.weld.map);
    let notes = note(dropped, "triangles with two equal corners left out").into_iter().collect();
    Ok(Parsed { vertices: soup.vertices, triangles, weld: Some(soup.weld.map), polygons: 0, notes })
}

fn begins_solid(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

fn is_text(bytes: &[u8]) -> bool {
    !bytes.iter().take(1024).any(|&b| b == 0)
}

#[derive(Default)]
struct Soup {
    vertices: Vec<[f64; 3]>,
    weld: Weld,
}

impl Soup {
    fn push(&mut self, position: [f64; 3]) {
        if self.weld.push(0, position) {
            self.vertices.push(position);
        }
    }
}

fn binary(bytes: &[u8], soup: &mut Soup) -> Result<(), Fault> {
    let Some(count) = declared(bytes) else {
        return Err(Fault::new(
            "neither ASCII STL (which begins with \"solid\") nor a whole binary header of 84 bytes; \
             the file is truncated or no STL; copy or export it again",
        ));
    };
    let held = (bytes.len() - HEADER) / RECORD;
    if count > held as u64 {
        return Err(Fault::new(format!(
            "{count} triangles are declared, but the file holds {held}; it is truncated or no STL; copy or export it again"
        )));
    }
    for (number, record) in bytes[HEADER..].chunks_exact(RECORD).take(count as usize).enumerate() {
        for corner in record[12..48].chunks_exact(12) {
            let position: [f64; 3] = std::array::from_fn(|a| {
                let x = [corner[4 * a], corner[4 * a + 1], corner[4 * a + 2], corner[4 * a + 3]];
                f32::from_le_bytes(x).into()
            });
            if position.iter().any(|x| !x.is_finite()) {
                return Err(Fault::new(format!(
                    "triangle {number} has a coordinate that is NaN or infinite; remove or repair it"
                )));
            }
            soup.push(position);
        }
    }
    Ok(())
}

/// `facet normal ... outer loop, vertex x y z three times, endloop endfacet`, one statement a line.
fn ascii(bytes: &[u8], soup: &mut Soup) -> Result<(), Fault> {
    let mut lines = Lines::new(bytes);
    let (mut corners, mut ended) = (0, false);
    while let Some(line) = lines.next_full() {
        let mut words = line.words();
        let word = words.next().unwrap_or_default().to_ascii_lowercase();
        match &word[..] {
            b"vertex" => {
                soup.push(words.position()?);
                corners += 1;
            }
            b"endfacet" if corners == 3 => corners = 0,
            b"endfacet" => {
                return Err(Fault::at(
                    line.number,
                    format!("a facet of {corners} vertices; it must have three"),
                ));
            }
            b"endsolid" => ended = true,
            b"solid" => ended = false,
            b"facet" | b"outer" | b"endloop" => {}
            _ => {
                let word = show(&word);
                return Err(Fault::at(line.number, format!("{word} is no statement of ASCII STL")));
            }
        }
    }
    if !ended || corners != 0 {
        return Err(Fault::at(
            lines.number(),
            "the file ends without endsolid; it is truncated; copy or export it again",
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn binary_stl(triangles: &[[[f32; 3]; 3]], header: &[u8]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for t in triangles {
            bytes.extend([0u8; 12]);
            bytes.extend(t.iter().flatten().flat_map(|x| x.to_le_bytes()));
            bytes.extend([0u8; 2]);
        }
        bytes
    }

    #[test]
    fn corners_are_welded_in_order_of_occurrence() {
        let (a, b, c, d) = ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        let minus = [-0.0, 0.0, -0.0];
        let triangles = [[c, b, a], [minus, b, d], [b, c, d], [a, d, c], [a, minus, b]];
        let binary = parse(&binary_stl(&triangles, b"solid in spite of its header")).unwrap();
        assert_eq!(binary.triangles, [[0, 1, 2], [2, 1, 3], [1, 0, 3], [2, 3, 0]]);
        assert_eq!(binary.weld.as_deref(), Some(&[0, 1, 2, 2, 1, 3, 1, 0, 3, 2, 3, 0, 2, 2, 1][..]));
        assert_eq!(binary.notes, ["1 triangles with two equal corners left out"]);

        let mut text = String::from("solid a b c\n");
        for t in triangles {
            text += "facet normal 0 0 0\n outer loop\n";
            for p in t {
                text += &format!("  VERTEX {:e} {} {}\r\n", p[0], p[1], p[2]);
            }
            text += " endloop\nendfacet\n";
        }
        text += "endsolid a b c";
        let ascii = parse(text.as_bytes()).unwrap();
        assert_eq!(ascii.vertices, binary.vertices);
        assert_eq!(ascii.triangles, binary.triangles);
    }
}

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

/// Whether a file that begins so has exactly the length that it would declare as a binary STL.
pub(crate) fn is_binary(start: &[u8], length: u64) -> bool {
    declared(start).is_some_and(|n| n > 0 && HEADER as u64 + n * RECORD as u64 == length)
}

pub(crate) fn parse(bytes: &[u8]) -> Result<Parsed, Fault> {
    let mut soup = Soup::default();
    let mut notes = Vec::new();
    // Some binary files begin with "solid" too; their size shows what they are.
    if !is_binary(bytes, bytes.len() as u64) && begins_solid(bytes) && is_text(bytes) {
        ascii(bytes, &mut soup)?;
    } else {
        binary(bytes, &mut soup, &mut notes)?;
    }
    let corners = (0..soup.weld.map.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    let (triangles, dropped) = collapse(corners, &soup.weld.map);
    notes.extend(note(dropped, "triangles with two equal corners left out"));
    Ok(Parsed { vertices: soup.vertices, triangles, weld: Some(soup.weld.map), polygons: 0, notes })
}

/// The bytes without a byte order mark.
fn unmarked(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

fn begins_solid(bytes: &[u8]) -> bool {
    unmarked(bytes).trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
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

    /// Whether a record that is not declared looks like a triangle: its corners are not a thousand times
    /// farther away than those that were read.
    fn is_plausible(&self, record: &[u8]) -> bool {
        let largest = |points: &mut dyn Iterator<Item = [f64; 3]>| {
            points.flatten().fold(0.0, |m: f64, x| if x.is_finite() { m.max(x.abs()) } else { f64::INFINITY })
        };
        let found = largest(&mut corners(record));
        let known = largest(&mut self.vertices.iter().take(1000).copied());
        found.is_finite() && (self.vertices.is_empty() || found <= 1000.0 * known)
    }
}

fn binary(bytes: &[u8], soup: &mut Soup, notes: &mut Vec<String>) -> Result<(), Fault> {
    if let Some(parts) = joined(bytes) {
        if parts.len() > 1 {
            let counts: Vec<String> = parts.iter().map(|part| (part.len() / RECORD).to_string()).collect();
            notes.push(format!(
                "{} STL files of {} triangles follow one another; all are read",
                parts.len(),
                counts.join(" and ")
            ));
        }
        return parts.into_iter().try_for_each(|part| records(part, soup));
    }
    let Some(count) = declared(bytes) else {
        return Err(Fault::new(
            "neither ASCII STL (which begins with \"solid\") nor a whole binary header of 84 bytes; \
             the file is truncated or no STL; copy or export it again",
        ));
    };
    let data = &bytes[HEADER..];
    let (held, rest) = (data.len() / RECORD, data.len() % RECORD);
    // A writer that miscounts still writes whole triangles.
    if count > held as u64 && (rest > 0 || held == 0) {
        return Err(Fault::new(format!(
            "{count} triangles are declared, but the file holds {held}; it is truncated or no STL; copy or export it again"
        )));
    }
    let sure = held.min(count as usize);
    records(&data[..sure * RECORD], soup)?;
    // What follows the declared triangles may be something else.
    let more = data[sure * RECORD..].chunks_exact(RECORD).take_while(|r| soup.is_plausible(r)).count();
    records(&data[sure * RECORD..][..more * RECORD], soup)?;
    let read = sure + more;
    if read as u64 != count {
        notes.push(format!("{count} triangles are declared, but the file holds {read}; {read} are read"));
    }
    notes.extend(note(data.len() - read * RECORD, "bytes after the last triangle left out"));
    Ok(())
}

/// The triangles of binary files that follow one another, if their counts work out to the last byte.
fn joined(mut bytes: &[u8]) -> Option<Vec<&[u8]>> {
    let mut parts = Vec::new();
    while !bytes.is_empty() {
        let end = usize::try_from(declared(bytes)?.checked_mul(RECORD as u64)?).ok()?.checked_add(HEADER)?;
        parts.push(bytes.get(HEADER..end)?);
        bytes = &bytes[end..];
    }
    Some(parts)
}

fn corners(record: &[u8]) -> impl Iterator<Item = [f64; 3]> + '_ {
    let number = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    record[12..48].chunks_exact(12).map(move |corner| std::array::from_fn(|a| number(&corner[4 * a..])))
}

fn records(bytes: &[u8], soup: &mut Soup) -> Result<(), Fault> {
    for (number, record) in bytes.chunks_exact(RECORD).enumerate() {
        for position in corners(record) {
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
        // Files that were joined may each have had a byte order mark.
        let word = unmarked(words.next().unwrap_or_default()).to_ascii_lowercase();
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

    const A: [[f32; 3]; 3] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
    const B: [[f32; 3]; 3] = [[0., 0., 0.], [0., 1., 0.], [0., 0., 1.]];

    #[test]
    fn triangles_are_read_whatever_the_count_says() {
        for count in [0u32, 1, 4, u32::MAX] {
            let mut bytes = binary_stl(&[A, B, A], b"");
            bytes[80..84].copy_from_slice(&count.to_le_bytes());
            let parsed = parse(&bytes).unwrap();
            assert_eq!((parsed.triangles.len(), parsed.vertices.len()), (3, 4));
            assert_eq!(
                parsed.notes,
                [format!("{count} triangles are declared, but the file holds 3; 3 are read")]
            );
        }
        // Cut within a triangle, a file is truncated.
        let cut = binary_stl(&[A, B, A], b"");
        assert!(parse(&cut[..cut.len() - 1]).is_err());
        // A note of another program is no triangle.
        let appended = [binary_stl(&[A, B], b""), b"made by a program that says much; ".repeat(5)].concat();
        let parsed = parse(&appended).unwrap();
        assert_eq!(parsed.triangles.len(), 2);
        assert_eq!(parsed.notes, ["170 bytes after the last triangle left out"]);
    }

    #[test]
    fn joined_files_are_read_whole() {
        let two = [binary_stl(&[A, B], b"solid"), binary_stl(&[A], b"")].concat();
        let parsed = parse(&two).unwrap();
        assert_eq!(parsed.triangles.len(), 3);
        assert_eq!(parsed.notes, ["2 STL files of 2 and 1 triangles follow one another; all are read"]);
        let facet =
            "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
        let solid = format!("\u{feff}solid a\n{facet}endsolid a\n");
        let parsed = parse(format!("{solid}{solid}").as_bytes()).unwrap();
        assert_eq!((parsed.triangles.len(), parsed.notes.len()), (2, 0));
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

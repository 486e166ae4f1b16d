//! OFF: `OFF`, the counts, the vertices, the faces; usually a line for each.

mod stream;

use crate::error::Fault;
use crate::polygon::Faces;
use crate::read::{Parsed, note};
use crate::text::{Line, Lines, Tokens, parse as number, show};

/// Whether a word begins an OFF file: `OFF`, perhaps after letters that say what vertices carry besides a
/// position.
pub(crate) fn is_header(word: &[u8]) -> bool {
    keyword(word).is_some()
}

/// The letters before `OFF` and what is glued to it (`OFF8 6 12` is seen in practice).
fn keyword(word: &[u8]) -> Option<(&[u8], &[u8])> {
    let at = word.windows(3).position(|w| w == b"OFF")?;
    let (letters, rest) = (&word[..at], &word[at + 3..]);
    let known = letters.iter().all(|b| b"STCN4n".contains(b));
    (known && rest.iter().all(u8::is_ascii_digit)).then_some((letters, rest))
}

pub(crate) fn parse(bytes: &[u8]) -> Result<Parsed, Fault> {
    let mut lines = Lines::new(bytes);
    let (vertex_count, face_count) = header(&mut lines)?;
    // A vertex takes at least 6 bytes ("0 0 0" and a line end), a face of three corners 8.
    let fits = |count: u64, size: u64| count.saturating_mul(size) <= bytes.len() as u64 + size;
    if !fits(vertex_count, 6) || !fits(face_count, 2) {
        return Err(Fault::at(
            lines.number(),
            format!(
                "{vertex_count} vertices and {face_count} faces are declared, more than {} bytes can hold; \
                 the file is truncated or its counts are wrong; copy or export it again",
                bytes.len()
            ),
        ));
    }
    // Nearly every file has a line for each vertex and face, which the format asks for, but its own programs
    // don't.
    one_a_line(lines, vertex_count, face_count).or_else(|fault| {
        stream::read(bytes, vertex_count, face_count).map_err(|other| {
            let lines = Heading::new(bytes);
            // Where both readings fail, the one that was meant knows what is wrong.
            let farther = other.line() > fault.line() && lines.after != vertex_count + face_count;
            if lines.runs_on || farther { other } else { fault }
        })
    })
}

fn one_a_line(mut lines: Lines, vertex_count: u64, face_count: u64) -> Result<Parsed, Fault> {
    let mut vertices = Vec::with_capacity(vertex_count as usize);
    while (vertices.len() as u64) < vertex_count {
        let line = next(&mut lines, "vertices", vertices.len(), vertex_count)?;
        vertices.push(line.words().position()?);
    }
    let mut faces = Faces::default();
    let mut corners = Vec::new();
    for read in 0..face_count {
        let line = next(&mut lines, "faces", read as usize, face_count)?;
        face(line, vertices.len(), &mut corners)?;
        faces.push(&corners, &vertices);
    }
    let mut more = 0;
    while lines.next_full().is_some() {
        more += 1;
    }
    Ok(parsed(vertices, faces, note(more, "lines after the last face left out")))
}

fn parsed(vertices: Vec<[f64; 3]>, faces: Faces, more: Option<String>) -> Parsed {
    let skipped = note(faces.skipped, "faces of fewer than three corners left out");
    let notes = skipped.into_iter().chain(more).collect();
    Parsed { vertices, triangles: faces.triangles, weld: None, polygons: faces.polygons, notes }
}

/// How a file is laid out that breaks the rules.
struct Heading {
    /// Vertices follow the counts on their line.
    runs_on: bool,
    /// Lines after that of the counts.
    after: u64,
}

impl Heading {
    fn new(bytes: &[u8]) -> Self {
        let mut lines = Lines::new(bytes);
        let _ = header(&mut lines);
        let head = &bytes[..bytes.len() - lines.rest().len()];
        let mut after = 0;
        while lines.next_full().is_some() {
            after += 1;
        }
        // `OFF` and three counts, or all glued.
        Self { runs_on: Tokens::new(head).count() > 4, after }
    }
}

/// The counts of vertices and faces.
fn header(lines: &mut Lines) -> Result<(u64, u64), Fault> {
    let no_header = || Fault::at(1, "an OFF file begins with the word OFF; this one doesn't");
    let line = lines.next_full().ok_or_else(no_header)?;
    let mut words = line.words();
    let (letters, glued) = words.next().and_then(keyword).ok_or_else(no_header)?;
    if letters.contains(&b'4') || letters.contains(&b'n') {
        return Err(Fault::unsupported(
            Some(line.number),
            "vertices of other than three dimensions are not supported; export plain OFF",
        ));
    }
    if words.clone().next() == Some(b"BINARY") {
        return Err(Fault::unsupported(
            Some(line.number),
            "binary OFF is not supported; export ASCII OFF or binary PLY",
        ));
    }
    let mut count = |what: &str| -> Result<u64, Fault> {
        while words.clone().next().is_none() {
            let end = "the file ends before the counts; it is truncated; copy or export it again";
            let end = Fault::at(lines.number(), end);
            words = lines.next_full().ok_or(end)?.words();
        }
        words.whole(what)
    };
    let vertices = match number(glued) {
        Some(vertices) => vertices,
        None => count("the number of vertices")?,
    };
    Ok((vertices, count("the number of faces")?))
}

fn next<'a>(lines: &mut Lines<'a>, what: &str, read: usize, declared: u64) -> Result<Line<'a>, Fault> {
    lines.next_full().ok_or_else(|| {
        Fault::at(
            lines.number(),
            format!(
                "the file ends after {read} of {declared} {what}; it is truncated or its counts are wrong; copy or export it again"
            ),
        )
    })
}

/// The corners of the face on a line; what follows them is colour.
fn face(line: Line, vertices: usize, corners: &mut Vec<u32>) -> Result<(), Fault> {
    corners.clear();
    let mut words = line.words();
    let count = words.whole("the face's number of corners")?;
    for read in 0..count {
        let word = words
            .next()
            .ok_or_else(|| Fault::at(line.number, format!("the face has {read} of its {count} corners")))?;
        match number::<u32>(word) {
            Some(v) if (v as usize) < vertices => corners.push(v),
            _ => {
                let (last, word) = (vertices.saturating_sub(1), show(word));
                return Err(Fault::at(
                    line.number,
                    format!("the face names vertex {word}, but vertices are numbered from 0 to {last}"),
                ));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_read_as_they_occur() {
        for header in
            ["OFF\n4 1 0\n", "OFF 4 1 0\n", "OFF4 1 0\n", "# c\nCOFF # d\n\n4 1\n", "STCNOFF\n4 1 0\n"]
        {
            let text = format!("{header}0 0 0 9 9\n1 0 0\n1 1 0 # c\n\n0 1 0\n4 0 1 2 3 255 0 0\n");
            let parsed = parse(text.as_bytes()).unwrap();
            assert_eq!(parsed.vertices[2], [1.0, 1.0, 0.0]);
            assert_eq!(parsed.triangles, [[0, 1, 2], [0, 2, 3]]);
            assert_eq!(parsed.polygons, 1);
        }
    }

    #[test]
    fn what_follows_the_last_face_is_noted() {
        let parsed = parse(b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n\n# end\nOFF\n3 1 0\n").unwrap();
        assert_eq!(parsed.notes, ["2 lines after the last face left out"]);
    }

    #[test]
    fn faces_without_area_are_noted() {
        let parsed = parse(b"OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n3 0 1 2\n").unwrap();
        assert_eq!(parsed.notes, ["1 faces of fewer than three corners left out"]);
    }
}

//! OFF whose vertices and faces run over line ends.

use super::{keyword, parsed};
use crate::error::Fault;
use crate::polygon::Faces;
use crate::read::Parsed;
use crate::text::{Tokens, show};

/// Reads a file word by word. How many numbers belong to a vertex, and whether colours follow a face, shows in
/// that it works out to the file's last word.
///
/// The fault, if nothing does, is that of the plainest reading.
pub(super) fn read(bytes: &[u8], vertex_count: u64, face_count: u64) -> Result<Parsed, Fault> {
    let (starts, letters) = after_counts(bytes)?;
    let has = |letter| letters.contains(&letter);
    let plain = 3 + if has(b'N') { 3 } else { 0 } + if has(b'S') { 2 } else { 0 };
    // Colours should have four numbers, and often have three; or the heading promises what is not there.
    // At last, each may be on a line of its own after all, and only faces run over line ends.
    let widths: &[Option<usize>] = if has(b'C') {
        &[Some(plain + 4), Some(plain + 3), Some(3), None]
    } else {
        &[Some(plain), Some(3), None]
    };
    let mut first: Option<Fault> = None;
    // Without colours, a reading that works out to the last word is hardly wrong.
    for colours in [false, true] {
        for tokens in &starts {
            for &width in widths {
                match (Layout { width, colours }).read(tokens.clone(), vertex_count as usize, face_count) {
                    Ok(parsed) => return Ok(parsed),
                    Err(fault) => first = first.or(Some(fault)),
                }
            }
        }
    }
    Err(first.unwrap_or_else(|| Fault::new("no vertices")))
}

/// The words after the counts, and the letters before `OFF`. The number of edges, which says nothing, may be
/// missing at the end of a line.
fn after_counts(bytes: &[u8]) -> Result<(Vec<Tokens<'_>>, &[u8]), Fault> {
    let mut tokens = Tokens::new(bytes);
    let (letters, glued) = tokens.next().and_then(keyword).unwrap_or_default();
    if glued.is_empty() {
        tokens.whole::<u64>("the number of vertices")?;
    }
    tokens.whole::<u64>("the number of faces")?;
    let mut with_edges = tokens.clone();
    let without_edges = tokens.at_line_end();
    with_edges.word("the number of edges")?;
    let mut starts = vec![with_edges];
    if without_edges {
        starts.push(tokens);
    }
    Ok((starts, letters))
}

/// How a file may be laid out.
struct Layout {
    /// Numbers of a vertex; `None` for a line each.
    width: Option<usize>,
    /// Whether what follows a face on its last line is its colour.
    colours: bool,
}

impl Layout {
    fn read(&self, mut tokens: Tokens, vertex_count: usize, face_count: u64) -> Result<Parsed, Fault> {
        let mut vertices = Vec::with_capacity(vertex_count);
        for read in 0..vertex_count {
            let mut position = [0.0; 3];
            for number in 0..self.width.unwrap_or(3) {
                if self.width.is_none() && number > 0 && tokens.at_line_end() {
                    return Err(tokens.fault("a coordinate is missing"));
                }
                let value = coordinate(&mut tokens, number, read, vertex_count)?;
                if number < 3 {
                    position[number] = value;
                }
            }
            if self.width.is_none() {
                tokens.take_line();
            }
            vertices.push(position);
        }
        let mut faces = Faces::default();
        let mut corners = Vec::new();
        for read in 0..face_count {
            // Colours end with their line, so the next face begins one. Faces that don't show that a number is
            // missing before.
            if self.colours && !tokens.at_line_end() {
                return Err(tokens.fault("a face begins within a line"));
            }
            face(&mut tokens, read, face_count, vertices.len(), &mut corners)?;
            faces.push(&corners, &vertices);
            if self.colours {
                let mut numbers = 0;
                while !tokens.at_line_end() {
                    tokens.number("a colour")?;
                    numbers += 1;
                }
                if ![0, 1, 3, 4].contains(&numbers) {
                    return Err(
                        tokens.fault(format!("{numbers} numbers follow a face; a colour has 1, 3 or 4"))
                    );
                }
            }
        }
        match tokens.next() {
            None => Ok(parsed(vertices, faces, None)),
            Some(word) => Err(tokens.fault(format!(
                "{} follows the last face; the counts are wrong, or a number is missing or too many before",
                show(word)
            ))),
        }
    }
}

fn coordinate(tokens: &mut Tokens, number: usize, read: usize, declared: usize) -> Result<f64, Fault> {
    let what =
        ["coordinate x", "coordinate y", "coordinate z"].get(number).unwrap_or(&"a number of a vertex");
    if tokens.clone().next().is_none() {
        return Err(ends_early(tokens, "vertices", read as u64, declared as u64));
    }
    let value = tokens.number(what)?;
    if value.is_finite() {
        return Ok(value);
    }
    Err(tokens.fault(format!("{what} is {value}; remove or repair it")))
}

fn ends_early(tokens: &Tokens, what: &str, read: u64, declared: u64) -> Fault {
    tokens.fault(format!(
        "the file ends after {read} of {declared} {what}; it is truncated or its counts are wrong; copy or export it again"
    ))
}

fn face(
    tokens: &mut Tokens,
    read: u64,
    declared: u64,
    vertices: usize,
    corners: &mut Vec<u32>,
) -> Result<(), Fault> {
    corners.clear();
    if tokens.clone().next().is_none() {
        return Err(ends_early(tokens, "faces", read, declared));
    }
    let count: u64 = tokens.whole("the face's number of corners")?;
    if count == 0 {
        return Err(tokens.fault("a face has no corners"));
    }
    for found in 0..count {
        let Some(word) = tokens.next() else {
            return Err(tokens.fault(format!("the face has {found} of its {count} corners")));
        };
        match crate::text::parse::<u32>(word) {
            Some(v) if (v as usize) < vertices => corners.push(v),
            _ => {
                let (last, word) = (vertices.saturating_sub(1), show(word));
                return Err(tokens.fault(format!(
                    "the face names vertex {word}, but vertices are numbered from 0 to {last}"
                )));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::off::parse;

    const TRIANGLES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

    #[test]
    fn lines_may_end_anywhere() {
        for text in [
            "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2\n1\n3 0 1\n3\n3 1 2\n3\n3 0 3\n2\n",
            "OFF 4 4 6 0 0 0 1 0 0 0 1 0 0 0 1 3 0 2 1 3 0 1 3 3 1 2 3 3 0 3 2",
            "OFF\n4\n4\n6\n0\n0\n0 1 0\n0 0 1 0 0 0 1\n3 0 2 1 3 0 1 3\n3 1 2 3 3 0 3 2\n",
            // Without the number of edges.
            "OFF\n4 4\n0 0 0 1 0 0\n0 1 0 0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n",
            // Colours at the end of a face's line, of any number.
            "OFF 4 4 0\n0 0 0 1 0 0\n0 1 0 0 0 1\n3 0 2 1 255 0 0\n3 0 1 3 7\n3 1 2 3\n3 0\n3 2 0.1 0.2 0.3 1\n",
            // Colours, normals and texture coordinates of vertices.
            "COFF 4 4 0\n0 0 0 9 9 9 9 1 0 0 9 9 9 9\n0 1 0 9 9 9 9 0 0\n1 9 9 9 9\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n",
            "COFF 4 4 0 0 0 0 9 9 9 1 0 0 9 9 9 0 1 0 9 9 9 0 0 1 9 9 9 3 0 2 1 3 0 1 3 3 1 2 3 3 0 3 2\n",
            "NOFF 4 4 0 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1 0 0 1 0 0 1 3 0 2 1 3 0 1 3 3 1 2 3 3 0 3 2\n",
            "STOFF 4 4 0 0 0 0 .5 .5 1 0 0 0 0 0 1 0 0 0 0 0 1 0 0 3 0 2 1 3 0 1 3 3 1 2 3 3 0 3 2\n",
            "OFF 4 4 0\n0 0 0 9 # 8\n1 0 0 9 9\n0 1 0\n0 0 1 9\n3 0 2\n1\n3 0 1 3 3 1 2 3\n3 0 3 2\n",
            "CNOFF 4 4 0\n0 0 0 1 0 0\n0 1 0 0 0 1 3 0 2 1\n3 0 1 3 3 1 2 3 3 0 3 2\n",
        ] {
            let parsed = parse(text.as_bytes()).unwrap();
            assert_eq!(parsed.vertices, [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]], "{text}");
            assert_eq!(parsed.triangles, TRIANGLES, "{text}");
            assert!(parsed.notes.is_empty());
        }
    }

    #[test]
    fn faults_are_those_of_the_layout_that_was_meant() {
        let message =
            |text: &str| parse(text.as_bytes()).map(|_| ()).unwrap_err().in_file("a".as_ref()).to_string();
        // One a line, with a number missing, which the next line must not lend.
        assert_eq!(message("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n"), "a:4: coordinate z is missing");
        assert_eq!(
            message("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n"),
            "a:6: the face has 2 of its 3 corners"
        );
        // Over line ends.
        let words = message("OFF 3 2 0 0 0 0\n1 0 0 0 1 0\n3 0 1\n9 3 0 2 1\n");
        assert_eq!(words, "a:4: the face names vertex \"9\", but vertices are numbered from 0 to 2");
        let nan = message("OFF 3 2 0 0 0 0\n1 0 0 0 nan 0\n3 0 1\n2 3 0 2 1\n");
        assert_eq!(nan, "a:2: coordinate y is NaN; remove or repair it");
        assert!(
            message("OFF 3 2 0 0 0 0 1 0 0\n0 1 0\n3 0 1\n2 3 0 2")
                .contains("the face has 2 of its 3 corners")
        );
    }
}

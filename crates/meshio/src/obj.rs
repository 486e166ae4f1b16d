//! Wavefront OBJ, read by tobj with the file's vertex order kept.
//!
//! tobj numbers vertices by first use within each group and drops unused ones. So positions are read
//! here, and tobj gets the surface's statements alone, with each vertex's own number for its
//! coordinates: it resolves polygons, texture and normal indices and negative indices, and the
//! numbers come back. (Its coordinates are f64, exact for numbers up to 2^53.)

use crate::error::Fault;
use crate::polygon::Faces;
use crate::read::{Parsed, note};
use crate::text::{Line, Lines, parse as number, show};
use std::io::Write;

pub(crate) fn parse(bytes: &[u8]) -> Result<Parsed, Fault> {
    let mut vertices = Vec::new();
    let mut others = [0usize; 2];
    let mut statements = Vec::with_capacity(bytes.len());
    let mut lines = Lines::new(bytes);
    while let Some(line) = lines.next() {
        let mut words = line.words();
        match words.next() {
            Some(b"v") => {
                // A vector is an infallible writer.
                let _ = writeln!(statements, "v {} 0 0", vertices.len());
                vertices.push(position(line)?);
            }
            Some(b"f") => {
                statements.push(b'f');
                push_words(&mut statements, words, &mut lines);
            }
            Some(b"p" | b"l") => others[0] += 1,
            Some(b"curv" | b"curv2" | b"surf") => others[1] += 1,
            _ => {}
        }
    }

    if vertices.is_empty() && statements.is_empty() {
        return Err(Fault::new("there is no vertex and no face of OBJ in it; is it of another format?"));
    }
    let options = tobj::LoadOptions { ignore_points: true, ignore_lines: true, ..Default::default() };
    // Without material statements there are no material files to load.
    let (models, _) =
        tobj::load_obj_buf(&mut &statements[..], &options, |_| Err(tobj::LoadError::GenericFailure))
            .map_err(|error| culprit(bytes, vertices.len(), error))?;
    drop(statements);

    let mut faces = Faces::default();
    let mut corners = Vec::new();
    for model in &models {
        let mesh = &model.mesh;
        let arities: &mut dyn Iterator<Item = usize> = match &mesh.face_arities[..] {
            [] => &mut std::iter::repeat_n(3, mesh.indices.len() / 3),
            arities => &mut arities.iter().map(|&n| n as usize),
        };
        let mut at = 0;
        for n in arities {
            corners.clear();
            corners.extend(mesh.indices[at..at + n].iter().map(|&i| mesh.positions[3 * i as usize] as u32));
            faces.push(&corners, &vertices);
            at += n;
        }
    }
    let notes = [
        note(faces.skipped, "faces of fewer than three corners left out"),
        note(others[0], "points and lines left out"),
        note(others[1], "free-form curves and surfaces left out; convert them to polygons if they matter"),
    ];
    let notes = notes.into_iter().flatten().collect();
    Ok(Parsed { vertices, triangles: faces.triangles, weld: None, polygons: faces.polygons, notes })
}

/// `v x y z`, `v x y z w` (homogeneous) or `v x y z r g b`.
fn position(line: Line) -> Result<[f64; 3], Fault> {
    let mut words = line.words().skip_keyword();
    let position = words.position()?;
    let mut rest = words.clone();
    if rest.next().is_none() || rest.next().is_some() {
        return Ok(position);
    }
    let weight = words.number("the vertex's weight")?;
    let position = position.map(|x| x / weight);
    if position.iter().any(|x| !x.is_finite()) {
        return Err(Fault::at(
            line.number,
            "the vertex's weight is zero: it lies at infinity; remove or repair it",
        ));
    }
    Ok(position)
}

/// Copies the words of a statement, and of the lines that a backslash continues it on.
fn push_words<'a>(out: &mut Vec<u8>, words: impl Iterator<Item = &'a [u8]>, lines: &mut Lines<'a>) {
    let mut continued = copy(out, words);
    while continued && let Some(line) = lines.next() {
        continued = copy(out, line.words());
    }
    out.push(b'\n');
}

fn copy<'a>(out: &mut Vec<u8>, words: impl Iterator<Item = &'a [u8]>) -> bool {
    let mut continued = false;
    for word in words {
        continued = word.ends_with(b"\\");
        out.push(b' ');
        out.extend_from_slice(word.strip_suffix(b"\\").unwrap_or(word));
    }
    continued
}

/// Finds the line of the face that tobj rejects, because its errors don't say.
fn culprit(bytes: &[u8], vertices: usize, error: tobj::LoadError) -> Fault {
    let mut before = 0;
    let mut is_face = false;
    for line in Lines::new(bytes) {
        let mut words = line.words();
        let continues = line.text.trim_ascii_end().ends_with(b"\\");
        if !is_face {
            match words.next() {
                Some(b"v") => before += 1,
                Some(b"f") => is_face = true,
                _ => {}
            }
        }
        if is_face {
            for word in words.map(|w| w.strip_suffix(b"\\").unwrap_or(w)).filter(|w| !w.is_empty()) {
                if let Some(reason) = wrong_corner(word, before, vertices) {
                    return Fault::at(line.number, reason);
                }
            }
        }
        is_face &= continues;
    }
    Fault::new(format!("the faces cannot be read: {error}"))
}

/// What is wrong with a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`, given the vertices before it and in all.
fn wrong_corner(word: &[u8], before: i64, vertices: usize) -> Option<String> {
    let mut parts = word.split(|&b| b == b'/');
    let index: Option<i64> = parts.next().and_then(number);
    let others = parts.all(|p| p.is_empty() || number::<i64>(p).is_some());
    let Some(index) = index.filter(|_| others && word.iter().filter(|&&b| b == b'/').count() <= 2) else {
        return Some(format!("the face has a corner {}; expected v, v/vt, v//vn or v/vt/vn", show(word)));
    };
    let found = if index < 0 { before + index } else { index - 1 };
    (found < 0 || found >= vertices as i64)
        .then(|| format!("the face names vertex {index}, but there are {vertices} vertices, numbered from 1"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_is_the_files_with_groups_duplicates_and_unused_vertices() {
        let parsed = parse(
            b"# comment \xff\nmtllib none.mtl\nv 9 9 9\no a\nv 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0\nv 0 0 0\n\
              vn 0 0 1\ng b\nusemtl m\nf 4//1 3//1 2//1\ng c\nf 5 3 4\nv 2 2 2\ng b\nf -1 -2 -4 # tail\n",
        )
        .unwrap();
        assert_eq!(parsed.vertices.len(), 6);
        assert_eq!(parsed.vertices[0], [9.0; 3]);
        assert_eq!(parsed.vertices[1], parsed.vertices[4]);
        assert_eq!(parsed.triangles, [[3, 2, 1], [4, 2, 3], [5, 4, 2]]);
    }

    #[test]
    fn polygons_continued_lines_and_weights() {
        let parsed =
            parse(b"v 0 0 0 1\nv 2 0 0 2\nv 1 1 0\nv 0 1 0\nv 5 5 5\nf 1/7 2/7 \\\n 3/7 4/7\nf 1 2\nl 1 2\n")
                .unwrap();
        assert_eq!(parsed.vertices[1], [1.0, 0.0, 0.0]);
        assert_eq!(parsed.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!((parsed.polygons, parsed.notes.len()), (1, 1));
    }

    #[test]
    fn coordinates_keep_their_17_digits() {
        let parsed = parse(b"v 0.1234567890123456 16777217 1e-300\nv 1 0 0\nv 0 1 0\nf 1 2 3").unwrap();
        assert_eq!(parsed.vertices[0], [0.1234567890123456, 16777217.0, 1e-300]);
    }

    #[test]
    fn wrong_faces_are_found_by_line() {
        for (face, line) in
            [("f 1 2 9", 4), ("f 1 2 0", 4), ("f 1 2 -4", 4), ("f 1 2 x", 4), ("f 1 2 \\\n7", 5)]
        {
            let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{face}\n");
            let fault = format!("{:?}", parse(text.as_bytes()).map(|_| ()).unwrap_err());
            assert!(fault.contains(&format!("line: Some({line})")), "{face}: {fault}");
        }
    }
}

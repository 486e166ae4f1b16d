//! Left-right symmetry maps: `isym` of a MAT-file, numbered from 1, or a plain list.

use std::path::Path;

use mser3d_fileio::InputFile;

use crate::{EvaluationError, mat5};

/// Reads a left-right symmetry for [`NullShape::with_symmetry`](crate::NullShape::with_symmetry): the
/// variable `isym` of a MAT-file, or a plain list. Line or entry i is the vertex that mirrors vertex i;
/// vertices count from 0 or from 1, which the file shows by naming vertex 0 or not.
///
/// # Errors
/// [`EvaluationError::Read`], [`EvaluationError::BadFile`] or [`EvaluationError::BadLine`].
pub fn read_symmetry(path: &Path, vertices: usize) -> Result<Vec<u32>, EvaluationError> {
    let bytes =
        InputFile::read_all(path).map_err(|source| EvaluationError::Read { path: path.into(), source })?;
    parse(&bytes, path, vertices)
}

/// The mirror vertex of each vertex, from 0, of a file that is a MAT-file or a text.
///
/// A list that names vertex 0 counts from 0, one that names vertex n of n counts from 1. (A
/// symmetry is one to one, so one of them occurs.)
fn parse(bytes: &[u8], path: &Path, vertices: usize) -> Result<Vec<u32>, EvaluationError> {
    let bad = |problem: String| EvaluationError::BadFile { path: path.into(), problem };
    let numbers = if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("mat")) {
        mat5::variable(bytes, "isym").map_err(bad)?
    } else {
        list(bytes, path)?
    };
    if numbers.len() != vertices {
        let problem = format!("{} entries, but the null shape has {vertices} vertices", numbers.len());
        return Err(bad(problem));
    }
    let first = if numbers.contains(&0.0) { 0.0 } else { 1.0 };
    let index = |x: &f64| {
        let index = x - first;
        let good = index.fract() == 0.0 && index >= 0.0 && index < vertices as f64;
        good.then_some(index as u32).ok_or_else(|| {
            bad(format!("vertex {x}, but the null shape has {vertices}, counted from {first}"))
        })
    };
    numbers.iter().map(index).collect()
}

fn list(bytes: &[u8], path: &Path) -> Result<Vec<f64>, EvaluationError> {
    let text = std::str::from_utf8(bytes)
        .map_err(|_| EvaluationError::BadFile { path: path.into(), problem: "not a text".into() })?;
    let mut numbers = Vec::new();
    for (line, words) in text.lines().enumerate() {
        for word in words.split_ascii_whitespace() {
            let problem = format!("{word:?} is not a number");
            let error = |_| EvaluationError::BadLine { path: path.into(), line: line + 1, problem };
            numbers.push(word.parse().map_err(error)?);
        }
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_count_from_0_or_from_1() {
        let read = |text: &str| parse(text.as_bytes(), Path::new("s.txt"), 3);
        assert_eq!(read("2\n1\n0\n").unwrap(), [2, 1, 0]);
        assert_eq!(read("3 2 1").unwrap(), [2, 1, 0]);
        for (text, problem) in [
            ("1 2", "s.txt: 2 entries"),
            ("1 2 4", "vertex 4"),
            ("0 1 3", "vertex 3"),
            ("1 2\nx", "s.txt:2: \"x\""),
            ("1 2 2.5", "vertex 2.5"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(problem), "{error}");
        }
    }
}

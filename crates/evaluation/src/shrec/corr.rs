//! `.corr`: eight columns a row. Triangle of the null shape, numbered from 1, and three barycentric
//! weights; triangle of the transformed shape and three weights, one of which is 1, so that it names
//! a vertex.

use std::fmt::Write;
use std::path::Path;

use mser3d_shape::TriangleMesh;

use super::Transformed;
use crate::{EvaluationError, SurfacePoint};

/// How far the weights' sum, or the one weight of a vertex, may be from 1: files have few digits.
const TOLERANCE: f64 = 1e-3;

/// The null shape's point of each transformed vertex that a row names; of several rows, the first.
pub(super) fn parse(
    text: &str,
    path: &Path,
    null: &TriangleMesh,
    transformed: &TriangleMesh,
) -> Result<Vec<Option<SurfacePoint>>, EvaluationError> {
    let mut points = vec![None; transformed.vertices().len()];
    for (number, line) in text.lines().enumerate() {
        let at = |problem: String| EvaluationError::BadLine { path: path.into(), line: number + 1, problem };
        let mut columns = Vec::with_capacity(8);
        for word in line.split_ascii_whitespace() {
            let number: f64 = word.parse().map_err(|_| at(format!("{word:?} is not a number")))?;
            columns.push(number);
        }
        if columns.is_empty() {
            continue;
        }
        let &[null_triangle, a, b, c, triangle, d, e, f] = &columns[..] else {
            return Err(at(format!("{} columns, 8 needed", columns.len())));
        };
        let index = |what: &str, number: f64, mesh: &TriangleMesh| {
            let count = mesh.triangles().len();
            let whole = number >= 1.0 && number <= count as f64 && number.fract() == 0.0;
            whole.then(|| number as u32 - 1).ok_or_else(|| {
                at(format!("triangle {number} of the {what} shape, which has triangles 1 to {count}"))
            })
        };
        let weights = [a, b, c];
        let near_one = |x: f64| (x - 1.0).abs() <= TOLERANCE;
        let sum: f64 = weights.iter().sum();
        if !near_one(sum) {
            return Err(at(format!("the barycentric weights on the null shape sum to {sum}, not 1")));
        }
        let point = SurfacePoint { triangle: index("null", null_triangle, null)?, weights };
        let corners = transformed.triangles()[index("transformed", triangle, transformed)? as usize];
        let corner = [d, e, f].iter().position(|w| near_one(*w)).ok_or_else(|| {
            at("no barycentric weight on the transformed shape is 1: the row names no vertex".into())
        })?;
        points[corners[corner] as usize].get_or_insert(point);
    }
    Ok(points)
}

/// One row for each vertex that is part of a triangle and has a point, by ascending number.
pub(super) fn format(transformed: &Transformed) -> String {
    let mut text = String::new();
    let own = SurfacePoint::vertices_of(&transformed.mesh);
    for (null, own) in transformed.points.iter().zip(own) {
        let (Some(null), Some(own)) = (null, own) else { continue };
        let ([a, b, c], [d, e, f]) = (null.weights, own.weights);
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{} {a} {b} {c} {} {d} {e} {f}", null.triangle + 1, own.triangle + 1);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> TriangleMesh {
        let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
        TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]).unwrap()
    }

    #[test]
    fn rows_name_vertices_and_points() {
        let mesh = tetrahedron();
        let text = "3 0.25 0.25 0.5 1 0 1 0\n\n1 1 0 0 2 0 0 1\n1 0 1 0 1 0 1 0\n";
        let points = parse(text, Path::new("x.corr"), &mesh, &mesh).unwrap();
        let middle = SurfacePoint { triangle: 2, weights: [0.25, 0.25, 0.5] };
        assert_eq!(points, [None, None, Some(middle), Some(SurfacePoint::corner(0, 0))]);
    }

    #[test]
    fn what_is_written_is_read_again() {
        let mesh = tetrahedron();
        let points: Vec<_> = (0..4)
            .map(|t| Some(SurfacePoint { triangle: t, weights: [0.1, 0.2, 1.0 - 0.1 - 0.2] }))
            .collect();
        let text = format(&Transformed { mesh: mesh.clone(), points: points.clone() });
        assert_eq!(parse(&text, Path::new("x.corr"), &mesh, &mesh).unwrap(), points);
    }

    #[test]
    fn wrong_rows_are_named() {
        let mesh = tetrahedron();
        for (row, problem) in [
            ("1 1 0 0 1 1 0", "7 columns"),
            ("1 1 0 0 1 1 0 zero", "\"zero\" is not a number"),
            ("5 1 0 0 1 1 0 0", "triangle 5 of the null shape"),
            ("0 1 0 0 1 1 0 0", "triangle 0 of the null shape"),
            ("1 1 0 0 1.5 1 0 0", "triangle 1.5 of the transformed shape"),
            ("1 1 1 0 1 1 0 0", "sum to 2"),
            ("1 NaN 0 0 1 1 0 0", "sum to NaN"),
            ("1 1 0 0 1 0.5 0.5 0", "names no vertex"),
        ] {
            let text = format!("1 1 0 0 1 1 0 0\n{row}\n");
            let error = parse(&text, Path::new("x.corr"), &mesh, &mesh).unwrap_err().to_string();
            assert!(error.starts_with("x.corr:2: ") && error.contains(problem), "{error}");
        }
    }
}

//! Scores a detector on a synthetic benchmark: the shape is transformed in known ways, regions are detected on each
//! transform, and are compared with those of the shape itself.
//!
//! Put your own detector in place of `detect`. `BenchmarkWriter` writes the transforms as files, for tools in other
//! languages.

use std::error::Error;
use std::f64::consts::TAU;

use mser3d_evaluation::shape::TriangleMesh;
use mser3d_evaluation::shrec::{Class, ShapeName, ShapeScore, mean_score, transform};
use mser3d_evaluation::{Correspondence, DetectedRegions, IndexSet, NullShape, Score};

/// Prints the mean repeatability of each class.
pub fn main() -> Result<(), Box<dyn Error>> {
    let null = NullShape::new(torus(60, 30)?);
    let on_null = detect(null.mesh());
    let mut scores = Vec::new();
    for class in [Class::Affine, Class::Noise, Class::Partial, Class::Sampling] {
        for strength in 1..=5 {
            let transformed = transform(null.mesh(), class, strength, 1)?;
            let shape = ShapeName { null: 1, class: class.to_string(), strength };
            let correspondence = Correspondence::new(null.mesh(), &transformed.mesh, &transformed.points)?;
            let score = Score::new(&null, &on_null, &detect(&transformed.mesh), &correspondence)?;
            scores.push(ShapeScore { shape, score });
        }
        let mean = mean_score(&scores, |s| s.class == class.to_string(), |s| s.repeatability(0.8));
        println!("{class:10} repeatability at overlap 0.8: {:.2}", mean.unwrap_or(0.0));
    }
    Ok(())
}

/// A detector that knows nothing of shapes: the parts left and right of the middle.
fn detect(mesh: &TriangleMesh) -> DetectedRegions {
    let vertices = mesh.vertices();
    let middle = vertices.iter().map(|p| p[0]).sum::<f64>() / vertices.len() as f64;
    let side = |sign: f64| IndexSet::from_fn(vertices.len(), |v| sign * (vertices[v][0] - middle) > 0.0);
    DetectedRegions { regions: vec![side(1.0), side(-1.0)], descriptors: Vec::new() }
}

/// A closed surface of m x n quadrilaterals, each cut in two.
fn torus(m: u32, n: u32) -> Result<TriangleMesh, Box<dyn Error>> {
    let place = |i: u32, j: u32| {
        let (a, b) = (TAU * f64::from(i) / f64::from(m), TAU * f64::from(j) / f64::from(n));
        [(1.0 + 0.4 * b.cos()) * a.cos(), (1.0 + 0.4 * b.cos()) * a.sin(), 0.4 * b.sin()]
    };
    let number = |i: u32, j: u32| (i % m) * n + j % n;
    let cells = || (0..m).flat_map(move |i| (0..n).map(move |j| (i, j)));
    let triangles = cells().flat_map(|(i, j)| {
        let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    Ok(TriangleMesh::new(cells().map(|(i, j)| place(i, j)).collect(), triangles.collect())?)
}

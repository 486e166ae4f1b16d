//! Shapes without parts have no regions, whatever their size, orientation, and order of triangles.

use std::f64::consts::TAU;

use mser3d::shape::TriangleMesh;
use mser3d::voxelize::Pitch;
use mser3d::{Detector, Input, Parameters};

use crate::{cuboid, shared};

/// The closed surface around z of a profile of (radius, z) from axis to axis.
fn revolved(profile: &[(f64, f64)]) -> TriangleMesh {
    let n = 64;
    let rings = &profile[1..profile.len() - 1];
    let mut vertices = vec![[0.0, 0.0, profile[0].1], [0.0, 0.0, profile[profile.len() - 1].1]];
    for &(radius, z) in rings {
        vertices.extend((0..n).map(|i| {
            let (sin, cos) = (TAU * f64::from(i) / f64::from(n)).sin_cos();
            [radius * cos, radius * sin, z]
        }));
    }
    let at = |ring: usize, i: u32| 2 + ring as u32 * n + i % n;
    let mut triangles = Vec::new();
    for i in 0..n {
        triangles.push([0, at(0, i + 1), at(0, i)]);
        triangles.push([1, at(rings.len() - 1, i), at(rings.len() - 1, i + 1)]);
        for ring in 1..rings.len() {
            let [a, b, c, d] = [at(ring - 1, i), at(ring - 1, i + 1), at(ring, i + 1), at(ring, i)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}

fn ball() -> TriangleMesh {
    let profile: Vec<(f64, f64)> = (0..=32)
        .map(|i| (TAU / 64.0 * f64::from(i) - TAU / 4.0).sin_cos())
        .map(|(sin, cos)| (cos, sin))
        .collect();
    revolved(&profile)
}

fn cylinder(length: f64) -> TriangleMesh {
    revolved(&[(0.0, 0.0), (1.0, 0.0), (1.0, length), (0.0, length)])
}

fn torus(radius: f64) -> TriangleMesh {
    let (n, m) = (96_u32, 48_u32);
    let vertex = |i: u32| {
        let ((s, c), (t, d)) = (
            (TAU * f64::from(i / m) / f64::from(n)).sin_cos(),
            (TAU * f64::from(i % m) / f64::from(m)).sin_cos(),
        );
        [(radius + d) * c, (radius + d) * s, t]
    };
    let at = |i: u32, j: u32| i % n * m + j % m;
    let triangles = (0..n * m).flat_map(|k| {
        let (i, j) = (k / m, k % m);
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    TriangleMesh::new((0..n * m).map(vertex).collect(), triangles.collect()).unwrap()
}

fn brick(sides: [f64; 3]) -> TriangleMesh {
    let (vertices, triangles) = cuboid([0.0; 3], sides);
    TriangleMesh::new(vertices, triangles).unwrap()
}

/// The same shape turned about an odd axis, moved, scaled, and with its triangles in another order.
fn other_file(mesh: &TriangleMesh) -> TriangleMesh {
    let ([x, y, z], angle) = ([0.36, 0.48, 0.8], 1.1_f64);
    let (s, c) = angle.sin_cos();
    let k = 1.0 - c;
    let turn = [
        [c + x * x * k, x * y * k - z * s, x * z * k + y * s],
        [y * x * k + z * s, c + y * y * k, y * z * k - x * s],
        [z * x * k - y * s, z * y * k + x * s, c + z * z * k],
    ];
    let moved = |p: &[f64; 3]| turn.map(|row| 1000.0 + 37.0 * (0..3).map(|a| row[a] * p[a]).sum::<f64>());
    let mut triangles: Vec<[u32; 3]> = mesh.triangles().iter().map(|&[a, b, c]| [b, c, a]).collect();
    let count = triangles.len();
    triangles.rotate_left(count / 3);
    triangles.reverse();
    TriangleMesh::new(mesh.vertices().iter().map(moved).collect(), triangles).unwrap()
}

fn nothing_at(voxels: usize) {
    let mut shapes = vec![("ball".to_owned(), ball()), ("cube".into(), brick([1.0; 3]))];
    shapes.extend([1.6, 3.0].map(|radius| (format!("torus {radius}"), torus(radius))));
    shapes.extend([1.0, 4.0, 5.0, 12.0].map(|length| (format!("cylinder {length}"), cylinder(length))));
    shapes.extend([[1.0, 1.0, 5.0], [1.0, 2.0, 3.0], [1.0, 1.0, 0.1]].map(|s| (format!("{s:?}"), brick(s))));
    for name in ["ball", "cube"] {
        shapes.extend(shared(&format!("cases/ball/{name}.off")).map(|mesh| (format!("{name}.off"), mesh)));
    }
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(voxels);
    for (name, mesh) in shapes {
        for (turned, mesh) in [(false, &mesh), (true, &other_file(&mesh))] {
            let features = Detector::new(parameters.clone()).detect(Input::Volume(mesh)).unwrap();
            let found: Vec<f64> = features.regions.iter().map(|r| r.volume_fraction).collect();
            assert!(found.is_empty(), "{name}, turned: {turned}, {voxels} voxels: {found:?}");
        }
    }
}

#[test]
fn shapes_without_parts_have_no_regions() {
    nothing_at(10_000);
}

/// Takes a minute: `cargo test --release -p mser3d --test it -- --ignored`.
#[test]
#[ignore = "a minute"]
fn shapes_without_parts_have_no_regions_at_45k_and_200k_voxels() {
    nothing_at(45_000);
    nothing_at(200_000);
}

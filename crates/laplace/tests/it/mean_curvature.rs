//! Mean curvature where it is known.

use std::f64::consts::TAU;

use mser3d_laplace::mean_curvature;
use mser3d_shape::{SplitMix64, TriangleMesh};

/// A surface over a rectangle of m x n parameters; closed along an axis where `closed` says so.
fn patch(m: u32, n: u32, closed: [bool; 2], at: impl Fn(f64, f64) -> [f64; 3]) -> TriangleMesh {
    let steps = |n: u32, closed: bool| f64::from(if closed { n } else { n - 1 });
    let (du, dv) = (1.0 / steps(m, closed[0]), 1.0 / steps(n, closed[1]));
    let vertices = (0..m * n).map(|i| at(f64::from(i / n) * du, f64::from(i % n) * dv)).collect();
    let number = |i: u32, j: u32| i % m * n + j % n;
    let (rows, columns) = (if closed[0] { m } else { m - 1 }, if closed[1] { n } else { n - 1 });
    let quads = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
    let triangles = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    TriangleMesh::new(vertices, triangles.collect()).unwrap()
}

/// A sphere around a point: an octahedron, subdivided; its vertices moved along the sphere at random.
fn sphere(radius: f64, centre: f64, subdivisions: usize, unevenness: f64) -> TriangleMesh {
    let mut points: Vec<[f64; 3]> =
        vec![[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..subdivisions {
        let mut middles = std::collections::HashMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |u: u32, v: u32| {
                *middles.entry((u.min(v), u.max(v))).or_insert_with(|| {
                    let (p, q) = (points[u as usize], points[v as usize]);
                    points.push(std::array::from_fn(|x| (p[x] + q[x]) / 2.0));
                    points.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    let mut random = SplitMix64::new(1);
    let edge = 1.5 / (1u32 << subdivisions) as f64;
    let vertices = points.into_iter().map(|p| {
        let norm = p.iter().map(|x| x * x).sum::<f64>().sqrt();
        let p = p.map(|x| x / norm + unevenness * edge * (random.uniform() - 0.5));
        let norm = p.iter().map(|x| x * x).sum::<f64>().sqrt();
        p.map(|x| radius * x / norm + centre)
    });
    TriangleMesh::new(vertices.collect(), triangles).unwrap()
}

fn worst(found: &[f64], expected: impl Fn(usize) -> f64) -> f64 {
    found.iter().enumerate().map(|(v, h)| (h - expected(v)).abs()).fold(0.0, f64::max)
}

#[test]
fn a_sphere_of_radius_r_has_one_over_r_everywhere() {
    for (radius, centre) in [(1.0, 0.0), (4.0, 1000.0), (1e-3, 0.0)] {
        let h = mean_curvature(&sphere(radius, centre, 4, 0.0)).unwrap();
        let error = worst(&h, |_| 1.0 / radius) * radius;
        assert!(error < 2e-3, "{error} at radius {radius}");
        // Uneven triangles. Where six meet or four, the areas of the nearest cells differ from a third of the triangles':
        // with those the error would be a half.
        let h = mean_curvature(&sphere(radius, centre, 4, 0.2)).unwrap();
        let error = worst(&h, |_| 1.0 / radius) * radius;
        assert!(error < 0.12, "{error} at radius {radius}");
    }
}

#[test]
fn a_torus_has_its_own_around_the_tube() {
    let (large, small) = (1.0, 0.4);
    let (m, n) = (120, 60);
    let ring = |v: f64| large + small * (TAU * v).cos();
    let torus = patch(m, n, [true; 2], |u, v| {
        [ring(v) * (TAU * u).cos(), ring(v) * (TAU * u).sin(), small * (TAU * v).sin()]
    });
    let h = mean_curvature(&torus).unwrap();
    // Half of 1/r and of the curvature along the ring, which is negative on the inside.
    let expected = |i: usize| {
        let angle = TAU * (i % n as usize) as f64 / f64::from(n);
        (1.0 / small + angle.cos() / (large + small * angle.cos())) / 2.0
    };
    let error = worst(&h, expected);
    assert!(error < 0.01, "{error}");
    assert!(expected(0) > 1.5 && expected(n as usize / 2) < 0.5);
}

#[test]
fn a_pipe_has_half_of_one_over_r_to_its_ends_and_a_saddle_nothing() {
    let pipe = patch(64, 40, [true, false], |u, v| [2.0 * (TAU * u).cos(), 2.0 * (TAU * u).sin(), 5.0 * v]);
    let error = worst(&mean_curvature(&pipe).unwrap(), |_| 0.25);
    assert!(error < 1e-3, "{error}");
    // A minimal surface: Enneper's.
    let enneper = patch(61, 61, [false; 2], |u, v| {
        let (u, v) = (u - 0.5, v - 0.5);
        [u - u.powi(3) / 3.0 + u * v * v, v - v.powi(3) / 3.0 + u * u * v, u * u - v * v]
    });
    let error = worst(&mean_curvature(&enneper).unwrap(), |_| 0.0);
    assert!(error < 0.01, "{error}");
}

#[test]
fn the_sign_is_that_of_the_body_and_of_the_triangles_of_an_open_surface() {
    let turned = |mesh: &TriangleMesh| {
        let triangles = mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
        TriangleMesh::new(mesh.vertices().to_vec(), triangles).unwrap()
    };
    let ball = sphere(1.0, 0.0, 3, 0.0);
    assert_eq!(mean_curvature(&turned(&ball)).unwrap(), mean_curvature(&ball).unwrap());
    let pipe = patch(24, 9, [true, false], |u, v| [(TAU * u).cos(), (TAU * u).sin(), v]);
    let [out, inwards] = [pipe.clone(), turned(&pipe)].map(|mesh| mean_curvature(&mesh).unwrap());
    assert!(out.iter().zip(&inwards).all(|(a, b)| (a + b).abs() < 1e-12 && *a > 0.4), "{out:?}");
}

#[test]
fn what_has_no_curvature_gets_none() {
    // A square of two triangles, a vertex that no triangle has, and a triangle without area.
    let corners = vec![[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.], [9., 9., 9.]];
    let mesh = TriangleMesh::new(corners, vec![[0, 1, 2], [0, 2, 3], [0, 0, 1]]).unwrap();
    assert_eq!(mean_curvature(&mesh).unwrap(), [0.0; 5]);
}

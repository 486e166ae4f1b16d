//! Pseudo-scalar fields, on functions whose products are known.

use super::common::with_threads;
use mser3d_descriptors::*;
use mser3d_shape::{Affine, BitGrid, Domain, Eigenbasis, Frame, TriangleMesh, VoxelGrid};

const SIDE: usize = 16;

fn times(three: [f64; 3]) -> ChiralityParameters {
    ChiralityParameters { times: three.map(TimeScale::Absolute).to_vec() }
}

/// A cube from -1 to 1 with the functions 1, x, y, z and, as one that has long died out, x y z, each of norm 1; the decay of
/// x, y and z is given, and x may run backwards.
fn cube(decay: [f64; 3], direction: f64) -> (VoxelGrid, Eigenbasis) {
    let h = 2.0 / SIDE as f64;
    let steps = [[direction * h, 0.0, 0.0], [0.0, h, 0.0], [0.0, 0.0, h]];
    let first = 1.0 - 0.5 * h;
    let affine = Affine::from_steps([-direction * first, -first, -first], steps).unwrap();
    let frame = Frame::placed([SIDE; 3], &affine).unwrap();
    let grid = VoxelGrid::solid(frame, BitGrid::full([SIDE; 3]).unwrap()).unwrap();
    let mut functions: Vec<[f64; 5]> = grid
        .voxels()
        .map(|v| {
            let [x, y, z] = frame.centre(v);
            [1.0, x, y, z, x * y * z]
        })
        .collect();
    let mass = h * h * h;
    for i in 0..5 {
        let length = functions.iter().map(|f| mass * f[i] * f[i]).sum::<f64>().sqrt();
        functions.iter_mut().for_each(|f| f[i] /= length);
    }
    let [a, b, c] = decay;
    let basis =
        Eigenbasis::new(Domain::Volume, vec![mass; grid.len()], vec![0.0, a, b, c, 1e4], functions.concat());
    (grid, basis.unwrap())
}

/// The correlation of the only field with x y z.
fn with_xyz(decay: [f64; 3], direction: f64, three: [f64; 3]) -> f64 {
    let (grid, basis) = cube(decay, direction);
    let chirality = chirality_of_solid(&basis, &grid, 1.0, &times(three)).unwrap();
    assert_eq!(chirality.fields(), 1);
    chirality.correlations(&[0.0, 0.0, 0.0, 0.0, 2.0])[0]
}

#[test]
fn the_field_of_squares_is_the_root_of_xyz() {
    // H_t = a(t) + b(t) x^2 + c(t) y^2 + d(t) z^2 has the gradient (2 b x, 2 c y, 2 d z) / H_t, so that
    // D is x y z det(b, c, d at the three times), over a factor that is nearly constant at late times. With the decays
    // 4, 6, 8 and ascending times the determinant is that of a Vandermonde matrix in e^-2t: the product of
    // the differences of descending numbers, which is negative three times.
    let h = 2.0 / SIDE as f64;
    let [mut product, mut squares, mut places] = [0.0f64; 3];
    for i in 0..SIDE {
        // The slope of x^2, half of it at the border, where no heat gets out.
        let x = |i: usize| (i as f64 + 0.5) * h - 1.0;
        let (before, after) = (x(i.saturating_sub(1)), x((i + 1).min(SIDE - 1)));
        let root = ((after * after - before * before) / (2.0 * h)).cbrt();
        product += root * x(i);
        squares += root * root;
        places += x(i) * x(i);
    }
    let expected = -(product / (squares * places).sqrt()).powi(3);
    let found = with_xyz([4.0, 6.0, 8.0], 1.0, [0.7, 1.0, 1.5]);
    assert!((found - expected).abs() < 0.01, "{found} {expected}");
}

#[test]
fn exchanging_two_times_changes_the_sign() {
    let found = with_xyz([4.0, 6.0, 8.0], 1.0, [0.7, 1.0, 1.5]);
    assert!((with_xyz([4.0, 6.0, 8.0], 1.0, [1.0, 0.7, 1.5]) + found).abs() < 1e-12);
    // All three in turn do not.
    assert!((with_xyz([4.0, 6.0, 8.0], 1.0, [1.0, 1.5, 0.7]) - found).abs() < 1e-12);
}

#[test]
fn a_frame_of_the_left_hand_gives_what_the_world_has() {
    let right = with_xyz([4.0, 6.0, 8.0], 1.0, [0.7, 1.0, 1.5]);
    assert!((with_xyz([4.0, 6.0, 8.0], -1.0, [0.7, 1.0, 1.5]) - right).abs() < 1e-12);
}

#[test]
fn even_functions_and_flat_solids_have_no_side() {
    let (grid, basis) = cube([4.0, 6.0, 8.0], 1.0);
    let chirality = chirality_of_solid(&basis, &grid, 1.0, &times([0.7, 1.0, 1.5])).unwrap();
    for even in [[1.0, 0.0, 0.0, 0.0, 0.0], [0.0, 1.0, -2.0, 3.0, 0.0]] {
        assert!(chirality.correlations(&even)[0].abs() < 1e-12);
    }
    assert_eq!(chirality.correlations(&[0.0; 5]), [0.0]);
    // One layer: no slope across it.
    let flat = VoxelGrid::solid(
        Frame::new([5, 4, 1], [0.0; 3], [1.0; 3]).unwrap(),
        BitGrid::full([5, 4, 1]).unwrap(),
    );
    let basis = super::common::box_basis([5, 4, 1], 1.0);
    let field = chirality_of_solid(&basis, &flat.unwrap(), 1.0, &ChiralityParameters::default()).unwrap();
    assert_eq!(field.correlations(&[1.0; 20]), [0.0; 20]);
}

/// A flat square from -1 to 1 with the functions 1, x, y and x y.
fn square(reversed: bool) -> (TriangleMesh, Eigenbasis) {
    let n = 20u32;
    let at = |i: u32| 2.0 * f64::from(i) / f64::from(n) - 1.0;
    let number = |i: u32, j: u32| j * (n + 1) + i;
    let vertices: Vec<[f64; 3]> = (0..=n).flat_map(|j| (0..=n).map(move |i| [at(i), at(j), 0.0])).collect();
    let cell = |i, j| {
        let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
        if reversed { [[a, c, b], [a, d, c]] } else { [[a, b, c], [a, c, d]] }
    };
    let triangles = (0..n).flat_map(|j| (0..n).flat_map(move |i| cell(i, j))).collect();
    let mesh = TriangleMesh::new(vertices, triangles).unwrap();
    let mass = mesh.vertex_areas();
    let mut functions: Vec<[f64; 4]> = mesh.vertices().iter().map(|&[x, y, _]| [1.0, x, y, x * y]).collect();
    for i in 0..4 {
        let length = functions.iter().zip(&mass).map(|(f, m)| m * f[i] * f[i]).sum::<f64>().sqrt();
        functions.iter_mut().for_each(|f| f[i] /= length);
    }
    let basis = Eigenbasis::new(Domain::Surface, mass, vec![0.0, 4.0, 6.0, 1e4], functions.concat()).unwrap();
    (mesh, basis)
}

#[test]
fn on_a_surface_the_normal_takes_the_place_of_a_gradient() {
    let of = |reversed| {
        let (mesh, basis) = square(reversed);
        let params = times([0.7, 1.0, 1.5]);
        let field = chirality_of_surface(&basis, &mesh, 1.0, &params).unwrap();
        assert_eq!(field.fields(), 3);
        field.correlations(&[0.0, 0.0, 0.0, 1.0])
    };
    // The root of x y, correlated with x y: (2/5)^2 / (1/2 1/3); the determinant of e^-4t, e^-6t at two times is negative.
    let expected = -(2.0f64 / 5.0).powi(2) / (1.0 / 6.0);
    for found in of(false) {
        assert!((found - expected).abs() < 0.02, "{found} {expected}");
    }
    let back: Vec<f64> = of(true).iter().map(|x| -x).collect();
    assert!(back.iter().zip(of(false)).all(|(a, b)| (a - b).abs() < 1e-12));
}

#[test]
fn an_inside_out_mesh_has_the_same_sides() {
    let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
    let outward = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    let inward = outward.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let basis = Eigenbasis::new(
        Domain::Surface,
        vec![1.0; 4],
        vec![0.0, 1.0, 2.0, 3.0],
        vec![0.5, 0.1, 0.7, 0.2, 0.5, -0.6, 0.2, 0.4, 0.5, 0.3, -0.5, 0.6, 0.5, 0.2, -0.4, -0.7],
    )
    .unwrap();
    let [out, inside] = [outward, inward].map(|triangles| {
        let mesh = TriangleMesh::new(corners.clone(), triangles).unwrap();
        chirality_of_surface(&basis, &mesh, 1.0, &ChiralityParameters::default()).unwrap()
    });
    assert!(out.correlations(&[1.0, 2.0, 3.0, 4.0]).iter().any(|x| x.abs() > 0.01));
    for function in [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 2.0, -1.0]] {
        let (a, b) = (out.correlations(&function), inside.correlations(&function));
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}

#[test]
fn threads_make_no_difference_and_wrong_input_is_refused() {
    let (grid, basis) = cube([4.0, 6.0, 8.0], 1.0);
    let run = || chirality_of_solid(&basis, &grid, 1.0, &ChiralityParameters::default()).unwrap();
    assert_eq!(with_threads(1, run), with_threads(3, run));
    let other = super::common::box_basis([3, 3, 3], 1.0);
    let error = chirality_of_solid(&other, &grid, 1.0, &ChiralityParameters::default()).unwrap_err();
    assert_eq!(error.to_string(), "elements of the eigenbasis: found 27, expected 4096");
    for times in [vec![], vec![TimeScale::Relative(0.1); 2], vec![TimeScale::Relative(0.1); 9]] {
        assert!(ChiralityParameters { times }.validate().is_err());
    }
    assert!(times([0.1, -1.0, 1.0]).validate().is_err());
}

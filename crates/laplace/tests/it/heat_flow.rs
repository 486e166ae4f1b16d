//! What heat does to a function, and harmonic functions.

use std::f64::consts::PI;

use mser3d_laplace::{LaplaceError, Operator, cotangent_laplacian, grid_laplacian};
use mser3d_shape::{BitGrid, Frame, SplitMix64, TriangleMesh, VoxelGrid};

fn rod(cells: usize, length: f64) -> Operator {
    let dims = [cells, 1, 1];
    let frame = Frame::new(dims, [0.0; 3], [length / cells as f64, 1.0, 1.0]).unwrap();
    grid_laplacian(&VoxelGrid::solid(frame, BitGrid::full(dims).unwrap()).unwrap())
}

fn noise(n: usize) -> Vec<f64> {
    let mut random = SplitMix64::new(5);
    (0..n).map(|_| random.uniform() - 0.3).collect()
}

fn integral(operator: &Operator, values: &[f64]) -> f64 {
    operator.mass().iter().zip(values).map(|(m, x)| m * x).sum()
}

#[test]
fn a_wave_on_a_rod_decays_as_its_eigenvalue_says() {
    let (cells, length) = (100, 2.0);
    let operator = rod(cells, length);
    for waves in [1.0, 4.0, 9.0] {
        let wave: Vec<f64> =
            (0..cells).map(|i| (waves * PI * (i as f64 + 0.5) / cells as f64).cos()).collect();
        let lambda = (waves * PI / length).powi(2);
        for t in [0.0, 0.01, 0.1, 1.0] {
            let after = operator.heat_flow(&wave, t).unwrap();
            for (a, b) in after.iter().zip(&wave) {
                // The rod's own eigenvalue, of a hundred cells, is a little less.
                let step = length / cells as f64;
                let own = 4.0 / (step * step) * (waves * PI / (2.0 * cells as f64)).sin().powi(2);
                assert!((own / lambda - 1.0).abs() < 0.01);
                assert!((a - b * (-own * t).exp()).abs() < 1e-9, "{waves} waves after {t}: {a} of {b}");
            }
        }
    }
}

#[test]
fn heat_keeps_the_integral_and_the_range_and_ends_at_the_mean() {
    let dims = [12, 9, 7];
    let mut inside = BitGrid::full(dims).unwrap();
    (0..9).for_each(|j| inside.set([5, j, 3], false));
    let grid = VoxelGrid::solid(Frame::new(dims, [0.0; 3], [1.0, 0.5, 2.0]).unwrap(), inside).unwrap();
    let operator = grid_laplacian(&grid);
    let values = noise(operator.len());
    let bounds = |x: &[f64]| x.iter().fold([f64::MAX, f64::MIN], |[l, h], &x| [l.min(x), h.max(x)]);
    let [low, high] = bounds(&values);
    for t in [1e-3, 0.1, 10.0] {
        let after = operator.heat_flow(&values, t).unwrap();
        let [l, h] = bounds(&after);
        assert!(l >= low - 1e-9 && h <= high + 1e-9);
        assert!((integral(&operator, &after) - integral(&operator, &values)).abs() < 1e-7);
    }
    let mean = integral(&operator, &values) / operator.mass().iter().sum::<f64>();
    let after = operator.heat_flow(&values, 1e5).unwrap();
    assert!(after.iter().all(|x| (x - mean).abs() < 1e-6));
    // Much above zero nothing else happens than near it.
    let shifted: Vec<f64> = values.iter().map(|x| x + 1e6).collect();
    let [near, far] = [&values, &shifted].map(|x| operator.heat_flow(x, 0.1).unwrap());
    assert!(near.iter().zip(&far).all(|(a, b)| (b - a - 1e6).abs() < 1e-6));
}

#[test]
fn a_surface_with_a_tiny_triangle_is_smoothed_as_one_without() {
    // A grid of squares, one of which has a vertex very near to another: its triangles are a millionth of the others.
    let n = 20u32;
    let flat = |x: f64, y: f64| [x, y, 0.0];
    let mut vertices: Vec<[f64; 3]> = (0..n * n).map(|i| flat(f64::from(i / n), f64::from(i % n))).collect();
    let mut triangles: Vec<[u32; 3]> = (0..n - 1)
        .flat_map(|i| (0..n - 1).map(move |j| i * n + j))
        .flat_map(|a| [[a, a + n, a + n + 1], [a, a + n + 1, a + 1]])
        .collect();
    let values = |vertices: &[[f64; 3]]| -> Vec<f64> {
        vertices.iter().map(|p| (0.6 * p[0]).sin() + (0.3 * p[1]).cos()).collect()
    };
    let flow = |vertices: &[[f64; 3]], triangles: &[[u32; 3]]| {
        let mesh = TriangleMesh::new(vertices.to_vec(), triangles.to_vec()).unwrap();
        cotangent_laplacian(&mesh).unwrap().heat_flow(&values(vertices), 2.0).unwrap()
    };
    let plain = flow(&vertices, &triangles);
    let [a, b, c] = triangles.swap_remove(400);
    let corner = vertices[a as usize];
    vertices.push([corner[0] + 6e-6, corner[1] + 3e-6, 0.0]);
    triangles.extend([[a, b, n * n], [b, c, n * n], [c, a, n * n]]);
    let tiny = flow(&vertices, &triangles);
    let error = plain.iter().zip(&tiny).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(error > 0.0 && error < 0.03, "{error}");
}

#[test]
fn heat_does_not_pass_where_nothing_is_linked() {
    let mut inside = BitGrid::full([5, 1, 1]).unwrap();
    inside.set([2, 0, 0], false);
    let frame = Frame::new([5, 1, 1], [0.0; 3], [1.0; 3]).unwrap();
    let operator = grid_laplacian(&VoxelGrid::solid(frame, inside).unwrap());
    let after = operator.heat_flow(&[1.0, 3.0, 7.0, 7.0], 1e4).unwrap();
    assert!(after.iter().zip([2.0, 2.0, 7.0, 7.0]).all(|(a, b)| (a - b).abs() < 1e-6), "{after:?}");
    // Where nothing is known, the mean of what is known elsewhere.
    let known = [Some(1.0), None, None, None];
    assert_eq!(operator.harmonic(&known).unwrap(), [1.0; 4]);
}

#[test]
fn harmonic_functions_of_a_rod_are_straight_and_of_a_plane_its_coordinates() {
    let operator = rod(11, 1.0);
    let mut known = vec![None; 11];
    (known[0], known[10]) = (Some(-3.0), Some(7.0));
    for (i, x) in operator.harmonic(&known).unwrap().iter().enumerate() {
        assert!((x - (i as f64 - 3.0)).abs() < 1e-8);
    }
    // A fan of uneven triangles around one vertex in a plane.
    let mut vertices = vec![[0.1, -0.2, 0.0]];
    vertices.extend((0..7).map(|i| {
        let (angle, r) = (f64::from(i) * 0.9, 1.0 + 0.3 * f64::from(i % 3));
        [r * angle.cos(), r * angle.sin(), 0.0]
    }));
    let triangles = (0..7).map(|i| [0, 1 + i, 1 + (i + 1) % 7]).collect();
    let mesh = TriangleMesh::new(vertices.clone(), triangles).unwrap();
    let known: Vec<Option<f64>> = vertices.iter().enumerate().map(|(v, p)| (v > 0).then_some(p[0])).collect();
    let found = cotangent_laplacian(&mesh).unwrap().harmonic(&known).unwrap();
    assert!((found[0] - 0.1).abs() < 1e-9, "{}", found[0]);
}

#[test]
fn what_cannot_be_solved_is_said() {
    let operator = rod(4, 1.0);
    let wrong = LaplaceError::WrongLength { found: 3, expected: 4 };
    assert_eq!(operator.heat_flow(&[0.0; 3], 1.0), Err(wrong.clone()));
    assert_eq!(operator.harmonic(&[None; 3]), Err(wrong));
    assert_eq!(operator.harmonic(&[None; 4]), Err(LaplaceError::NothingKnown));
    for t in [-1.0, f64::INFINITY] {
        assert_eq!(operator.heat_flow(&[0.0; 4], t), Err(LaplaceError::InvalidTime { time: t }));
    }
    assert!(operator.heat_flow(&[f64::MAX, -f64::MAX, 0.0, 1.0], 1.0).is_err());
}

//! Completeness: as many eigenpairs as the inertia of a factorization says, and all below a bound.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use mser3d_laplace::{cotangent_laplacian, grid_laplacian};
use mser3d_shape::{BitGrid, Frame, TriangleMesh, VoxelGrid};
use mser3d_spectral::{
    EigenpairRange, Eigensolver, SpectralError, Spectrum, SpectrumParameters, count_below,
    smallest_eigenpairs, smallest_eigenpairs_of_grid,
};

fn solid(dims: [usize; 3], spacing: f64, inside: impl Fn([f64; 3]) -> bool) -> VoxelGrid {
    let frame = Frame::new(dims, [0.0; 3], [spacing; 3]).unwrap();
    let mut bits = BitGrid::empty(dims).unwrap();
    for v in BitGrid::full(dims).unwrap().ones() {
        bits.set(v, inside(v.map(|x| f64::from(x) + 0.5)));
    }
    VoxelGrid::solid(frame, bits).unwrap()
}

fn in_ball([x, y, z]: [f64; 3], [a, b, c]: [f64; 3], radius: f64) -> bool {
    (x - a).powi(2) + (y - b).powi(2) + (z - c).powi(2) <= radius * radius
}

fn solve(grid: &VoxelGrid, eigenpairs: EigenpairRange, solver: Eigensolver) -> Spectrum {
    let parameters = SpectrumParameters { eigenpairs, solver, ..Default::default() };
    smallest_eigenpairs_of_grid(grid, &parameters, &|_| ControlFlow::Continue(())).unwrap()
}

/// The widest relative gap among the last eigenvalues: how many lie below it, and its middle.
fn last_gap(values: &[f64]) -> (usize, f64) {
    let gap = |i: &usize| values[*i] / values[i - 1].max(f64::MIN_POSITIVE);
    let from = (values.len() / 2).max(1);
    let at = (from..values.len()).max_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap();
    (at, 0.5 * (values[at - 1] + values[at]))
}

#[test]
fn spectra_are_complete_by_the_inertia_of_a_factorization() {
    // A fishbone: each of its 25 ribs has the same odd waves, more than a block has columns.
    let fishbone = |[x, y, _]: [f64; 3]| (y - 60.5).abs() < 0.6 || (x as u32).is_multiple_of(2);
    let solids = [
        ("ball", solid([20; 3], 1.0, |c| in_ball(c, [10.0; 3], 10.0))),
        ("cube", solid([16; 3], 1.0, |_| true)),
        ("plate", solid([64, 56, 1], 1.0, |_| true)),
        ("rod", solid([3, 400, 3], 1.0, |_| true)),
        (
            "two touching balls",
            solid([37, 17, 17], 1.0, |c| {
                in_ball(c, [8.5; 3], 8.5)
                    || in_ball(c, [28.5, 8.5, 8.5], 8.5)
                    || (c[0] > 16.0 && c[0] < 21.0 && c[1] == 8.5 && c[2] == 8.5)
            }),
        ),
        ("three parts", solid([50, 12, 12], 1.0, |c| c[0] < 14.0 || c[0] > 30.0 && c[0] as u32 != 45)),
        ("fishbone", solid([49, 121, 1], 1.0, fishbone)),
    ];
    for (name, grid) in &solids {
        let operator = grid_laplacian(grid);
        for solver in [Eigensolver::Filter, Eigensolver::ShiftInvert] {
            let spectrum = solve(grid, EigenpairRange::Count(60), solver);
            let (below, bound) = last_gap(spectrum.basis.eigenvalues());
            assert_eq!(count_below(&operator, bound, None), Ok(below), "{name} {solver:?} {bound}");
            let parts = grid.component_count();
            assert_eq!(
                (spectrum.report.zero_modes, spectrum.basis.eigenvalues()[parts] > 0.0),
                (parts, true)
            );
        }
    }
}

#[test]
fn all_eigenpairs_below_a_bound_at_any_size() {
    // A cube's: (2 - 2 cos(pi i / n)) / h^2 along each axis, all sums.
    let n = 18;
    let axis: Vec<f64> = (0..n).map(|i| 2.0 - 2.0 * (PI * i as f64 / n as f64).cos()).collect();
    let axis = &axis;
    let pairs = axis.iter().flat_map(|a| axis.iter().map(move |b| a + b));
    let mut expected: Vec<f64> = pairs.flat_map(|ab| axis.iter().map(move |c| ab + c)).collect();
    expected.sort_by(f64::total_cmp);
    let side = n as f64;
    for bound in [1.0, 60.0, 200.0] {
        let count = expected.iter().filter(|&&value| value * side * side < bound).count();
        for (size, solver) in [(1.0, Eigensolver::Filter), (1e-3, Eigensolver::ShiftInvert)] {
            let grid = solid([n; 3], size, |_| true);
            let spectrum = solve(&grid, EigenpairRange::LambdaMax(bound), solver);
            let values = spectrum.basis.eigenvalues();
            assert_eq!(values.len(), count, "{bound} {solver:?}");
            let close = |(value, e): (&f64, &f64)| (value * size * size - e).abs() <= 1e-9 * e;
            assert!(values.iter().zip(&expected).all(close), "{bound} {solver:?}");
        }
    }
    let parts = solid([37, 9, 9], 1.0, |c| c[0] as u32 % 10 != 9);
    let spectrum = solve(&parts, EigenpairRange::LambdaMax(20.0), Eigensolver::Auto);
    let (count, bound) = (spectrum.basis.eigenvalues().len(), 20.0 * parts.volume().powf(-2.0 / 3.0));
    assert_eq!(count_below(&grid_laplacian(&parts), bound, None), Ok(count));
}

#[test]
fn surfaces_are_bounded_by_their_area() {
    let n = 40;
    let at = |i: usize, j: usize| (i * (n + 1) + j) as u32;
    let vertices =
        (0..=n).flat_map(|i| (0..=n).map(move |j| [i as f64 / n as f64, j as f64 / n as f64, 0.0])).collect();
    let triangles = (0..n)
        .flat_map(|i| (0..n).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        })
        .collect();
    let sheet = TriangleMesh::new(vertices, triangles).unwrap();
    let operator = cotangent_laplacian(&sheet).unwrap();
    // A square's: pi^2 (i^2 + j^2). 30 of them are below 30.5 pi^2.
    let parameters =
        SpectrumParameters { eigenpairs: EigenpairRange::LambdaMax(30.5 * PI * PI), ..Default::default() };
    let spectrum = smallest_eigenpairs(&operator, &parameters, &|_| ControlFlow::Continue(())).unwrap();
    let expected = (0..6).flat_map(|i| (0..6).map(move |j| i * i + j * j)).filter(|&s| s <= 30).count();
    assert_eq!(spectrum.basis.eigenvalues().len(), expected);
}

#[test]
fn bounds_that_are_none_and_too_little_memory_are_errors() {
    let grid = solid([12; 3], 1.0, |_| true);
    for bound in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let parameters =
            SpectrumParameters { eigenpairs: EigenpairRange::LambdaMax(bound), ..Default::default() };
        let error = smallest_eigenpairs_of_grid(&grid, &parameters, &|_| ControlFlow::Continue(()));
        assert!(matches!(error, Err(SpectralError::InvalidParameter(_))), "{bound}");
    }
    let operator = grid_laplacian(&grid);
    assert_eq!(count_below(&operator, -1.0, None), Ok(0));
    assert_eq!(count_below(&operator, 100.0, None), Ok(1728));
    assert!(count_below(&operator, f64::NAN, None).is_err());
    let error = count_below(&operator, 1.0, Some(1000)).unwrap_err();
    assert!(matches!(error, SpectralError::TooMuchMemory { .. }), "{error}");
}

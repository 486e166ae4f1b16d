//! Eigenpairs carried up from coarser grids: what the filter and the inverse find, on shapes that coarse grids show badly.

use std::ops::ControlFlow;

use mser3d_shape::{BitGrid, Eigenbasis, Frame, FunctionsView, VoxelGrid};
use mser3d_spectral::{
    Eigensolver, SolverUsed, SpectralError, Spectrum, SpectrumParameters, smallest_eigenpairs_of_grid,
};

fn solid(dims: [usize; 3], spacing: [f64; 3], inside: impl Fn([u32; 3]) -> bool) -> VoxelGrid {
    let frame = Frame::new(dims, [0.0; 3], spacing).unwrap();
    let mut bits = BitGrid::empty(dims).unwrap();
    for v in BitGrid::full(dims).unwrap().ones() {
        bits.set(v, inside(v));
    }
    VoxelGrid::solid(frame, bits).unwrap()
}

fn parameters(k: usize, tolerance: f64, solver: Eigensolver) -> SpectrumParameters {
    SpectrumParameters { eigenpairs: k.into(), tolerance, solver, ..Default::default() }
}

fn solve(grid: &VoxelGrid, parameters: &SpectrumParameters) -> Result<Spectrum, SpectralError> {
    smallest_eigenpairs_of_grid(grid, parameters, &|_| ControlFlow::Continue(()))
}

/// Solves by multigrid on one thread and on three, and compares with another solver's answer.
fn assert_same(name: &str, grid: &VoxelGrid, k: usize, tolerance: f64, other: Eigensolver) {
    assert_eq!(grid.component_count(), 1, "{name}");
    let expected = solve(grid, &parameters(k, tolerance, other)).unwrap();
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(grid, &parameters(k, tolerance, Eigensolver::Multigrid))).unwrap()
    });
    assert_eq!(one.report.solver, SolverUsed::Multigrid, "{name}");
    assert!(one.basis == three.basis, "{name}: other bits on three threads");
    let report = one.report;
    assert!(report.residual <= tolerance && report.orthogonality < 1e-9, "{name}: {report:?}");
    for (i, (a, b)) in one.basis.eigenvalues().iter().zip(expected.basis.eigenvalues()).enumerate() {
        assert!((a - b).abs() <= 1e-10 * b, "{name}: eigenvalue {i} is {a}, not {b}; {report:?}");
    }
    println!("{name}, {} voxels: {report:?}", grid.len());
}

/// Three bars that cross: limbs, as bodies have them. Each is `width` voxels across.
fn cross(width: u32, spacing: [f64; 3]) -> VoxelGrid {
    let middle = |x: u32| (2 * width..3 * width).contains(&x);
    solid([5 * width as usize; 3], spacing, |v| v.iter().filter(|&&x| middle(x)).count() >= 2)
}

#[test]
fn limbs() {
    assert_same("cross", &cross(13, [0.1; 3]), 20, 1e-9, Eigensolver::Filter);
}

#[test]
fn a_loose_tolerance_gives_single_precision() {
    for (name, grid, k) in
        [("cross", cross(13, [0.1; 3]), 20), ("bar", solid([150, 20, 18], [2.0; 3], |_| true), 12)]
    {
        let [one, three] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| solve(&grid, &parameters(k, 1e-4, Eigensolver::Multigrid))).unwrap()
        });
        assert_eq!(one.report.solver, SolverUsed::Multigrid, "{name}");
        assert!(one.basis == three.basis, "{name}: other bits on three threads");
        assert!(one.report.residual <= 1e-4 && one.report.orthogonality < 1e-6, "{name}: {:?}", one.report);
        assert!(matches!(one.basis.functions(), FunctionsView::Single(_)), "{name}");
        let double = solve(&grid, &parameters(k, 1e-9, Eigensolver::Filter)).unwrap().basis;
        assert!(matches!(double.functions(), FunctionsView::Double(_)), "{name}");
        // The error of an eigenvalue is about the square of the residual, and single precision's rounding.
        for (i, (a, b)) in one.basis.eigenvalues().iter().zip(double.eigenvalues()).enumerate() {
            assert!((a - b).abs() <= 1e-7 * b, "{name}: eigenvalue {i} is {a}, not {b}");
        }
        // Of the heat kernel, which no choice of signs or of a basis of a multiple eigenvalue changes.
        let time = 3.0 / one.basis.eigenvalues()[1];
        let heat = |basis: &Eigenbasis, v: usize| -> f64 {
            basis.at(v).iter().zip(basis.eigenvalues()).map(|(x, l)| x * x * (-l * time).exp()).sum()
        };
        for v in (0..grid.len()).step_by(97) {
            let (a, b) = (heat(&one.basis, v), heat(&double, v));
            assert!((a - b).abs() < 1e-4 * b, "{name}: at {v} the heat kernel is {a}, not {b}");
        }
    }
}

#[test]
fn all_copies_of_multiple_eigenvalues() {
    let ball =
        solid([36; 3], [1.0; 3], |v| v.map(|x| (f64::from(x) - 17.5).powi(2)).iter().sum::<f64>() < 324.0);
    assert_same("ball", &ball, 26, 1e-8, Eigensolver::Filter);
    assert_same("cube", &solid([27; 3], [1.0; 3], |_| true), 20, 1e-8, Eigensolver::Filter);
}

#[test]
fn limbs_that_touch_stay_apart() {
    // A bar folded in two: its halves are neighbours in each cell of the coarse levels along the whole fold.
    let grid = solid([120, 15, 14], [1.0; 3], |_| true);
    let cut: Vec<[u32; 3]> = grid.voxels().filter(|v| v[1] == 6 && v[0] < 108).collect();
    let (folded, found) = grid.with_cut_links(1, &cut);
    assert_eq!(found, cut.len());
    assert_same("folded", &folded, 16, 1e-8, Eigensolver::ShiftInvert);
}

#[test]
fn voxels_that_are_no_cubes() {
    for spacing in [[1.0, 1.0, 3.0], [0.3, 2.0, 0.8], [1e-6, 1e-6, 2e-6]] {
        assert_same(&format!("{spacing:?}"), &cross(12, spacing), 12, 1e-8, Eigensolver::Filter);
    }
}

#[test]
fn plates_walls_and_sponges() {
    assert_same("plate", &solid([110, 90, 3], [1.0; 3], |_| true), 16, 1e-8, Eigensolver::ShiftInvert);
    // A house of walls two voxels thick.
    let walls = solid([44; 3], [1.0; 3], |v| v.iter().any(|x| x % 14 < 2));
    assert_same("walls", &walls, 12, 1e-8, Eigensolver::ShiftInvert);
    let wave = |x: u32, y: u32| (f64::from(x) * 0.55).sin() * (f64::from(y) * 0.55).cos();
    let sponge = solid([40; 3], [1.0; 3], |[x, y, z]| wave(x, y) + wave(y, z) + wave(z, x) > 0.2);
    let sponge = sponge.largest_component().0;
    assert_same("sponge", &sponge, 12, 1e-8, Eigensolver::ShiftInvert);
}

#[test]
fn where_coarser_levels_are_poor_or_missing_pairs_are_right_all_the_same() {
    let small = solid([20, 12, 10], [1.0; 3], |_| true);
    // Of the links within cells of 2 x 2 x 2 hardly more is left than holds the body together: nearly every voxel is an aggregate.
    let mut loose = solid([26; 3], [1.0; 3], |_| true);
    let kept: [fn(&[u32; 3]) -> bool; 3] =
        [|v| v[1] % 2 == 1 && v[2] % 2 == 1, |v| v[0] == 1 && v[2] % 2 == 1, |v| v[0] == 1 && v[1] == 1];
    for (axis, kept) in kept.iter().enumerate() {
        let cut: Vec<[u32; 3]> = loose.voxels().filter(|v| v[axis] % 2 == 0 && !kept(v)).collect();
        loose = loose.with_cut_links(axis, &cut).0;
    }
    let loose = loose.largest_component().0;
    assert!(loose.len() > 12_000);
    for (name, grid) in [("small", small), ("loose", loose)] {
        let found = solve(&grid, &parameters(10, 1e-8, Eigensolver::Multigrid)).unwrap();
        println!("{name}: {} voxels by {}", grid.len(), found.report.solver);
        let expected = solve(&grid, &parameters(10, 1e-8, Eigensolver::ShiftInvert)).unwrap();
        for (a, b) in found.basis.eigenvalues().iter().zip(expected.basis.eigenvalues()) {
            assert!((a - b).abs() <= 1e-9 * b, "{name}: {a}, not {b}");
        }
        assert!(name == "loose" || found.report.solver != SolverUsed::Multigrid, "{name}");
    }
}

#[test]
fn where_corrections_come_to_a_stop_the_filter_goes_on() {
    let grid = cross(12, [1.0; 3]);
    let solver = |solver| SpectrumParameters { max_iterations: 1, ..parameters(12, 1e-10, solver) };
    let [found, expected] = [Eigensolver::Multigrid, Eigensolver::Filter].map(|s| solve(&grid, &solver(s)));
    let (found, expected) = (found.unwrap(), expected.unwrap());
    assert_eq!(found.report.solver, SolverUsed::Filter);
    assert_eq!(found.basis, expected.basis);
    // Where the filter would not fit in memory, what is told is why multigrid stopped.
    let fits = 8 * 80 * grid.len() as u64;
    let [stopped, refused] = [Eigensolver::Multigrid, Eigensolver::Filter].map(|s| {
        solve(&grid, &SpectrumParameters { memory_limit: Some(fits), ..solver(s) }).map(|_| ()).unwrap_err()
    });
    assert!(matches!(stopped, SpectralError::NotConverged { restarts: 1, .. }), "{stopped}");
    assert!(matches!(refused, SpectralError::TooMuchMemory { .. }), "{refused}");
}

#[test]
fn progress_never_goes_back_and_cancels() {
    let grid = cross(12, [1.0; 3]);
    let parameters = parameters(12, 1e-8, Eigensolver::Multigrid);
    let heard = std::sync::Mutex::new(Vec::new());
    let hear = |share: f64| {
        heard.lock().unwrap().push(share);
        ControlFlow::Continue(())
    };
    smallest_eigenpairs_of_grid(&grid, &parameters, &hear).unwrap();
    let heard = heard.into_inner().unwrap();
    assert!(heard.is_sorted() && heard.len() > 8, "{heard:?}");
    assert_eq!(heard.last(), Some(&1.0));
    for at in [0.0, 0.1, 0.5] {
        let stop = |share: f64| if share > at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let ended = smallest_eigenpairs_of_grid(&grid, &parameters, &stop);
        assert_eq!(ended.unwrap_err(), SpectralError::Cancelled);
    }
}

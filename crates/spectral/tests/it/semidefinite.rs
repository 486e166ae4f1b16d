//! Operators other than Neumann Laplacians: any symmetric positive semidefinite matrix.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use mser3d_laplace::{Operator, sprs::TriMat};
use mser3d_shape::Domain;
use mser3d_spectral::{
    EigenpairRange, SolverUsed, SpectralError, Spectrum, SpectrumParameters, count_below, smallest_eigenpairs,
};

/// The Laplacian of a box of cells of size 1 plus a potential. The wall is held at 0 (Dirichlet), or free
/// (Neumann).
#[derive(Clone, Copy)]
struct Room {
    dims: [usize; 3],
    held: bool,
    potential: f64,
}

impl Room {
    fn free(dims: [usize; 3]) -> Self {
        Self { dims, held: false, potential: 0.0 }
    }

    fn held(dims: [usize; 3]) -> Self {
        Self { held: true, ..Self::free(dims) }
    }

    fn len(self) -> usize {
        self.dims.iter().product()
    }

    /// All eigenvalues, ascending: sums of 2 - 2 cos(pi i / n) with i from 0, or of 2 - 2 cos(pi i / (n + 1))
    /// with i from 1, along each axis.
    fn spectrum(self) -> Vec<f64> {
        let first = usize::from(self.held);
        let axis = |n: usize| {
            (first..n + first).map(move |i| 2.0 - 2.0 * (PI * i as f64 / (n + first) as f64).cos())
        };
        let [x, y, z] = self.dims;
        let pairs = axis(x).flat_map(|a| axis(y).map(move |b| a + b));
        let mut all: Vec<f64> = pairs.flat_map(|ab| axis(z).map(move |c| ab + c + self.potential)).collect();
        all.sort_by(f64::total_cmp);
        all
    }
}

/// Rooms side by side, not linked, with a mass of `mass` for each cell. Row v is multiplied by `sign(v)`, and
/// so is column v: that changes eigenfunctions, but no eigenvalue.
fn operator(rooms: &[Room], mass: f64, sign: impl Fn(usize) -> f64) -> Operator {
    let n = rooms.iter().map(|room| room.len()).sum();
    let mut stiffness = TriMat::new((n, n));
    let mut base = 0;
    for room in rooms {
        let [nx, ny, nz] = room.dims;
        for v in 0..room.len() {
            let place = [v % nx, v / nx % ny, v / nx / ny];
            let mut links = 0;
            for (axis, stride) in [1, nx, nx * ny].into_iter().enumerate() {
                let end = [nx, ny, nz][axis] - 1;
                for u in [(place[axis] > 0).then(|| v - stride), (place[axis] < end).then(|| v + stride)] {
                    let Some(u) = u else { continue };
                    links += 1;
                    stiffness.add_triplet(base + v, base + u, -mass * sign(base + v) * sign(base + u));
                }
            }
            let diagonal = mass * (if room.held { 6.0 } else { f64::from(links) } + room.potential);
            stiffness.add_triplet(base + v, base + v, diagonal);
        }
        base += room.len();
    }
    Operator::new(Domain::Volume, stiffness.to_csr(), vec![mass; n]).unwrap()
}

fn try_solve(operator: &Operator, eigenpairs: EigenpairRange) -> Result<Spectrum, SpectralError> {
    let parameters = SpectrumParameters { eigenpairs, ..Default::default() };
    smallest_eigenpairs(operator, &parameters, &|_| ControlFlow::Continue(()))
}

fn solve(operator: &Operator, k: usize) -> Spectrum {
    try_solve(operator, k.into()).unwrap()
}

fn assert_values(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (i, (found, exact)) in found.iter().zip(expected).enumerate() {
        assert!(
            (found - exact).abs() <= 1e-9 * exact.max(1e-2),
            "eigenvalue {i}: {found} instead of {exact}"
        );
    }
}

fn assert_exact(spectrum: &Spectrum, expected: &[f64]) {
    assert_values(spectrum.basis.eigenvalues(), expected);
    let report = spectrum.report;
    // Relative to a very small eigenvalue, rounding errors of an operator of norm 12 are more.
    let smallest = expected.iter().copied().find(|&value| value > 0.0).unwrap_or(1.0);
    let reachable = 1e-9 + 16.0 * f64::EPSILON * 12.0 / smallest;
    assert!(report.residual <= reachable && report.orthogonality < 1e-10, "{report:?}");
}

/// Sizes at which the dense solver serves, and at which shift-invert does.
const SIZES: [([usize; 3], SolverUsed); 2] =
    [([7, 6, 5], SolverUsed::Dense), ([14, 11, 9], SolverUsed::ShiftInvert)];

#[test]
fn a_room_held_at_its_walls_has_the_dirichlet_spectrum() {
    for (dims, solver) in SIZES {
        let room = Room::held(dims);
        let operator = operator(&[room], 0.25, |_| 1.0);
        let exact = room.spectrum();
        // A few, with the shift below all; and many, with the shift among them.
        for k in [1, 10, 60] {
            let spectrum = solve(&operator, k);
            assert_exact(&spectrum, &exact[..k]);
            assert_eq!((spectrum.report.zero_modes, spectrum.report.solver), (0, solver));
            assert_eq!(count_below(&operator, 0.5 * (exact[k - 1] + exact[k]), None), Ok(k));
        }
    }
}

#[test]
fn a_potential_moves_the_spectrum() {
    for (dims, _) in SIZES {
        for potential in [1e-6, 0.3, 1000.0] {
            let room = Room { potential, ..Room::free(dims) };
            let operator = operator(&[room], 0.25, |_| 1.0);
            for k in [1, 10, 60] {
                let spectrum = solve(&operator, k);
                assert_exact(&spectrum, &room.spectrum()[..k]);
                assert_eq!(spectrum.report.zero_modes, 0);
            }
        }
    }
}

#[test]
fn one_room_free_and_one_held() {
    for (dims, _) in SIZES {
        let rooms = [Room::held(dims), Room::free(dims)];
        let operator = operator(&rooms, 1.0, |_| 1.0);
        let mut exact = [rooms[0].spectrum(), rooms[1].spectrum()].concat();
        exact.sort_by(f64::total_cmp);
        exact[0] = 0.0;
        for k in [1, 2, 50] {
            let spectrum = solve(&operator, k);
            assert_exact(&spectrum, &exact[..k]);
            assert_eq!((spectrum.report.zero_modes, spectrum.basis.eigenvalues()[0]), (1, 0.0));
            // The zero mode is exactly constant on the free room, exactly zero in the other.
            let n = rooms[0].len();
            for v in 0..2 * n {
                let constant = if v < n { 0.0 } else { 1.0 / (n as f64).sqrt() };
                assert!((spectrum.basis.at(v)[0] - constant).abs() < 1e-14);
            }
        }
        assert_eq!(count_below(&operator, 0.5 * (exact[19] + exact[20]), None), Ok(20));
    }
}

#[test]
fn the_smallest_pairs_may_all_be_those_of_the_largest_of_many_rooms() {
    let rooms = [[2, 2, 2], [3, 2, 2], [9, 8, 7], [2, 3, 3], [1, 1, 1]].map(Room::held);
    let operator = operator(&rooms, 1.0, |_| 1.0);
    let mut exact: Vec<f64> = rooms.iter().flat_map(|room| room.spectrum()).collect();
    exact.sort_by(f64::total_cmp);
    for k in [1, 3, 4, 5, 30, exact.len()] {
        let spectrum = solve(&operator, k);
        assert_exact(&spectrum, &exact[..k]);
        assert_eq!(spectrum.report.zero_modes, 0);
    }
}

#[test]
fn all_pairs_below_a_bound() {
    let room = Room::held([14, 11, 9]);
    let operator = operator(&[room], 1.0, |_| 1.0);
    let exact = room.spectrum();
    // In the unit V^(-2/3); the least that is found is one pair.
    for (bound, count) in [(0.5 * (exact[29] + exact[30]), 30), (0.5 * exact[0], 1)] {
        let range = EigenpairRange::LambdaMax(bound * (room.len() as f64).powf(2.0 / 3.0));
        assert_exact(&try_solve(&operator, range).unwrap(), &exact[..count]);
    }
}

#[test]
fn a_zero_mode_that_is_not_constant_is_computed() {
    let sign = |v: usize| if v * v % 7 < 3 { -1.0 } else { 1.0 };
    for (dims, _) in SIZES {
        let room = Room::free(dims);
        let operator = operator(&[room], 1.0, sign);
        let spectrum = solve(&operator, 12);
        let report = spectrum.report;
        assert_values(spectrum.basis.eigenvalues(), &room.spectrum()[..12]);
        assert!(
            report.zero_modes == 0 && report.residual < 1.0 && report.orthogonality < 1e-10,
            "{report:?}"
        );
        assert!(spectrum.basis.eigenvalues()[0] < 1e-13);
        let size = (room.len() as f64).sqrt();
        let first = spectrum.basis.at(0)[0];
        for v in 0..room.len() {
            assert!((spectrum.basis.at(v)[0] - first * sign(0) * sign(v)).abs() < 1e-9 / size);
        }
    }
}

#[test]
fn negative_eigenvalues_are_refused_and_counted() {
    for (dims, _) in SIZES {
        let free = Room::free(dims).spectrum();
        for below in [1, 5] {
            // So many eigenvalues are negative.
            let potential = -0.5 * (free[below - 1] + free[below]);
            let operator = operator(&[Room { potential, ..Room::free(dims) }], 1.0, |_| 1.0);
            assert!(!operator.is_known_semidefinite());
            for k in [1, 10, 60] {
                let error = try_solve(&operator, k.into()).unwrap_err();
                let SpectralError::Indefinite { eigenvalue } = error else { panic!("{k}: {error}") };
                assert!(eigenvalue < 0.0 && eigenvalue >= potential - 1e-9, "{k}: {error}");
            }
            assert_eq!(count_below(&operator, 0.0, None), Ok(below));
            assert_eq!(count_below(&operator, 2.0 * potential, None), Ok(0));
        }
    }
    // Rows that sum to zero alone make no Laplacian: a weight of -2 across the rod.
    let n = 500;
    let mut stiffness = TriMat::new((n, n));
    for i in 0..n - 1 {
        let weight = if i == n / 2 { -2.0 } else { 1.0 };
        for (row, column, value) in
            [(i, i, weight), (i + 1, i + 1, weight), (i, i + 1, -weight), (i + 1, i, -weight)]
        {
            stiffness.add_triplet(row, column, value);
        }
    }
    let rod = Operator::new(Domain::Volume, stiffness.to_csc(), vec![1.0; n]).unwrap();
    for k in [1, 2, 40] {
        let error = try_solve(&rod, k.into()).unwrap_err();
        assert!(matches!(error, SpectralError::Indefinite { .. }), "{k}: {error}");
    }
}

#[test]
fn rows_without_entries_are_bodies_of_their_own() {
    // Three points that nothing links, and a rod of two cells.
    let mut stiffness = TriMat::new((5, 5));
    for (row, column, value) in [(1, 1, 1.0), (1, 3, -1.0), (3, 1, -1.0), (3, 3, 1.0)] {
        stiffness.add_triplet(row, column, value);
    }
    let operator = Operator::new(Domain::Volume, stiffness.to_csc(), vec![2.0; 5]).unwrap();
    let spectrum = solve(&operator, 5);
    assert_eq!((spectrum.report.zero_modes, &spectrum.basis.eigenvalues()[..4]), (4, &[0.0; 4][..]));
    assert_exact(&spectrum, &[0.0, 0.0, 0.0, 0.0, 1.0]);
    assert_eq!(count_below(&operator, 0.5, None), Ok(4));
}

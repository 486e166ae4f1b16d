//! Odd solids and meshes, both solvers, against the dense spectrum.

use std::ops::ControlFlow;

use faer::{Mat, Side};
use mser3d_laplace::{Operator, cotangent_laplacian, grid_laplacian};
use mser3d_shape::{BitGrid, Frame, SplitMix64, TriangleMesh, VoxelGrid};
use mser3d_spectral::{
    Eigensolver, SpectralError, Spectrum, SpectrumParameters, smallest_eigenpairs,
    smallest_eigenpairs_of_grid,
};

fn solid(dims: [usize; 3], spacing: [f64; 3], mut inside: impl FnMut([u32; 3]) -> bool) -> VoxelGrid {
    let frame = Frame::new(dims, [0.0; 3], spacing).unwrap();
    let mut bits = BitGrid::empty(dims).unwrap();
    for v in BitGrid::full(dims).unwrap().ones() {
        bits.set(v, inside(v));
    }
    VoxelGrid::solid(frame, bits).unwrap()
}

fn ball([x, y, z]: [u32; 3], [a, b, c]: [f64; 3], radius: f64) -> bool {
    let square = |u: u32, v: f64| (f64::from(u) + 0.5 - v).powi(2);
    square(x, a) + square(y, b) + square(z, c) <= radius * radius
}

/// All eigenvalues of the operator, by a dense solver.
fn dense_spectrum(operator: &Operator) -> Vec<f64> {
    let active: Vec<usize> = (0..operator.len()).filter(|&v| operator.mass()[v] > 0.0).collect();
    let (w, m) = (operator.stiffness().to_dense(), operator.mass());
    let matrix = Mat::from_fn(active.len(), active.len(), |i, j| {
        w[[active[i], active[j]]] / (m[active[i]] * m[active[j]]).sqrt()
    });
    matrix.self_adjoint_eigenvalues(Side::Lower).unwrap()
}

/// So many eigenpairs to the default tolerance, and the last number of them to one that regions need.
fn requests(counts: &[usize]) -> impl Iterator<Item = (usize, f64)> {
    counts.iter().map(|&k| (k, 1e-9)).chain(counts.last().map(|&k| (k, 1e-4)))
}

/// What is wrong with a spectrum, if anything.
fn fault(
    spectrum: &Spectrum,
    expected: &[f64],
    components: usize,
    k: usize,
    tolerance: f64,
) -> Option<String> {
    let (values, report) = (spectrum.basis.eigenvalues(), &spectrum.report);
    if values.len() != k || report.zero_modes != components.min(k) {
        return Some(format!("{} values, {} zero modes of {components}", values.len(), report.zero_modes));
    }
    // Dense solvers are exact to rounding relative to the largest eigenvalue.
    let rounding = 1e-13 * expected.last().unwrap();
    // The error of an eigenvalue goes with the square of the residual.
    let error = tolerance.powf(1.5).max(1e-9);
    let wrong = (0..k).find(|&i| (values[i] - expected[i]).abs() > error * expected[i].abs() + rounding);
    if let Some(i) = wrong {
        return Some(format!("eigenvalue {i} is {:e} instead of {:e}", values[i], expected[i]));
    }
    // A relative residual cannot be smaller than the rounding of the operator's largest entries.
    let smallest = expected.iter().copied().find(|&e| e > rounding).unwrap_or(f64::INFINITY);
    let reachable = tolerance + 64.0 * f64::EPSILON * expected.last().unwrap() / smallest;
    (report.residual > reachable || report.orthogonality > tolerance.powi(2).max(1e-10))
        .then(|| format!("{report:?}"))
}

/// Solves by both solvers on one thread and two, and collects what is wrong.
fn faults_of_grid(name: &str, grid: &VoxelGrid, counts: &[usize]) -> Vec<String> {
    let operator = grid_laplacian(grid);
    let (expected, components) = (dense_spectrum(&operator), operator.components().len());
    let mut faults = Vec::new();
    for (k, tolerance) in requests(counts) {
        for solver in [Eigensolver::ShiftInvert, Eigensolver::Filter] {
            let parameters =
                SpectrumParameters { eigenpairs: k.into(), solver, tolerance, ..Default::default() };
            let run = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    smallest_eigenpairs_of_grid(grid, &parameters, &|_| ControlFlow::Continue(()))
                })
            };
            let what = format!("{name} ({} voxels), k = {k}, {solver:?}, {tolerance:e}", grid.len());
            let attempt = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| (run(1), run(2))));
            match attempt {
                Err(_) => faults.push(format!("{what}: PANIC")),
                Ok((Ok(one), Ok(two))) => {
                    if let Some(fault) = fault(&one, &expected, components, k, tolerance) {
                        faults.push(format!("{what} [{}]: {fault}", one.report.solver));
                    }
                    if one.basis != two.basis {
                        faults.push(format!("{what}: other bits on two threads"));
                    }
                }
                Ok((one, _)) => faults.push(format!("{what}: {:?}", one.map(|s| s.report))),
            }
        }
    }
    faults
}

fn faults_of_mesh(name: &str, mesh: &TriangleMesh, counts: &[usize]) -> Vec<String> {
    let operator = match cotangent_laplacian(mesh) {
        Ok(operator) => operator,
        Err(error) => return vec![format!("{name}: no operator: {error}")],
    };
    let expected = dense_spectrum(&operator);
    let massless = operator.mass().iter().filter(|&&m| m == 0.0).count();
    let components = operator.components().len() - massless;
    let mut faults = Vec::new();
    for (k, tolerance) in requests(counts) {
        let parameters = SpectrumParameters { eigenpairs: k.into(), tolerance, ..Default::default() };
        let what = format!("{name} ({} vertices), k = {k}, {tolerance:e}", operator.len());
        let attempt = std::panic::catch_unwind(|| {
            smallest_eigenpairs(&operator, &parameters, &|_| ControlFlow::Continue(()))
        });
        match attempt {
            Err(_) => faults.push(format!("{what}: PANIC")),
            Ok(Ok(spectrum)) => faults.extend(
                fault(&spectrum, &expected, components, k, tolerance).map(|fault| format!("{what}: {fault}")),
            ),
            Ok(Err(error)) => faults.push(format!("{what}: {error:?}")),
        }
    }
    faults
}

fn assert_none(faults: &[String]) {
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn sheets_rods_combs_and_antennas() {
    let mut faults = Vec::new();
    faults.extend(faults_of_grid("sheet", &solid([45, 33, 1], [1.0; 3], |_| true), &[1, 2, 5, 20]));
    faults.extend(faults_of_grid("line", &solid([1500, 1, 1], [1.0; 3], |_| true), &[1, 2, 5, 20]));
    faults.extend(faults_of_grid("rod", &solid([2, 360, 2], [0.1; 3], |_| true), &[2, 20]));
    faults.extend(faults_of_grid(
        "comb",
        &solid([100, 30, 1], [1.0; 3], |v| v[1] < 1 || v[0] % 2 == 0),
        &[2, 20],
    ));
    faults.extend(faults_of_grid(
        "antenna",
        &solid([12, 12, 300], [1.0; 3], |v| v[2] < 9 || (v[0] == 6 && v[1] == 6)),
        &[2, 20],
    ));
    assert_none(&faults);
}

#[test]
fn balls_dumbbells_and_cubes() {
    let mut faults = Vec::new();
    faults.extend(faults_of_grid(
        "ball",
        &solid([14; 3], [1.0; 3], |v| ball(v, [7.0; 3], 7.0)),
        &[4, 17, 20],
    ));
    faults.extend(faults_of_grid(
        "dumbbell",
        &solid([40, 12, 12], [1.0; 3], |v| {
            ball(v, [6.0; 3], 6.0)
                || ball(v, [34.0, 6.0, 6.0], 6.0)
                || (v[1] == 6 && v[2] == 6 && v[0] > 5 && v[0] < 35)
        }),
        &[2, 3, 20],
    ));
    faults.extend(faults_of_grid("cube", &solid([12; 3], [1.0; 3], |_| true), &[2, 7, 20]));
    assert_none(&faults);
}

#[test]
fn equal_pieces_and_dust() {
    let mut faults = Vec::new();
    let apart = |v: [u32; 3]| v[0] % 9 != 8;
    faults.extend(faults_of_grid(
        "four equal boxes",
        &solid([35, 8, 6], [1.0; 3], apart),
        &[1, 3, 4, 5, 8, 20],
    ));
    faults.extend(faults_of_grid(
        "sixteen lines",
        &solid([100, 31, 1], [1.0; 3], |v| v[1] % 2 == 0),
        &[2, 16, 17, 20],
    ));
    faults.extend(faults_of_grid(
        "box and dust",
        &solid([40, 12, 12], [1.0; 3], |v| {
            v[0] < 10 || (v[0] > 11 && v[0] % 3 == 0 && v[1] % 4 == 0 && v[2] % 6 == 0)
        }),
        &[1, 10, 60, 80],
    ));
    faults.extend(faults_of_grid(
        "checkerboard",
        &solid([14; 3], [1.0; 3], |v| (v[0] + v[1] + v[2]) % 2 == 0),
        &[1, 5, 20],
    ));
    assert_none(&faults);
}

#[test]
fn percolation_clusters() {
    let mut faults = Vec::new();
    for (seed, p) in [(1, 0.36), (2, 0.45), (3, 0.7)] {
        let mut random = SplitMix64::new(seed);
        let side = (1700.0f64 / p).cbrt() as usize;
        let grid = solid([side; 3], [1.0; 3], |_| random.uniform() < p);
        faults.extend(faults_of_grid(&format!("percolation {p}"), &grid, &[1, 20]));
        let largest = grid.largest_component().0;
        faults.extend(faults_of_grid(&format!("cluster {p}"), &largest, &[1, 2, 10]));
    }
    assert_none(&faults);
}

#[test]
fn voxels_that_are_no_cubes() {
    let mut faults = Vec::new();
    for spacing in [[1.0, 1.0, 100.0], [1.0, 30.0, 0.01], [1e-6; 3], [1e6; 3]] {
        let grid = solid([13, 12, 10], spacing, |_| true);
        faults.extend(faults_of_grid(&format!("box {spacing:?}"), &grid, &[2, 20]));
    }
    assert_none(&faults);
}

#[test]
fn every_count_up_to_all() {
    let mut faults = Vec::new();
    let grid = solid([10, 9, 7], [1.0; 3], |_| true);
    faults.extend(faults_of_grid("630", &grid, &[1, 100, 300, 500, 502, 600, 629, 630]));
    let grid = solid([2, 1, 1], [1.0; 3], |_| true);
    faults.extend(faults_of_grid("2", &grid, &[1, 2]));
    let grid = solid([1, 1, 1], [1.0; 3], |_| true);
    faults.extend(faults_of_grid("1", &grid, &[1]));
    let grid = solid([401, 1, 1], [1.0; 3], |_| true);
    faults.extend(faults_of_grid("401", &grid, &[1, 2, 270, 272, 273, 274, 400, 401]));
    assert_none(&faults);
}

/// A square sheet of 2 n^2 triangles.
fn sheet(n: usize, mut place: impl FnMut(f64, f64) -> [f64; 3]) -> TriangleMesh {
    let at = |i: usize, j: usize| (i * (n + 1) + j) as u32;
    let step = |i: usize| i as f64 / n as f64;
    let points = (0..=n).flat_map(|i| (0..=n).map(move |j| (step(i), step(j))));
    let vertices: Vec<[f64; 3]> = points.map(|(u, v)| place(u, v)).collect();
    let squares = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let triangles = squares.flat_map(|(i, j)| {
        [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    });
    TriangleMesh::new(vertices, triangles.collect()).unwrap()
}

fn joined(meshes: &[TriangleMesh]) -> TriangleMesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let base = vertices.len() as u32;
        vertices.extend_from_slice(mesh.vertices());
        triangles.extend(mesh.triangles().iter().map(|t| t.map(|v| v + base)));
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}

#[test]
fn slivers_open_and_non_manifold_meshes() {
    let mut faults = Vec::new();
    let plain = sheet(30, |u, v| [u, v, 0.0]);
    faults.extend(faults_of_mesh("open sheet", &plain, &[1, 2, 20, 100]));
    for squeeze in [1e-2, 1e-4, 1e-6] {
        let mesh = sheet(30, |u, v| [u, squeeze * v, 0.0]);
        faults.extend(faults_of_mesh(&format!("slivers {squeeze}"), &mesh, &[2, 20]));
    }
    let mut random = SplitMix64::new(7);
    let mesh =
        sheet(30, |u, v| [u + 0.03 * random.uniform(), v + 0.03 * random.uniform(), 0.1 * random.uniform()]);
    faults.extend(faults_of_mesh("crumpled", &mesh, &[2, 20, 100]));
    // Rows of vertices that are nearly one.
    for gap in [1e-3, 1e-6] {
        let mesh =
            sheet(30, |u, v| [if (u * 30.0) as u32 % 2 == 1 { u - (1.0 - gap) / 30.0 } else { u }, v, 0.0]);
        faults.extend(faults_of_mesh(&format!("rows {gap} apart"), &mesh, &[2, 20]));
    }
    // A page on an edge of the sheet: three triangles on each edge.
    let page = sheet(30, |u, v| [0.5, u, v]);
    let mut book = joined(&[plain.clone(), page]);
    let spine = |v: u32| if v >= 961 && (v - 961).is_multiple_of(31) { 15 * 31 + (v - 961) / 31 } else { v };
    let triangles = book.triangles().iter().map(|t| t.map(spine)).collect();
    book = TriangleMesh::new(book.vertices().to_vec(), triangles).unwrap();
    faults.extend(faults_of_mesh("book", &book, &[2, 20]));
    let copies: Vec<TriangleMesh> = (0..5).map(|i| sheet(18, |u, v| [u + 3.0 * i as f64, v, 0.0])).collect();
    faults.extend(faults_of_mesh("five equal sheets", &joined(&copies), &[1, 5, 6, 20, 60]));
    for scale in [1e-2, 1e-4, 1e2, 1e5] {
        let other = sheet(20, |u, v| [scale * u, scale * v, 1.0]);
        faults.extend(faults_of_mesh(
            &format!("two scales {scale}"),
            &joined(&[plain.clone(), other]),
            &[2, 3, 30],
        ));
    }
    for scale in [1e-6, 1e6] {
        faults.extend(faults_of_mesh(
            &format!("size {scale}"),
            &sheet(30, |u, v| [scale * u, scale * v, 0.0]),
            &[20],
        ));
    }
    // A bow tie: two sheets that share one vertex.
    let mut tie = joined(&[plain.clone(), sheet(20, |u, v| [u + 1.0, v + 1.0, 0.0])]);
    let triangles = tie.triangles().iter().map(|t| t.map(|v| if v == 961 { 960 } else { v })).collect();
    tie = TriangleMesh::new(tie.vertices().to_vec(), triangles).unwrap();
    faults.extend(faults_of_mesh("bow tie", &tie, &[2, 20]));
    // Triangles that are lines and points.
    let mesh = sheet(30, |u, v| [(u * 10.0).round() / 10.0, v, 0.0]);
    faults.extend(faults_of_mesh("degenerate", &mesh, &[2, 20]));
    assert_none(&faults);
}

#[test]
fn more_pairs_than_voxels_are_refused() {
    let grid = solid([3, 3, 3], [1.0; 3], |_| true);
    for solver in [Eigensolver::Auto, Eigensolver::ShiftInvert, Eigensolver::Filter] {
        let parameters = SpectrumParameters { eigenpairs: 28.into(), solver, ..Default::default() };
        let error =
            smallest_eigenpairs_of_grid(&grid, &parameters, &|_| ControlFlow::Continue(())).unwrap_err();
        assert_eq!(error, SpectralError::TooManyEigenpairs { requested: 28, available: 27 });
    }
}

#[test]
fn copies_of_one_body_multiply_its_eigenvalues() {
    // 27 cubes of 9^3: 0 is 27-fold, 2 - 2 cos(pi / 9) 81-fold, far more than a block has columns.
    let grid = solid([29; 3], [1.0; 3], |v| v.iter().all(|x| x % 10 != 9));
    let first = 2.0 - 2.0 * (std::f64::consts::PI / 9.0).cos();
    for solver in [Eigensolver::ShiftInvert, Eigensolver::Filter] {
        for k in [100, 120] {
            let parameters = SpectrumParameters { eigenpairs: k.into(), solver, ..Default::default() };
            let spectrum =
                smallest_eigenpairs_of_grid(&grid, &parameters, &|_| ControlFlow::Continue(())).unwrap();
            let values = spectrum.basis.eigenvalues();
            let copies = values.iter().filter(|&&v| (v / first - 1.0).abs() < 1e-9).count();
            assert_eq!((spectrum.report.zero_modes, copies), (27, 81.min(k - 27)), "{solver:?} {k}");
        }
    }
}

#[test]
fn more_copies_of_an_eigenvalue_than_a_block_has_columns() {
    // A fishbone: 40 ribs of 31 voxels across a spine. Waves that are odd along a rib vanish at the spine, so
    // each rib has its own: every such eigenvalue is 40-fold.
    let grid = solid([79, 31, 1], [1.0; 3], |v| v[1] == 15 || v[0] % 2 == 0);
    assert_none(&faults_of_grid("fishbone", &grid, &[30, 60, 100]));
    // A book: 24 pages bound at one edge. Waves that vanish at the spine are 23-fold at least.
    let pages: Vec<TriangleMesh> = (0..24)
        .map(|page| {
            let (sin, cos) = (page as f64 * std::f64::consts::TAU / 24.0).sin_cos();
            sheet(8, |u, v| [u * cos, u * sin, v])
        })
        .collect();
    let book = joined(&pages);
    // The first row of nine vertices of each page is the spine.
    let spine = |v: u32| if v % 81 < 9 { v % 81 } else { v };
    let triangles = book.triangles().iter().map(|t| t.map(spine)).collect();
    let book = TriangleMesh::new(book.vertices().to_vec(), triangles).unwrap();
    assert_none(&faults_of_mesh("book of 24 pages", &book, &[40, 100, 200]));
}

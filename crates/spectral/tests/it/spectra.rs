//! Spectra that are known in closed form.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use mser3d_laplace::{Operator, cotangent_laplacian, grid_laplacian};
use mser3d_shape::{BitGrid, Frame, InvalidParameter, TriangleMesh, VoxelGrid};
use mser3d_spectral::{
    SolverUsed, SpectralError, Spectrum, SpectrumParameters, smallest_eigenpairs, smallest_eigenpairs_of_grid,
};

fn solve(operator: &Operator, eigenpairs: usize) -> Spectrum {
    let parameters = SpectrumParameters { eigenpairs: eigenpairs.into(), ..Default::default() };
    smallest_eigenpairs(operator, &parameters, &|_| ControlFlow::Continue(())).unwrap()
}

fn solid(dims: [usize; 3], spacing: [f64; 3], inside: impl Fn([f64; 3]) -> bool) -> VoxelGrid {
    let frame = Frame::new(dims, [0.0; 3], spacing).unwrap();
    let mut bits = BitGrid::empty(dims).unwrap();
    for v in BitGrid::full(dims).unwrap().ones() {
        bits.set(v, inside(frame.centre(v)));
    }
    VoxelGrid::solid(frame, bits).unwrap()
}

/// The k smallest eigenvalues of a box of voxels: sums of (2 - 2 cos(pi i / n)) / h^2 along the axes.
fn box_spectrum(dims: [usize; 3], spacing: [f64; 3], k: usize) -> Vec<f64> {
    let axis = |a: usize| -> Vec<f64> {
        (0..dims[a])
            .map(|i| (2.0 - 2.0 * (PI * i as f64 / dims[a] as f64).cos()) / spacing[a].powi(2))
            .collect()
    };
    let (x, y, z) = (axis(0), axis(1), axis(2));
    let mut all: Vec<f64> = x
        .iter()
        .flat_map(|a| y.iter().map(move |b| a + b))
        .flat_map(|ab| z.iter().map(move |c| ab + c))
        .collect();
    all.sort_by(f64::total_cmp);
    all.truncate(k);
    all
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (i, (f, e)) in found.iter().zip(expected).enumerate() {
        assert!((f - e).abs() <= tolerance * e.max(1e-3), "eigenvalue {i}: {f} instead of {e}");
    }
}

#[test]
fn boxes_have_their_closed_spectra() {
    // A cube (multiplicities up to 6), a thin plate, a long rod, voxels that are no cubes.
    for (dims, spacing) in [
        ([13, 13, 13], [1.0; 3]),
        ([60, 50, 2], [1.0; 3]),
        ([900, 2, 2], [0.1; 3]),
        ([20, 15, 12], [0.5, 1.0, 0.7]),
    ] {
        let spectrum = solve(&grid_laplacian(&solid(dims, spacing, |_| true)), 60);
        assert_close(spectrum.basis.eigenvalues(), &box_spectrum(dims, spacing, 60), 1e-9);
        assert!(spectrum.report.residual < 1e-9 && spectrum.report.orthogonality < 1e-10);
    }
}

#[test]
fn eigenfunctions_are_orthonormal_under_the_mass() {
    let spectrum = solve(&grid_laplacian(&solid([17, 11, 9], [0.3, 0.5, 0.4], |_| true)), 30);
    let basis = &spectrum.basis;
    for i in 0..30 {
        for j in 0..=i {
            let dot: f64 = (0..basis.len()).map(|v| basis.mass()[v] * basis.at(v)[i] * basis.at(v)[j]).sum();
            assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-11, "{i} {j} {dot}");
        }
    }
}

#[test]
fn a_ball_converges_to_the_zeros_of_spherical_bessel_derivatives() {
    // Neumann eigenvalues of the unit ball: squares of the zeros of j_l'(x), each (2l + 1)-fold:
    // l = 1: 2.0816, l = 2: 3.3421, l = 0: 4.4934, l = 3: 4.5141.
    let zeros = [(2.081_575_98, 3), (3.342_093_66, 5), (4.493_409_46, 1), (4.514_099_65, 7)];
    let expected: Vec<f64> = std::iter::once(0.0)
        .chain(zeros.iter().flat_map(|&(x, m): &(f64, usize)| std::iter::repeat_n(x * x, m)))
        .collect();
    let worst = |diameter: usize| {
        let h = 2.0 / diameter as f64;
        let ball = solid([diameter; 3], [h; 3], |c| c.iter().map(|x| (x - 1.0).powi(2)).sum::<f64>() <= 1.0);
        // The voxel ball's own radius, by its volume.
        let scale = (ball.volume() / (4.0 / 3.0 * PI)).powf(2.0 / 3.0);
        let spectrum = solve(&grid_laplacian(&ball), 17);
        let error = |(f, e): (&f64, &f64)| if *e == 0.0 { *f } else { (f * scale / e - 1.0).abs() };
        spectrum.basis.eigenvalues().iter().zip(&expected).map(error).fold(0.0, f64::max)
    };
    let (coarse, fine) = (worst(12), worst(36));
    assert!(fine < 0.06 && fine < coarse / 3.0, "relative errors {coarse} and {fine}");
}

/// An icosphere: its vertices lie on the unit sphere.
fn sphere(subdivisions: usize) -> TriangleMesh {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut points: Vec<[f64; 3]> = Vec::new();
    for (a, b) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
        points.extend([[a, b, 0.0], [0.0, a, b], [b, 0.0, a]]);
    }
    let distance = |p: [f64; 3], q: [f64; 3]| (0..3).map(|a| (p[a] - q[a]).powi(2)).sum::<f64>();
    let mut triangles = Vec::new();
    for i in 0..12u32 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let [p, q, r] = [i, j, k].map(|v| points[v as usize]);
                if [distance(p, q), distance(q, r), distance(p, r)].iter().all(|d| (d - 4.0).abs() < 1e-9) {
                    triangles.push([i, j, k]);
                }
            }
        }
    }
    let mut midpoints = std::collections::HashMap::new();
    for _ in 0..subdivisions {
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |u: u32, v: u32| {
                *midpoints.entry((u.min(v), u.max(v))).or_insert_with(|| {
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
    for p in &mut points {
        let norm = p.iter().map(|x| x * x).sum::<f64>().sqrt();
        *p = p.map(|x| x / norm);
    }
    TriangleMesh::new(points, triangles).unwrap()
}

#[test]
fn a_sphere_has_l_times_l_plus_one() {
    let spectrum = solve(&cotangent_laplacian(&sphere(4)).unwrap(), 36);
    let expected: Vec<f64> =
        (0..6).flat_map(|l| std::iter::repeat_n(f64::from(l * (l + 1)), 2 * l as usize + 1)).collect();
    assert_close(spectrum.basis.eigenvalues(), &expected, 0.02);
}

#[test]
fn triangles_of_very_different_sizes_cost_no_accuracy() {
    // A conformal map of the sphere to itself that shrinks one pole by 1000 and blows up the other: the
    // operator's largest eigenvalue is more than 10^7 times the smallest. (The spectrum of the blown-up
    // side is coarse; this is about the eigenpairs of the mesh as it is.)
    let mesh = sphere(4);
    let map = |&[x, y, z]: &[f64; 3]| {
        let (s, w) = (1.0 / 1000.0, (1.0 + 1e-12 - z).recip());
        let (u, v) = (s * x * w, s * y * w);
        let r = u * u + v * v;
        [2.0 * u / (1.0 + r), 2.0 * v / (1.0 + r), (r - 1.0) / (1.0 + r)]
    };
    let graded = mesh.with_vertices(mesh.vertices().iter().map(map).collect()).unwrap();
    let report = solve(&cotangent_laplacian(&graded).unwrap(), 100).report;
    assert!(report.residual < 1e-9 && report.orthogonality < 1e-9, "{report:?}");
}

#[test]
fn counts_follow_weyls_law() {
    // N(lambda) ~ V lambda^(3/2) / (6 pi^2) + A lambda / (16 pi), Neumann boundary.
    let spectrum = solve(&grid_laplacian(&solid([24, 20, 18], [1.0; 3], |_| true)), 150);
    let lambda = spectrum.basis.eigenvalues()[149];
    let (volume, area) = (24.0 * 20.0 * 18.0, 2.0 * (24.0 * 20.0 + 20.0 * 18.0 + 18.0 * 24.0));
    let weyl = volume * lambda.powf(1.5) / (6.0 * PI * PI) + area * lambda / (16.0 * PI);
    assert!((weyl / 150.0 - 1.0).abs() < 0.1, "{weyl}");
}

#[test]
fn every_component_has_its_exact_constant() {
    // Three bodies: 0 is threefold, each zero mode constant on one body and zero elsewhere.
    let grid =
        solid([40, 9, 9], [1.0; 3], |c| !(13.0..14.0).contains(&c[0]) && !(30.0..31.0).contains(&c[0]));
    let spectrum = solve(&grid_laplacian(&grid), 20);
    assert_eq!(spectrum.report.zero_modes, 3);
    let basis = &spectrum.basis;
    assert_eq!(basis.eigenvalues()[..3], [0.0; 3]);
    assert!(basis.eigenvalues()[3] > 1e-3);
    let labels = grid.components().labels;
    for v in 0..basis.len() {
        for i in 0..3 {
            let size = [13.0, 16.0, 9.0][i] * 81.0f64;
            let expected = if labels[v] as usize == i { 1.0 / size.sqrt() } else { 0.0 };
            assert!((basis.at(v)[i] - expected).abs() < 1e-14);
        }
    }
    let mut parts: Vec<f64> =
        [13, 16, 9].iter().flat_map(|&n| box_spectrum([n, 9, 9], [1.0; 3], 20)).collect();
    parts.sort_by(f64::total_cmp);
    assert_close(basis.eigenvalues(), &parts[..20], 1e-9);
}

#[test]
fn equal_bodies_miss_no_copy_of_an_eigenvalue() {
    // 27 cubes of 9^3: 27 zeros and 81 copies of 2 - 2 cos(pi / 9), on the grid and as a matrix.
    let grid = solid([29; 3], [1.0; 3], |c| c.iter().all(|x| (x - 0.5) % 10.0 != 9.0));
    let mut expected: Vec<f64> = box_spectrum([9; 3], [1.0; 3], 8).repeat(27);
    expected.sort_by(f64::total_cmp);
    let parameters = SpectrumParameters { eigenpairs: 120.into(), ..Default::default() };
    let found = smallest_eigenpairs_of_grid(&grid, &parameters, &|_| ControlFlow::Continue(())).unwrap();
    assert_eq!(found.report.zero_modes, 27);
    assert_close(found.basis.eigenvalues(), &expected[..120], 1e-9);
    assert_close(solve(&grid_laplacian(&grid), 120).basis.eigenvalues(), &expected[..120], 1e-9);
}

#[test]
fn a_vertex_without_triangles_takes_no_part() {
    let mesh = sphere(2);
    let mut vertices = mesh.vertices().to_vec();
    vertices.insert(0, [7.0; 3]);
    let shifted = mesh.triangles().iter().map(|t| t.map(|v| v + 1)).collect();
    let padded = TriangleMesh::new(vertices, shifted).unwrap();
    let (plain, padded) =
        (solve(&cotangent_laplacian(&mesh).unwrap(), 9), solve(&cotangent_laplacian(&padded).unwrap(), 9));
    assert_eq!(padded.report.zero_modes, 1);
    assert_close(padded.basis.eigenvalues(), plain.basis.eigenvalues(), 1e-9);
    assert_eq!(*padded.basis.at(0), [0.0; 9]);
}

#[test]
fn the_bits_do_not_depend_on_the_number_of_threads() {
    let operator = grid_laplacian(&solid([19, 18, 17], [1.0; 3], |_| true));
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&operator, 25)).basis
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn wrong_requests_are_clear_errors() {
    let operator = grid_laplacian(&solid([5, 5, 5], [1.0; 3], |_| true));
    let ask = |parameters: SpectrumParameters| {
        smallest_eigenpairs(&operator, &parameters, &|_| ControlFlow::Continue(())).unwrap_err()
    };
    let error = ask(SpectrumParameters { eigenpairs: 10_000_000.into(), ..Default::default() });
    assert_eq!(error, SpectralError::TooManyEigenpairs { requested: 10_000_000, available: 125 });
    assert!(matches!(
        ask(SpectrumParameters { eigenpairs: 0.into(), ..Default::default() }),
        SpectralError::InvalidParameter(InvalidParameter { name: "eigenpairs", .. })
    ));
    assert!(matches!(
        ask(SpectrumParameters { tolerance: f64::NAN, ..Default::default() }),
        SpectralError::InvalidParameter(InvalidParameter { name: "tolerance", .. })
    ));
    let error = ask(SpectrumParameters { memory_limit: Some(1000), ..Default::default() });
    assert!(error.to_string().contains("coarser grid"), "{error}");
}

#[test]
fn sizes_whose_powers_overflow_are_no_panic() {
    for spacing in [1e-170, 1e160] {
        let grid = solid([24; 3], [spacing; 3], |_| true);
        let parameters = SpectrumParameters { eigenpairs: 10.into(), ..Default::default() };
        let go_on = |_| ControlFlow::Continue(());
        assert!(smallest_eigenpairs_of_grid(&grid, &parameters, &go_on).is_err());
        assert!(smallest_eigenpairs(&grid_laplacian(&grid), &parameters, &go_on).is_err());
    }
}

#[test]
fn cancelling_ends_the_work() {
    let operator = grid_laplacian(&solid([20, 20, 20], [1.0; 3], |_| true));
    let result = smallest_eigenpairs(&operator, &SpectrumParameters::default(), &|_| ControlFlow::Break(()));
    assert_eq!(result.unwrap_err(), SpectralError::Cancelled);
}

#[test]
fn progress_never_goes_back_and_ends_at_one() {
    let body = solid([24, 60, 16], [1.0; 3], |c| c[1] < 30.0 || c[0] < 12.0);
    let two = solid([50, 40, 14], [1.0; 3], |c| c[0] < 28.0 || c[0] > 30.0);
    assert_eq!((body.component_count(), two.component_count()), (1, 2));
    let cube = solid([16; 3], [1.0; 3], |_| true);
    let parameters = SpectrumParameters { eigenpairs: 30.into(), ..Default::default() };
    let heard = std::sync::Mutex::new(Vec::new());
    let hear = |share: f64| {
        heard.lock().unwrap().push(share);
        ControlFlow::Continue(())
    };
    let solvers: [&dyn Fn() -> Spectrum; 4] = [
        &|| smallest_eigenpairs_of_grid(&body, &parameters, &hear).unwrap(),
        &|| smallest_eigenpairs_of_grid(&two, &parameters, &hear).unwrap(),
        &|| smallest_eigenpairs(&grid_laplacian(&cube), &parameters, &hear).unwrap(),
        &|| smallest_eigenpairs(&grid_laplacian(&two), &parameters, &hear).unwrap(),
    ];
    let mut names = Vec::new();
    for solve in solvers {
        names.push(solve().report.solver);
        let heard = std::mem::take(&mut *heard.lock().unwrap());
        assert!(heard.is_sorted(), "{heard:?}");
        assert!(heard.len() > 4 && heard[0] < 0.3, "{heard:?}");
        // It neither stands still and leaps, nor ends too early.
        assert!(heard.windows(2).all(|w| w[1] - w[0] < 0.3), "{heard:?}");
        assert_eq!(heard.iter().filter(|&&share| share == 1.0).count(), 1);
        assert_eq!(heard.last(), Some(&1.0));
    }
    let (filter, shift_invert) = (SolverUsed::Filter, SolverUsed::ShiftInvert);
    assert_eq!(names, [filter, filter, shift_invert, shift_invert]);
}

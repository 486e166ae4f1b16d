//! Spectra of small solids and surfaces beside a dense solver: Jacobi's rotations, which share nothing with ours.

use arbitrary::Unstructured;
use mser3d::NO_PROGRESS;
use mser3d_laplace::{Operator, cotangent_laplacian, grid_laplacian};
use mser3d_shape::{BitGrid, Frame, TriangleMesh, VoxelGrid};
use mser3d_spectral::{
    Eigensolver, Spectrum, SpectrumParameters, smallest_eigenpairs, smallest_eigenpairs_of_grid,
};
use std::ops::ControlFlow;

pub fn run(input: &[u8]) {
    let mut input = Unstructured::new(input);
    let _ = match input.arbitrary::<bool>() {
        Ok(true) => solids(&mut input),
        Ok(false) => surfaces(&mut input),
        Err(error) => Err(error),
    };
}

fn solids(input: &mut Unstructured) -> arbitrary::Result<()> {
    let dims = [input.int_in_range(1..=5)?, input.int_in_range(1..=4)?, input.int_in_range(1..=3)?];
    let spacing = *input.choose(&[[1.0; 3], [0.5, 1.0, 2.0], [1e-3; 3], [1e6, 1e6, 3e6]])?;
    let frame = Frame::new(dims, [0.0; 3], spacing).unwrap_or_else(|error| panic!("{error}"));
    let mut inside = BitGrid::empty(dims).unwrap_or_else(|error| panic!("{error}"));
    let places: Vec<[u32; 3]> = (0..dims.iter().product::<usize>())
        .map(|v| [v % dims[0], v / dims[0] % dims[1], v / dims[0] / dims[1]].map(|x| x as u32))
        .collect();
    for &place in &places {
        inside.set(place, input.ratio(7, 8)?);
    }
    let mut grid = VoxelGrid::solid(frame, inside).unwrap_or_else(|error| panic!("{error}"));
    for axis in 0..3 {
        let mut cut = Vec::new();
        for &place in &places {
            if input.ratio(1, 12)? {
                cut.push(place);
            }
        }
        grid = grid.with_cut_links(axis, &cut).0;
    }
    if grid.is_empty() {
        return Ok(());
    }
    let operator = grid_laplacian(&grid);
    let expected = dense_eigenvalues(&operator);
    let parameters = parameters(input, grid.len())?;
    let go_on = |_: f64| ControlFlow::Continue(());
    let of_grid = smallest_eigenpairs_of_grid(&grid, &parameters, &go_on);
    compare(&of_grid.unwrap_or_else(|error| panic!("{error}")), &operator, &expected, &parameters);
    let of_matrix = smallest_eigenpairs(&operator, &parameters, &go_on);
    compare(&of_matrix.unwrap_or_else(|error| panic!("{error}")), &operator, &expected, &parameters);
    let _ = NO_PROGRESS;
    Ok(())
}

/// Triangles at random on a few vertices: non-manifold, degenerate, in pieces.
fn surfaces(input: &mut Unstructured) -> arbitrary::Result<()> {
    let count = input.int_in_range(3..=12usize)?;
    let mut vertices = Vec::new();
    for _ in 0..count {
        let mut place = [0.0; 3];
        for x in &mut place {
            *x = f64::from(input.int_in_range(0..=6u8)?);
        }
        vertices.push(place);
    }
    let mut triangles = Vec::new();
    for _ in 0..input.int_in_range(1..=16)? {
        let mut triangle = [0u32; 3];
        for v in &mut triangle {
            *v = input.int_in_range(0..=count as u32 - 1)?;
        }
        triangles.push(triangle);
    }
    let Ok(mesh) = TriangleMesh::new(vertices, triangles) else { return Ok(()) };
    let Ok(operator) = cotangent_laplacian(&mesh) else { return Ok(()) };
    let rows = operator.mass().iter().filter(|mass| **mass > 0.0).count();
    if rows == 0 {
        return Ok(());
    }
    let expected = dense_eigenvalues(&operator);
    let parameters = parameters(input, rows)?;
    let go_on = |_: f64| ControlFlow::Continue(());
    match smallest_eigenpairs(&operator, &parameters, &go_on) {
        Ok(spectrum) => compare(&spectrum, &operator, &expected, &parameters),
        Err(error) => panic!("{error}: {:?}", mesh),
    }
    Ok(())
}

fn parameters(input: &mut Unstructured, most: usize) -> arbitrary::Result<SpectrumParameters> {
    let count = input.int_in_range(1..=most.min(20))?;
    let solver = *input.choose(&[
        Eigensolver::Auto,
        Eigensolver::ShiftInvert,
        Eigensolver::Filter,
        Eigensolver::Multigrid,
    ])?;
    Ok(SpectrumParameters { eigenpairs: count.into(), solver, ..SpectrumParameters::default() })
}

/// Eigenvalues as the dense solver has them, and residuals and lengths as promised.
fn compare(spectrum: &Spectrum, operator: &Operator, expected: &[f64], parameters: &SpectrumParameters) {
    let (basis, about) = (&spectrum.basis, (&spectrum.report, parameters));
    let largest = expected.last().copied().unwrap_or(0.0);
    let found = basis.eigenvalues();
    assert!(!found.is_empty() && found.len() <= expected.len(), "{about:?}");
    for (found, wanted) in found.iter().zip(expected) {
        let error = (found - wanted).abs();
        assert!(error <= 1e-7 * wanted.abs() + 1e-10 * largest, "{about:?}: {found} for {wanted}");
    }
    let (count, functions) = (found.len(), basis.functions().to_f64());
    for i in 0..count {
        for j in 0..=i {
            let rows = operator.mass().iter().enumerate();
            let product: f64 =
                rows.map(|(row, mass)| mass * functions[row * count + i] * functions[row * count + j]).sum();
            let wanted = f64::from(u8::from(i == j));
            assert!((product - wanted).abs() < 1e-6, "{about:?}: {i} and {j} have the product {product}");
        }
    }
}

/// All eigenvalues of W x = lambda M x on the rows with mass, ascending.
fn dense_eigenvalues(operator: &Operator) -> Vec<f64> {
    let rows: Vec<usize> = (0..operator.len()).filter(|&row| operator.mass()[row] > 0.0).collect();
    let n = rows.len();
    let mut a = vec![0.0; n * n];
    for (i, &row) in rows.iter().enumerate() {
        for (j, &column) in rows.iter().enumerate() {
            let value = operator.stiffness().get(row, column).copied().unwrap_or(0.0);
            a[i * n + j] = value / (operator.mass()[row] * operator.mass()[column]).sqrt();
        }
    }
    jacobi(&mut a, n)
}

/// The eigenvalues of a symmetric matrix, by cyclic rotations.
fn jacobi(a: &mut [f64], n: usize) -> Vec<f64> {
    let norm: f64 = a.iter().map(|x| x * x).sum::<f64>().sqrt();
    for _ in 0..60 {
        let off: f64 =
            (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| a[i * n + j].powi(2)).sum();
        if off.sqrt() <= 1e-16 * norm {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                let apq = a[p * n + q];
                if apq == 0.0 {
                    continue;
                }
                let theta = (a[q * n + q] - a[p * n + p]) / (2.0 * apq);
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let t = if theta == 0.0 { 1.0 } else { t };
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for k in 0..n {
                    let (x, y) = (a[k * n + p], a[k * n + q]);
                    (a[k * n + p], a[k * n + q]) = (c * x - s * y, s * x + c * y);
                }
                for k in 0..n {
                    let (x, y) = (a[p * n + k], a[q * n + k]);
                    (a[p * n + k], a[q * n + k]) = (c * x - s * y, s * x + c * y);
                }
            }
        }
    }
    let mut values: Vec<f64> = (0..n).map(|i| a[i * n + i]).collect();
    values.sort_by(f64::total_cmp);
    values
}

pub fn seeds() -> Vec<Vec<u8>> {
    (0..16u8).map(|kind| (0..120u8).map(|i| i.wrapping_mul(kind | 1).wrapping_add(kind)).collect()).collect()
}

//! The entry points: choose a solver, run it, measure the result.

use std::ops::ControlFlow;

use mser3d_laplace::{Operator, grid_laplacian};
use mser3d_shape::{Domain, Eigenbasis, VoxelGrid};
use rayon::prelude::*;

use crate::filter::{basis_columns, coarse_factor, filtered_eigenpairs};
use crate::lanczos::{BLOCK, Lanczos, RitzPairs};
use crate::parts::{members, merge};
use crate::shift_invert::Inverse;
use crate::standard::{StandardProblem, dense_eigenpairs};
use crate::tall::{LANES, Tall};
use crate::{Eigensolver, SpectralError, Spectrum, SpectrumParameters, SpectrumReport};

/// Rows below which a dense solver is faster than any iteration.
const DENSE_ROWS: usize = 400;

/// The smallest eigenpairs of `W phi = lambda M phi`.
///
/// `progress` hears the number of converged eigenpairs now and then, and may break to cancel.
///
/// Cost: a sparse Cholesky factorization, then about 2.5 k solves and `O(n k^2)` for orthogonality.
///
/// # Errors
/// [`SpectralError`]: parameters out of range, more eigenpairs than rows, too much memory, no
/// convergence, a breakdown of the factorization, or cancellation.
pub fn smallest_eigenpairs(
    operator: &Operator,
    parameters: &SpectrumParameters,
    progress: &(dyn Fn(usize) -> ControlFlow<()> + Sync),
) -> Result<Spectrum, SpectralError> {
    parameters.validate()?;
    let bodies = members(&operator.components(), |row| operator.mass()[row] > 0.0);
    let (available, k) = (bodies.iter().map(Vec::len).sum(), parameters.eigenpairs);
    if k > available {
        return Err(SpectralError::TooManyEigenpairs { requested: k, available });
    }
    if bodies.len() > 1 {
        return merge(operator.domain(), operator.mass(), &bodies, k, |body, count| {
            let parameters = SpectrumParameters { eigenpairs: count, ..parameters.clone() };
            connected_eigenpairs(&operator.restrict(&bodies[body]), &parameters, progress)
        });
    }
    connected_eigenpairs(operator, parameters, progress)
}

/// As [`smallest_eigenpairs`], of an operator with one component.
fn connected_eigenpairs(
    operator: &Operator,
    parameters: &SpectrumParameters,
    progress: &(dyn Fn(usize) -> ControlFlow<()> + Sync),
) -> Result<Spectrum, SpectralError> {
    let problem = StandardProblem::new(operator);
    let (n, k) = (problem.len(), parameters.eigenpairs);
    check_size(problem.unit_eigenvalue, problem.bound())?;
    let zeros = problem.null_space.len().min(k);
    let wanted = k - zeros;
    let capacity = lanczos_capacity((COLUMNS_PER_PAIR * wanted as f64) as usize);
    if n <= DENSE_ROWS || capacity + 2 * BLOCK > n - problem.null_space.len() {
        check_memory(parameters, n, 3 * n * n)?;
        let (values, vectors) = dense_eigenpairs(&problem)?;
        return finish(operator, &problem, parameters, "dense", values, vectors, (0, 0), k);
    }
    if wanted == 0 {
        let none = Tall::zeros(n, 1);
        return finish(operator, &problem, parameters, "shift-invert Lanczos", vec![], none, (0, 0), k);
    }
    check_memory(parameters, n, n * (capacity + 5 * BLOCK + k) + 60 * n)?;
    let (restarts, tolerance) = (parameters.max_iterations, parameters.tolerance);
    let (values, ritz) = inverse_lanczos(&problem, wanted, capacity, restarts, tolerance, progress)?;
    let counts = (ritz.restarts, ritz.applications);
    finish(operator, &problem, parameters, "shift-invert Lanczos", values, ritz.vectors, counts, k)
}

/// The smallest eigenpairs of a voxel grid's Laplacian ([`mser3d_laplace::grid_laplacian`]), by the
/// solver that suits it: from a few thousand voxels on a polynomial filter that needs no matrix.
///
/// Cost of the filter, measured: `16 n^(4/3) k^(2/3)` stencil updates of half a nanosecond and `20 n k^2` flops;
/// memory for about 2.5 k vectors. `progress` as in [`smallest_eigenpairs`].
///
/// # Errors
/// As [`smallest_eigenpairs`].
pub fn smallest_eigenpairs_of_grid(
    grid: &VoxelGrid,
    parameters: &SpectrumParameters,
    progress: &(dyn Fn(usize) -> ControlFlow<()> + Sync),
) -> Result<Spectrum, SpectralError> {
    parameters.validate()?;
    let (n, k) = (grid.len(), parameters.eigenpairs);
    if k > n {
        return Err(SpectralError::TooManyEigenpairs { requested: k, available: n });
    }
    let volume = grid.frame().voxel_volume();
    check_size(volume, grid.frame().spacing().iter().map(|h| 1.0 / (h * h)).sum())?;
    let bodies = members(&grid.components(), |_| true);
    if bodies.len() > 1 {
        let mass = vec![grid.frame().voxel_volume(); n];
        return merge(Domain::Volume, &mass, &bodies, k, |body, count| {
            let parameters = SpectrumParameters { eigenpairs: count, ..parameters.clone() };
            let part = grid.restrict(|v| bodies[body].binary_search(&v).is_ok());
            smallest_eigenpairs_of_grid(&part, &parameters, progress)
        });
    }
    let filter = match parameters.solver {
        Eigensolver::Auto => coarse_factor(n, k).is_some(),
        Eigensolver::Filter => basis_columns(k) + 2 * BLOCK < n / 8,
        Eigensolver::ShiftInvert => false,
    };
    // The zero mode alone needs no iteration.
    if !filter || k == 1 {
        return smallest_eigenpairs(&grid_laplacian(grid), parameters, progress);
    }
    check_memory(parameters, n, n * filter_columns(k) + 8 * n)?;
    let found = filtered_eigenpairs(grid, parameters, progress)?;
    let zero_modes = found.null_space.len().min(k);
    let wanted = k - zero_modes;
    let residual = check_residuals(&found.values, &found.residuals, found.bound, parameters, found.restarts)?;
    let report = SpectrumReport {
        solver: "filtered Lanczos",
        iterations: found.restarts,
        applications: found.applications,
        residual,
        orthogonality: orthogonality(&found.vectors, wanted),
        zero_modes,
    };
    let scale = 1.0 / grid.frame().voxel_volume().sqrt();
    let order = ascending(&found.values);
    let mut functions = vec![0.0; n * k];
    for (row, &voxel) in found.order.iter().enumerate() {
        let target = &mut functions[voxel as usize * k..(voxel as usize + 1) * k];
        if let Some(constant) = target[..zero_modes].get_mut(found.null_space.label(row)) {
            *constant = found.null_space.constant(row);
        }
        for (t, &i) in target[zero_modes..].iter_mut().zip(&order) {
            *t = found.vectors.at(row, i) * scale;
        }
    }
    let values = std::iter::repeat_n(0.0, zero_modes).chain(order.iter().map(|&i| found.values[i]));
    let mass = vec![grid.frame().voxel_volume(); n];
    let basis = Eigenbasis::new(Domain::Volume, mass, values.collect(), functions)
        .map_err(|_| SpectralError::Overflow)?;
    Ok(Spectrum { basis, report })
}

/// Columns of n numbers that the filter holds at its peak: the basis with a block's image and work
/// space, or the eigenvectors twice.
fn filter_columns(k: usize) -> usize {
    (basis_columns(k) + 3 * BLOCK).max(2 * k + BLOCK)
}

/// The places of values that are nearly in order, in order.
fn ascending(values: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    order
}

/// The smallest non-zero eigenvalues of a coarse operator, roughly.
pub(crate) fn coarse_eigenvalues(operator: &Operator, wanted: usize) -> Result<Vec<f64>, SpectralError> {
    let problem = StandardProblem::new(operator);
    let wanted = wanted.min(problem.len() - problem.null_space.len());
    // One sweep without restarts: a cut-off need not be exact.
    let capacity = lanczos_capacity(3 * wanted / 2);
    let rows = problem.len() - problem.null_space.len();
    let mut values = if problem.len() <= DENSE_ROWS || capacity + 2 * BLOCK > rows {
        dense_eigenpairs(&problem)?.0
    } else {
        inverse_lanczos(&problem, wanted, capacity, 0, 1e-2, &|_| ControlFlow::Continue(()))?.0
    };
    values.truncate(wanted);
    Ok(values)
}

/// About 2.5 k columns find k pairs without a restart; small k needs some more.
const COLUMNS_PER_PAIR: f64 = 2.5;

/// Columns of the basis, a multiple of the block's.
fn lanczos_capacity(columns: usize) -> usize {
    (columns + 4 * BLOCK) / BLOCK * BLOCK
}

/// Eigenvalues, ascending, and Ritz vectors by Lanczos on the inverse.
fn inverse_lanczos(
    problem: &StandardProblem,
    wanted: usize,
    capacity: usize,
    max_restarts: usize,
    tolerance: f64,
    progress: &(dyn Fn(usize) -> ControlFlow<()> + Sync),
) -> Result<(Vec<f64>, RitzPairs), SpectralError> {
    let zeros = problem.null_space.len();
    // A shift well below the wanted eigenvalues (33 k^(2/3) / V^(2/3) by Weyl's law) that still keeps
    // the matrix well conditioned.
    let sigma = problem.unit_eigenvalue;
    let inverse = Inverse::new(problem, sigma)?;
    let lanczos = Lanczos {
        rows: problem.len(),
        wanted,
        capacity,
        check_from: 7 * wanted / 4,
        max_restarts,
        null_space: &problem.null_space,
    };
    // With theta = 1 / (lambda + sigma), a residual r of the inverse is one of r / theta^2 of A after a
    // step of inverse iteration, and lambda may be far below sigma. A margin, and a floor where rounding
    // ends all progress, because true residuals decide in the end.
    let accept = |theta: f64, residual: f64| {
        let lambda_theta = 1.0 - sigma * theta;
        residual <= theta * (0.1 * tolerance * lambda_theta).max(1e-14)
    };
    let report = |converged: usize| progress(zeros + converged).is_continue();
    let mut ritz = lanczos.run(|x| inverse.apply(x), accept, report)?;
    let values: Vec<f64> = ritz.values.iter().map(|theta| (1.0 / theta - sigma).max(0.0)).collect();
    let residuals = Quality::measure(problem, &values[..wanted], &ritz.vectors).residuals;
    let bound = problem.bound();
    if residuals.iter().zip(&values).any(|(&r, &value)| r > attainable(tolerance, bound, value)) {
        ritz.vectors = smoothed(ritz.vectors, &ritz.values[..wanted], &inverse);
    }
    Ok((values, ritz))
}

/// `theta^(-1) (A + sigma I)^(-1) x` for each Ritz pair.
///
/// Lanczos leaves the rounding errors of hundreds of columns in its vectors, tiny but rough, and a mesh
/// with triangles of very different sizes multiplies those by 10^7. The inverse smooths them away.
/// Residuals of Ritz vectors are orthogonal to all of them, so this changes their scalar products only
/// by the square of the residuals.
fn smoothed(mut vectors: Tall, theta: &[f64], inverse: &Inverse) -> Tall {
    inverse.apply(&mut vectors);
    rescale(&mut vectors, theta);
    vectors
}

/// Divides each column by its Ritz value.
pub(crate) fn rescale(vectors: &mut Tall, theta: &[f64]) {
    vectors.blocks_mut().iter_mut().zip(theta.chunks(LANES)).for_each(|(block, theta)| {
        for row in block {
            theta.iter().zip(&mut row.0).for_each(|(theta, x)| *x /= theta);
        }
    });
}

/// Measures residuals and orthogonality of the pairs, and makes the eigenbasis if they will do.
#[allow(clippy::too_many_arguments)]
fn finish(
    operator: &Operator,
    problem: &StandardProblem,
    parameters: &SpectrumParameters,
    solver: &'static str,
    values: Vec<f64>,
    vectors: Tall,
    (iterations, applications): (usize, usize),
    k: usize,
) -> Result<Spectrum, SpectralError> {
    let zero_modes = problem.null_space.len().min(k);
    let wanted = k - zero_modes;
    let quality = Quality::measure(problem, &values[..wanted], &vectors);
    let residual =
        check_residuals(&values[..wanted], &quality.residuals, problem.bound(), parameters, iterations)?;
    let report = SpectrumReport {
        solver,
        iterations,
        applications,
        residual,
        orthogonality: quality.orthogonality,
        zero_modes,
    };
    Ok(Spectrum { basis: problem.eigenbasis(operator, &values, &vectors, k)?, report })
}

/// True residuals and orthogonality, measured on the vectors.
struct Quality {
    residuals: Vec<f64>,
    orthogonality: f64,
}

impl Quality {
    fn measure(problem: &StandardProblem, values: &[f64], vectors: &Tall) -> Self {
        let count = values.len();
        let residuals = vectors.blocks()[..count.div_ceil(LANES)].par_iter().enumerate().map(|(b, x)| {
            let mut y = x.clone();
            problem.apply(x, &mut y);
            let mut sums = [0.0; LANES];
            for (x, y) in x.iter().zip(&y) {
                for l in 0..LANES.min(count - b * LANES) {
                    sums[l] += (y.0[l] - values[b * LANES + l] * x.0[l]).powi(2);
                }
            }
            std::array::from_fn(|l| sums[l].sqrt() / values.get(b * LANES + l).unwrap_or(&1.0))
        });
        let residuals: Vec<[f64; LANES]> = residuals.collect();
        let residuals = residuals.as_flattened()[..count].to_vec();
        Self { residuals, orthogonality: orthogonality(vectors, count) }
    }
}

/// The relative residual to reach at an eigenvalue: the tolerance, or what rounding allows. An operator
/// of norm `bound` is applied with an error of a few units in the last place of `bound`, which is much of a
/// small eigenvalue on long thin shapes and on meshes of very uneven triangles.
pub(crate) fn attainable(tolerance: f64, bound: f64, eigenvalue: f64) -> f64 {
    tolerance.max(16.0 * f64::EPSILON * bound / eigenvalue)
}

/// The largest residual, if all are below what is attainable.
fn check_residuals(
    values: &[f64],
    residuals: &[f64],
    bound: f64,
    parameters: &SpectrumParameters,
    restarts: usize,
) -> Result<f64, SpectralError> {
    let residual = residuals.iter().copied().fold(0.0, f64::max);
    let good =
        |&(&value, &residual): &(&f64, &f64)| residual <= attainable(parameters.tolerance, bound, value);
    let converged = values.iter().zip(residuals).filter(good).count();
    if converged == residuals.len() {
        return Ok(residual);
    }
    Err(SpectralError::NotConverged {
        converged: parameters.eigenpairs - residuals.len() + converged,
        wanted: parameters.eigenpairs,
        restarts,
        residual,
        tolerance: parameters.tolerance,
    })
}

/// Whether a measure and the operator's bound are numbers that can be computed with.
fn check_size(measure: f64, bound: f64) -> Result<(), SpectralError> {
    // A bound of zero is an operator of one row.
    if measure.is_normal() && bound.is_finite() { Ok(()) } else { Err(SpectralError::Overflow) }
}

/// Largest entry of |V^T V - I| over the first columns.
fn orthogonality(vectors: &Tall, count: usize) -> f64 {
    let gram = vectors.gram(0..count.div_ceil(LANES), vectors);
    let entries = (0..count).flat_map(|i| (0..count).map(move |j| (i, j)));
    entries.map(|(i, j)| (gram[(i, j)] - f64::from(u8::from(i == j))).abs()).fold(0.0, f64::max)
}

fn check_memory(parameters: &SpectrumParameters, rows: usize, numbers: usize) -> Result<(), SpectralError> {
    let needed = numbers as u64 * 8;
    match parameters.memory_limit {
        Some(limit) if needed > limit => Err(SpectralError::TooMuchMemory {
            pairs: parameters.eigenpairs,
            rows,
            needed_mb: needed / 1_000_000,
            limit_mb: limit / 1_000_000,
        }),
        _ => Ok(()),
    }
}

//! The entry points: choose a solver, run it, measure the result.

use std::ops::ControlFlow;

use mser3d_laplace::{Operator, aggregate_grid, grid_laplacian};
use mser3d_shape::{Domain, Eigenbasis, VoxelGrid};
use rayon::prelude::*;

use crate::complete::may_hide_copies;
use crate::count::count_below;
use crate::extent::all_below;
use crate::factor::Elimination;
use crate::filter::{basis_columns, coarse_factor, filtered_eigenpairs};
use crate::parts::{members, merge};
use crate::progress::Heard;
use crate::shift_invert::{self, Pairs, Task, inverse_eigenpairs};
use crate::standard::{StandardProblem, dense_eigenpairs, unit_eigenvalue};
use crate::tall::{LANES, Tall};
use crate::{Eigensolver, Extent, SpectralError, Spectrum, SpectrumParameters, SpectrumReport};

/// Rows below which a dense solver is faster than any iteration.
const DENSE_ROWS: usize = 400;

/// The smallest eigenpairs of `W phi = lambda M phi`.
///
/// `progress` hears the number of converged eigenpairs now and then, at the end that of all, and may break to cancel.
///
/// Cost: a few sparse factorizations, then 3 k solves at most and `O(n k^2)` for orthogonality.
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
    let available = bodies.iter().map(Vec::len).sum();
    let solve = |k: usize| {
        let heard = Heard::new(k, progress);
        let spectrum = if bodies.len() > 1 {
            merge(operator.domain(), operator.mass(), &bodies, k, |body, count| {
                let part = operator.restrict(&bodies[body]);
                heard.next(count, |progress| connected_eigenpairs(&part, count, parameters, progress))
            })
        } else {
            heard.next(k, |progress| connected_eigenpairs(operator, k, parameters, progress))
        };
        heard.end(spectrum)
    };
    match parameters.eigenpairs {
        Extent::Count(k) if k > available => {
            Err(SpectralError::TooManyEigenpairs { requested: k, available })
        }
        Extent::Count(k) => solve(k),
        Extent::Below(_) if available == 0 => {
            Err(SpectralError::TooManyEigenpairs { requested: 1, available })
        }
        Extent::Below(relative) => {
            let measure = operator.mass().iter().sum();
            let bound = relative * unit_eigenvalue(operator.domain(), measure);
            check_size(measure, bound)?;
            // One more lies beyond the bound.
            let count = count_below(operator, bound, parameters.memory_limit)? + 1;
            all_below(bound, count, available, solve)
        }
    }
}

/// As [`smallest_eigenpairs`], of an operator with one component.
fn connected_eigenpairs(
    operator: &Operator,
    k: usize,
    parameters: &SpectrumParameters,
    progress: &(dyn Fn(usize) -> ControlFlow<()> + Sync),
) -> Result<Spectrum, SpectralError> {
    let problem = StandardProblem::new(operator);
    let n = problem.len();
    check_size(problem.unit_eigenvalue, problem.bound())?;
    let zeros = problem.null_space.len().min(k);
    let wanted = k - zeros;
    let columns = shift_invert::basis_columns(wanted) + 2 * LANES;
    if n <= DENSE_ROWS || columns > n - problem.null_space.len() {
        check_memory(parameters.memory_limit, format!("{k} eigenpairs"), n, 3 * n * n)?;
        let (mut values, vectors) = dense_eigenpairs(&problem)?;
        values.truncate(wanted);
        return finish(
            operator,
            &problem,
            k,
            parameters.tolerance,
            "dense",
            Pairs::measured(&problem, values, vectors),
        );
    }
    let solver = "shift-invert Lanczos";
    if wanted == 0 {
        let pairs = Pairs::measured(&problem, Vec::new(), Tall::zeros(n, 1));
        return finish(operator, &problem, k, parameters.tolerance, solver, pairs);
    }
    // Before anything large is made; the factor's size is known when its pattern is.
    let numbers = n * (columns + 3 * k) + 60 * n;
    check_memory(parameters.memory_limit, format!("{k} eigenpairs"), n, numbers)?;
    let elimination = Elimination::new(&problem)?;
    check_memory(parameters.memory_limit, format!("{k} eigenpairs"), n, numbers + elimination.len())?;
    let task = Task { wanted, tolerance: parameters.tolerance, max_restarts: parameters.max_iterations };
    let report = |converged: usize| progress(zeros + converged).is_continue();
    let pairs = inverse_eigenpairs(&problem, &elimination, &task, &report)?;
    finish(operator, &problem, k, parameters.tolerance, solver, pairs)
}

/// The smallest eigenpairs of a voxel grid's Laplacian ([`mser3d_laplace::grid_laplacian`]), by the
/// solver that suits it: from a few thousand voxels on a polynomial filter that needs no matrix.
///
/// Cost of the filter, measured: `9.5 n^(4/3) k^(2/3)` stencil updates of 0.25 to 0.5 ns and `20 n k^2` flops;
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
    let n = grid.len();
    let cell = grid.frame().voxel_volume();
    check_size(cell, grid.frame().spacing().iter().map(|h| 1.0 / (h * h)).sum())?;
    let bodies = members(&grid.components(), |_| true);
    let solve = |k: usize| {
        let heard = Heard::new(k, progress);
        let spectrum = if bodies.len() > 1 {
            merge(Domain::Volume, &vec![cell; n], &bodies, k, |body, count| {
                let part = grid.restrict(|v| bodies[body].binary_search(&v).is_ok());
                heard.next(count, |progress| connected_grid_eigenpairs(&part, count, parameters, progress))
            })
        } else {
            heard.next(k, |progress| connected_grid_eigenpairs(grid, k, parameters, progress))
        };
        heard.end(spectrum)
    };
    match parameters.eigenpairs {
        Extent::Count(k) if k > n => Err(SpectralError::TooManyEigenpairs { requested: k, available: n }),
        Extent::Count(k) => solve(k),
        Extent::Below(relative) => {
            let bound = relative * unit_eigenvalue(Domain::Volume, grid.volume());
            check_size(grid.volume(), bound)?;
            // A coarser grid has about as many; Weyl's law says how coarse it may be.
            let operator = match coarse_factor(n, parameters.eigenpairs.about(Domain::Volume)) {
                Some(factor) => aggregate_grid(grid, factor).operator,
                None => grid_laplacian(grid),
            };
            let count = count_below(&operator, bound, parameters.memory_limit)?;
            all_below(bound, count + count / 10 + 4, n, solve)
        }
    }
}

/// As [`smallest_eigenpairs_of_grid`], of a grid with one component.
fn connected_grid_eigenpairs(
    grid: &VoxelGrid,
    k: usize,
    parameters: &SpectrumParameters,
    progress: &(dyn Fn(usize) -> ControlFlow<()> + Sync),
) -> Result<Spectrum, SpectralError> {
    let n = grid.len();
    let filter = match parameters.solver {
        Eigensolver::Auto => coarse_factor(n, k).is_some(),
        Eigensolver::Filter => basis_columns(k) + 2 * LANES < n / 8,
        Eigensolver::ShiftInvert => false,
    };
    // The zero mode alone needs no iteration.
    if !filter || k == 1 {
        return connected_eigenpairs(&grid_laplacian(grid), k, parameters, progress);
    }
    check_memory(parameters.memory_limit, format!("{k} eigenpairs"), n, n * filter_columns(k) + 8 * n)?;
    let found = filtered_eigenpairs(grid, k, parameters, progress)?;
    // The inverse sees more copies than a block has columns, the filter doesn't: bodies with so many are rare.
    if may_hide_copies(&found.values, LANES) {
        return connected_eigenpairs(&grid_laplacian(grid), k, parameters, progress);
    }
    let zero_modes = found.null_space.len().min(k);
    let wanted = k - zero_modes;
    let residual =
        check_residuals(&found.values, &found.residuals, found.bound, parameters.tolerance, found.restarts)?;
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
    let mut rows = vec![0u32; n];
    for (row, &voxel) in found.order.iter().enumerate() {
        rows[voxel as usize] = row as u32;
    }
    let mut functions = vec![0.0; n * k];
    functions.par_chunks_exact_mut(k).zip(rows).with_min_len(512).for_each(|(target, row)| {
        let row = row as usize;
        if let Some(constant) = target[..zero_modes].get_mut(found.null_space.label(row)) {
            *constant = found.null_space.constant(row);
        }
        for (t, &i) in target[zero_modes..].iter_mut().zip(&order) {
            *t = found.vectors.at(row, i) * scale;
        }
    });
    let values = std::iter::repeat_n(0.0, zero_modes).chain(order.iter().map(|&i| found.values[i]));
    let mass = vec![grid.frame().voxel_volume(); n];
    let basis = Eigenbasis::new(Domain::Volume, mass, values.collect(), functions)
        .map_err(|_| SpectralError::Overflow)?;
    Ok(Spectrum { basis, report })
}

/// Columns of n numbers that the filter holds at its peak: the basis with a block's image and work
/// space, or the eigenvectors twice.
fn filter_columns(k: usize) -> usize {
    (basis_columns(k) + 6 * LANES).max(2 * k + LANES)
}

/// The places of values that are nearly in order, in order.
fn ascending(values: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    order
}

/// Makes the eigenbasis of the pairs if they will do.
fn finish(
    operator: &Operator,
    problem: &StandardProblem,
    k: usize,
    tolerance: f64,
    solver: &'static str,
    pairs: Pairs,
) -> Result<Spectrum, SpectralError> {
    let zero_modes = problem.null_space.len().min(k);
    let residual =
        check_residuals(&pairs.values, &pairs.residuals, problem.bound(), tolerance, pairs.restarts)?;
    let report = SpectrumReport {
        solver,
        iterations: pairs.restarts,
        applications: pairs.applications,
        residual,
        orthogonality: pairs.orthogonality,
        zero_modes,
    };
    Ok(Spectrum { basis: problem.eigenbasis(operator, &pairs.values, &pairs.vectors, k)?, report })
}

/// `|A x - lambda x| / lambda` of each pair, measured on the vectors.
pub(crate) fn residuals(problem: &StandardProblem, values: &[f64], vectors: &Tall) -> Vec<f64> {
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
    residuals.as_flattened()[..count].to_vec()
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
    tolerance: f64,
    restarts: usize,
) -> Result<f64, SpectralError> {
    let residual = residuals.iter().copied().fold(0.0, f64::max);
    let good = |&(&value, &residual): &(&f64, &f64)| residual <= attainable(tolerance, bound, value);
    let converged = values.iter().zip(residuals).filter(good).count();
    if converged == residuals.len() {
        return Ok(residual);
    }
    Err(SpectralError::NotConverged { converged, wanted: residuals.len(), restarts, residual, tolerance })
}

/// Whether a measure and the operator's bound are numbers that can be computed with.
fn check_size(measure: f64, bound: f64) -> Result<(), SpectralError> {
    // A bound of zero is an operator of one row.
    if measure.is_normal() && bound.is_finite() { Ok(()) } else { Err(SpectralError::Overflow) }
}

/// Largest entry of |V^T V - I| over the first columns.
pub(crate) fn orthogonality(vectors: &Tall, count: usize) -> f64 {
    let gram = vectors.upper_gram(count.div_ceil(LANES));
    let entries = (0..count).flat_map(|i| (i..count).map(move |j| (i, j)));
    entries.map(|(i, j)| (gram[(i, j)] - f64::from(u8::from(i == j))).abs()).fold(0.0, f64::max)
}

/// Whether so many numbers fit within the limit.
pub(crate) fn check_memory(
    limit: Option<u64>,
    work: String,
    rows: usize,
    numbers: usize,
) -> Result<(), SpectralError> {
    let needed = numbers as u64 * 8;
    match limit {
        Some(limit) if needed > limit => Err(SpectralError::TooMuchMemory {
            work,
            rows,
            needed_mb: needed / 1_000_000,
            limit_mb: limit / 1_000_000,
        }),
        _ => Ok(()),
    }
}

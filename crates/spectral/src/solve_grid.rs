//! The smallest eigenpairs of a voxel grid: by the filter, which needs no matrix, where it serves.

use std::ops::ControlFlow;

use mser3d_laplace::{aggregate_grid, grid_laplacian};
use mser3d_shape::{Domain, Eigenbasis, Functions, VoxelGrid};

use crate::block_matrix::PIECE;
use crate::components::{members, merge};
use crate::count::count_below;
use crate::eigenpairs::GridPairs;
use crate::filter::{basis_columns, coarse_factor, filtered_eigenpairs};
use crate::fronts::suits_inverse;
use crate::lambda_max::all_below;
use crate::limits::{check_memory, check_size};
use crate::multigrid::{self, uses_multigrid};
use crate::multiplicity::may_hide_copies;
use crate::progress::Heard;
use crate::quality::{check_residuals, orthogonality};
use crate::row::{LANES, Lanes, Row, Short};
use crate::solve_matrix::connected_eigenpairs;
use crate::standard_problem::unit_eigenvalue;
use crate::{
    EigenpairRange, Eigensolver, SolverUsed, SpectralError, Spectrum, SpectrumParameters, SpectrumReport,
};

/// The tolerance from which on multigrid keeps eigenfunctions in single precision: they take half the memory.
pub const SINGLE_PRECISION: f64 = 1e-4;

/// The smallest eigenpairs of a voxel grid's Laplacian ([`mser3d_laplace::grid_laplacian`]), by the solver
/// that suits it: where there are more than about a hundred voxels for each eigenpair, the polynomial filter,
/// which needs no matrix; from `10 k ln(1 / tolerance)^3` voxels on, multigrid. Long thin bodies, such as rods and
/// coils, suit the inverse: their eigenvalues are so small that the polynomials would be long, and their factors are
/// thin.
///
/// Cost of the filter, measured: `8.3 n^(4/3) k^(2/3)` stencil updates of 0.25 to 0.5 ns and `20 n k^2`
/// flops; memory for about 2.5 k vectors. Of multigrid: 6 to 15 corrections of 1.1 k vectors of 16 ns for each voxel, and
/// `4 n k^2` flops for every three; memory for 1.1 k vectors and 20 more. `progress` as in [`crate::smallest_eigenpairs`].
///
/// ```
/// use std::ops::ControlFlow;
/// use mser3d_shape::{BitGrid, Frame, VoxelGrid};
/// use mser3d_spectral::{EigenpairRange, SpectrumParameters, smallest_eigenpairs_of_grid};
///
/// // All eigenpairs of a cube of side 1 with lambda V^(2/3) below 15: 0, and three near pi^2.
/// let frame = Frame::new([8; 3], [0.0; 3], [0.125; 3])?;
/// let cube = VoxelGrid::solid(frame, BitGrid::full(frame.dims())?)?;
/// let parameters = SpectrumParameters { eigenpairs: EigenpairRange::LambdaMax(15.0), ..Default::default() };
/// let spectrum = smallest_eigenpairs_of_grid(&cube, &parameters, &|_| ControlFlow::Continue(()))?;
/// assert_eq!(spectrum.basis.eigenvalues().len(), 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`crate::smallest_eigenpairs`].
pub fn smallest_eigenpairs_of_grid(
    grid: &VoxelGrid,
    parameters: &SpectrumParameters,
    progress: &(dyn Fn(f64) -> ControlFlow<()> + Sync),
) -> Result<Spectrum, SpectralError> {
    parameters.validate()?;
    let n = grid.len();
    let cell = grid.frame().voxel_volume();
    check_size(cell, grid.frame().spacing().iter().map(|h| 1.0 / (h * h)).sum())?;
    let parts = grid.components();
    // A single body needs no list of its voxels.
    let bodies = if parts.len() > 1 { members(&parts, |_| true) } else { Vec::new() };
    drop(parts);
    let heard = Heard::new(progress);
    let solve = |k: usize| {
        if bodies.len() > 1 {
            merge(Domain::Volume, &vec![cell; n], &bodies, k, |body, count| {
                let part = grid.restrict(|v| bodies[body].binary_search(&v).is_ok());
                heard.next(bodies[body].len() as f64 / n as f64, |progress| {
                    connected_grid_eigenpairs(&part, count, parameters, progress)
                })
            })
        } else {
            heard.next(1.0, |progress| connected_grid_eigenpairs(grid, k, parameters, progress))
        }
    };
    let spectrum = match parameters.eigenpairs {
        EigenpairRange::Count(k) if k > n => {
            Err(SpectralError::TooManyEigenpairs { requested: k, available: n })
        }
        EigenpairRange::Count(k) => solve(k),
        EigenpairRange::AtMost(k) => solve(k.min(n)),
        EigenpairRange::LambdaMax(relative) => {
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
    };
    heard.end(spectrum)
}

/// As [`smallest_eigenpairs_of_grid`], of a grid with one component.
fn connected_grid_eigenpairs(
    grid: &VoxelGrid,
    k: usize,
    parameters: &SpectrumParameters,
    progress: &(dyn Fn(f64) -> ControlFlow<()> + Sync),
) -> Result<Spectrum, SpectralError> {
    let n = grid.len();
    let mut solver = match parameters.solver {
        Eigensolver::Auto if coarse_factor(n, k).is_none() || suits_inverse(grid, k)? => {
            Eigensolver::ShiftInvert
        }
        Eigensolver::Auto | Eigensolver::Multigrid => match uses_multigrid(n, k, parameters) {
            true => Eigensolver::Multigrid,
            false => Eigensolver::Filter,
        },
        chosen => chosen,
    };
    if solver == Eigensolver::Filter && basis_columns(k) + 2 * LANES >= n / 8 {
        solver = Eigensolver::ShiftInvert;
    }
    // The zero mode alone needs no iteration.
    if solver == Eigensolver::ShiftInvert || k == 1 {
        return connected_eigenpairs(&grid_laplacian(grid), k, parameters, progress);
    }
    let what = || format!("{k} eigenpairs");
    let mut stopped = None;
    if solver == Eigensolver::Multigrid {
        let single = parameters.tolerance >= SINGLE_PRECISION;
        let numbers = n * (multigrid::columns(k - 1, single) + 20) + n.min(PIECE) * k;
        check_memory(parameters.memory_limit, what(), n, if single { numbers / 2 } else { numbers })?;
        let found = match single {
            true => by_multigrid::<Short>(grid, k, parameters, progress),
            false => by_multigrid::<Lanes>(grid, k, parameters, progress),
        };
        // Corrections can come to a stop, or make vectors dependent, where a shape's coarse levels are poor; polynomials cannot.
        stopped = match found {
            Ok(Some(spectrum)) => return Ok(spectrum),
            Err(SpectralError::Cancelled) => return Err(SpectralError::Cancelled),
            Ok(None) => None,
            Err(error) => Some(error),
        };
    }
    check_memory(parameters.memory_limit, what(), n, n * filter_columns(k) + 8 * n)
        .map_err(|too_large| stopped.unwrap_or(too_large))?;
    let found = filtered_eigenpairs(grid, k, parameters, progress)?;
    // With the inverse, copies that a block cannot see are searched for; here they are not. Shapes with so many are rare.
    if may_hide_copies(&found.values, LANES, parameters.tolerance) {
        return connected_eigenpairs(&grid_laplacian(grid), k, parameters, progress);
    }
    spectrum(grid, SolverUsed::Filter, found, parameters.tolerance)
}

/// The eigenpairs by multigrid, in the precision of the rows R; none where levels stay large.
fn by_multigrid<R: Row>(
    grid: &VoxelGrid,
    k: usize,
    parameters: &SpectrumParameters,
    progress: &(dyn Fn(f64) -> ControlFlow<()> + Sync),
) -> Result<Option<Spectrum>, SpectralError>
where
    Functions: From<Vec<R::Number>>,
{
    let found = multigrid::multigrid_eigenpairs::<R>(grid, k, parameters, progress)?;
    found.map(|found| spectrum(grid, SolverUsed::Multigrid, found, parameters.tolerance)).transpose()
}

/// The spectrum of a connected grid: the constant, and what was found.
fn spectrum<R: Row>(
    grid: &VoxelGrid,
    solver: SolverUsed,
    found: GridPairs<R>,
    tolerance: f64,
) -> Result<Spectrum, SpectralError>
where
    Functions: From<Vec<R::Number>>,
{
    let (n, wanted) = (grid.len(), found.values.len());
    let report = SpectrumReport {
        solver,
        iterations: found.restarts,
        applications: found.applications,
        residual: check_residuals::<R>(
            &found.values,
            &found.residuals,
            found.bound,
            tolerance,
            found.restarts,
        )?,
        orthogonality: orthogonality(&found.vectors, wanted),
        zero_modes: 1,
    };
    let (scale, constant) = (1.0 / grid.frame().voxel_volume().sqrt(), R::number(1.0 / grid.volume().sqrt()));
    let order = ascending(&found.values);
    let mut rows = vec![0u32; n];
    for (row, &voxel) in found.order.iter().enumerate() {
        rows[voxel as usize] = row as u32;
    }
    // Where each vector's number comes in a row of the result, behind the constant.
    let mut places = vec![0; wanted.next_multiple_of(LANES)];
    order.iter().enumerate().for_each(|(place, &i)| places[i] = place + 1);
    let functions = found.vectors.into_rows(&rows, wanted + 1, |blocks, row, target| {
        target[0] = constant;
        for (block, places) in blocks.iter().zip(places.chunks(LANES)) {
            for (x, &place) in block[row].wide().0.iter().zip(places) {
                if place > 0 {
                    target[place] = R::number(x * scale);
                }
            }
        }
    });
    let values = std::iter::once(0.0).chain(order.iter().map(|&i| found.values[i]));
    let mass = vec![grid.frame().voxel_volume(); n];
    let basis = Eigenbasis::new(Domain::Volume, mass, values.collect(), functions)
        .map_err(|_| SpectralError::Overflow)?;
    Ok(Spectrum { basis, report })
}

/// Columns of n numbers that the filter holds at its peak: the basis with a block's image and work space, or
/// the eigenvectors twice.
fn filter_columns(k: usize) -> usize {
    (basis_columns(k) + 6 * LANES).max(2 * k + LANES)
}

/// The places of the values in ascending order.
fn ascending(values: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    order
}

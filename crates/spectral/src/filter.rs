//! Chebyshev-filtered subspace iteration for grids, matrix-free (Zhou, Saad, Tiago & Chelikowsky 2006),
//! started from the spectrum of a coarser operator (as Nasikun & Hildebrandt 2022) and with a degree
//! of its own for each block of vectors (as Winkelmann, Springer & Di Napoli 2019).
//!
//! The coarse spectrum gives a starting subspace and the cut-off of the first polynomial. Then each
//! pass filters the vectors that have not converged, finds the best combinations of them
//! (Rayleigh-Ritz), measures true residuals, and locks what has converged. Nothing is factorized;
//! memory is that of the subspace.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use faer::Mat;
use mser3d_laplace::aggregate_grid;
use mser3d_shape::VoxelGrid;
use rayon::prelude::*;

use crate::chebyshev::{Polynomial, SlicedStencil};
use crate::solve::coarse_eigenpairs;
use crate::standard::NullSpace;
use crate::tall::{Block, LANES, Lanes, Noise, Tall, orthonormal_combinations, small_eigen};
use crate::{SpectralError, SpectrumParameters};

/// Columns of noise beside the coarse vectors: they catch what the coarse grid cannot see.
const NOISE: usize = LANES;
/// Rows of the coarse operator for each vector of the subspace: fewer, and the coarse vectors are too coarse.
const COARSE_ROWS: usize = 30;
/// Largest growth, as a logarithm, of unwanted low modes in a pass: beyond e^16 they hide the others.
const GROWTH: f64 = 6.0;

/// Converged eigenpairs of the standard problem without its null space.
pub(crate) struct Filtered {
    /// Ascending.
    pub values: Vec<f64>,
    /// Rows in the order of `order`.
    pub vectors: Tall,
    /// The voxel of each row.
    pub order: Vec<u32>,
    pub null_space: NullSpace,
    pub residual: f64,
    pub passes: usize,
    pub applications: usize,
}

/// Columns of the subspace that finds `wanted` pairs.
pub(crate) fn subspace_size(wanted: usize) -> usize {
    (wanted + wanted / 4 + 2 * NOISE).next_multiple_of(LANES)
}

/// The edge of the coarse cells for a subspace of `columns`, or `None` for a grid too small to coarsen.
pub(crate) fn coarse_factor(voxels: usize, columns: usize) -> Option<u32> {
    [16u32, 8, 4, 2].into_iter().find(|f| voxels / (f.pow(3) as usize) >= COARSE_ROWS * columns)
}

/// The smallest `wanted` non-zero eigenpairs of the grid.
pub(crate) fn filtered_eigenpairs(
    grid: &VoxelGrid,
    parameters: &SpectrumParameters,
    progress: &(dyn Fn(usize) -> ControlFlow<()> + Sync),
) -> Result<Filtered, SpectralError> {
    let stencil = SlicedStencil::new(grid);
    let (n, h3) = (stencil.len(), grid.frame().voxel_volume());
    let null_space = NullSpace::new(&stencil.labels(), &vec![h3.sqrt(); n]);
    let zeros = null_space.len().min(parameters.eigenpairs);
    let wanted = parameters.eigenpairs - zeros;
    let columns = subspace_size(wanted).min(n - null_space.len());
    let mut iteration = Iteration {
        subspace: Tall::zeros(n, columns),
        values: vec![0.0; columns],
        residuals: vec![1.0; columns],
        locked: 0,
        applications: 0,
        noise: Noise(0x6d73_6572_3364),
        stencil,
        null_space,
    };
    let mut cutoff = iteration.start(grid, columns - NOISE)?;
    let cancelled = AtomicBool::new(false);
    for pass in 1..=parameters.max_iterations {
        let report = || {
            if progress(zeros + iteration.locked.min(wanted)).is_break() {
                cancelled.store(true, Ordering::Relaxed);
            }
        };
        report();
        iteration.filter(wanted, cutoff, parameters.tolerance, &cancelled);
        if cancelled.load(Ordering::Relaxed) {
            return Err(SpectralError::Cancelled);
        }
        iteration.rayleigh_ritz()?;
        iteration.lock(parameters.tolerance);
        if iteration.locked >= wanted {
            let residual = iteration.residuals[..wanted].iter().copied().fold(0.0, f64::max);
            return Ok(Filtered {
                values: iteration.values,
                vectors: iteration.subspace,
                order: iteration.stencil.order,
                null_space: iteration.null_space,
                residual,
                passes: pass,
                applications: iteration.applications,
            });
        }
        // The highest Ritz values are the least certain. Any cut-off above the wanted eigenvalues is
        // right, so it is raised only where they come too close.
        let highest = iteration.values[columns - NOISE - 1];
        let needed = 1.1 * iteration.values[wanted - 1];
        cutoff = if cutoff < needed { highest.max(needed) } else { cutoff.min(highest.max(needed)) };
    }
    Err(SpectralError::NotConverged {
        converged: zeros + iteration.locked.min(wanted),
        wanted: parameters.eigenpairs,
        iterations: parameters.max_iterations,
        unit: "filter passes",
        residual: iteration.residuals[..wanted].iter().copied().fold(0.0, f64::max),
        tolerance: parameters.tolerance,
    })
}

/// A subspace on its way to the smallest eigenvectors.
struct Iteration {
    stencil: SlicedStencil,
    null_space: NullSpace,
    /// n x columns; the first `locked` have converged and stay.
    subspace: Tall,
    /// Ritz values, ascending.
    values: Vec<f64>,
    /// |A x - theta x| / theta of each column.
    residuals: Vec<f64>,
    locked: usize,
    applications: usize,
    noise: Noise,
}

impl Iteration {
    fn columns(&self) -> usize {
        self.subspace.columns()
    }

    /// Fills the subspace from the coarse operator, constant on its cells, and noise. Returns the
    /// first cut-off.
    fn start(&mut self, grid: &VoxelGrid, from_coarse: usize) -> Result<f64, SpectralError> {
        let factor = coarse_factor(grid.len(), self.columns()).unwrap_or(2);
        let coarse = aggregate_grid(grid, factor);
        let zeros = self.null_space.len();
        let available = coarse.operator.len().saturating_sub(zeros).min(from_coarse);
        let (values, vectors) = coarse_eigenpairs(&coarse.operator, available)?;
        let columns = self.columns();
        let (order, noise) = (&self.stencil.order, &mut self.noise);
        self.subspace.fill(|row, column| {
            if column < available {
                vectors[coarse.aggregate[order[row] as usize] as usize * available + column]
            } else {
                noise.next()
            }
        });
        self.null_space.project_out(&mut self.subspace);
        let cutoff = values.last().copied().unwrap_or(0.25 * self.stencil.bound());
        self.values = values;
        self.values.resize(columns, cutoff);
        Ok(cutoff)
    }

    /// Applies to each block of columns that is not locked the polynomial that should bring it to the
    /// tolerance, as far as one pass may go.
    fn filter(&mut self, wanted: usize, cutoff: f64, tolerance: f64, cancelled: &AtomicBool) {
        let bound = self.stencil.bound();
        let rate = |lambda: f64| Polynomial::rate(lambda, cutoff, bound);
        let low = self.values[self.locked];
        // The lower a mode, the faster it grows: the difference to the slowest one limits the degree.
        let slowest = rate(self.values[wanted.min(self.columns()) - 1]);
        let safe = GROWTH - self.residuals[self.locked].min(1.0).ln();
        let limit = (safe / (rate(low) - slowest).max(1e-12)).max(8.0);
        let degree = |column: usize| {
            let column = column.min(wanted - 1);
            let missing = (self.residuals[column] / (0.3 * tolerance)).max(10.0).ln();
            (missing / rate(self.values[column]).max(1e-12)).min(limit).ceil() as usize
        };
        // Blocks that hold a free column; locked columns among them are filtered too and put back.
        let first = self.locked / LANES;
        let blocks: Vec<usize> = (first..self.subspace.blocks().len()).collect();
        let polynomial = |&block: &usize| {
            let last = ((block + 1) * LANES).min(self.columns()) - 1;
            let target = self.values[(block * LANES).max(self.locked)].min(0.9 * cutoff);
            Polynomial { degree: degree(last), target, cutoff }
        };
        let polynomials: Vec<Polynomial> = blocks.iter().map(polynomial).collect();
        self.applications += polynomials.iter().map(|p| LANES * p.degree.next_multiple_of(2)).sum::<usize>();
        let kept = self.subspace.blocks()[first].clone();
        let threads = rayon::current_num_threads().min(blocks.len());
        let mut buffers = vec![vec![Lanes([0.0; LANES]); self.stencil.len()]; threads];
        for (blocks, polynomials) in blocks.chunks(threads).zip(polynomials.chunks(threads)) {
            let stencil = &self.stencil;
            let free = &mut self.subspace.blocks_mut()[blocks[0]..];
            let tasks = free.par_iter_mut().zip(&mut buffers).zip(polynomials);
            tasks.for_each(|((x, work), polynomial)| stencil.filter(*polynomial, x, work, cancelled));
        }
        let lanes = self.locked % LANES;
        for (row, old) in self.subspace.blocks_mut()[first].iter_mut().zip(&kept) {
            row.0[..lanes].copy_from_slice(&old.0[..lanes]);
        }
    }

    /// Replaces the free columns by the Ritz vectors of their span, ascending.
    fn rayleigh_ritz(&mut self) -> Result<(), SpectralError> {
        let (locked, columns) = (self.locked, self.columns());
        self.null_space.project_out(&mut self.subspace);
        for round in 0..4 {
            if locked > 0 {
                for _ in 0..2 {
                    let overlaps = self.subspace.gram(0..locked, &self.subspace, locked..columns);
                    self.subspace.subtract_within(0..locked, overlaps.as_ref(), locked);
                }
            }
            let image = |x: &Block, rows, y: &mut [Lanes]| self.stencil.apply_rows(x, rows, y);
            let (gram, energy) = self.subspace.gram_and_energy(locked..columns, image);
            self.applications += columns - locked;
            let (basis, condition) =
                orthonormal_combinations(&gram).ok_or(SpectralError::DenseEigenproblem)?;
            let energy = Mat::from_fn(energy.nrows(), energy.ncols(), |i, j| energy[(i.max(j), i.min(j))]);
            let reduced = basis.transpose() * &energy * &basis;
            let (values, rotation) = small_eigen(&reduced).ok_or(SpectralError::DenseEigenproblem)?;
            let combination = &basis * &rotation;
            let found = combination.ncols();
            self.subspace.rotate(locked..columns, combination.as_ref(), locked);
            self.values.truncate(locked);
            self.values.extend(values.iter().map(|v| v.max(0.0)));
            self.values.resize(columns, self.stencil.bound());
            if found < columns - locked {
                self.refill(locked + found);
            } else if condition < 1e8 || round == 3 {
                break;
            }
        }
        Ok(())
    }

    /// New noise in the columns from `from` on, in place of vectors that depended on the others.
    fn refill(&mut self, from: usize) {
        let columns = self.columns();
        self.subspace.fill_noise(from..columns, &mut self.noise);
        self.null_space.project_out(&mut self.subspace);
    }

    /// Measures the residuals of the free columns and locks the leading ones below the tolerance.
    fn lock(&mut self, tolerance: f64) {
        let first = self.locked / LANES;
        let image = |x: &Block, rows, y: &mut [Lanes]| self.stencil.apply_rows(x, rows, y);
        let norms = self.subspace.residual_norms(first, &self.values, image);
        self.applications += self.columns() - self.locked;
        for column in self.locked..self.columns() {
            let theta = self.values[column].max(f64::MIN_POSITIVE);
            self.residuals[column] = norms[column - first * LANES] / theta;
        }
        while self.locked < self.columns() && self.residuals[self.locked] <= tolerance {
            self.locked += 1;
        }
    }
}

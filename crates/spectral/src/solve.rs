//! The entry points: choose a solver, run it, measure the result.

use std::ops::ControlFlow;

use mser3d_laplace::Operator;

use crate::lanczos::Lanczos;
use crate::shift_invert::{Inverse, SOLVE_WIDTH};
use crate::standard::{StandardProblem, dense_eigenpairs};
use crate::tall::Tall;
use crate::{SpectralError, Spectrum, SpectrumParameters, SpectrumReport};

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
    progress: &mut dyn FnMut(usize) -> ControlFlow<()>,
) -> Result<Spectrum, SpectralError> {
    parameters.validate()?;
    let problem = StandardProblem::new(operator);
    let (n, k) = (problem.len(), parameters.eigenpairs);
    if k > n {
        return Err(SpectralError::TooManyEigenpairs { requested: k, available: n });
    }
    let zeros = problem.null_space.len().min(k);
    let wanted = k - zeros;
    if n <= DENSE_ROWS || k + 8 * SOLVE_WIDTH > n {
        check_memory(parameters, n, 3 * n * n)?;
        let (values, vectors) = dense_eigenpairs(&problem)?;
        return finish(operator, &problem, parameters, "dense", values, vectors, (0, 0), k);
    }
    if wanted == 0 {
        let none = Tall::zeros(n, 1);
        return finish(operator, &problem, parameters, "shift-invert Lanczos", vec![], none, (0, 0), k);
    }
    let block = 2 * SOLVE_WIDTH;
    // Weyl: about 2.5 k columns find k pairs without a restart; small k needs some more.
    let capacity = (5 * wanted / 2 + 4 * block).min(n - problem.null_space.len()) / block * block;
    check_memory(parameters, n, n * (capacity + 5 * block + k) + 60 * n)?;

    // A shift well below the wanted eigenvalues (33 k^(2/3) / V^(2/3) by Weyl's law) that still keeps
    // the matrix well conditioned.
    let measure: f64 = operator.mass().iter().sum();
    let sigma = measure.powf(-2.0 / f64::from(operator.domain().dimension()));
    let inverse = Inverse::new(&problem, sigma)?;
    let lanczos = Lanczos {
        rows: n,
        wanted,
        block,
        capacity,
        max_restarts: parameters.max_iterations,
        null_space: &problem.null_space,
    };
    // With theta = 1 / (lambda + sigma), a residual r of the inverse is about r / theta^2 of A, and
    // relative to lambda r / theta or less. A margin, because true residuals decide in the end.
    let accept = |theta: f64, residual: f64| residual <= 0.02 * parameters.tolerance * theta;
    let ritz = lanczos.run(
        |x, y| inverse.apply(x, y),
        accept,
        |converged| progress(zeros + converged).is_continue(),
    )?;
    let values: Vec<f64> = ritz.values.iter().map(|theta| (1.0 / theta - sigma).max(0.0)).collect();
    let counts = (ritz.restarts, ritz.applications);
    finish(operator, &problem, parameters, "shift-invert Lanczos", values, ritz.vectors, counts, k)
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
    let converged = quality.residuals.iter().filter(|&&r| r <= parameters.tolerance).count();
    if converged < wanted {
        return Err(SpectralError::NotConverged {
            converged: zero_modes + converged,
            wanted: k,
            iterations,
            unit: "restarts",
            residual: quality.residual(),
            tolerance: parameters.tolerance,
        });
    }
    let report = SpectrumReport {
        solver,
        iterations,
        applications,
        residual: quality.residual(),
        orthogonality: quality.orthogonality,
        zero_modes,
    };
    Ok(Spectrum { basis: problem.eigenbasis(operator, &values, &vectors, k), report })
}

/// True residuals and orthogonality, measured on the vectors.
struct Quality {
    residuals: Vec<f64>,
    orthogonality: f64,
}

impl Quality {
    fn measure(problem: &StandardProblem, values: &[f64], vectors: &Tall) -> Self {
        let count = values.len();
        let width = 16.min(count.max(1));
        let (mut x, mut y) = (Tall::zeros(problem.len(), width), Tall::zeros(problem.len(), width));
        let mut residuals = Vec::with_capacity(count);
        for from in (0..count).step_by(width) {
            let columns = width.min(count - from);
            vectors.get_columns(from, columns, &mut x);
            problem.apply(&x, &mut y);
            for (row, target) in y.data_mut().chunks_mut(width).enumerate() {
                for j in 0..columns {
                    target[j] -= values[from + j] * x.row(row)[j];
                }
            }
            residuals.extend(y.column_norms()[..columns].iter().zip(&values[from..]).map(|(r, l)| r / l));
        }
        let gram = vectors.gram(0..count, vectors, 0..count);
        let mut orthogonality = 0f64;
        for i in 0..count {
            for j in 0..count {
                orthogonality = orthogonality.max((gram[(i, j)] - f64::from(u8::from(i == j))).abs());
            }
        }
        Self { residuals, orthogonality }
    }

    fn residual(&self) -> f64 {
        self.residuals.iter().copied().fold(0.0, f64::max)
    }
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

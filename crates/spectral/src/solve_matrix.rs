//! The smallest eigenpairs of an operator given as a matrix: chooses a solver and runs it on each component.

use std::ops::ControlFlow;

use mser3d_laplace::Operator;

use crate::block_matrix::BlockMatrix;
use crate::components::{members, merge};
use crate::count::count_below;
use crate::dense::dense_eigenpairs;
use crate::eigenpairs::Pairs;
use crate::elimination::Elimination;
use crate::lambda_max::all_below;
use crate::limits::{check_memory, check_size};
use crate::progress::Heard;
use crate::row::LANES;
use crate::shift_invert::{Task, basis_columns, inverse_eigenpairs};
use crate::standard_problem::{NEGATIVE, StandardProblem, unit_eigenvalue};
use crate::{EigenpairRange, SolverUsed, SpectralError, Spectrum, SpectrumParameters};

/// Most rows for which a dense solver is faster than any iteration.
const DENSE_ROWS: usize = 400;

/// The smallest eigenpairs of `W phi = lambda M phi`, for any [`Operator`]: the Laplacian of a shape, or a
/// symmetric positive semidefinite matrix of your own ([`Operator::new`]).
///
/// A component whose rows of W sum to zero (a Neumann boundary, a closed surface) has the constant as its
/// exact zero mode. On any other (a Dirichlet boundary, a potential) all eigenpairs are computed.
///
/// `progress` is called now and then with the share of the work that is done, as far as that can be foreseen: it never
/// falls, and is 1 at the end. It cancels the work by returning `Break`.
///
/// Cost of k eigenpairs of n rows: a few sparse factorizations, about 3 k solves, and `O(n k^2)` for
/// orthogonality.
///
/// # Errors
/// [`SpectralError`]: parameters out of range, more eigenpairs than rows, too much memory, a negative
/// eigenvalue, no convergence, a breakdown of the factorization, or cancellation.
pub fn smallest_eigenpairs(
    operator: &Operator,
    parameters: &SpectrumParameters,
    progress: &(dyn Fn(f64) -> ControlFlow<()> + Sync),
) -> Result<Spectrum, SpectralError> {
    parameters.validate()?;
    let bodies = members(&operator.components(), |row| operator.mass()[row] > 0.0);
    let available = bodies.iter().map(Vec::len).sum();
    let heard = Heard::new(progress);
    let solve = |k: usize| {
        if bodies.len() > 1 {
            merge(operator.domain(), operator.mass(), &bodies, k, |body, count| {
                let part = operator.restrict(&bodies[body]);
                heard.next(bodies[body].len() as f64 / available as f64, |progress| {
                    connected_eigenpairs(&part, count, parameters, progress)
                })
            })
        } else {
            heard.next(1.0, |progress| connected_eigenpairs(operator, k, parameters, progress))
        }
    };
    let spectrum = match parameters.eigenpairs {
        EigenpairRange::Count(k) if k > available => {
            Err(SpectralError::TooManyEigenpairs { requested: k, available })
        }
        EigenpairRange::Count(k) => solve(k),
        EigenpairRange::AtMost(k) => solve(k.min(available)),
        EigenpairRange::LambdaMax(_) if available == 0 => {
            Err(SpectralError::TooManyEigenpairs { requested: 1, available })
        }
        EigenpairRange::LambdaMax(relative) => {
            let measure = operator.mass().iter().sum();
            let bound = relative * unit_eigenvalue(operator.domain(), measure);
            check_size(measure, bound)?;
            // One more lies beyond the bound.
            let count = count_below(operator, bound, parameters.memory_limit)? + 1;
            all_below(bound, count, available, solve)
        }
    };
    heard.end(spectrum)
}

/// As [`smallest_eigenpairs`], of an operator with one component.
pub(crate) fn connected_eigenpairs(
    operator: &Operator,
    k: usize,
    parameters: &SpectrumParameters,
    progress: &(dyn Fn(f64) -> ControlFlow<()> + Sync),
) -> Result<Spectrum, SpectralError> {
    let problem = StandardProblem::new(operator);
    let n = problem.len();
    check_size(problem.unit_eigenvalue, problem.bound)?;
    let zeros = problem.null_space.len().min(k);
    let wanted = k - zeros;
    let columns = basis_columns(wanted) + 2 * LANES;
    if n <= DENSE_ROWS || columns > n - problem.null_space.len() {
        check_memory(parameters.memory_limit, format!("{k} eigenpairs"), n, 3 * n * n)?;
        let (mut values, vectors) = dense_eigenpairs(&problem)?;
        values.truncate(wanted);
        let pairs = Pairs::measured(&problem, values, vectors);
        return pairs.into_spectrum(operator, &problem, k, parameters.tolerance, SolverUsed::Dense);
    }
    let solver = SolverUsed::ShiftInvert;
    if wanted == 0 {
        let negative = -NEGATIVE * problem.bound;
        if !operator.is_known_semidefinite() && count_below(operator, negative, parameters.memory_limit)? > 0
        {
            return Err(SpectralError::Indefinite { eigenvalue: negative });
        }
        let pairs = Pairs::measured(&problem, Vec::new(), BlockMatrix::zeros(n, 1));
        return pairs.into_spectrum(operator, &problem, k, parameters.tolerance, solver);
    }
    // Before anything large is made; the factor's size is known when its pattern is.
    let numbers = n * (columns + 3 * k) + 60 * n;
    check_memory(parameters.memory_limit, format!("{k} eigenpairs"), n, numbers)?;
    let elimination = Elimination::new(&problem)?;
    check_memory(parameters.memory_limit, format!("{k} eigenpairs"), n, numbers + elimination.len())?;
    let task = Task { wanted, tolerance: parameters.tolerance, max_restarts: parameters.max_iterations };
    let report = |share: f64| progress(share).is_continue();
    let pairs = inverse_eigenpairs(&problem, &elimination, &task, &report)?;
    pairs.into_spectrum(operator, &problem, k, parameters.tolerance, solver)
}

//! All eigenpairs of a small problem by a dense solver.

use crate::SpectralError;
use crate::block_matrix::BlockMatrix;
use crate::small_dense::small_eigen;
use crate::standard_problem::StandardProblem;

/// The eigenpairs beside the null space, ascending.
pub(crate) fn dense_eigenpairs(problem: &StandardProblem) -> Result<(Vec<f64>, BlockMatrix), SpectralError> {
    let n = problem.len();
    let mut matrix = faer::Mat::<f64>::zeros(n, n);
    for row in 0..n {
        for at in problem.starts[row]..problem.starts[row + 1] {
            matrix[(row, problem.columns[at])] = problem.values[at];
        }
    }
    // Lift the null space above everything else, so that it cannot mix with small eigenvalues.
    let lift = 2.0 * problem.bound.max(f64::MIN_POSITIVE);
    let null = &problem.null_space;
    if null.len() > 0 {
        for i in 0..n {
            for j in 0..n {
                matrix[(i, j)] += null.projection(lift, i, j);
            }
        }
    }
    let (values, vectors) = small_eigen(&matrix).ok_or(SpectralError::Overflow)?;
    if let Some(&smallest) = values.first() {
        problem.check_semidefinite(smallest)?;
    }
    let rest = n - null.len();
    let mut columns = BlockMatrix::zeros(n, rest);
    columns.fill(rest, |row, column| vectors[(row, column)]);
    Ok((values[..rest].iter().map(|v| v.max(0.0)).collect(), columns))
}

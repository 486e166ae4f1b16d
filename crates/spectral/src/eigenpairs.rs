//! The eigenpairs of a standard problem, and the spectrum made of them.

use mser3d_laplace::Operator;

use crate::block_matrix::BlockMatrix;
use crate::quality::{check_residuals, orthogonality, residuals};
use crate::row::Lanes;
use crate::standard_problem::StandardProblem;
use crate::{SolverUsed, SpectralError, Spectrum, SpectrumReport};

/// Eigenpairs without the null space.
pub(crate) struct Pairs {
    /// Ascending.
    pub values: Vec<f64>,
    pub vectors: BlockMatrix,
    /// |A x - lambda x| / lambda of each pair.
    pub residuals: Vec<f64>,
    /// Largest entry of |X^T X - I|.
    pub orthogonality: f64,
    pub restarts: usize,
    /// Vectors that the inverse was applied to.
    pub applications: usize,
}

/// Converged eigenpairs of a connected grid without the constant.
pub(crate) struct GridPairs<R = Lanes> {
    /// Ascending.
    pub values: Vec<f64>,
    /// Rows in the order of `order`.
    pub vectors: BlockMatrix<R>,
    /// The voxel of each row.
    pub order: Vec<u32>,
    /// |A x - lambda x| / lambda of each pair.
    pub residuals: Vec<f64>,
    /// Upper bound of the spectrum.
    pub bound: f64,
    pub restarts: usize,
    /// Vectors that A was applied to.
    pub applications: usize,
}

impl Pairs {
    /// As computed in one go, with residuals and orthogonality measured on the vectors.
    pub fn measured(problem: &StandardProblem, values: Vec<f64>, vectors: BlockMatrix) -> Self {
        let residuals = residuals(problem, &values, &vectors);
        let orthogonality = orthogonality(&vectors, values.len());
        Self { values, vectors, residuals, orthogonality, restarts: 0, applications: 0 }
    }

    /// The spectrum of `k` eigenpairs, with the null space's, if these will do.
    pub fn into_spectrum(
        self,
        operator: &Operator,
        problem: &StandardProblem,
        k: usize,
        tolerance: f64,
        solver: SolverUsed,
    ) -> Result<Spectrum, SpectralError> {
        let residual =
            check_residuals::<Lanes>(&self.values, &self.residuals, problem.bound, tolerance, self.restarts)?;
        let report = SpectrumReport {
            solver,
            iterations: self.restarts,
            applications: self.applications,
            residual,
            orthogonality: self.orthogonality,
            zero_modes: problem.null_space.len().min(k),
        };
        Ok(Spectrum { basis: problem.eigenbasis(operator, &self.values, &self.vectors, k)?, report })
    }
}

use mser3d_shape::Eigenbasis;

use crate::SpectralError;

/// Which algorithm finds the eigenpairs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Eigensolver {
    /// By size and kind of operator: dense below a few hundred rows, the polynomial filter for grids,
    /// shift-invert for everything else.
    #[default]
    Auto,
    /// Block Lanczos on the inverse, by sparse Cholesky factorization.
    ShiftInvert,
    /// Block Lanczos on a Chebyshev polynomial of the grid's stencil, without a matrix.
    Filter,
}

/// What to compute and how exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectrumParameters {
    /// How many of the smallest eigenpairs, zero modes included. Default 100.
    pub eigenpairs: usize,
    /// Largest relative residual |W phi - lambda M phi| / (lambda |phi|), in the norms of M^-1 and M.
    /// Default 1e-9.
    pub tolerance: f64,
    /// The algorithm. Default [`Eigensolver::Auto`].
    pub solver: Eigensolver,
    /// Restarts before giving up. Default 60.
    pub max_iterations: usize,
    /// Refuse work whose estimated memory exceeds this many bytes. Default: no limit.
    pub memory_limit: Option<u64>,
}

impl Default for SpectrumParameters {
    fn default() -> Self {
        Self {
            eigenpairs: 100,
            tolerance: 1e-9,
            solver: Eigensolver::Auto,
            max_iterations: 60,
            memory_limit: None,
        }
    }
}

impl SpectrumParameters {
    /// Checks the ranges of all fields.
    ///
    /// # Errors
    /// [`SpectralError::BadParameter`] for the first field that is out of range.
    pub fn validate(&self) -> Result<(), SpectralError> {
        let bad = |name, value: String, expected| Err(SpectralError::BadParameter { name, value, expected });
        if self.eigenpairs == 0 {
            return bad("eigenpairs", "0".into(), "at least 1");
        }
        if !(self.tolerance > 0.0 && self.tolerance <= 1e-2) {
            return bad("tolerance", self.tolerance.to_string(), "above 0 and at most 0.01");
        }
        if self.max_iterations == 0 {
            return bad("max_iterations", "0".into(), "at least 1");
        }
        Ok(())
    }
}

/// Eigenpairs and how good they are.
#[derive(Clone, Debug)]
pub struct Spectrum {
    /// The eigenpairs.
    pub basis: Eigenbasis,
    /// How they were found, and their measured quality.
    pub report: SpectrumReport,
}

/// How a spectrum was found, and its quality as measured on the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectrumReport {
    /// `"dense"`, `"shift-invert Lanczos"` or `"filtered Lanczos"`.
    pub solver: &'static str,
    /// Restarts.
    pub iterations: usize,
    /// Vectors that the operator, or its inverse, was applied to.
    pub applications: usize,
    /// Largest relative residual over the non-zero eigenpairs; the zero modes are exact.
    pub residual: f64,
    /// Largest entry of |Phi^T M Phi - I|.
    pub orthogonality: f64,
    /// Number of zero eigenvalues: the components of the operator.
    pub zero_modes: usize,
}

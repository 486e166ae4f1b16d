use mser3d_shape::{Domain, Eigenbasis};

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

/// Which of the eigenpairs, from the smallest on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// So many, zero modes included.
    Count(usize),
    /// All with `lambda V^(2/3)` below this, `lambda A` on a surface: bodies of any size then have spectra
    /// that end at the same scale. A body in one piece has about `x^(3/2) / (6 pi^2)` of them below x, and more
    /// by its surface; a surface `x / (4 pi)` (Weyl's law).
    Below(f64),
}

impl Extent {
    /// About how many these are, by Weyl's law; bodies with much surface have more.
    pub fn about(self, domain: Domain) -> usize {
        use std::f64::consts::PI;
        match (self, domain) {
            (Self::Count(count), _) => count,
            (Self::Below(bound), Domain::Volume) => (bound.powf(1.5) / (6.0 * PI * PI)) as usize + 1,
            (Self::Below(bound), Domain::Surface) => (bound / (4.0 * PI)) as usize + 1,
        }
    }
}

impl From<usize> for Extent {
    fn from(count: usize) -> Self {
        Self::Count(count)
    }
}

/// What to compute and how exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectrumParameters {
    /// Which eigenpairs. Default: the 100 smallest.
    pub eigenpairs: Extent,
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
            eigenpairs: Extent::Count(100),
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
        match self.eigenpairs {
            Extent::Count(0) => return bad("eigenpairs", "0".into(), "at least 1"),
            Extent::Below(bound) if !(bound > 0.0 && bound.is_finite()) => {
                return bad("the bound of the eigenvalues", bound.to_string(), "above 0");
            }
            _ => {}
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

use mser3d_shape::{Eigenbasis, choice};

choice! {
    /// Which algorithm found a spectrum. The first is the default only because there has to be one.
    pub enum SolverUsed("solver used") {
        /// A dense eigensolver, for operators of a few hundred rows
        #[default]
        Dense = "dense",
        /// Block Lanczos on the inverse, by sparse factorizations
        ShiftInvert = "shift-invert",
        /// Block Lanczos on a Chebyshev polynomial of the grid's stencil
        Filter = "filter",
        /// Eigenvectors of coarser grids, carried up level by level and corrected by multigrid cycles
        Multigrid = "multigrid",
    }
}

/// Eigenpairs and how good they are.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Spectrum {
    /// The eigenpairs.
    pub basis: Eigenbasis,
    /// How they were found, and their measured quality.
    pub report: SpectrumReport,
}

impl Spectrum {
    /// Of eigenpairs that were computed before and stored.
    pub fn new(basis: Eigenbasis, report: SpectrumReport) -> Self {
        Self { basis, report }
    }
}

/// How a spectrum was found, and its quality as measured on the result.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct SpectrumReport {
    /// The algorithm; of several components, that of the one with most work.
    pub solver: SolverUsed,
    /// Restarts.
    pub iterations: usize,
    /// Vectors that the operator, or its inverse, was applied to.
    pub applications: usize,
    /// Largest |W phi - lambda M phi| / (lambda |phi|) over the eigenpairs, in the norms of M^-1 and M. The
    /// exact zero modes are left out; for an eigenvalue that is zero only to rounding, the limit of rounding
    /// stands for lambda, 4e-15 times the bound of the spectrum. Of eigenfunctions in single precision without what their
    /// rounding explains: of their smooth part.
    pub residual: f64,
    /// Largest entry of |Phi^T M Phi - I|.
    pub orthogonality: f64,
    /// Exact zero modes: constants on the components whose rows sum to zero.
    pub zero_modes: usize,
}

impl SpectrumReport {
    /// A report with nothing but the solver, all numbers zero: for a spectrum that was stored, whose numbers
    /// are then put in field by field.
    ///
    /// ```
    /// use mser3d_spectral::{SolverUsed, SpectrumReport};
    /// let mut report = SpectrumReport::new(SolverUsed::Filter);
    /// report.residual = 3e-10;
    /// ```
    pub fn new(solver: SolverUsed) -> Self {
        Self { solver, iterations: 0, applications: 0, residual: 0.0, orthogonality: 0.0, zero_modes: 0 }
    }
}

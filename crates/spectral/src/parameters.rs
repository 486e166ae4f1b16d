use mser3d_shape::{Domain, InvalidParameter, choice};

use crate::SpectralError;

choice! {
    /// Which algorithm to use.
    pub enum Eigensolver("solver") {
        /// By size and kind: dense, the filter for grids, shift-invert for all others
        ///
        /// Dense up to 400 rows. The filter wherever a grid has many times more voxels than eigenpairs are
        /// wanted, but for long thin bodies, such as rods.
        #[default]
        Auto = "auto",
        /// Block Lanczos on the inverse, by sparse L D L^T factorizations
        ShiftInvert = "shift-invert",
        /// Block Lanczos on a Chebyshev polynomial of the grid's stencil, without a matrix
        ///
        /// For grids only: an operator given as a matrix is solved by shift-invert.
        Filter = "filter",
        /// Eigenvectors of coarser grids, carried up level by level and corrected by multigrid cycles
        ///
        /// For grids with some thousand voxels for each eigenpair; where it comes to no end, the filter takes its place.
        Multigrid = "multigrid",
    }
}

/// Which eigenpairs to compute, from the smallest on.
///
/// In JSON `{"count": 100}`, `{"at_most": 100}` or `{"lambda_max": 30.0}`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum EigenpairRange {
    /// This many, zero modes included; an error where there are fewer.
    Count(usize),
    /// This many, or all there are if the shape is so small that it has fewer.
    AtMost(usize),
    /// All whose `lambda V^(2/3)` (on a surface `lambda A`) is less than this number, at least one.
    ///
    /// The spectra of shapes of any size then end at the same scale. By Weyl's law a connected solid has about
    /// `x^(3/2) / (6 pi^2)` of them below x, and more if it has much surface; a surface has about `x / (4 pi)`.
    LambdaMax(f64),
}

impl EigenpairRange {
    /// About how many these are, by Weyl's law; solids with much surface have more.
    pub fn about(self, domain: Domain) -> usize {
        use std::f64::consts::PI;
        match (self, domain) {
            (Self::Count(count) | Self::AtMost(count), _) => count,
            (Self::LambdaMax(bound), Domain::Volume) => (bound.powf(1.5) / (6.0 * PI * PI)) as usize + 1,
            (Self::LambdaMax(bound), Domain::Surface) => (bound / (4.0 * PI)) as usize + 1,
        }
    }
}

impl From<usize> for EigenpairRange {
    fn from(count: usize) -> Self {
        Self::Count(count)
    }
}

/// What to compute and how exactly.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SpectrumParameters {
    /// Which eigenpairs. Default: the 100 smallest, or as many as there are.
    pub eigenpairs: EigenpairRange,
    /// Largest relative residual |W phi - lambda M phi| / (lambda |phi|), in the norms of M^-1 and M.
    /// Default 1e-9. From 1e-4 on, [`Eigensolver::Multigrid`] keeps eigenfunctions in single precision.
    pub tolerance: f64,
    /// The algorithm. Default [`Eigensolver::Auto`].
    pub solver: Eigensolver,
    /// Restarts before giving up. Default 60.
    pub max_iterations: usize,
    /// Refuse work whose estimated memory exceeds this many bytes. Default: no limit.
    // Not stored: it changes no result, and another machine has another limit.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub memory_limit: Option<u64>,
}

impl Default for SpectrumParameters {
    fn default() -> Self {
        Self {
            eigenpairs: EigenpairRange::AtMost(100),
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
    /// [`SpectralError::InvalidParameter`] for the first field that is out of range.
    pub fn validate(&self) -> Result<(), SpectralError> {
        match self.eigenpairs {
            EigenpairRange::Count(count) | EigenpairRange::AtMost(count) => {
                InvalidParameter::unless(count > 0, "eigenpairs", count, "at least 1")?
            }
            EigenpairRange::LambdaMax(bound) => {
                let valid = bound > 0.0 && bound.is_finite();
                InvalidParameter::unless(valid, "lambda_max", bound, "a finite number above 0")?;
            }
        }
        let valid = self.tolerance > 0.0 && self.tolerance <= 1e-2;
        InvalidParameter::unless(valid, "tolerance", self.tolerance, "above 0 and at most 0.01")?;
        let iterations = self.max_iterations;
        Ok(InvalidParameter::unless(iterations > 0, "max_iterations", iterations, "at least 1")?)
    }
}

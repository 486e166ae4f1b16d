use crate::ShapeError;

crate::choice! {
    /// What a Laplacian lives on: it fixes the exponents of the paper's formulas and the units.
    pub enum Domain("domain") {
        /// A solid: masses are volumes
        #[default]
        Volume = "volume",
        /// A surface: masses are areas
        Surface = "surface",
    }
}

impl Domain {
    /// 3 for a volume, 2 for a surface.
    pub fn dimension(self) -> u32 {
        match self {
            Self::Volume => 3,
            Self::Surface => 2,
        }
    }
}

/// The smallest eigenpairs of a Laplacian, `W phi_i = lambda_i M phi_i`.
///
/// The eigenfunctions are M-orthonormal: `sum_v m_v phi_i(v) phi_j(v) = delta_ij`, so heat-kernel
/// values have units length^-3 in a volume and length^-2 on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenbasis {
    domain: Domain,
    mass: Vec<f64>,
    eigenvalues: Vec<f64>,
    functions: Vec<f64>,
}

impl Eigenbasis {
    /// `mass`: n; `eigenvalues`: k, ascending, in length^-2; `functions`: n x k, row by row, so that
    /// `functions[v * k + i]` is phi_i(v).
    ///
    /// # Errors
    /// [`ShapeError::SizeMismatch`], or [`ShapeError::BadEigenbasis`] for eigenvalues that are
    /// negative, not finite or not ascending, or masses that are negative or not finite.
    pub fn new(
        domain: Domain,
        mass: Vec<f64>,
        eigenvalues: Vec<f64>,
        functions: Vec<f64>,
    ) -> Result<Self, ShapeError> {
        EigenbasisView::new(domain, &mass, &eigenvalues, &functions)?;
        Ok(Self { domain, mass, eigenvalues, functions })
    }

    /// The same, borrowed.
    pub fn view(&self) -> EigenbasisView<'_> {
        let Self { domain, mass, eigenvalues, functions } = self;
        EigenbasisView { domain: *domain, mass, eigenvalues, functions }
    }

    /// Volume or surface.
    pub fn domain(&self) -> Domain {
        self.domain
    }

    /// Number of voxels or vertices, n.
    pub fn len(&self) -> usize {
        self.mass.len()
    }

    /// Whether there are no voxels or vertices.
    pub fn is_empty(&self) -> bool {
        self.mass.is_empty()
    }

    /// Volume or area of each voxel or vertex.
    pub fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// The k eigenvalues in length^-2, ascending.
    pub fn eigenvalues(&self) -> &[f64] {
        &self.eigenvalues
    }

    /// All eigenfunctions, n x k, row by row.
    pub fn functions(&self) -> &[f64] {
        &self.functions
    }

    /// The values of all k eigenfunctions at a voxel or vertex.
    #[inline]
    pub fn at(&self, vertex: usize) -> &[f64] {
        self.view().at(vertex)
    }

    /// Total volume or area.
    pub fn measure(&self) -> f64 {
        self.view().measure()
    }

    /// The unit of time: V^(2/3) of a volume V, or A of a surface of area A. A relative time scale
    /// times this is an absolute one (units length^2).
    pub fn unit_time(&self) -> f64 {
        self.view().unit_time()
    }
}

/// Eigenpairs that lie elsewhere, such as in an array of another library: an [`Eigenbasis`] without a copy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EigenbasisView<'a> {
    domain: Domain,
    mass: &'a [f64],
    eigenvalues: &'a [f64],
    functions: &'a [f64],
}

impl<'a> EigenbasisView<'a> {
    /// As [`Eigenbasis::new`], with its errors.
    pub fn new(
        domain: Domain,
        mass: &'a [f64],
        eigenvalues: &'a [f64],
        functions: &'a [f64],
    ) -> Result<Self, ShapeError> {
        let expected = mass.len() * eigenvalues.len();
        if functions.len() != expected {
            let found = functions.len();
            return Err(ShapeError::SizeMismatch { what: "values of the eigenfunctions", found, expected });
        }
        if !eigenvalues.is_sorted() || eigenvalues.iter().any(|l| !(l.is_finite() && *l >= 0.0)) {
            return Err(ShapeError::BadEigenbasis {
                reason: "eigenvalues must be finite, non-negative and ascending",
            });
        }
        if mass.iter().any(|m| !(m.is_finite() && *m >= 0.0)) {
            return Err(ShapeError::BadEigenbasis { reason: "masses must be finite and non-negative" });
        }
        Ok(Self { domain, mass, eigenvalues, functions })
    }

    /// Volume or surface.
    pub fn domain(self) -> Domain {
        self.domain
    }

    /// Number of voxels or vertices, n.
    pub fn len(self) -> usize {
        self.mass.len()
    }

    /// Whether there are no voxels or vertices.
    pub fn is_empty(self) -> bool {
        self.mass.is_empty()
    }

    /// The k eigenvalues in length^-2, ascending.
    pub fn eigenvalues(self) -> &'a [f64] {
        self.eigenvalues
    }

    /// The values of all k eigenfunctions at a voxel or vertex.
    #[inline]
    pub fn at(self, vertex: usize) -> &'a [f64] {
        let k = self.eigenvalues.len();
        &self.functions[vertex * k..(vertex + 1) * k]
    }

    /// Total volume or area.
    pub fn measure(self) -> f64 {
        self.mass.iter().sum()
    }

    /// As [`Eigenbasis::unit_time`].
    pub fn unit_time(self) -> f64 {
        self.measure().powf(2.0 / f64::from(self.domain.dimension()))
    }
}

impl<'a> From<&'a Eigenbasis> for EigenbasisView<'a> {
    fn from(basis: &'a Eigenbasis) -> Self {
        basis.view()
    }
}

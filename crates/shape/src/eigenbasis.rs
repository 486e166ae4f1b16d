use std::borrow::Cow;
use std::ops::Range;

use crate::{Functions, FunctionsView, ShapeError};

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
/// values have units length^-3 in a volume and length^-2 on a surface. Masses and eigenvalues are in double precision;
/// eigenfunctions are in either ([`Functions`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenbasis {
    domain: Domain,
    mass: Vec<f64>,
    eigenvalues: Vec<f64>,
    functions: Functions,
}

impl Eigenbasis {
    /// `mass`: n; `eigenvalues`: k, ascending, in length^-2; `functions`: n x k, row by row, so that
    /// `functions[v * k + i]` is phi_i(v). A `Vec` of `f64` or of `f32` will do.
    ///
    /// # Errors
    /// [`ShapeError::SizeMismatch`], or [`ShapeError::BadEigenbasis`] for eigenvalues that are
    /// negative, not finite or not ascending, or masses that are negative or not finite.
    pub fn new(
        domain: Domain,
        mass: Vec<f64>,
        eigenvalues: Vec<f64>,
        functions: impl Into<Functions>,
    ) -> Result<Self, ShapeError> {
        let functions = functions.into();
        EigenbasisView::new(domain, &mass, &eigenvalues, functions.view())?;
        Ok(Self { domain, mass, eigenvalues, functions })
    }

    /// The same, borrowed.
    pub fn view(&self) -> EigenbasisView<'_> {
        let Self { domain, mass, eigenvalues, functions } = self;
        EigenbasisView { domain: *domain, mass, eigenvalues, functions: functions.view() }
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
    pub fn functions(&self) -> FunctionsView<'_> {
        self.functions.view()
    }

    /// The values of all k eigenfunctions at a voxel or vertex: a copy if they are in single precision. Where many are asked for,
    /// [`Eigenbasis::row`] is faster.
    pub fn at(&self, vertex: usize) -> Cow<'_, [f64]> {
        self.view().part(vertex, 0..self.eigenvalues.len()).to_f64()
    }

    /// The values of some of the k eigenfunctions at a voxel or vertex. Those in double precision are given as they lie; others are
    /// written to `scratch`, which may be empty at first and serves for any number of rows.
    #[inline(always)]
    pub fn row<'s>(&'s self, vertex: usize, modes: Range<usize>, scratch: &'s mut Vec<f64>) -> &'s [f64] {
        self.view().row(vertex, modes, scratch)
    }

    /// Keeps the first `count` eigenpairs, with their precision; all of them if there are no more.
    pub fn truncate(&mut self, count: usize) {
        let all = self.eigenvalues.len();
        if count < all {
            self.functions.truncate_rows(all, count);
            self.eigenvalues.truncate(count);
        }
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
    functions: FunctionsView<'a>,
}

impl<'a> EigenbasisView<'a> {
    /// As [`Eigenbasis::new`], with its errors.
    pub fn new(
        domain: Domain,
        mass: &'a [f64],
        eigenvalues: &'a [f64],
        functions: impl Into<FunctionsView<'a>>,
    ) -> Result<Self, ShapeError> {
        let functions = functions.into();
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

    /// As [`Eigenbasis::row`].
    #[inline(always)]
    pub fn row<'s>(self, vertex: usize, modes: Range<usize>, scratch: &'s mut Vec<f64>) -> &'s [f64]
    where
        'a: 's,
    {
        match self.part(vertex, modes) {
            FunctionsView::Double(values) => values,
            FunctionsView::Single(values) => {
                scratch.resize(values.len(), 0.0);
                scratch.iter_mut().zip(values).for_each(|(x, &value)| *x = value.into());
                scratch
            }
        }
    }

    #[inline(always)]
    fn part(self, vertex: usize, modes: Range<usize>) -> FunctionsView<'a> {
        let first = vertex * self.eigenvalues.len();
        self.functions.slice(first + modes.start..first + modes.end)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Three rows of two eigenfunctions, with values that single precision cannot hold.
    const VALUES: [f64; 6] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];

    fn basis(functions: impl Into<Functions>) -> Eigenbasis {
        Eigenbasis::new(Domain::Volume, vec![1.0; 3], vec![0.0, 1.0], functions).unwrap()
    }

    #[test]
    fn a_row_is_the_same_however_it_is_asked_for_and_doubles_are_not_copied() {
        let rounded = VALUES.map(|x| x as f32);
        let (double, single) = (basis(VALUES.to_vec()), basis(rounded.to_vec()));
        let mut scratch = Vec::new();
        assert_eq!(double.row(1, 0..2, &mut scratch), [0.3, 0.4]);
        assert!(scratch.is_empty() && matches!(double.at(1), Cow::Borrowed(_)));
        assert_eq!(*double.at(1), [0.3, 0.4]);
        let [third, fourth] = [0.3f32, 0.4].map(f64::from);
        assert_eq!(single.row(1, 0..2, &mut scratch), [third, fourth]);
        assert_eq!(single.row(1, 1..2, &mut scratch), [fourth]);
        assert_eq!(*single.at(1), [third, fourth]);
        assert!(single.functions().values().eq(rounded.map(f64::from)));
        assert_eq!(*single.functions().slice(2..4).to_f64(), [third, fourth]);
        assert_ne!(basis(rounded.map(f64::from).to_vec()), single);
        assert!(Eigenbasis::new(Domain::Volume, vec![1.0; 3], vec![0.0], rounded.to_vec()).is_err());
    }

    #[test]
    fn the_first_eigenpairs_keep_their_precision() {
        let cut = |functions: Functions| {
            let mut basis = basis(functions);
            basis.truncate(2);
            assert_eq!(basis.eigenvalues(), [0.0, 1.0]);
            basis.truncate(1);
            assert_eq!((basis.eigenvalues(), basis.len()), (&[0.0][..], 3));
            basis.functions
        };
        assert_eq!(cut(VALUES.to_vec().into()), vec![0.1, 0.3, 0.5].into());
        assert_eq!(cut(VALUES.map(|x| x as f32).to_vec().into()), vec![0.1f32, 0.3, 0.5].into());
    }
}

use mser3d_shape::{Components, Domain, Graph};
use sprs::CsMat;

/// The generalized eigenproblem `W phi = lambda M phi`: a symmetric stiffness W and a diagonal mass M.
///
/// The Laplacians of this crate (sections 3.1 and 3.2 of the paper) are positive semidefinite, and their rows
/// sum to zero. [`Operator::new`] takes any symmetric matrix: a Dirichlet Laplacian, a Laplacian plus a
/// potential, the matrices of other finite elements with lumped masses. A row without mass (a vertex that no
/// triangle with area touches) has no stiffness either and takes no part.
///
/// ```
/// use mser3d_laplace::{Operator, sprs::TriMat};
/// use mser3d_shape::Domain;
///
/// // A rod of three cells of length 1, held at 0 at both ends.
/// let mut stiffness = TriMat::new((3, 3));
/// for i in 0..3 {
///     stiffness.add_triplet(i, i, if i == 1 { 2.0 } else { 3.0 });
/// }
/// for i in 0..2 {
///     stiffness.add_triplet(i, i + 1, -1.0);
///     stiffness.add_triplet(i + 1, i, -1.0);
/// }
/// let rod = Operator::new(Domain::Volume, stiffness.to_csc(), vec![1.0; 3])?;
/// assert!(rod.is_known_semidefinite());
/// assert_eq!([0, 1, 2].map(|row| rod.sums_to_zero(row)), [false, true, false]);
/// # Ok::<(), mser3d_laplace::LaplaceError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Operator {
    domain: Domain,
    stiffness: CsMat<f64>,
    mass: Vec<f64>,
    known_semidefinite: bool,
}

/// Sums of a row count as zero up to this part of its absolute values' sum: rounding errors of assembly.
const ROUNDING: f64 = 1e-13;

/// Why a shape has no Laplacian.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LaplaceError {
    /// Matrix and mass do not belong together.
    #[error("the stiffness matrix is {rows} x {columns}, the mass has {masses} entries; all must agree")]
    SizeMismatch {
        /// Rows of the matrix.
        rows: usize,
        /// Columns of the matrix.
        columns: usize,
        /// Entries of the mass.
        masses: usize,
    },
    /// A stiffness matrix that is not symmetric or not finite, or masses that are not masses.
    #[error("not an operator: {reason} (row {row})")]
    InvalidOperator {
        /// What is wrong.
        reason: &'static str,
        /// The first row where it is.
        row: usize,
    },
    /// All triangles are degenerate.
    #[error(
        "the mesh has no triangle with an area (of {triangles}); check that the file's coordinates are not all equal"
    )]
    NoArea {
        /// How many triangles there are.
        triangles: usize,
    },
    /// A function with another number of values than the operator has rows.
    #[error("the function has {found} values; the operator has {expected} rows")]
    WrongLength {
        /// Its values.
        found: usize,
        /// Rows of the operator.
        expected: usize,
    },
    /// A time in which no heat can flow.
    #[error("heat flows for a time that is finite and not negative, not for {time}")]
    InvalidTime {
        /// The time.
        time: f64,
    },
    /// A harmonic function without a single value to begin with.
    #[error("no value of the function is known; at least one is needed")]
    NothingKnown,
    /// A linear system that rounding errors keep from being solved.
    #[error(
        "a linear system with the Laplacian cannot be solved (relative residual {residual:.1e}): some triangles are far \
         too thin; remesh the surface or search the volume"
    )]
    NotSolved {
        /// The residual that was reached, relative to the right-hand side.
        residual: f64,
    },
}

impl Operator {
    /// An operator from its stiffness W (n x n, units length^(d-2)) and the diagonal of its mass M (n,
    /// length^d).
    ///
    /// W may be compressed by rows or by columns. It need not be positive semidefinite here; the eigensolvers
    /// of `mser3d-spectral` refuse it if it is not.
    ///
    /// # Errors
    /// [`LaplaceError::SizeMismatch`]; [`LaplaceError::InvalidOperator`] for a stiffness that is not finite or
    /// not symmetric to the last bit, for masses that are negative or not finite, and for stiffness without mass.
    pub fn new(domain: Domain, stiffness: CsMat<f64>, mass: Vec<f64>) -> Result<Self, LaplaceError> {
        let (rows, columns) = stiffness.shape();
        if rows != mass.len() || columns != mass.len() {
            return Err(LaplaceError::SizeMismatch { rows, columns, masses: mass.len() });
        }
        let stiffness = stiffness.into_csc();
        let mut known_semidefinite = true;
        for (row, vector) in stiffness.outer_iterator().enumerate() {
            let fail = |reason| Err(LaplaceError::InvalidOperator { reason, row });
            let (mut diagonal, mut rest) = (0.0, 0.0f64);
            for (column, &value) in vector.iter() {
                if !value.is_finite() {
                    return fail("the stiffness is not finite");
                }
                let mirror = stiffness.get(row, column).copied().unwrap_or(0.0);
                if mirror != value {
                    return fail("the stiffness is not symmetric");
                }
                match column == row {
                    true => diagonal = value,
                    false => rest += value.abs(),
                }
            }
            if !(mass[row].is_finite() && mass[row] >= 0.0) {
                return fail("the mass is negative or not finite");
            }
            if mass[row] == 0.0 && (diagonal != 0.0 || rest > 0.0) {
                return fail("there is stiffness but no mass");
            }
            known_semidefinite &= diagonal - rest >= -ROUNDING * rest;
        }
        Ok(Self { domain, stiffness, mass, known_semidefinite })
    }

    /// For the Laplacians of this crate, which are right by construction.
    pub(crate) fn assembled(domain: Domain, stiffness: CsMat<f64>, mass: Vec<f64>) -> Self {
        Self { domain, stiffness, mass, known_semidefinite: true }
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

    /// W: n x n, compressed by columns, both triangles, units length^(d-2).
    pub fn stiffness(&self) -> &CsMat<f64> {
        &self.stiffness
    }

    /// The diagonal of M: units length^d, zero where a vertex takes no part.
    pub fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// Whether W is known to be positive semidefinite, to rounding: a Laplacian of this crate, or a matrix
    /// whose diagonal is at least the sum of its row's other absolute values (Gershgorin). Others may be or
    /// not.
    pub fn is_known_semidefinite(&self) -> bool {
        self.known_semidefinite
    }

    /// Whether a row of W sums to zero, to rounding. Where all rows of a component do, the constant is an
    /// eigenfunction of it with eigenvalue 0.
    pub fn sums_to_zero(&self, row: usize) -> bool {
        let (mut sum, mut size, mut entries) = (0.0, 0.0, 0);
        for &value in self.stiffness.outer_view(row).iter().flat_map(|v| v.data()) {
            (sum, size, entries) = (sum + value, size + value.abs(), entries + 1);
        }
        let rounding = ROUNDING.max(4.0 * f64::from(entries) * f64::EPSILON);
        // A sum that overflows to no number is no sign of a boundary.
        sum.is_nan() || sum.abs() <= rounding * size
    }

    /// The operator on some rows, ascending, that are not linked to any others: one or more whole components.
    pub fn restrict(&self, rows: &[u32]) -> Self {
        let mut position = vec![usize::MAX; self.len()];
        rows.iter().enumerate().for_each(|(at, &row)| position[row as usize] = at);
        let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        for &row in rows {
            for (column, &value) in self.stiffness.outer_view(row as usize).iter().flat_map(|v| v.iter()) {
                if position[column] != usize::MAX {
                    columns.push(position[column]);
                    values.push(value);
                }
            }
            starts.push(columns.len());
        }
        let n = rows.len();
        let mass = rows.iter().map(|&row| self.mass[row as usize]).collect();
        let stiffness = CsMat::new_csc((n, n), starts, columns, values);
        Self { domain: self.domain, stiffness, mass, known_semidefinite: self.known_semidefinite }
    }

    /// The connected components of the rows. Rows without mass are components of their own.
    ///
    /// Of a Laplacian, 0 is an eigenvalue as often as there are components with mass.
    pub fn components(&self) -> Components {
        let edges: Vec<[u32; 2]> = self
            .stiffness
            .iter()
            .filter(|&(&value, (row, column))| row < column && value != 0.0)
            .map(|(_, (row, column))| [row as u32, column as u32])
            .collect();
        Graph::from_edges(self.len(), &edges).expect("rows of the matrix are in range").components()
    }
}

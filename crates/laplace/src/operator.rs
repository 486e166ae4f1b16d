use mser3d_shape::{Components, Domain, Graph};
use sprs::CsMat;

/// The generalized eigenproblem `W phi = lambda M phi` of a shape's Laplacian, sections 3.1 and 3.2.
///
/// W is symmetric and positive semidefinite with zero row sums; M is diagonal. A row without mass
/// (a vertex that no triangle with area touches) has no stiffness either and takes no part.
#[derive(Clone, Debug)]
pub struct Operator {
    domain: Domain,
    stiffness: CsMat<f64>,
    mass: Vec<f64>,
}

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
    /// A stiffness matrix that is not the symmetric matrix of a Laplacian, or masses that are not masses.
    #[error("not a Laplacian: {reason} (row {row})")]
    NotALaplacian {
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
}

impl Operator {
    /// An operator from its stiffness (n x n, length^(d-2)) and mass (n, length^d).
    ///
    /// # Errors
    /// [`LaplaceError::SizeMismatch`]; [`LaplaceError::NotALaplacian`] for entries that are not
    /// finite, not symmetric, rows that do not sum to zero, negative masses, or stiffness without mass.
    pub fn new(domain: Domain, stiffness: CsMat<f64>, mass: Vec<f64>) -> Result<Self, LaplaceError> {
        let (rows, columns) = stiffness.shape();
        if rows != mass.len() || columns != mass.len() {
            return Err(LaplaceError::SizeMismatch { rows, columns, masses: mass.len() });
        }
        let stiffness = stiffness.into_csc();
        for (row, vector) in stiffness.outer_iterator().enumerate() {
            let fail = |reason| Err(LaplaceError::NotALaplacian { reason, row });
            let (mut sum, mut size) = (0.0, 0.0f64);
            for (column, &value) in vector.iter() {
                if !value.is_finite() {
                    return fail("the stiffness is not finite");
                }
                let mirror = stiffness.get(row, column).copied().unwrap_or(0.0);
                if mirror != value {
                    return fail("the stiffness is not symmetric");
                }
                sum += value;
                size += value.abs();
            }
            if sum.abs() > 1e-9 * size {
                return fail("the stiffness does not sum to zero");
            }
            if !(mass[row].is_finite() && mass[row] >= 0.0) {
                return fail("the mass is negative or not finite");
            }
            if mass[row] == 0.0 && size > 0.0 {
                return fail("there is stiffness but no mass");
            }
        }
        Ok(Self { domain, stiffness, mass })
    }

    /// For assemblies in this crate, which are right by construction.
    pub(crate) fn assembled(domain: Domain, stiffness: CsMat<f64>, mass: Vec<f64>) -> Self {
        Self { domain, stiffness, mass }
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
        Self { domain: self.domain, stiffness: CsMat::new_csc((n, n), starts, columns, values), mass }
    }

    /// The connected components of the rows; their number is the number of zero eigenvalues, rows
    /// without mass apart.
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

//! Laplacians and their eigenpairs.

use std::sync::Arc;

use mser3d::laplace::sprs::CsMat;
use mser3d::laplace::{self, LaplaceError};
use mser3d::shape::{Domain, Eigenbasis, VoxelGrid};
use mser3d::spectral::{SpectralError, SpectrumParameters, smallest_eigenpairs, smallest_eigenpairs_of_grid};
use mser3d_cli::CliError;
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{columns, flat, mesh, wrong};
use crate::errors::{exception, of_library, usage};
use crate::run::{Call, Told, run};
use crate::voxels::Voxels;

/// A stiffness matrix and a diagonal mass; of a grid without a matrix until it is asked for.
#[pyclass(frozen, module = "mser3d._native")]
pub struct Operator {
    kind: Kind,
}

enum Kind {
    Grid(Arc<VoxelGrid>),
    Matrix(Arc<laplace::Operator>),
}

#[pymethods]
impl Operator {
    /// An operator from a symmetric matrix, compressed by rows or columns, and a mass.
    #[new]
    fn new(
        py: Python<'_>,
        indptr: PyReadonlyArray1<'_, i64>,
        indices: PyReadonlyArray1<'_, i64>,
        data: PyReadonlyArray1<'_, f64>,
        mass: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Self> {
        let whole = |name: &str, values: &[i64]| -> PyResult<Vec<usize>> {
            let whole = values.iter().map(|&v| usize::try_from(v));
            whole.collect::<Result<_, _>>().map_err(|_| wrong(name, "holds a negative number"))
        };
        let (starts, rows) = (whole("indptr", indptr.as_slice()?)?, whole("indices", indices.as_slice()?)?);
        let (data, mass) = (data.as_slice()?.to_vec(), mass.as_slice()?.to_vec());
        let n = mass.len();
        let operator = py.detach(|| -> Result<laplace::Operator, CliError> {
            let matrix = CsMat::try_new_csc((n, n), starts, rows, data)
                .map_err(|(_, _, _, e)| usage(format!("operator: not a compressed matrix: {e}")))?;
            laplace::Operator::new(Domain::Volume, matrix, mass).map_err(|e| usage(format!("operator: {e}")))
        });
        Ok(Self { kind: Kind::Matrix(Arc::new(operator.map_err(exception)?)) })
    }

    /// The stiffness compressed by columns (data, indices, indptr), and the mass.
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyAny>; 4]> {
        let operator = match &self.kind {
            Kind::Grid(grid) => Arc::new(py.detach(|| laplace::grid_laplacian(grid))),
            Kind::Matrix(operator) => Arc::clone(operator),
        };
        let matrix = operator.stiffness();
        let int = |values: &[usize]| -> Bound<'py, PyAny> {
            // SciPy takes the same type for both, the smaller where it does.
            if matrix.nnz() < i32::MAX as usize {
                flat(py, values.iter().map(|&v| v as i32).collect()).into_any()
            } else {
                flat(py, values.iter().map(|&v| v as i64).collect()).into_any()
            }
        };
        let starts = matrix.indptr();
        let starts = starts.as_slice().ok_or_else(|| wrong("operator", "is a part of a matrix"))?;
        Ok([
            flat(py, matrix.data().to_vec()).into_any(),
            int(matrix.indices()),
            int(starts),
            flat(py, operator.mass().to_vec()).into_any(),
        ])
    }
}

/// The Laplacian of the voxels of a solid.
#[pyfunction]
pub fn grid_laplacian(voxels: &Voxels) -> Operator {
    Operator { kind: Kind::Grid(Arc::clone(&voxels.grid)) }
}

/// The cotangent Laplacian of a mesh.
#[pyfunction]
pub fn cotangent_laplacian(
    py: Python<'_>,
    vertices: PyReadonlyArray2<'_, f64>,
    faces: PyReadonlyArray2<'_, i64>,
) -> PyResult<Operator> {
    let mesh = mesh(&vertices, &faces)?;
    let operator: Result<laplace::Operator, LaplaceError> = py.detach(|| laplace::cotangent_laplacian(&mesh));
    let operator = operator.map_err(|e| exception(of_library(e)))?;
    Ok(Operator { kind: Kind::Matrix(Arc::new(operator)) })
}

/// The smallest eigenpairs: eigenvalues, and eigenfunctions in columns.
#[pyfunction]
#[pyo3(signature = (operator, k, tolerance, solver, memory_limit=None, threads=None, progress=None))]
#[allow(clippy::too_many_arguments)]
pub fn eigs<'py>(
    py: Python<'py>,
    operator: &Operator,
    k: usize,
    tolerance: f64,
    solver: &str,
    memory_limit: Option<u64>,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let solver = solver.parse().map_err(|e| exception(usage(format!("solver: {e}"))))?;
    let parameters = SpectrumParameters {
        eigenpairs: k.into(),
        tolerance,
        solver,
        memory_limit,
        ..SpectrumParameters::default()
    };
    let call = Call { progress, threads };
    let (values, basis) = match &operator.kind {
        Kind::Grid(grid) => {
            let grid = Arc::clone(grid);
            run(py, &call, move |told| {
                let found = smallest_eigenpairs_of_grid(&grid, &parameters, &|done| {
                    told.report_share("spectrum", done)
                });
                found.map(|found| pairs(found.basis)).map_err(of_library)
            })?
        }
        Kind::Matrix(matrix) => {
            let matrix = Arc::clone(matrix);
            run(py, &call, move |told| of_matrix(&matrix, &parameters, told))?
        }
    };
    Ok((flat(py, values).into_any(), columns(py, &basis)?))
}

/// Eigenvalues, and a basis with the eigenfunctions.
type Pairs = (Vec<f64>, Eigenbasis);

fn pairs(basis: Eigenbasis) -> Pairs {
    (basis.eigenvalues().to_vec(), basis)
}

/// The eigenpairs of any symmetric matrix: one that is not positive semidefinite is shifted until it is, by the circles of
/// Gershgorin.
fn of_matrix(
    matrix: &laplace::Operator,
    parameters: &SpectrumParameters,
    told: &Told,
) -> Result<Pairs, CliError> {
    let report = |done: f64| told.report_share("spectrum", done);
    match smallest_eigenpairs(matrix, parameters, &report) {
        Err(SpectralError::Indefinite { .. }) => {}
        found => return found.map(|found| pairs(found.basis)).map_err(of_library),
    }
    let mut shift = 0.0f64;
    for (row, vector) in matrix.stiffness().outer_iterator().enumerate() {
        let (mut diagonal, mut rest) = (0.0, 0.0);
        for (column, &value) in vector.iter() {
            if column == row { diagonal = value } else { rest += value.abs() }
        }
        if matrix.mass()[row] > 0.0 {
            shift = shift.max((rest - diagonal) / matrix.mass()[row]);
        }
    }
    let mass: Vec<f64> = matrix.mass().iter().map(|m| shift * m).collect();
    let shifted = matrix.stiffness()
        + &CsMat::new_csc(
            (mass.len(), mass.len()),
            (0..=mass.len()).collect(),
            (0..mass.len()).collect(),
            mass,
        );
    let shifted =
        laplace::Operator::new(matrix.domain(), shifted, matrix.mass().to_vec()).map_err(of_library)?;
    let found = smallest_eigenpairs(&shifted, parameters, &report).map_err(of_library)?;
    let (mut values, basis) = pairs(found.basis);
    values.iter_mut().for_each(|value| *value -= shift);
    Ok((values, basis))
}

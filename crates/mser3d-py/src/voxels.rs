//! Solids as voxels: made of a mesh, or given as a mask.

use std::sync::Arc;

use mser3d::shape::{BitGrid, Connectivity, VoxelGrid};
use mser3d_cli::{CliError, VoxelizeArgs};
use mser3d_results::{ShapeFile, ShapeOptions, VoxelizationRecord};
use numpy::{PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{affine, flat, mesh, rows, volume, wrong};
use crate::detect::{ARRAY, Source};
use crate::errors::exception;
use crate::options::parse;
use crate::run::{Call, run};

/// The voxels of a solid, with the links between them.
#[pyclass(frozen, module = "mser3d._native")]
pub struct Voxels {
    pub grid: Arc<VoxelGrid>,
    pub connectivity: Connectivity,
    report: String,
    warnings: Vec<String>,
}

#[pymethods]
impl Voxels {
    fn __len__(&self) -> usize {
        self.grid.len()
    }

    #[getter]
    fn dims(&self) -> [usize; 3] {
        self.grid.frame().dims()
    }

    /// How it was made, as JSON; empty for a mask.
    #[getter]
    fn report(&self) -> String {
        self.report.clone()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// Index to world, 4 x 4.
    fn affine<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let matrix = self.grid.frame().affine().matrix();
        Ok(rows(py, matrix.as_flattened().to_vec(), 4)?.into_any())
    }

    /// Which voxels are inside, indexed [x, y, z].
    fn mask<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let [nx, ny, nz] = self.dims();
        let mut inside = vec![false; nx * ny * nz];
        for [i, j, k] in self.grid.voxels() {
            inside[(i as usize * ny + j as usize) * nz + k as usize] = true;
        }
        let mask = flat(py, inside).reshape([nx, ny, nz]);
        Ok(mask.map_err(|e| PyValueError::new_err(e.to_string()))?.into_any())
    }

    /// The place of each voxel, in the order of the rows of operators: x fastest.
    fn index<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let index = self.grid.voxels().flatten().map(|i| i as i32).collect();
        Ok(rows(py, index, 3)?.into_any())
    }
}

/// The solid inside a mesh.
#[pyfunction]
#[pyo3(signature = (source, keywords, threads=None))]
pub fn voxelize(
    py: Python<'_>,
    source: Source<'_>,
    keywords: &Bound<'_, PyDict>,
    threads: Option<usize>,
) -> PyResult<Voxels> {
    let path = match &source {
        Source::Path(path) => path.clone(),
        Source::Mesh(..) => ARRAY.into(),
    };
    let args: VoxelizeArgs = parse("voxelize", keywords, &[path.into()])?;
    let given = match source {
        Source::Path(_) => None,
        Source::Mesh(vertices, faces) => Some(mesh(&vertices, &faces)?),
    };
    run(py, &Call { progress: None, threads }, move |_| {
        let file = match given {
            Some(mesh) => ShapeFile::of_mesh(mesh, ARRAY, &ShapeOptions::default())?,
            None => args.read()?,
        };
        let solid = args.find(&file)?;
        let record: VoxelizationRecord = (&solid).into();
        let report = serde_json::to_string(&record).map_err(|e| CliError::Usage(e.to_string()))?;
        let warnings = solid.warnings.iter().map(|warning| format!("{}: {warning}", file.path.display()));
        let connectivity = args.connectivity();
        Ok(Voxels { warnings: warnings.collect(), grid: Arc::new(solid.grid), connectivity, report })
    })
}

/// A solid from a mask, x fastest, whose neighbouring voxels are all linked.
#[pyfunction]
pub fn solid(
    py: Python<'_>,
    dims: [usize; 3],
    array: &Bound<'_, PyAny>,
    map: PyReadonlyArray2<'_, f64>,
) -> PyResult<Voxels> {
    debug_assert_eq!(map.shape(), [4, 4]);
    let volume = volume(dims, 1, array)?.with_affine(affine(&map)?);
    let work = || -> Result<Voxels, CliError> {
        let usage = |e: mser3d::shape::ShapeError| CliError::Usage(e.to_string());
        let mut mask = BitGrid::empty(dims).map_err(usage)?;
        let [nx, ny, _] = dims;
        for place in volume.samples().nonzero() {
            mask.set([place % nx, place / nx % ny, place / (nx * ny)].map(|i| i as u32), true);
        }
        let frame = volume.frame().map_err(usage)?;
        let grid = VoxelGrid::solid(frame, mask).map_err(usage)?;
        let connectivity = Connectivity::default();
        Ok(Voxels { grid: Arc::new(grid), connectivity, report: String::new(), warnings: Vec::new() })
    };
    let voxels = py.detach(work).map_err(exception)?;
    if voxels.grid.is_empty() { Err(wrong("mask", "no voxel is inside")) } else { Ok(voxels) }
}

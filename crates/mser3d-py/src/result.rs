//! `Result`: what was found on a shape, as arrays.

use std::path::{Path, PathBuf};
use std::result::Result as StdResult;
use std::sync::{Arc, OnceLock};

use mser3d_cli::{CliError, RenderArgs};
use mser3d_collection::DescribedResult;
use mser3d_results::{Eigenfunctions, Extra, Results, ResultsFolder, Up};
use numpy::PyArrayMethods;
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::arrays::{columns, flat, rows};
use crate::errors::{exception, usage};
use crate::options::parse;
use crate::run::{Call, run};

/// What was found on a shape. Arrays are made anew by each call.
#[pyclass(frozen, name = "Result", module = "mser3d._native")]
pub struct Found {
    results: Arc<Results>,
    /// Those of each body; none of a result that was read from a folder without them.
    eigenfunctions: Option<Arc<Vec<Eigenfunctions>>>,
    warnings: Vec<String>,
    /// Where it was read from, or what it is called.
    folder: PathBuf,
    /// A copy to be compared with others, once one was asked for.
    described: OnceLock<Arc<DescribedResult>>,
}

pub use Found as Result;

impl Found {
    /// Results with their eigenfunctions, and what else there is to say of them.
    pub fn new(mut results: Results, warnings: Vec<String>) -> Self {
        let eigenfunctions = results.eigenfunctions.take().map(Arc::new);
        let folder = PathBuf::from(&results.record.input.path);
        Self { results: Arc::new(results), eigenfunctions, warnings, folder, described: OnceLock::new() }
    }

    /// A copy to be compared with others.
    ///
    /// # Errors
    /// For a result without regions.
    pub fn described(&self) -> StdResult<Arc<DescribedResult>, CliError> {
        if let Some(known) = self.described.get() {
            return Ok(Arc::clone(known));
        }
        let new = DescribedResult::new(Results::clone(&self.results), &self.folder)?;
        Ok(Arc::clone(self.described.get_or_init(|| Arc::new(new))))
    }

    fn body(&self, body: usize) -> PyResult<&Eigenfunctions> {
        let bodies = self.eigenfunctions.as_ref().ok_or_else(|| {
            let why = "eigenfunctions were not kept: save the result with write=['eigenfunctions'], or run \
                       `mser3d detect --write eigenfunctions`";
            PyValueError::new_err(format!("{}: {why}", self.folder.display()))
        })?;
        bodies.get(body).ok_or_else(|| PyIndexError::new_err(format!("body {body} of {}", bodies.len())))
    }

    fn region(&self, region: usize) -> PyResult<()> {
        let count = self.results.record.regions.len();
        if region < count {
            Ok(())
        } else {
            Err(PyIndexError::new_err(format!("region {region} of {count}")))
        }
    }
}

#[pymethods]
impl Found {
    /// What the user should know beside the record's warnings.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// `regions.json` as text.
    fn json(&self) -> PyResult<String> {
        self.results.record.to_json().map_err(|e| PyValueError::new_err(e.to_string()))
    }

    /// What it is called.
    #[getter]
    fn name(&self) -> String {
        self.results.name()
    }

    /// Whether the vertices are those of the input, not of the faces of its voxels.
    #[getter]
    fn has_mesh(&self) -> bool {
        !self.results.mesh_of_voxels
    }

    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(rows(py, self.results.mesh.vertices().as_flattened().to_vec(), 3)?.into_any())
    }

    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let faces = self.results.mesh.triangles().as_flattened();
        Ok(rows(py, faces.iter().map(|&v| v as i32).collect(), 3)?.into_any())
    }

    fn file_vertex<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        let map = self.results.file_vertex.as_ref()?;
        Some(flat(py, map.iter().map(|&v| v as i32).collect()).into_any())
    }

    fn voxel_index<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let grid = self.results.grid.iter();
        let index = grid.flat_map(|grid| grid.voxels()).flatten().map(|i| i as i32).collect();
        Ok(rows(py, index, 3)?.into_any())
    }

    fn vertex_voxel<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        flat(py, self.results.vertex_voxel.clone()).into_any()
    }

    fn vertex_labels<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        flat(py, self.results.vertex_region()).into_any()
    }

    fn voxel_labels<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        flat(py, self.results.voxel_region()).into_any()
    }

    fn vertex_parts<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        flat(py, self.results.vertex_part.clone()).into_any()
    }

    fn voxel_parts<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        flat(py, self.results.voxel_part.clone()).into_any()
    }

    fn region_vertices<'py>(&self, py: Python<'py>, region: usize) -> PyResult<Bound<'py, PyAny>> {
        self.region(region)?;
        let vertices = &self.results.region_vertices[region];
        Ok(flat(py, vertices.iter().map(|&v| v as i32).collect()).into_any())
    }

    fn region_voxels<'py>(&self, py: Python<'py>, region: usize) -> PyResult<Bound<'py, PyAny>> {
        self.region(region)?;
        let voxels = &self.results.region_voxels[region];
        Ok(flat(py, voxels.iter().map(|&v| v as i32).collect()).into_any())
    }

    fn descriptors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(rows(py, self.results.descriptors.clone(), self.results.descriptor_width)?.into_any())
    }

    fn evals<'py>(&self, py: Python<'py>, body: usize) -> PyResult<Bound<'py, PyAny>> {
        let values = self.results.eigenvalues.get(body);
        let values = values.ok_or_else(|| PyIndexError::new_err(format!("there is no body {body}")))?;
        Ok(flat(py, values.clone()).into_any())
    }

    fn evecs<'py>(&self, py: Python<'py>, body: usize) -> PyResult<Bound<'py, PyAny>> {
        columns(py, &self.body(body)?.basis)
    }

    fn mass<'py>(&self, py: Python<'py>, body: usize) -> PyResult<Bound<'py, PyAny>> {
        Ok(flat(py, self.body(body)?.basis.mass().to_vec()).into_any())
    }

    /// The voxel of each row of the eigenfunctions, or of a surface the row of each vertex.
    fn element_rows<'py>(&self, py: Python<'py>, body: usize) -> PyResult<Bound<'py, PyAny>> {
        let body = self.body(body)?;
        if self.results.grid.is_some() {
            return Ok(flat(py, body.voxels.iter().map(|&v| v as i32).collect()).into_any());
        }
        let row = |row: &Option<u32>| row.map_or(-1, |row| row as i32);
        Ok(flat(py, body.row_of_vertex.iter().map(row).collect()).into_any())
    }

    /// Parents (-1 for a root), altitudes and volumes of the nodes of a tree, and the node in which each element enters.
    fn tree<'py>(&self, py: Python<'py>, tree: usize) -> PyResult<[Bound<'py, PyAny>; 4]> {
        let found = self.results.trees.get(tree);
        let tree = found.ok_or_else(|| PyIndexError::new_err(format!("there is no tree {tree}")))?;
        let signed = |numbers: &[u32]| numbers.iter().map(|&n| n as i32).collect::<Vec<_>>();
        Ok([
            flat(py, signed(&tree.parents)).into_any(),
            flat(py, tree.altitudes.clone()).into_any(),
            flat(py, tree.volumes.clone()).into_any(),
            flat(py, signed(&tree.entry)).into_any(),
        ])
    }

    /// Writes the folder of `mser3d detect`.
    #[pyo3(signature = (folder, write=Vec::new()))]
    fn save(&self, py: Python<'_>, folder: PathBuf, write: Vec<String>) -> PyResult<()> {
        let extras: StdResult<Vec<Extra>, _> = write.iter().map(|name| name.parse::<Extra>()).collect();
        let extras = extras.map_err(|e| exception(usage(format!("write: {e}"))))?;
        let needed = extras.iter().any(|extra| extra.needs_eigenfunctions());
        if needed {
            self.body(0)?;
        }
        py.detach(|| -> StdResult<(), CliError> {
            let kept = self.eigenfunctions.as_ref().filter(|_| needed);
            let own;
            let mut results = &*self.results;
            if let Some(kept) = kept {
                own = {
                    let mut own = Results::clone(results);
                    own.eigenfunctions = Some(Vec::clone(kept));
                    own
                };
                results = &own;
            }
            Ok(ResultsFolder::create(&folder)?.write(results, &extras)?)
        })
        .map_err(exception)
    }

    /// The page that shows it in a browser.
    #[pyo3(signature = (up="y"))]
    fn page(&self, py: Python<'_>, up: &str) -> PyResult<String> {
        let up: Up = up.parse().map_err(|e| exception(usage(format!("up: {e}"))))?;
        let what =
            if self.results.record.parts.is_some() { "Parts and stable regions" } else { "Stable regions" };
        let title = format!("{what} of {}", self.results.name());
        py.detach(|| self.results.page(&title, up)).map_err(|e| exception(e.into()))
    }

    /// A picture as bytes of a PNG file, or as rows of pixels of three bytes.
    fn render<'py>(
        &self,
        py: Python<'py>,
        keywords: &Bound<'_, PyDict>,
        png: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let args: RenderArgs = parse("render", keywords, &[self.folder.clone().into()])?;
        let results = Arc::clone(&self.results);
        let image = run(py, &Call { progress: None, threads: None }, move |_| args.draw(&results))?;
        if png {
            let mut bytes = Vec::new();
            image.write_png(&mut bytes).map_err(|e| PyValueError::new_err(e.to_string()))?;
            return Ok(PyBytes::new(py, &bytes).into_any());
        }
        let bytes: Vec<u8> = image.pixels().iter().flat_map(|pixel| pixel.0).collect();
        let picture = flat(py, bytes).reshape([image.height(), image.width(), 3]);
        Ok(picture.map_err(|e| PyValueError::new_err(e.to_string()))?.into_any())
    }
}

/// Reads a folder that `mser3d detect` or `Result.save` wrote.
#[pyfunction]
pub fn load(py: Python<'_>, folder: PathBuf) -> PyResult<Found> {
    let read = |folder: &Path| -> StdResult<(Results, Option<Vec<Eigenfunctions>>), CliError> {
        let results = Results::load(folder)?;
        let there = folder.join(Extra::Eigenfunctions.file_name()).is_file();
        let eigenfunctions = there.then(|| Eigenfunctions::load(folder, &results)).transpose()?;
        Ok((results, eigenfunctions))
    };
    let (results, eigenfunctions) = py.detach(|| read(&folder)).map_err(exception)?;
    let eigenfunctions = eigenfunctions.map(Arc::new);
    let described = OnceLock::new();
    Ok(Found { results: Arc::new(results), eigenfunctions, warnings: Vec::new(), folder, described })
}

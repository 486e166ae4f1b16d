//! The regions of a collection that are most like those of a shape.

use std::path::PathBuf;
use std::sync::Arc;

use mser3d_cli::QueryArgs;
use mser3d_collection as collection;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{exception, usage};
use crate::options::parse;
use crate::result::Found;
use crate::run::{Call, run};

/// All regions of a collection, to be searched.
#[pyclass(frozen, module = "mser3d._native")]
pub struct Index {
    index: Arc<collection::Index>,
}

#[pymethods]
impl Index {
    /// Reads the tables that `mser3d batch` wrote.
    #[new]
    fn new(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        let index = py.detach(|| collection::Index::load(&folder)).map_err(|e| exception(e.into()))?;
        Ok(Self { index: Arc::new(index) })
    }

    fn __len__(&self) -> usize {
        self.index.len()
    }

    /// The shapes that can be found, by name.
    #[getter]
    fn shapes(&self) -> Vec<&str> {
        self.index.shapes()
    }

    /// What is nearest to each region of a shape, as JSON. `itself` is the shape's name in the collection.
    #[pyo3(signature = (shape, keywords, itself=None))]
    fn query(
        &self,
        py: Python<'_>,
        shape: &Found,
        keywords: &Bound<'_, PyDict>,
        itself: Option<String>,
    ) -> PyResult<String> {
        let args: QueryArgs = parse("query", keywords, &["collection".into(), "shape".into()])?;
        let shape = shape.described().map_err(exception)?;
        let index = Arc::clone(&self.index);
        let hits = run(py, &Call { progress: None, threads: None }, move |_| {
            args.find(&index, &shape, itself.as_deref())
        })?;
        serde_json::to_string(&hits).map_err(|e| exception(usage(e)))
    }
}

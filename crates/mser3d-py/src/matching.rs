//! Which regions of two shapes are the same.

use mser3d_cli::MatchArgs;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{exception, usage};
use crate::options::parse;
use crate::result::Found;
use crate::run::{Call, run};

/// The matching of two results as JSON, the warnings in it.
#[pyfunction]
pub fn match_results(
    py: Python<'_>,
    first: &Found,
    second: &Found,
    keywords: &Bound<'_, PyDict>,
) -> PyResult<String> {
    let args: MatchArgs = parse("match", keywords, &["first".into(), "second".into()])?;
    let (first, second) = (first.described().map_err(exception)?, second.described().map_err(exception)?);
    let matching = run(py, &Call { progress: None, threads: None }, move |_| args.find(&first, &second))?;
    serde_json::to_string(&matching).map_err(|e| exception(usage(e)))
}

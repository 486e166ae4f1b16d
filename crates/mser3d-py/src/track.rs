//! Regions followed through a sequence.

use std::path::PathBuf;
use std::sync::Mutex;

use mser3d_cli::TrackArgs;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{exception, usage};
use crate::options::words;
use crate::run::{Call, run};

/// Follows regions through files into a folder: `tracks.json` as text, the frames that failed (name and why), and what else
/// there is to say.
#[pyfunction]
#[pyo3(signature = (inputs, folder, keywords, write=Vec::new(), progress=None))]
pub fn track(
    py: Python<'_>,
    inputs: Vec<PathBuf>,
    folder: PathBuf,
    keywords: &Bound<'_, PyDict>,
    write: Vec<String>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, Vec<(String, String)>, Vec<String>)> {
    let mut words = words("track", keywords)?;
    let mut output = std::ffi::OsString::from("--output=");
    output.push(&folder);
    words.push(output);
    if !write.is_empty() {
        words.push(format!("--write={}", write.join(",")).into());
    }
    words.push("--".into());
    words.extend(inputs.into_iter().map(Into::into));
    let args: TrackArgs = mser3d_cli::parse("track", words).map_err(exception)?;
    let call = Call { progress, threads: args.threads().map_err(exception)? };
    let (tracks, summary, warnings) = run(py, &call, move |told| {
        let shares = Mutex::new(0.0f64);
        let heard = |event: mser3d_collection::Event| {
            if let Ok(mut most) = shares.lock() {
                *most = most.max(event.share);
                let _ = told.report_share("frames", *most);
            }
        };
        let (tracks, summary) = args.find(&|_| told.go_on(), &heard, &|what| told.warn(what))?;
        Ok((tracks, summary, told.warnings()))
    })?;
    let json = serde_json::to_string(&tracks).map_err(|e| exception(usage(e)))?;
    let failed = summary.failed.into_iter().map(|failure| (failure.name, failure.error)).collect();
    Ok((json, failed, warnings))
}

use std::fs;
use std::path::PathBuf;

use crate::EvaluationError;

/// Under another name first: a file that is there is whole, even after an interruption.
pub(crate) fn save(path: PathBuf, text: &str) -> Result<(), EvaluationError> {
    let mut part = path.clone().into_os_string();
    part.push(".part");
    let written = fs::write(&part, text).and_then(|()| fs::rename(&part, &path));
    written.map_err(|source| EvaluationError::Write { path, source })
}

//! What options there are, for signatures, docstrings and stubs.

use std::any::TypeId;

use mser3d_cli::clap::{Arg, ArgAction};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::options::known;

/// The commands of the command line.
#[pyfunction]
pub fn commands() -> Vec<String> {
    let command = mser3d_cli::command();
    command.get_subcommands().map(|c| c.get_name().to_owned()).collect()
}

/// The options of a command that are keyword arguments: a dict of name, help, kind (flag, int, float, path or text), many,
/// default (texts), choices (name and help) and value for each.
#[pyfunction]
pub fn options<'py>(py: Python<'py>, command: &str) -> PyResult<Bound<'py, PyList>> {
    let known =
        known(command).ok_or_else(|| PyValueError::new_err(format!("there is no command {command}")))?;
    let list = PyList::empty(py);
    for arg in &known {
        list.append(described(py, arg)?)?;
    }
    Ok(list)
}

fn described<'py>(py: Python<'py>, arg: &Arg) -> PyResult<Bound<'py, PyDict>> {
    let help = arg.get_long_help().or(arg.get_help()).map(|text| text.to_string()).unwrap_or_default();
    let value = arg.get_value_names().and_then(|names| names.first()).map(|name| name.to_string());
    let choices: Vec<(String, String)> = arg
        .get_possible_values()
        .iter()
        .map(|value| {
            let help = value.get_help().map(|text| text.to_string()).unwrap_or_default();
            (value.get_name().to_owned(), help)
        })
        .collect();
    let default: Vec<String> =
        arg.get_default_values().iter().map(|text| text.to_string_lossy().into_owned()).collect();
    let dict = PyDict::new(py);
    dict.set_item("name", arg.get_id().as_str())?;
    dict.set_item("option", arg.get_long())?;
    dict.set_item("help", help)?;
    dict.set_item("kind", kind(arg))?;
    dict.set_item("many", arg.get_value_delimiter().is_some())?;
    dict.set_item("heading", arg.get_help_heading())?;
    // A flag's is that it is not given.
    let is_flag = matches!(arg.get_action(), ArgAction::SetTrue);
    dict.set_item("default", if is_flag { Vec::new() } else { default })?;
    dict.set_item("choices", if is_flag { Vec::new() } else { choices })?;
    dict.set_item("value", value)?;
    Ok(dict)
}

/// Flag, int, float, path or text.
fn kind(arg: &Arg) -> &'static str {
    if matches!(arg.get_action(), ArgAction::SetTrue) {
        return "flag";
    }
    let parsed = arg.get_value_parser().type_id();
    let one_of = |types: &[TypeId]| types.iter().any(|id| parsed == *id);
    if one_of(&[TypeId::of::<usize>(), TypeId::of::<u64>(), TypeId::of::<u32>()]) {
        "int"
    } else if one_of(&[TypeId::of::<f64>()]) {
        "float"
    } else if one_of(&[TypeId::of::<std::path::PathBuf>()]) {
        "path"
    } else {
        "text"
    }
}

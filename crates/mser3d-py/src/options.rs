//! Python's keyword arguments as the words of the command line.

use std::collections::HashSet;
use std::ffi::OsString;
use std::sync::LazyLock;

use mser3d_cli::CliError;
use mser3d_cli::clap::{Arg, ArgAction, Command};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};

use crate::errors::exception;

/// What concerns the terminal or is an argument of its own in Python.
const NOT_IN_PYTHON: [&str; 15] = [
    "help",
    "version",
    "verbose",
    "quiet",
    "json",
    "html",
    "output",
    "input",
    "inputs",
    "folder",
    "first",
    "second",
    "collection",
    "shape",
    "write",
];

/// The options of a command that are keyword arguments in Python.
pub fn known(command: &str) -> Option<Vec<Arg>> {
    // Made once: it takes longer than many a call.
    static COMMAND: LazyLock<Command> = LazyLock::new(mser3d_cli::command);
    let root = &*COMMAND;
    let found = root.find_subcommand(command)?;
    let kept = |arg: &&Arg| {
        !NOT_IN_PYTHON.contains(&arg.get_id().as_str())
            && (arg.get_long().is_some() || arg.get_short().is_some())
    };
    Some(found.get_arguments().filter(kept).cloned().collect())
}

/// The words for these keyword arguments of a command. `None` is as if the argument were not given.
///
/// # Errors
/// `TypeError` for an argument that the command does not have, or of a type that no option has.
pub fn words(command: &str, keywords: &Bound<'_, PyDict>) -> PyResult<Vec<OsString>> {
    let known = known(command).unwrap_or_default();
    let mut words = Vec::new();
    for (name, value) in keywords.iter() {
        let name: String = name.extract()?;
        let Some(arg) = known.iter().find(|arg| arg.get_id().as_str() == name) else {
            return Err(unknown(command, &name, &known));
        };
        if value.is_none() {
            continue;
        }
        let option = match (arg.get_long(), arg.get_short()) {
            (Some(long), _) => format!("--{long}"),
            (None, short) => format!("-{}", short.unwrap_or_default()),
        };
        if matches!(arg.get_action(), ArgAction::SetTrue) {
            let wrong = || PyTypeError::new_err(format!("{name}: must be True or False"));
            if value.is_instance_of::<PyBool>() || value.get_type().name()?.to_string().starts_with("bool") {
                if value.is_truthy().map_err(|_| wrong())? {
                    words.push(option.into());
                }
                continue;
            }
            return Err(wrong());
        }
        let text = match texts(&name, &value, arg.get_value_delimiter())? {
            Some(text) => text,
            None => continue,
        };
        let mut word = OsString::from(option);
        // A short option takes its value without a sign.
        if arg.get_long().is_some() {
            word.push("=");
        }
        word.push(text);
        words.push(word);
    }
    Ok(words)
}

/// A value as the command line has it; none for an empty list.
fn texts(name: &str, value: &Bound<'_, PyAny>, delimiter: Option<char>) -> PyResult<Option<OsString>> {
    if let Some(text) = scalar(value)? {
        return Ok(Some(text));
    }
    let wrong = || {
        let found = value.get_type().name().map_or_else(|_| "object".into(), |n| n.to_string());
        let wanted =
            if delimiter.is_some() { "a number, a text or a list of them" } else { "a number or a text" };
        PyTypeError::new_err(format!("{name}: must be {wanted}, not {found}"))
    };
    let delimiter = delimiter.ok_or_else(wrong)?;
    let mut list = OsString::new();
    for item in value.try_iter().map_err(|_| wrong())? {
        if !list.is_empty() {
            list.push(delimiter.to_string());
        }
        list.push(scalar(&item?)?.ok_or_else(wrong)?);
    }
    Ok((!list.is_empty()).then_some(list))
}

/// A number, a text or a path; none for anything else.
fn scalar(value: &Bound<'_, PyAny>) -> PyResult<Option<OsString>> {
    if value.is_instance_of::<PyBool>() {
        return Ok(None);
    }
    if value.is_instance_of::<PyString>() || value.is_instance_of::<PyInt>() {
        return Ok(Some(value.str()?.extract()?));
    }
    if value.is_instance_of::<PyFloat>() {
        return Ok(Some(number(value.extract()?).into()));
    }
    if value.hasattr("__fspath__")? {
        return Ok(Some(value.call_method0("__fspath__")?.extract()?));
    }
    // NumPy's numbers.
    if value.hasattr("dtype")? && value.getattr("ndim")?.extract::<usize>()? == 0 {
        let item = value.call_method0("item")?;
        return if item.hasattr("dtype")? { Ok(None) } else { scalar(&item) };
    }
    Ok(None)
}

/// A number so that it is read as the same: whole ones without a point, for options that count.
fn number(value: f64) -> String {
    if value == value.trunc() && value.abs() < 1e15 { format!("{value:.0}") } else { value.to_string() }
}

/// What a misspelt or unknown argument becomes.
fn unknown(command: &str, name: &str, known: &[Arg]) -> PyErr {
    let pairs = |text: &str| -> HashSet<[char; 2]> {
        let letters: Vec<char> = text.chars().collect();
        letters.windows(2).map(|pair| [pair[0], pair[1]]).collect()
    };
    let own = pairs(name);
    let likeness = |other: &str| {
        let other = pairs(other);
        let shared = own.intersection(&other).count();
        2 * shared * 100 / (own.len() + other.len()).max(1)
    };
    let nearest = known.iter().map(|arg| arg.get_id().as_str()).max_by_key(|other| likeness(other));
    let hint = nearest.filter(|other| likeness(other) >= 50);
    let hint = hint.map_or(String::new(), |other| format!("; did you mean '{other}'?"));
    PyTypeError::new_err(format!("{command}: there is no keyword argument '{name}'{hint}"))
}

/// What the command is told by keyword arguments and words that follow them.
///
/// # Errors
/// `TypeError` as of [`words`], `ValueError` with what the command line would say.
pub fn parse<A: mser3d_cli::clap::Args>(
    command: &'static str,
    keywords: &Bound<'_, PyDict>,
    positional: &[OsString],
) -> PyResult<A> {
    let mut words = words(command, keywords)?;
    words.push("--".into());
    words.extend_from_slice(positional);
    mser3d_cli::parse(command, words).map_err(|error: CliError| exception(error))
}

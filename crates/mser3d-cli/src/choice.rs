//! Choices of the library as values of options: their names and help come from there.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use mser3d::shape::{Choice, UnknownChoice};

/// Parses the name of a value; `--help` lists all names with what they mean.
pub fn choice<T: Choice + Send + Sync>() -> impl TypedValueParser<Value = T> {
    let values = T::ALL.iter().map(|value| PossibleValue::new(value.name()).help(value.about()));
    PossibleValuesParser::new(values).try_map(|name| name.parse().map_err(|e: UnknownChoice| e))
}

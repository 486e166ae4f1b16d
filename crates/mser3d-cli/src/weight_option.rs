//! `--weight`: the name of a weight, or a file with its values.

use std::fmt;
use std::path::{Path, PathBuf};

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use mser3d::Weight;
use mser3d::shape::{Choice, UnknownChoice};

/// What the component tree is built on.
#[derive(Clone, Debug, PartialEq)]
pub enum WeightOption {
    Named(Weight),
    File(PathBuf),
}

impl WeightOption {
    pub fn weight(&self) -> Weight {
        match self {
            Self::Named(weight) => *weight,
            Self::File(_) => Weight::Field,
        }
    }

    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::Named(_) => None,
            Self::File(path) => Some(path),
        }
    }
}

impl Default for WeightOption {
    fn default() -> Self {
        Self::Named(Weight::default())
    }
}

impl fmt::Display for WeightOption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Named(weight) => weight.fmt(f),
            Self::File(path) => path.display().fmt(f),
        }
    }
}

/// Parses the name of a weight, or a path that ends in .npy; `--help` lists all names with what they mean.
#[derive(Clone)]
pub struct WeightParser;

impl TypedValueParser for WeightParser {
    type Value = WeightOption;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<WeightOption, clap::Error> {
        let path = Path::new(value);
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("npy")) {
            return Ok(WeightOption::File(path.to_owned()));
        }
        let named = |name: String| match name.parse() {
            Ok(Weight::Field) => {
                Err("give the file with its values in place of the name, as in --weight height.npy"
                    .to_owned())
            }
            Ok(weight) => Ok(WeightOption::Named(weight)),
            Err(error) => {
                let error: UnknownChoice = error;
                Err(format!("{error}, or give a file that ends in .npy"))
            }
        };
        StringValueParser::new().try_map(named).parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let value = |weight: &Weight| PossibleValue::new(weight.name()).help(weight.about());
        Some(Box::new(Weight::ALL.iter().map(value)))
    }
}

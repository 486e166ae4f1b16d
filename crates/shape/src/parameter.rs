use std::fmt;

use crate::Readable;

/// A parameter that is out of its range: the one such error of all crates.
///
/// ```
/// use mser3d_shape::InvalidParameter;
/// let error = InvalidParameter::unless(2.0 < 1.0, "window", 2.0, "less than 1").unwrap_err();
/// assert_eq!(error.to_string(), "window is 2: it must be less than 1");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InvalidParameter {
    /// The field of the parameter struct, or the argument.
    pub name: &'static str,
    /// Its value.
    pub value: String,
    /// What it has to be.
    pub expected: String,
}

impl InvalidParameter {
    /// The error of a parameter that has this value and must be something else.
    pub fn new(name: &'static str, value: impl fmt::Display, expected: impl Into<String>) -> Self {
        let value = value.to_string();
        // Not rows of zeros.
        let number = value.parse::<f64>().ok().filter(|_| value.len() > 20);
        Self {
            name,
            value: number.map_or(value, |number| Readable(number).to_string()),
            expected: expected.into(),
        }
    }

    /// The error, unless the condition holds.
    ///
    /// # Errors
    /// [`InvalidParameter`] when it does not.
    pub fn unless(
        holds: bool,
        name: &'static str,
        value: impl fmt::Display,
        expected: impl Into<String>,
    ) -> Result<(), Self> {
        if holds { Ok(()) } else { Err(Self::new(name, value, expected)) }
    }
}

impl fmt::Display for InvalidParameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} is {}: it must be {}", self.name, self.value, self.expected)
    }
}

impl std::error::Error for InvalidParameter {}

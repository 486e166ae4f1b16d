use std::fmt;
use std::str::FromStr;

use mser3d_shape::InvalidParameter;

/// How many parts are wanted of each body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum PartCount {
    /// The limbs and the trunk: all that last as long as [`PartParameters::min_lifetime`].
    #[default]
    Auto,
    /// This many, or as near below as the shape and its symmetry allow.
    Count(usize),
}

impl fmt::Display for PartCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Count(count) => count.fmt(f),
        }
    }
}

/// From `auto`, or a whole number of at least 1.
impl FromStr for PartCount {
    type Err = InvalidParameter;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match (text, text.parse()) {
            ("auto", _) => Ok(Self::Auto),
            (_, Ok(count)) if count > 0 => Ok(Self::Count(count)),
            _ => Err(InvalidParameter::new("parts", text, "auto, or a whole number of at least 1")),
        }
    }
}

/// How a body is divided into parts.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PartParameters {
    /// How many parts each body gets, the trunk included. Default: [`PartCount::Auto`].
    pub count: PartCount,
    /// Smallest part, as a fraction of its body. Default 0.01.
    pub min_volume_fraction: f64,
    /// What lasts at least this long before a real merge ends it is a limb: the least lifetime, in altitude, by default in
    /// its logarithm. Default 0.5: its end is e^0.5 = 1.6 times as hot as the place where it joins the body.
    pub min_lifetime: f64,
    /// How far borders are smoothed: the standard deviation of the diffusion, in voxels, of a surface about in edges. 0: not
    /// at all. Default 1.5.
    pub smoothing: f64,
}

impl Default for PartParameters {
    fn default() -> Self {
        Self { count: PartCount::Auto, min_volume_fraction: 0.01, min_lifetime: 0.5, smoothing: 1.5 }
    }
}

impl PartParameters {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`InvalidParameter`] for the first parameter that is out of range.
    pub fn validate(&self) -> Result<(), InvalidParameter> {
        let Self { count, min_volume_fraction: fraction, min_lifetime: lifetime, smoothing } = *self;
        InvalidParameter::unless(count != PartCount::Count(0), "parts.count", count, "at least 1")?;
        let good = (0.0..=1.0).contains(&fraction);
        InvalidParameter::unless(good, "parts.min_volume_fraction", fraction, "between 0 and 1")?;
        let good = lifetime > 0.0 && lifetime.is_finite();
        InvalidParameter::unless(good, "parts.min_lifetime", lifetime, "positive and finite")?;
        let good = (0.0..=10.0).contains(&smoothing);
        InvalidParameter::unless(good, "parts.smoothing", smoothing, "from 0 to 10")
    }
}

//! Times of heat diffusion, in units of the shape or of the file.
use std::fmt;

use crate::DescriptorError;
use mser3d_shape::EigenbasisView;

/// A time of heat diffusion. Time has units of length^2.
///
/// It is shown as `0.5` (relative) or `t = 2048` (absolute); in JSON it is `{"relative": 0.5}` or
/// `{"absolute": 2048.0}`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum TimeScale {
    /// In units of the shape: `t = t_rel V^(2/3)` for a volume V, `t = t_rel A` for a surface of area A.
    ///
    /// The same relative time means the same on a scaled copy, and sees the same detail on shapes of
    /// different size.
    Relative(f64),
    /// In squared units of the input's coordinates.
    Absolute(f64),
}

impl TimeScale {
    /// The time in length^2 on this shape.
    ///
    /// # Errors
    /// [`DescriptorError::InvalidParameter`] unless the time is positive and finite.
    pub fn on<'a>(self, basis: impl Into<EigenbasisView<'a>>) -> Result<f64, DescriptorError> {
        match self {
            Self::Relative(_) => self.with_unit(basis.into().unit_time()),
            // It takes a look at all vertices to know the unit.
            Self::Absolute(_) => self.with_unit(1.0),
        }
    }

    /// The time in length^2 when one relative unit is `unit_time`.
    ///
    /// Take the unit of one shape for all poses of it: then a pose that loses a part keeps its scales.
    ///
    /// # Errors
    /// [`DescriptorError::InvalidParameter`] unless the time is positive and finite.
    pub fn with_unit(self, unit_time: f64) -> Result<f64, DescriptorError> {
        let (t, value) = match self {
            Self::Relative(t) => (t * unit_time, t),
            Self::Absolute(t) => (t, t),
        };
        if t.is_finite() && t > 0.0 {
            return Ok(t);
        }
        let expected = if value.is_finite() && value > 0.0 {
            "finite and positive in length^2 too: the shape's volume or area is zero or too large"
        } else {
            "finite and positive"
        };
        Err(DescriptorError::parameter("the time scale", value, expected))
    }
}

impl fmt::Display for TimeScale {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Relative(t) => write!(f, "{t}"),
            Self::Absolute(t) => write!(f, "t = {t}"),
        }
    }
}

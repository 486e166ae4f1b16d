//! The plane that cuts a shape open.

use mser3d_shape::vector::{Vec3, dot, scale};
use mser3d_shape::{BoundingBox, InvalidParameter};

use crate::ViewerError;

/// A plane that cuts a shape open: points p with `normal . p <= offset` are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Direction towards the side that is taken away; need not have length one.
    pub normal: [f64; 3],
    /// Where the plane lies along `normal`, in units of length times the length of `normal`.
    pub offset: f64,
}

impl Cut {
    /// The plane across a box that takes away the far end along an axis. `kept` is the fraction that is left:
    /// 0 keeps nothing, 1 all.
    pub fn across(bounds: &BoundingBox, axis: usize, kept: f64) -> Self {
        let mut normal = [0.0; 3];
        normal[axis % 3] = 1.0;
        let a = axis % 3;
        Self { normal, offset: bounds.min[a] + kept * (bounds.max[a] - bounds.min[a]) }
    }

    /// The same plane with the other side taken away.
    #[must_use]
    pub fn flipped(self) -> Self {
        Self { normal: scale(self.normal, -1.0), offset: -self.offset }
    }

    /// How far a point lies on the side that is taken away.
    pub(crate) fn beyond(&self, p: Vec3) -> f64 {
        dot(self.normal, p) - self.offset
    }

    /// Checks that it is a plane.
    ///
    /// # Errors
    /// [`ViewerError::InvalidParameter`] when it is not.
    pub(crate) fn check(&self) -> Result<(), ViewerError> {
        let length = dot(self.normal, self.normal);
        if length > 0.0 && length.is_finite() && self.offset.is_finite() {
            return Ok(());
        }
        let expected = "a plane with a finite normal that is not zero and a finite offset";
        Err(InvalidParameter::new("cut", format!("{self:?}"), expected).into())
    }
}

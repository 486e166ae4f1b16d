//! Descriptors as a table, one a row.
use crate::DescriptorError;

/// Descriptors of equal length, one a row: of vertices, voxels or regions.
#[derive(Clone, Debug, PartialEq)]
pub struct Descriptors {
    width: usize,
    values: Vec<f64>,
}

impl Descriptors {
    /// A table of rows of `width` values, row by row.
    ///
    /// # Errors
    /// [`DescriptorError::InvalidParameter`] for a width of zero, [`DescriptorError::SizeMismatch`] when the
    /// last row is cut short, [`DescriptorError::NotFinite`] for NaN or infinite values.
    pub fn new(width: usize, values: Vec<f64>) -> Result<Self, DescriptorError> {
        if width == 0 {
            return Err(DescriptorError::parameter("the length of the descriptors", 0, "at least 1"));
        }
        if !values.len().is_multiple_of(width) {
            let (found, expected) = (values.len(), values.len().next_multiple_of(width));
            return Err(DescriptorError::SizeMismatch { what: "values of the descriptors", found, expected });
        }
        if let Some(at) = values.iter().position(|x| !x.is_finite()) {
            return Err(DescriptorError::NotFinite { row: at / width });
        }
        Ok(Self { width, values })
    }

    /// Values in each descriptor.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of descriptors.
    pub fn len(&self) -> usize {
        self.values.len() / self.width
    }

    /// Whether there are no descriptors.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// All values, row by row.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// One descriptor.
    pub fn row(&self, number: usize) -> &[f64] {
        &self.values[number * self.width..(number + 1) * self.width]
    }

    /// The descriptors in order.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[f64]> + Clone {
        self.values.chunks_exact(self.width)
    }

    /// Whether two tables can be compared.
    pub(crate) fn check_width(&self, other: &Self) -> Result<(), DescriptorError> {
        if self.width == other.width {
            return Ok(());
        }
        let (found, expected) = (other.width, self.width);
        Err(DescriptorError::SizeMismatch { what: "lengths of the descriptors to compare", found, expected })
    }
}

/// `|a - b|^2`.
pub(crate) fn squared_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}

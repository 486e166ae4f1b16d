use std::borrow::Cow;
use std::ops::Range;

/// The values of eigenfunctions, n x k, row by row: value i of row v is phi_i(v), in length^(-3/2) in a volume and length^-1 on
/// a surface.
///
/// Single precision takes half the memory. Its rounding, 6e-8 of each value, is less than what most solvers leave. The precision is
/// only that of the memory: all that is computed from the values is computed in `f64`.
#[derive(Clone, Debug, PartialEq)]
pub enum Functions {
    /// In double precision, 8 bytes a value.
    Double(Vec<f64>),
    /// In single precision, 4 bytes a value.
    Single(Vec<f32>),
}

impl Functions {
    /// The same, borrowed.
    pub fn view(&self) -> FunctionsView<'_> {
        match self {
            Self::Double(values) => FunctionsView::Double(values),
            Self::Single(values) => FunctionsView::Single(values),
        }
    }

    /// Keeps the first `kept` values of each `width`.
    pub(crate) fn truncate_rows(&mut self, width: usize, kept: usize) {
        match self {
            Self::Double(values) => truncate_rows(values, width, kept),
            Self::Single(values) => truncate_rows(values, width, kept),
        }
    }
}

fn truncate_rows<T: Copy>(values: &mut Vec<T>, width: usize, kept: usize) {
    let rows = values.len().checked_div(width).unwrap_or(0);
    for row in 0..rows {
        values.copy_within(row * width..row * width + kept, row * kept);
    }
    values.truncate(rows * kept);
    values.shrink_to_fit();
}

impl From<Vec<f64>> for Functions {
    fn from(values: Vec<f64>) -> Self {
        Self::Double(values)
    }
}

impl From<Vec<f32>> for Functions {
    fn from(values: Vec<f32>) -> Self {
        Self::Single(values)
    }
}

/// [`Functions`] that lie elsewhere, or a part of them, without a copy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FunctionsView<'a> {
    /// In double precision.
    Double(&'a [f64]),
    /// In single precision.
    Single(&'a [f32]),
}

impl<'a> FunctionsView<'a> {
    /// How many values there are, n times k.
    pub fn len(self) -> usize {
        match self {
            Self::Double(values) => values.len(),
            Self::Single(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Some of the values, which must be there as for a slice.
    #[inline]
    pub fn slice(self, range: Range<usize>) -> Self {
        match self {
            Self::Double(values) => Self::Double(&values[range]),
            Self::Single(values) => Self::Single(&values[range]),
        }
    }

    /// The values one after the other, in double precision.
    pub fn values(self) -> impl Iterator<Item = f64> {
        let (double, single): (&[f64], &[f32]) = match self {
            Self::Double(values) => (values, &[]),
            Self::Single(values) => (&[], values),
        };
        double.iter().copied().chain(single.iter().map(|&x| x.into()))
    }

    /// The values in double precision: those that are so as they lie, others in a copy.
    pub fn to_f64(self) -> Cow<'a, [f64]> {
        match self {
            Self::Double(values) => Cow::Borrowed(values),
            Self::Single(_) => Cow::Owned(self.values().collect()),
        }
    }
}

impl<'a> From<&'a [f64]> for FunctionsView<'a> {
    fn from(values: &'a [f64]) -> Self {
        Self::Double(values)
    }
}

impl<'a> From<&'a [f32]> for FunctionsView<'a> {
    fn from(values: &'a [f32]) -> Self {
        Self::Single(values)
    }
}

use crate::Error;

/// The largest size of a value: squares of differences stay finite.
pub const LARGEST_WEIGHT: f64 = 1e100;

/// A weight from outside: a number or a vector for each element of a shape, or for each vertex of a mesh (section 4.3 of the
/// paper: any scalar function, or vector-valued data).
///
/// Numbers are the weights of elements. Of vectors, the weight of a link or edge is their (Euclidean) distance; vectors of length
/// one give the absolute difference.
///
/// ```
/// use mser3d::Field;
/// let heights = Field::scalar(vec![0.0, 0.5, 1.0])?;
/// assert_eq!((heights.len(), heights.at(2)), (3, &[1.0][..]));
/// let colours = Field::vectors(3, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0])?;
/// assert_eq!((colours.len(), colours.at(1)), (2, &[1.0; 3][..]));
/// assert!(Field::scalar(vec![1.0, f64::NAN]).unwrap_err().to_string().contains("value 1 is NaN"));
/// # Ok::<(), mser3d::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    values: Vec<f64>,
    width: usize,
    vectors: bool,
}

impl Field {
    /// A number for each element or vertex.
    ///
    /// # Errors
    /// [`Error::FieldValue`] for a value that is not finite, or larger than [`LARGEST_WEIGHT`].
    pub fn scalar(values: Vec<f64>) -> Result<Self, Error> {
        Self { values, width: 1, vectors: false }.checked()
    }

    /// A vector of `width` numbers for each element or vertex, one after another.
    ///
    /// # Errors
    /// [`Error::FieldValue`]; [`Error::FieldWidth`] when the values are no whole number of vectors.
    pub fn vectors(width: usize, values: Vec<f64>) -> Result<Self, Error> {
        if width == 0 || !values.len().is_multiple_of(width) {
            return Err(Error::FieldWidth { values: values.len(), width });
        }
        Self { values, width, vectors: true }.checked()
    }

    fn checked(self) -> Result<Self, Error> {
        let bad = |x: &f64| x.is_nan() || x.abs() > LARGEST_WEIGHT;
        match self.values.iter().position(bad) {
            Some(place) => Err(Error::FieldValue {
                place: format!("value {}", place / self.width),
                value: self.values[place],
            }),
            None => Ok(self),
        }
    }

    /// How many elements or vertices it has values for.
    pub fn len(&self) -> usize {
        self.values.len() / self.width
    }

    /// Whether it has no values.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Numbers of each value.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Whether its values are vectors.
    pub fn has_vectors(&self) -> bool {
        self.vectors
    }

    /// The value of an element or vertex.
    pub fn at(&self, place: usize) -> &[f64] {
        &self.values[place * self.width..][..self.width]
    }

    /// All numbers, value by value.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The distance of two values.
    pub(crate) fn distance(&self, u: u32, v: u32) -> f64 {
        let pairs = self.at(u as usize).iter().zip(self.at(v as usize));
        pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    }

    /// The values of some elements.
    pub(crate) fn of(&self, elements: &[u32]) -> Self {
        let values = elements.iter().flat_map(|&e| self.at(e as usize).iter().copied()).collect();
        Self { values, ..*self }
    }

    /// One number of each value.
    pub(crate) fn component(&self, c: usize) -> Vec<f64> {
        self.values.iter().skip(c).step_by(self.width).copied().collect()
    }

    /// A field of the same kind, from the numbers of its values by their place in them.
    pub(crate) fn with_components(
        &self,
        component: impl Fn(usize) -> Result<Vec<f64>, Error>,
    ) -> Result<Self, Error> {
        let components = (0..self.width).map(component).collect::<Result<Vec<_>, Error>>()?;
        let len = components.first().map_or(0, Vec::len);
        let values = (0..len).flat_map(|i| components.iter().map(move |c| c[i])).collect();
        Self { values, ..*self }.checked()
    }

    /// An error unless there are so many values.
    pub(crate) fn expect(&self, what: &'static str, expected: usize) -> Result<(), Error> {
        let found = self.len();
        if found == expected { Ok(()) } else { Err(Error::FieldLength { found, expected, what }) }
    }
}

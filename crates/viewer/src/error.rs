use thiserror::Error;

/// Why a picture or a page cannot be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ViewerError {
    /// An array does not fit the shape it belongs to.
    #[error("{what}: {found} given, {expected} needed; they must come from the same shape")]
    SizeMismatch {
        /// What the array holds.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it should have.
        expected: usize,
    },
    /// A number names something that is not there.
    #[error("{what} {number} names {target} {index}, but there are only {count} (numbered from 0)")]
    OutOfRange {
        /// What names it.
        what: &'static str,
        /// Its own number.
        number: usize,
        /// What is named.
        target: &'static str,
        /// The number given.
        index: i64,
        /// How many there are.
        count: usize,
    },
    /// There is nothing to draw.
    #[error("there is nothing to draw: {reason}")]
    Empty {
        /// Why.
        reason: &'static str,
    },
    /// An option lies outside its range.
    #[error(transparent)]
    InvalidParameter(#[from] mser3d_shape::InvalidParameter),
    /// A coordinate is NaN or infinite.
    #[error("{what} {number} is NaN or infinite; remove or repair it")]
    NotFinite {
        /// What it belongs to.
        what: &'static str,
        /// Its number.
        number: usize,
    },
    /// The picture would be larger than the limit.
    #[error(
        "the picture would have {width} x {height} pixels, more than 2^28; lower its height or the number of panels"
    )]
    TooLarge {
        /// Its width in pixels.
        width: usize,
        /// Its height in pixels.
        height: usize,
    },
    /// A shape cannot be put together.
    #[error(transparent)]
    Shape(#[from] mser3d_shape::ShapeError),
    /// PNG data could not be written.
    #[error("cannot encode the picture as PNG: {0}")]
    Png(#[from] png::EncodingError),
}

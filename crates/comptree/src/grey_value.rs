//! Types of grey values: trees of 8-bit images need no conversion.

/// A number that weighs a vertex: grey values and measurements. Sealed.
pub trait GreyValue: Copy + PartialOrd + Into<f64> + Send + Sync + sealed::Sealed + 'static {}

mod sealed {
    pub trait Sealed {}
}

macro_rules! grey {
    ($($t:ty)*) => { $(impl sealed::Sealed for $t {} impl GreyValue for $t {})* };
}

grey!(u8 i8 u16 i16 u32 i32 f32 f64);

//! Types of grey values: trees of 8-bit images need no conversion.

/// A number that weighs a vertex: grey values and measurements. Sealed.
pub trait GreyValue: Copy + PartialOrd + Into<f64> + Send + Sync + sealed::Sealed + 'static {}

mod sealed {
    pub trait Sealed {
        const INTEGER: bool;
    }
}

macro_rules! grey {
    ($integer:literal: $($t:ty)*) => { $(
        impl sealed::Sealed for $t { const INTEGER: bool = $integer; }
        impl GreyValue for $t {}
    )* };
}

grey!(true: u8 i8 u16 i16 u32 i32);
grey!(false: f32 f64);

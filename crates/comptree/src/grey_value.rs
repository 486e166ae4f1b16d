//! Types of grey values: trees of 8-bit images need no conversion.

/// A number that weighs a vertex: grey values and measurements. Sealed.
pub trait GreyValue: Copy + PartialOrd + Into<f64> + Send + Sync + sealed::Sealed + 'static {}

mod sealed {
    pub trait Sealed {
        const INTEGER: bool;

        /// A small number in as many bits: what goes side by side with values in vector registers.
        type Step: Copy + From<u8>;

        fn index(step: Self::Step) -> usize;
    }
}

macro_rules! grey {
    ($integer:literal: $($t:ty, $step:ty;)*) => { $(
        impl sealed::Sealed for $t {
            const INTEGER: bool = $integer;

            type Step = $step;

            #[inline(always)]
            fn index(step: $step) -> usize {
                step as usize
            }
        }
        impl GreyValue for $t {}
    )* };
}

grey!(true: u8, u8; i8, u8; u16, u16; i16, u16; u32, u32; i32, u32;);
grey!(false: f32, u32; f64, u64;);

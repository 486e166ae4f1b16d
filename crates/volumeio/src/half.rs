//! Floating-point numbers of 16 bits.
use crate::Samples;

/// Numbers of IEEE 754's binary16, given as their bits.
pub(crate) fn halves(bits: &Samples) -> Samples {
    let Samples::U16(bits) = bits else { return bits.clone() };
    let number = |&bits: &u16| {
        let sign = if bits >> 15 == 1 { -1.0f32 } else { 1.0 };
        let (exponent, mantissa) = (i32::from(bits >> 10 & 31), f32::from(bits & 1023));
        sign * match exponent {
            0 => mantissa * 2f32.powi(-24),
            31 if mantissa == 0.0 => f32::INFINITY,
            31 => f32::NAN,
            _ => (1024.0 + mantissa) * 2f32.powi(exponent - 25),
        }
    };
    Samples::F32(bits.iter().map(number).collect())
}

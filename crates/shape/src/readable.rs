use std::fmt;

/// A number for people: very large and very small ones with an exponent, where they would be rows of zeros. A precision counts
/// the digits behind the point.
///
/// ```
/// use mser3d_shape::Readable;
/// assert_eq!(format!("{} {:.2} {}", Readable(0.25), Readable(1234.5678), Readable(1e-300)), "0.25 1234.57 1e-300");
/// assert_eq!(format!("{:.4} {:.4}", Readable(0.0000123456), Readable(0.0)), "1.2346e-5 0.0000");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Readable(pub f64);

impl fmt::Display for Readable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plain = self.0 == 0.0 || !self.0.is_finite() || (1e-3..1e9).contains(&self.0.abs());
        match f.precision() {
            Some(digits) if plain => write!(f, "{:.digits$}", self.0),
            Some(digits) => write!(f, "{:.digits$e}", self.0),
            None if plain => write!(f, "{}", self.0),
            None => write!(f, "{:e}", self.0),
        }
    }
}

/// A number of bytes for people, in units in which it is not zero.
///
/// ```
/// use mser3d_shape::Bytes;
/// assert_eq!([Bytes(999), Bytes(4_200_000), Bytes(0)].map(|b| b.to_string()), ["999 bytes", "4200 kB", "0 bytes"]);
/// assert_eq!(Bytes(121_000_000).to_string(), "121 MB");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bytes(pub u64);

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            bytes if bytes >= 10_000_000 => write!(f, "{} MB", bytes / 1_000_000),
            bytes if bytes >= 10_000 => write!(f, "{} kB", bytes / 1000),
            bytes => write!(f, "{bytes} bytes"),
        }
    }
}

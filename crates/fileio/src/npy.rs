//! Arrays as numpy stores them: the `.npy` format, version 1.0 and later.

use crate::ReadLimits;
use crate::error::{Fault, FileError};
use crate::file::{read_bytes_within, write_atomically};
use std::borrow::Cow;
use std::io::{self, Write};
use std::path::Path;

/// An array of numbers with its shape, last axis fastest.
///
/// ```
/// use mser3d_fileio::NpyArray;
/// let voxels = [[0, 0, 0], [1, 0, 0]];
/// let array = NpyArray::new(&[2, 3], voxels.as_flattened())?;
/// assert_eq!(array.shape(), [2, 3]);
/// # Ok::<(), mser3d_fileio::FileError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct NpyArray<'a> {
    shape: Vec<usize>,
    values: NpyValues<'a>,
}

impl<'a> NpyArray<'a> {
    /// An array of a shape.
    ///
    /// # Errors
    /// [`FileError::InvalidArray`] when the shape needs another number of values.
    pub fn new(shape: &[usize], values: impl Into<NpyValues<'a>>) -> Result<Self, FileError> {
        let values = values.into();
        if product(shape) != Some(values.len()) {
            let reason = format!("shape {shape:?} does not fit {} values", values.len());
            return Err(FileError::InvalidArray { reason });
        }
        Ok(Self { shape: shape.to_vec(), values })
    }

    /// An array of one axis.
    pub fn flat(values: impl Into<NpyValues<'a>>) -> Self {
        let values = values.into();
        Self { shape: vec![values.len()], values }
    }

    /// Length of each axis.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// The numbers, last axis fastest.
    pub fn values(&self) -> &NpyValues<'a> {
        &self.values
    }

    /// The numbers, without a copy.
    pub fn into_values(self) -> NpyValues<'a> {
        self.values
    }

    /// Bytes in a file.
    pub(crate) fn byte_len(&self) -> u64 {
        self.header().len() as u64 + self.values.len() as u64 * self.values.item_size() as u64
    }

    fn header(&self) -> Vec<u8> {
        let axes: Vec<String> = self.shape.iter().map(|n| format!("{n},")).collect();
        // Python writes (3,) but (3, 4).
        let shape = match &axes[..] {
            [one] => one.clone(),
            _ => axes.join(" ").trim_end_matches(',').to_owned(),
        };
        let mut text = format!(
            "{{'descr': '{}', 'fortran_order': False, 'shape': ({shape}), }}",
            self.values.descriptor()
        );
        // The values begin at a multiple of 64 bytes.
        let padding = 63 - (MAGIC.len() + 4 + text.len()) % 64;
        text.extend(std::iter::repeat_n(' ', padding));
        text.push('\n');
        let mut header = MAGIC.to_vec();
        header.extend([1, 0]);
        header.extend((text.len() as u16).to_le_bytes());
        header.extend(text.into_bytes());
        header
    }

    pub(crate) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        out.write_all(&self.header())?;
        self.values.write(out)
    }
}

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Reads a file of `numpy.save`: the array, and whether its *first* axis is the fastest (numpy's
/// Fortran order) instead of the last. `bool` is read as 0 and 1. Memory is twice the size of the file.
///
/// # Errors
/// [`FileError::Read`]; [`FileError::OverLimit`]; [`FileError::Invalid`] for a broken or truncated file;
/// [`FileError::Unsupported`] for other types of numbers, big-endian ones included.
pub fn read_npy(path: &Path, limits: &ReadLimits) -> Result<(NpyArray<'static>, bool), FileError> {
    let stored = parse(&read_bytes_within(path, limits, 2)?).map_err(|fault| fault.in_file(path))?;
    Ok((stored.array, stored.first_axis_fastest))
}

/// Writes an array as a file that `numpy.load` opens.
///
/// # Errors
/// [`FileError::Write`].
pub fn write_npy(path: &Path, array: &NpyArray) -> Result<(), FileError> {
    write_atomically(path, |out| array.write(out))
}

fn product(shape: &[usize]) -> Option<usize> {
    shape.iter().try_fold(1usize, |n, &axis| n.checked_mul(axis))
}

macro_rules! values {
    ($($(#[$doc:meta])* $variant:ident($type:ty) = $descriptor:literal;)*) => {
        /// The numbers of an [`NpyArray`], borrowed or owned.
        #[derive(Clone, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum NpyValues<'a> {
            $($(#[$doc])* $variant(Cow<'a, [$type]>),)*
        }

        impl NpyValues<'_> {
            /// How many there are.
            pub fn len(&self) -> usize {
                match self { $(Self::$variant(values) => values.len(),)* }
            }

            /// Whether there are none.
            pub fn is_empty(&self) -> bool {
                self.len() == 0
            }

            fn item_size(&self) -> usize {
                match self { $(Self::$variant(_) => size_of::<$type>(),)* }
            }

            fn descriptor(&self) -> &'static str {
                match self { $(Self::$variant(_) => $descriptor,)* }
            }

            fn write(&self, out: &mut impl Write) -> io::Result<()> {
                match self {
                    // Many at once: whoever gets them sums each piece and asks where it fits.
                    $(Self::$variant(values) => {
                        let mut bytes = [[0; size_of::<$type>()]; 1 << 10];
                        values.chunks(bytes.len()).try_for_each(|values| {
                            bytes.iter_mut().zip(values).for_each(|(bytes, x)| *bytes = x.to_le_bytes());
                            out.write_all(bytes[..values.len()].as_flattened())
                        })
                    })*
                }
            }

            /// All whole values that the bytes hold; `None` for a type that is not read.
            fn read(descriptor: &str, bytes: &[u8]) -> Option<NpyValues<'static>> {
                match descriptor {
                    $($descriptor => Some(NpyValues::$variant(Cow::Owned(
                        bytes.as_chunks().0.iter().map(|&x| <$type>::from_le_bytes(x)).collect(),
                    ))),)*
                    _ => None,
                }
            }
        }

        $(
            impl<'a> From<&'a [$type]> for NpyValues<'a> {
                fn from(values: &'a [$type]) -> Self {
                    Self::$variant(Cow::Borrowed(values))
                }
            }
            impl From<Vec<$type>> for NpyValues<'_> {
                fn from(values: Vec<$type>) -> Self {
                    Self::$variant(Cow::Owned(values))
                }
            }
        )*
    };
}

values! {
    /// numpy's `uint8`; `bool` is read as 0 and 1.
    U8(u8) = "|u1";
    /// numpy's `int8`.
    I8(i8) = "|i1";
    /// numpy's `uint16`.
    U16(u16) = "<u2";
    /// numpy's `int16`.
    I16(i16) = "<i2";
    /// numpy's `int32`.
    I32(i32) = "<i4";
    /// numpy's `uint32`.
    U32(u32) = "<u4";
    /// numpy's `int64`.
    I64(i64) = "<i8";
    /// numpy's `float32`.
    F32(f32) = "<f4";
    /// numpy's `float64`.
    F64(f64) = "<f8";
}

/// An array as its file holds it.
#[derive(Debug)]
pub(crate) struct Stored {
    pub array: NpyArray<'static>,
    /// Whether the first axis is fastest, instead of the last.
    pub first_axis_fastest: bool,
}

/// Reads a `.npy` file; trailing bytes are ignored.
pub(crate) fn parse(bytes: &[u8]) -> Result<Stored, Fault> {
    let truncated =
        || Fault::invalid("the .npy file ends within its header; it is truncated; copy or export it again");
    let rest = bytes
        .strip_prefix(MAGIC)
        .ok_or_else(|| Fault::invalid("not a .npy file; save the array with numpy.save"))?;
    let (version, rest) = rest.split_first_chunk::<2>().ok_or_else(truncated)?;
    let (length, rest) = match version[0] {
        1 => rest.split_first_chunk().map(|(n, rest)| (u16::from_le_bytes(*n) as usize, rest)),
        _ => rest.split_first_chunk().map(|(n, rest)| (u32::from_le_bytes(*n) as usize, rest)),
    }
    .ok_or_else(truncated)?;
    let (header, data) = rest.split_at_checked(length).ok_or_else(truncated)?;
    let header = String::from_utf8_lossy(header);
    let broken = |what: &str| Fault::invalid(format!("the .npy header has no legible {what}"));

    let entry = |key: &str| header.split_once(&format!("'{key}':")).map(|(_, value)| value.trim_start());
    let descriptor = entry("descr").ok_or_else(|| broken("type"))?;
    let descriptor =
        descriptor.strip_prefix('\'').and_then(|d| d.split_once('\'')).map_or("a record", |d| d.0);
    let first_axis_fastest = entry("fortran_order").ok_or_else(|| broken("order"))?.starts_with("True");
    let shape: Vec<usize> = entry("shape")
        .and_then(|s| s.strip_prefix('(')?.split_once(')'))
        .and_then(|(axes, _)| {
            axes.split(',')
                .map(str::trim)
                .filter(|axis| !axis.is_empty())
                .map(|axis| axis.parse().ok())
                .collect()
        })
        .ok_or_else(|| broken("shape"))?;

    let values = NpyValues::read(if descriptor == "|b1" { "|u1" } else { descriptor }, &[]);
    let size = values.map(|v| v.item_size()).ok_or_else(|| {
        Fault::unsupported(format!(
            "an array of type {descriptor} is not supported; convert it with .astype to bool, int8, uint8, \
             int16, uint16, int32, uint32, int64, float32 or float64"
        ))
    })?;
    let needed = product(&shape).and_then(|n| n.checked_mul(size)).unwrap_or(usize::MAX);
    let data = data.get(..needed).ok_or_else(|| {
        let held = data.len();
        Fault::invalid(format!(
            "shape {shape:?} needs {needed} bytes, but the file holds {held}; it is truncated; copy or export it again"
        ))
    })?;
    let values = NpyValues::read(if descriptor == "|b1" { "|u1" } else { descriptor }, data)
        .ok_or_else(|| broken("type"))?;
    Ok(Stored { array: NpyArray { shape, values }, first_axis_fastest })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_is_numpys() {
        let mut bytes = Vec::new();
        NpyArray::new(&[2, 3], vec![1.5; 6]).unwrap().write(&mut bytes).unwrap();
        assert_eq!(bytes.len(), 128 + 48);
        assert!(bytes[10..].starts_with(b"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }   "));
        assert_eq!(bytes[127], b'\n');
    }

    #[test]
    fn arrays_survive_a_round_trip() {
        for array in [
            NpyArray::flat(vec![1i32, -2, 3]),
            NpyArray::flat(Vec::<u32>::new()),
            NpyArray::new(&[], vec![7i64]).unwrap(),
            NpyArray::new(&[2, 1, 2], vec![0.1, f64::NAN.min(2.0), -0.0, 1e300]).unwrap(),
            NpyArray::new(&[0, 3], Vec::<f32>::new()).unwrap(),
            NpyArray::flat(vec![0u8, 255]),
            NpyArray::flat(vec![-1i8, 2]),
            NpyArray::flat(vec![-300i16, 2]),
            NpyArray::flat(vec![u16::MAX, 2]),
        ] {
            let mut bytes = Vec::new();
            array.write(&mut bytes).unwrap();
            assert_eq!(bytes.len() as u64, array.byte_len());
            assert_eq!(parse(&bytes).unwrap().array, array);
            assert!(array.values().is_empty() || parse(&bytes[..bytes.len() - 1]).is_err());
        }
        assert!(NpyArray::new(&[2, 2], vec![1i32; 3]).is_err());
        assert!(NpyArray::new(&[usize::MAX, 2], vec![1i32; 3]).is_err());
    }
}

//! The arrays of VTK's XML files: text, base64 or raw bytes, perhaps packed by zlib in blocks.

use super::base64::Stream;
use super::tags::{Tag, find};
use crate::budget::Budget;
use crate::error::Fault;
use crate::text::{Tokens, parse, show};
use flate2::read::ZlibDecoder;
use std::io::Read;

/// What the root of a file says of all its arrays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Encoding<'a> {
    pub big_endian: bool,
    /// Bytes of a number before an array: 4 or 8.
    pub header: usize,
    pub packed: bool,
    /// What all arrays together may take.
    pub budget: &'a Budget<'a>,
}

impl<'a> Encoding<'a> {
    pub(super) fn new(root: &Tag, budget: &'a Budget) -> Result<Self, Fault> {
        let header = match root.attribute("header_type") {
            Some("UInt64") => 8,
            None | Some("UInt32") => 4,
            Some(other) => {
                return Err(Fault::new(format!(
                    "header_type is {}; expected UInt32 or UInt64",
                    show(other.as_bytes())
                )));
            }
        };
        let packed = match root.attribute("compressor") {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                let reason = format!(
                    "arrays packed by {} are not supported; save the file with ZLib or without compression",
                    show(other.as_bytes())
                );
                return Err(Fault::unsupported(None, reason));
            }
        };
        Ok(Self { big_endian: root.attribute("byte_order") == Some("BigEndian"), header, packed, budget })
    }
}

impl Encoding<'_> {
    /// Takes memory for the bytes of an array, for its numbers of eight bytes each, and for what they become in the mesh.
    fn take(&self, bytes: u64, number: Number) -> Result<(), Fault> {
        let each = 1 + 16 / number.size() as u64;
        self.budget.take(bytes.saturating_mul(each), || format!("an array has {bytes} bytes"))
    }
}

/// A type of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Number {
    fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "Int8" => Self::I8,
            "UInt8" => Self::U8,
            "Int16" => Self::I16,
            "UInt16" => Self::U16,
            "Int32" => Self::I32,
            "UInt32" => Self::U32,
            "Int64" => Self::I64,
            "UInt64" => Self::U64,
            "Float32" => Self::F32,
            "Float64" => Self::F64,
            _ => return None,
        })
    }

    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The numbers of a sequence of bytes, as f64.
    pub(super) fn floats(self, bytes: &[u8], big_endian: bool) -> Vec<f64> {
        match self {
            Self::F32 => values(bytes, big_endian, |b| f32::from_le_bytes(b).into()),
            Self::F64 => values(bytes, big_endian, f64::from_le_bytes),
            whole => whole.integers(bytes, big_endian).into_iter().map(|x| x as f64).collect(),
        }
    }

    /// The numbers of a sequence of bytes, as whole ones; unsigned ones beyond i64 become negative, and no
    /// number of anything is.
    pub(super) fn integers(self, bytes: &[u8], big_endian: bool) -> Vec<i64> {
        match self {
            Self::I8 => bytes.iter().map(|&b| i64::from(b as i8)).collect(),
            Self::U8 => bytes.iter().map(|&b| b.into()).collect(),
            Self::I16 => values(bytes, big_endian, |b| i16::from_le_bytes(b).into()),
            Self::U16 => values(bytes, big_endian, |b| u16::from_le_bytes(b).into()),
            Self::I32 => values(bytes, big_endian, |b| i32::from_le_bytes(b).into()),
            Self::U32 => values(bytes, big_endian, |b| u32::from_le_bytes(b).into()),
            Self::I64 => values(bytes, big_endian, i64::from_le_bytes),
            Self::U64 => values(bytes, big_endian, |b| u64::from_le_bytes(b) as i64),
            Self::F32 | Self::F64 => {
                let whole = |x: f64| if x.fract() == 0.0 { x as i64 } else { -1 };
                self.floats(bytes, big_endian).into_iter().map(whole).collect()
            }
        }
    }
}

fn values<const N: usize, T>(bytes: &[u8], big_endian: bool, value: impl Fn([u8; N]) -> T) -> Vec<T> {
    let order = |mut b: [u8; N]| {
        if big_endian {
            b.reverse();
        }
        value(b)
    };
    bytes.as_chunks::<N>().0.iter().map(|&b| order(b)).collect()
}

/// Where the bytes of an array are.
#[derive(Clone, Copy, Debug)]
enum Place<'a> {
    Text(&'a [u8]),
    Base64(&'a [u8]),
    Appended(u64),
}

/// An array as it is declared.
#[derive(Clone, Debug)]
pub(super) struct Array<'a> {
    pub name: &'a str,
    number: Option<Number>,
    kind: &'a str,
    /// 0 where it is not said.
    pub components: u64,
    place: Place<'a>,
}

/// The section that arrays refer to by their offset.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Appended<'a> {
    pub bytes: &'a [u8],
    pub base64: bool,
}

impl<'a> Array<'a> {
    pub(super) fn new(tag: &Tag<'a>, text: &'a [u8]) -> Result<Self, Fault> {
        let place = match tag.attribute("format") {
            Some("appended") => Place::Appended(tag.count("offset")?),
            Some("binary") => Place::Base64(text),
            None | Some("ascii") => Place::Text(text),
            Some(other) => {
                return Err(Fault::new(format!(
                    "an array's format is {}; expected ascii, binary or appended",
                    show(other.as_bytes())
                )));
            }
        };
        let kind = tag.attribute("type").unwrap_or_default();
        let components = tag.count("NumberOfComponents")?;
        Ok(Self {
            name: tag.attribute("Name").unwrap_or_default(),
            number: Number::from_name(kind),
            kind,
            components,
            place,
        })
    }

    pub(super) fn is_whole(&self) -> bool {
        !matches!(self.number, None | Some(Number::F32 | Number::F64))
    }

    pub(super) fn floats(&self, encoding: Encoding, appended: Appended) -> Result<Vec<f64>, Fault> {
        self.read(encoding, appended, parse, Number::floats)
    }

    pub(super) fn integers(&self, encoding: Encoding, appended: Appended) -> Result<Vec<i64>, Fault> {
        self.read(encoding, appended, parse, Number::integers)
    }

    fn read<T>(
        &self,
        encoding: Encoding,
        appended: Appended,
        parse: impl Fn(&[u8]) -> Option<T>,
        convert: impl Fn(Number, &[u8], bool) -> Vec<T>,
    ) -> Result<Vec<T>, Fault> {
        let [name, kind] = [self.name, self.kind].map(|word| show(word.as_bytes()));
        let number = self.number.ok_or_else(|| {
            Fault::new(format!("array {name} is of type {kind}, which holds no numbers of VTK"))
        })?;
        let (bytes, base64) = match self.place {
            Place::Text(text) => {
                let word = |word| {
                    parse(word).ok_or_else(|| {
                        Fault::new(format!("array {name} holds {}, which is not of type {kind}", show(word)))
                    })
                };
                return Tokens::without_comments(text).map(word).collect();
            }
            Place::Base64(text) => (text, true),
            Place::Appended(offset) => {
                let at = usize::try_from(offset).ok().and_then(|offset| appended.bytes.get(offset..));
                let missing = || {
                    Fault::new(format!(
                        "array {name} begins beyond the end of the file; it is truncated; copy or export it again"
                    ))
                };
                (at.ok_or_else(missing)?, appended.base64)
            }
        };
        let bytes = unpack(Stream::new(bytes, base64), encoding, number)
            .map_err(|fault| fault.within(&format!("array {name}")))?;
        Ok(convert(number, &bytes, encoding.big_endian))
    }
}

/// The bytes of an array after their header: how many there are, or of packed ones how many blocks, how long
/// each is and the last one, and how long each is when packed.
fn unpack(mut stream: Stream, encoding: Encoding, number: Number) -> Result<Vec<u8>, Fault> {
    let counter = if encoding.header == 8 { Number::U64 } else { Number::U32 };
    let counts = |stream: &mut Stream, n: u64| -> Result<Vec<u64>, Fault> {
        let bytes = stream.take(n.saturating_mul(encoding.header as u64))?;
        Ok(counter.integers(&bytes, encoding.big_endian).into_iter().map(|x| x as u64).collect())
    };
    if !encoding.packed {
        let length = counts(&mut stream, 1)?[0];
        encoding.take(length.min(stream.left()), number)?;
        return stream.take(length - length % number.size() as u64);
    }
    let blocks = counts(&mut stream, 1)?[0];
    if blocks == 0 {
        return Ok(Vec::new());
    }
    let sizes = counts(&mut stream, 2)?;
    let packed = counts(&mut stream, blocks)?;
    encoding.take(sizes[0].saturating_mul(blocks - 1).saturating_add(sizes[0].max(sizes[1])), number)?;
    let mut out = Vec::new();
    for (block, &length) in packed.iter().enumerate() {
        let last = block + 1 == packed.len() && sizes[1] > 0;
        let expected = if last { sizes[1] } else { sizes[0] };
        let before = out.len();
        let bytes = stream.take(length)?;
        let unpacked = ZlibDecoder::new(&bytes[..]).take(expected).read_to_end(&mut out);
        unpacked.map_err(|e| {
            Fault::new(format!("block {block} cannot be unpacked: {e}; the file is damaged; export it again"))
        })?;
        if (out.len() - before) as u64 != expected {
            return Err(Fault::new(format!(
                "block {block} is shorter than it declares; the file is damaged; export it again"
            )));
        }
    }
    Ok(out)
}

/// The section after all arrays, if the tag that was read last opens it.
pub(super) fn appended<'a>(tag: &Tag, rest: &'a [u8]) -> Option<Appended<'a>> {
    let start = rest.iter().position(|&b| b == b'_')? + 1;
    let bytes = &rest[start..];
    let base64 = tag.attribute("encoding") != Some("raw");
    // Raw bytes may look like a tag; base64 cannot.
    let end = if base64 { find(bytes, b"<").unwrap_or(bytes.len()) } else { bytes.len() };
    Some(Appended { bytes: &bytes[..end], base64 })
}

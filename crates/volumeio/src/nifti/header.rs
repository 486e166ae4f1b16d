//! The header of either version, and that of Analyze 7.5, from which NIfTI-1 grew.
use super::placement::{Placed, placed};
use super::{LENGTH_1, LENGTH_2, TYPES};
use crate::bytes::Fields;
use crate::error::Fault;
use crate::sample_type::SampleType;
use std::io::Read;

/// Whose header it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Version {
    Analyze,
    One,
    Two,
}

/// What the header says, whichever version.
pub(super) struct Header {
    pub version: Version,
    pub dims: [usize; 3],
    /// Product of the axes beyond the third: points in time, components of vectors.
    pub volumes: usize,
    pub sample: SampleType,
    /// Numbers side by side in a voxel: colours.
    pub colours: usize,
    /// Whether the data is in a file of its own.
    pub pair: bool,
    pub data_at: u64,
    /// Bytes of the header.
    pub length: u64,
    pub slope: f64,
    pub intercept: f64,
    pub placed: Placed,
    /// The unit of length, if the header says one.
    pub unit: Option<&'static str>,
    pub big_endian: bool,
    pub notes: Vec<String>,
}

impl Header {
    pub fn read(source: &mut impl Read) -> Result<Self, Fault> {
        let mut bytes = vec![0; LENGTH_1];
        source.read_exact(&mut bytes)?;
        let length = |big_endian| Fields { bytes: &bytes, big_endian }.i32(0);
        let (big_endian, two) = match (length(false), length(true)) {
            (348, _) => (false, false),
            (_, 348) => (true, false),
            (540, _) => (false, true),
            (_, 540) => (true, true),
            _ => {
                let reason = "not a NIfTI file: it does not begin with the header's length, 348 or 540";
                return Err(Fault::invalid(reason));
            }
        };
        if two {
            bytes.resize(LENGTH_2, 0);
            source.read_exact(&mut bytes[LENGTH_1..])?;
        }
        let magic = if two { &bytes[4..7] } else { &bytes[344..347] };
        let (version, pair) = match (two, magic) {
            (false, b"n+1") => (Version::One, false),
            (true, b"n+2") => (Version::Two, false),
            (false, b"ni1") => (Version::One, true),
            (true, b"ni2") => (Version::Two, true),
            (true, _) => {
                return Err(Fault::invalid("not a NIfTI-2 file: it lacks the letters n+2 or ni2"));
            }
            (false, b"n+2" | b"ni2") => {
                return Err(Fault::invalid("not a whole NIfTI-2 file: its header has the length of NIfTI-1"));
            }
            (false, _) => (Version::Analyze, true),
        };
        let fields = Fields { bytes: &bytes, big_endian };
        let mut notes = Vec::new();
        let sizes = sizes(&fields, two, &mut notes)?;
        let volumes = sizes[3..].iter().try_fold(1usize, |n, &axis| n.checked_mul(axis));
        let code = if two { fields.i16(12) } else { fields.i16(70) };
        let (_, sample, colours) = TYPES.into_iter().find(|t| t.0 == code).ok_or_else(|| {
            Fault::unsupported(format!(
                "numbers of NIfTI type {code} are not supported; convert them to float"
            ))
        })?;
        let number = |one: usize, other: usize| if two { fields.f64(other) } else { fields.f32(one) };
        let data_at = if two { fields.i64(168) as f64 } else { fields.f32(108) };
        let dims = [sizes[0], sizes[1], sizes[2]];
        let unit = match (version, if two { fields.i32(500) } else { i64::from(bytes[123]) } & 7) {
            (Version::Analyze, _) => None,
            (_, 1) => Some("m"),
            (_, 2) => Some("mm"),
            (_, 3) => Some("um"),
            _ => None,
        };
        Ok(Self {
            version,
            dims,
            volumes: volumes.unwrap_or(usize::MAX),
            sample,
            colours,
            pair,
            data_at: data_at.max(0.0) as u64,
            length: bytes.len() as u64,
            slope: number(112, 176),
            intercept: number(116, 184),
            placed: placed(&fields, version, dims, &mut notes)?,
            unit,
            big_endian,
            notes,
        })
    }
}

/// The lengths of seven axes.
fn sizes(fields: &Fields, two: bool, notes: &mut Vec<String>) -> Result<[usize; 7], Fault> {
    let dim = |i: usize| if two { fields.i64(16 + 8 * i) } else { fields.i16(40 + 2 * i) };
    let axes = dim(0);
    if !(1..=7).contains(&axes) {
        return Err(Fault::invalid(format!("{axes} axes; NIfTI has 1 to 7")));
    }
    let mut sizes = [1usize; 7];
    for (i, size) in sizes.iter_mut().enumerate().take(axes as usize) {
        let found = dim(i + 1);
        *size = match usize::try_from(found) {
            Ok(length) if length > 0 => length,
            // As nifti_clib, the format's own library, takes it.
            _ if i >= 3 => {
                notes.push(format!("axis {} has the length {found}; it was taken as 1", i + 1));
                1
            }
            _ => return Err(Fault::invalid(format!("axis {} has the length {found}", i + 1))),
        };
    }
    Ok(sizes)
}

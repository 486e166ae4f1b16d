//! The header of either version.
use super::{LENGTH_1, LENGTH_2, TYPES};
use crate::Affine;
use crate::error::Fault;
use crate::sample_type::SampleType;
use std::io::Read;

/// What the header says, whichever version.
pub(super) struct Header {
    pub dims: [usize; 3],
    /// Product of the axes beyond the third: points in time, components of vectors.
    pub volumes: usize,
    pub sample: SampleType,
    /// Numbers side by side in a voxel: colours.
    pub colours: usize,
    pub data_at: u64,
    pub length: u64,
    pub slope: f64,
    pub intercept: f64,
    pub affine: Affine,
    pub big_endian: bool,
}

/// Numbers at fixed places.
struct Fields<'a> {
    bytes: &'a [u8],
    big_endian: bool,
}

impl Fields<'_> {
    fn raw<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut bytes = [0; N];
        bytes.copy_from_slice(&self.bytes[at..at + N]);
        if self.big_endian {
            bytes.reverse();
        }
        bytes
    }

    fn i16(&self, at: usize) -> i64 {
        i16::from_le_bytes(self.raw(at)).into()
    }

    fn i32(&self, at: usize) -> i64 {
        i32::from_le_bytes(self.raw(at)).into()
    }

    fn i64(&self, at: usize) -> i64 {
        i64::from_le_bytes(self.raw(at))
    }

    fn f32(&self, at: usize) -> f64 {
        f32::from_le_bytes(self.raw(at)).into()
    }

    fn f64(&self, at: usize) -> f64 {
        f64::from_le_bytes(self.raw(at))
    }
}

impl Header {
    pub fn read(source: &mut impl Read) -> Result<Self, Fault> {
        let mut bytes = vec![0; LENGTH_1];
        let no_nifti = "not a NIfTI file: it does not begin with the header's length, 348 or 540";
        let pair = "header and data are in two files; join them into one .nii file";
        source.read_exact(&mut bytes)?;
        let length = |big_endian| Fields { bytes: &bytes, big_endian }.i32(0);
        let (big_endian, version) = match (length(false), length(true)) {
            (348, _) => (false, 1),
            (_, 348) => (true, 1),
            (540, _) => (false, 2),
            (_, 540) => (true, 2),
            _ => return Err(Fault::invalid(no_nifti)),
        };
        if version == 2 {
            bytes.resize(LENGTH_2, 0);
            source.read_exact(&mut bytes[LENGTH_1..])?;
        }
        let fields = Fields { bytes: &bytes, big_endian };
        let magic = if version == 1 { &bytes[344..347] } else { &bytes[4..7] };
        match magic {
            b"n+1" | b"n+2" => {}
            b"ni1" | b"ni2" => return Err(Fault::unsupported(pair)),
            _ => return Err(Fault::unsupported("a file of Analyze 7.5, not of NIfTI; convert it")),
        }
        let of_version = |one: &dyn Fn(&Fields) -> f64, two: &dyn Fn(&Fields) -> f64| {
            if version == 1 { one(&fields) } else { two(&fields) }
        };
        let dim = |i: usize| if version == 1 { fields.i16(40 + 2 * i) } else { fields.i64(16 + 8 * i) };
        let axes = dim(0);
        if !(1..=7).contains(&axes) {
            return Err(Fault::invalid(format!("{axes} axes; NIfTI has 1 to 7")));
        }
        let mut sizes = [1usize; 7];
        for (i, size) in sizes.iter_mut().enumerate().take(axes as usize) {
            let found = dim(i + 1);
            *size = usize::try_from(found)
                .ok()
                .filter(|&n| n > 0)
                .ok_or_else(|| Fault::invalid(format!("axis {} has the length {found}", i + 1)))?;
        }
        let volumes = sizes[3..].iter().try_fold(1usize, |n, &axis| n.checked_mul(axis));
        let code = if version == 1 { fields.i16(70) } else { fields.i16(12) };
        let (_, sample, colours) = TYPES.into_iter().find(|t| t.0 == code).ok_or_else(|| {
            Fault::unsupported(format!(
                "numbers of NIfTI type {code} are not supported; convert them to float"
            ))
        })?;
        let data_at = of_version(&|f| f.f32(108), &|f| f.i64(168) as f64);
        Ok(Self {
            dims: [sizes[0], sizes[1], sizes[2]],
            volumes: volumes.unwrap_or(usize::MAX),
            sample,
            colours,
            data_at: data_at.max(0.0) as u64,
            length: bytes.len() as u64,
            slope: of_version(&|f| f.f32(112), &|f| f.f64(176)),
            intercept: of_version(&|f| f.f32(116), &|f| f.f64(184)),
            affine: affine(&fields, version)?,
            big_endian,
        })
    }
}

/// The affine map of the header: the general one, else rotation and offset, else the spacing alone.
fn affine(fields: &Fields, version: u32) -> Result<Affine, Fault> {
    let number = |one: usize, two: usize, i: usize| {
        if version == 1 { fields.f32(one + 4 * i) } else { fields.f64(two + 8 * i) }
    };
    let code = |one: usize, two: usize| if version == 1 { fields.i16(one) } else { fields.i32(two) };
    let (qform, sform) = (code(252, 344), code(254, 348));
    if sform > 0 {
        let row = |i: usize| std::array::from_fn::<f64, 4, _>(|j| number(280, 400, 4 * i + j));
        let rows = [row(0), row(1), row(2)];
        let steps = std::array::from_fn(|axis| rows.map(|row| row[axis]));
        return Ok(Affine::from_steps(rows.map(|row| row[3]), steps)?);
    }
    // Images of one layer often have no third step.
    let usual = |length: f64| if length.is_normal() { length.abs() } else { 1.0 };
    let spacing: [f64; 3] = std::array::from_fn(|axis| usual(number(76, 104, axis + 1)));
    let mut directions = [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    let mut origin = [0.0; 3];
    if qform > 0 {
        let [b, c, d] = std::array::from_fn(|i| number(256, 352, i));
        let a = (1.0 - (b * b + c * c + d * d)).max(0.0).sqrt();
        // The columns of the rotation of the quaternion (a, b, c, d); pixdim[0] turns the last around.
        let flip = if number(76, 104, 0) < 0.0 { -1.0 } else { 1.0 };
        directions = [
            [a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)],
            [2.0 * (b * c - a * d), a * a + c * c - b * b - d * d, 2.0 * (c * d + a * b)],
            [2.0 * (b * d + a * c), 2.0 * (c * d - a * b), a * a + d * d - b * b - c * c].map(|x| flip * x),
        ];
        origin = std::array::from_fn(|i| number(268, 376, i));
    }
    let steps = std::array::from_fn(|axis| directions[axis].map(|x| x * spacing[axis]));
    Ok(Affine::from_steps(origin, steps)?)
}

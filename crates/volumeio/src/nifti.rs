//! NIfTI-1 and NIfTI-2 in one file: the format of neuroimaging (<https://nifti.nimh.nih.gov>).
//!
//! Read here and not by the crate `nifti`: that one needs ndarray to write, and asserts in the wrong
//! places on headers that are damaged.
use crate::error::Fault;
use crate::samples::Sample;
use crate::volume::{Placement, Volume, interleaved, voxel_count};
use crate::{Values, VolumeIoError};
use flate2::Compression;
use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;
use mser3d_fileio::write_atomically;
use std::io::{BufRead, Read, Write};
use std::path::Path;

/// Codes of the types of numbers, how each is stored, and how many make a voxel.
const TYPES: [(i64, Sample, usize); 12] = [
    (2, Sample::U8, 1),
    (4, Sample::I16, 1),
    (8, Sample::I32, 1),
    (16, Sample::F32, 1),
    (64, Sample::F64, 1),
    (128, Sample::U8, 3),
    (256, Sample::I8, 1),
    (512, Sample::U16, 1),
    (768, Sample::U32, 1),
    (1024, Sample::I64, 1),
    (1280, Sample::U64, 1),
    (2304, Sample::U8, 4),
];

/// What the header says, whichever version.
struct Header {
    dims: [usize; 3],
    /// Product of the axes beyond the third: points in time, components of vectors.
    volumes: usize,
    sample: Sample,
    /// Numbers side by side in a voxel: colours.
    colours: usize,
    data_at: u64,
    length: u64,
    slope: f64,
    intercept: f64,
    placement: Placement,
    big_endian: bool,
}

pub(crate) fn read(mut source: impl BufRead) -> Result<Volume, Fault> {
    let packed = source.fill_buf()?.starts_with(&[0x1f, 0x8b]);
    if packed { unpacked(MultiGzDecoder::new(source)) } else { unpacked(source) }
}

fn unpacked(mut source: impl Read) -> Result<Volume, Fault> {
    let header = Header::read(&mut source)?;
    let Header { dims, volumes, sample, colours, .. } = header;
    // Extensions may stand between the header and the data.
    let gap = header.data_at.saturating_sub(header.length);
    std::io::copy(&mut source.by_ref().take(gap), &mut std::io::sink())?;
    let voxels = voxel_count(dims).and_then(|n| n.checked_mul(colours));
    let count = voxels.and_then(|n| n.checked_mul(volumes)).unwrap_or(usize::MAX);
    let mut values = sample.read(count, header.big_endian, source)?;
    let trivial = header.slope == 0.0 || !header.slope.is_finite() || !header.intercept.is_finite();
    if !trivial && (header.slope, header.intercept) != (1.0, 0.0) && colours == 1 {
        let scaled = values.to_f64().into_iter().map(|x| header.slope * x + header.intercept);
        values = Values::F64(scaled.collect());
    }
    let (channels, values) = match colours {
        1 => (volumes, interleaved(values, volumes)),
        _ if volumes == 1 => (colours, values),
        _ => return Err(Fault::unsupported("several coloured volumes in one file; export one of them")),
    };
    Ok(Volume::new(dims, channels, header.placement, values)?)
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

const LENGTH_1: usize = 348;
const LENGTH_2: usize = 540;

impl Header {
    fn read(source: &mut impl Read) -> Result<Self, Fault> {
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
            placement: placement(&fields, version),
            big_endian,
        })
    }
}

/// The affine map of the header: the general one, else rotation and offset, else the spacing alone.
fn placement(fields: &Fields, version: u32) -> Placement {
    let number = |one: usize, two: usize, i: usize| {
        if version == 1 { fields.f32(one + 4 * i) } else { fields.f64(two + 8 * i) }
    };
    let code = |one: usize, two: usize| if version == 1 { fields.i16(one) } else { fields.i32(two) };
    let (qform, sform) = (code(252, 344), code(254, 348));
    if sform > 0 {
        let row = |i: usize| std::array::from_fn::<f64, 4, _>(|j| number(280, 400, 4 * i + j));
        let rows = [row(0), row(1), row(2)];
        let steps = std::array::from_fn(|axis| rows.map(|row| row[axis]));
        return Placement::from_steps(rows.map(|row| row[3]), steps);
    }
    let spacing: [f64; 3] = std::array::from_fn(|axis| number(76, 104, axis + 1).abs());
    let mut directions = Placement::default().directions;
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
    Placement::from_steps(origin, steps)
}

/// Writes NIfTI-1; packed if the name ends in `.gz`. Channels become the components of vectors. The
/// placement is kept to the precision of f32, as the format has it.
///
/// # Errors
/// [`VolumeIoError::Unsupported`] beyond 32,767 voxels along an axis; [`VolumeIoError::File`].
pub fn write_nifti(path: &Path, volume: &Volume) -> Result<(), VolumeIoError> {
    let header = header(volume).ok_or_else(|| {
        let dims = volume.dims();
        let reason = format!("NIfTI-1 holds at most 32767 voxels along an axis, not {dims:?}; write .npy");
        VolumeIoError::Unsupported { path: path.to_path_buf(), reason }
    })?;
    let channels = volume.channels();
    let voxels = volume.values().len() / channels;
    let planar;
    let values = match channels {
        1 => volume.values(),
        _ => {
            planar = volume.values().permuted(|i| i % voxels * channels + i / voxels);
            &planar
        }
    };
    let packed = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz"));
    write_atomically(path, |out| {
        if !packed {
            out.write_all(&header)?;
            return values.write(out);
        }
        let mut packer = std::io::BufWriter::new(GzEncoder::new(out, Compression::default()));
        packer.write_all(&header)?;
        values.write(&mut packer)?;
        packer.into_inner().map_err(|e| e.into_error())?.finish().map(|_| ())
    })?;
    Ok(())
}

/// The header, and the four bytes that say that no extensions follow.
fn header(volume: &Volume) -> Option<Vec<u8>> {
    let mut bytes = vec![0u8; LENGTH_1 + 4];
    let mut put = |at: usize, field: &[u8]| bytes[at..at + field.len()].copy_from_slice(field);
    put(0, &(LENGTH_1 as i32).to_le_bytes());
    let channels = volume.channels();
    let [nx, ny, nz] = volume.dims();
    let axes = if channels == 1 { 3 } else { 5 };
    for (i, size) in [axes, nx, ny, nz, 1, channels, 1, 1].into_iter().enumerate() {
        put(40 + 2 * i, &i16::try_from(size).ok()?.to_le_bytes());
    }
    let sample = match volume.values() {
        Values::U8(_) => Sample::U8,
        Values::I8(_) => Sample::I8,
        Values::U16(_) => Sample::U16,
        Values::I16(_) => Sample::I16,
        Values::U32(_) => Sample::U32,
        Values::I32(_) => Sample::I32,
        Values::F32(_) => Sample::F32,
        Values::F64(_) => Sample::F64,
    };
    let (code, ..) = TYPES.into_iter().find(|t| t.1 == sample && t.2 == 1)?;
    if channels > 1 {
        put(68, &1007i16.to_le_bytes()); // NIFTI_INTENT_VECTOR
    }
    put(70, &(code as i16).to_le_bytes());
    put(72, &(8 * sample.bytes() as i16).to_le_bytes());
    let placement = volume.placement();
    let [hx, hy, hz] = placement.spacing;
    for (i, length) in [1.0, hx, hy, hz, 1.0, 1.0, 1.0, 1.0].into_iter().enumerate() {
        put(76 + 4 * i, &(length as f32).to_le_bytes());
    }
    put(108, &((LENGTH_1 + 4) as f32).to_le_bytes());
    put(112, &1f32.to_le_bytes());
    put(254, &2i16.to_le_bytes()); // NIFTI_XFORM_ALIGNED_ANAT
    let steps = placement.steps();
    for row in 0..3 {
        let entries = [steps[0][row], steps[1][row], steps[2][row], placement.origin[row]];
        for (column, entry) in entries.into_iter().enumerate() {
            put(280 + 16 * row + 4 * column, &(entry as f32).to_le_bytes());
        }
    }
    put(344, b"n+1\0");
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(volume: &Volume) -> Vec<u8> {
        let mut bytes = header(volume).unwrap();
        volume.values().write(&mut bytes).unwrap();
        bytes
    }

    fn small() -> Volume {
        Volume::new([2, 1, 2], 1, Placement::default(), vec![1i16, -2, 3, 400]).unwrap()
    }

    fn put(bytes: &mut [u8], at: usize, field: &[u8]) {
        bytes[at..at + field.len()].copy_from_slice(field);
    }

    #[test]
    fn scaled_values_are_what_they_mean() {
        let mut bytes = file(&small());
        put(&mut bytes, 112, &0.5f32.to_le_bytes());
        put(&mut bytes, 116, &10f32.to_le_bytes());
        assert_eq!(*read(&bytes[..]).unwrap().values(), Values::F64(vec![10.5, 9.0, 11.5, 210.0]));
    }

    #[test]
    fn the_quaternion_turns_the_axes() {
        let mut bytes = file(&small());
        put(&mut bytes, 254, &0i16.to_le_bytes());
        put(&mut bytes, 252, &1i16.to_le_bytes());
        // A quarter turn about z: x goes to y, y to -x.
        put(&mut bytes, 264, &(0.5f32.sqrt()).to_le_bytes());
        put(&mut bytes, 268, &7f32.to_le_bytes());
        put(&mut bytes, 80, &3f32.to_le_bytes());
        let volume = read(&bytes[..]).unwrap();
        let there = volume.placement().position([1.0, 0.0, 0.0]);
        let away = (0..3).map(|i| (there[i] - [7.0, 3.0, 0.0][i]).abs()).fold(0.0, f64::max);
        assert!(away < 1e-6, "{there:?}");
    }

    #[test]
    fn both_byte_orders_and_version_2() {
        let volume = small();
        let mut bytes = vec![0u8; LENGTH_2];
        put(&mut bytes, 0, &540i32.to_be_bytes());
        put(&mut bytes, 4, b"n+2\0\r\n\x1a\n");
        put(&mut bytes, 12, &4i16.to_be_bytes());
        for (i, size) in [3i64, 2, 1, 2].into_iter().enumerate() {
            put(&mut bytes, 16 + 8 * i, &size.to_be_bytes());
        }
        put(&mut bytes, 168, &544i64.to_be_bytes());
        bytes.extend([0; 4]);
        [1i16, -2, 3, 400].iter().for_each(|x| bytes.extend(x.to_be_bytes()));
        assert_eq!(read(&bytes[..]).unwrap(), volume);
    }

    #[test]
    fn damaged_files_are_errors() {
        let whole = file(&small());
        for length in 0..whole.len() {
            assert!(read(&whole[..length]).is_err(), "{length} bytes");
        }
        for (at, field, says) in [
            (0, &[9u8, 9][..], "not a NIfTI file"),
            (344, b"ni1", "two files"),
            (344, b"xxx", "Analyze"),
            (40, &[9, 0], "9 axes"),
            (42, &[0, 0], "length 0"),
            (42, &[255, 127], "promises"),
            (70, &[32, 0], "type 32"),
        ] {
            let mut bytes = whole.clone();
            put(&mut bytes, at, field);
            let error = read(&bytes[..]).unwrap_err().in_file(Path::new("a.nii")).to_string();
            assert!(error.contains(says), "{error}");
        }
    }
}

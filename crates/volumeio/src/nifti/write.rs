//! Writing either version.
use super::placement::{furthest, quaternion, turned};
use super::{LENGTH_1, LENGTH_2, TYPES};
use crate::{Affine, Volume, VolumeIoError};
use flate2::Compression;
use flate2::write::GzEncoder;
use mser3d_fileio::write_atomically;
use std::io::Write;
use std::path::Path;

/// Writes NIfTI in millimetres, as by [`write_nifti_in`].
///
/// # Errors
/// [`VolumeIoError::File`].
pub fn write_nifti(path: &Path, volume: &Volume) -> Result<(), VolumeIoError> {
    write_nifti_in(path, volume, Some("mm"))
}

/// Writes NIfTI; packed if the name ends in `.gz`. Channels become the components of vectors. The unit is `mm`, `m`
/// or `um`; of any other the file says nothing.
///
/// The affine is written as sform and, unless it is sheared, as qform too, both with the code of scanner
/// coordinates. Version 1 keeps it in 32-bit floats. Where that would move a voxel by more than a thousandth of its
/// size, as far from the origin, and beyond 32,767 voxels along an axis, the file is of version 2, which is exact.
///
/// # Errors
/// [`VolumeIoError::File`].
pub fn write_nifti_in(path: &Path, volume: &Volume, unit: Option<&str>) -> Result<(), VolumeIoError> {
    let header = header(volume, unit);
    let channels = volume.channels();
    let voxels = volume.samples().len() / channels;
    let planar;
    let values = match channels {
        1 => volume.samples(),
        _ => {
            planar = volume.samples().permuted(|i| i % voxels * channels + i / voxels);
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

/// A voxel may move by this share of its size when the affine is rounded.
const TOLERANCE: f64 = 1e-3;

/// The header, and the four bytes that say that no extensions follow.
pub(super) fn header(volume: &Volume, unit: Option<&str>) -> Vec<u8> {
    let (dims, affine) = (volume.dims(), *volume.affine());
    let small = |size: &usize| i16::try_from(*size).is_ok();
    let rounded = Affine::new(affine.rows().map(|row| row.map(|x| f64::from(x as f32))));
    let finest = affine.spacing().into_iter().fold(f64::INFINITY, f64::min);
    let exact = rounded.is_ok_and(|rounded| furthest(&affine, &rounded, dims) <= TOLERANCE * finest);
    let mut header =
        Writer { bytes: Vec::new(), two: !(exact && dims.iter().all(small) && small(&volume.channels())) };
    header.bytes = vec![0; if header.two { LENGTH_2 } else { LENGTH_1 } + 4];
    header.fill(volume, unit);
    header.bytes
}

/// A header of either version, little end first.
struct Writer {
    bytes: Vec<u8>,
    two: bool,
}

impl Writer {
    fn put(&mut self, at: usize, field: &[u8]) {
        self.bytes[at..at + field.len()].copy_from_slice(field);
    }

    /// A floating-point number of a row of such.
    fn number(&mut self, one: usize, two: usize, i: usize, value: f64) {
        match self.two {
            true => self.put(two + 8 * i, &value.to_le_bytes()),
            false => self.put(one + 4 * i, &(value as f32).to_le_bytes()),
        }
    }

    fn code(&mut self, one: usize, two: usize, value: i16) {
        match self.two {
            true => self.put(two, &i32::from(value).to_le_bytes()),
            false => self.put(one, &value.to_le_bytes()),
        }
    }

    fn fill(&mut self, volume: &Volume, unit: Option<&str>) {
        let length = self.bytes.len() - 4;
        self.put(0, &(length as i32).to_le_bytes());
        let channels = volume.channels();
        let [nx, ny, nz] = volume.dims();
        let axes = if channels == 1 { 3 } else { 5 };
        for (i, size) in [axes, nx, ny, nz, 1, channels, 1, 1].into_iter().enumerate() {
            match self.two {
                true => self.put(16 + 8 * i, &(size as i64).to_le_bytes()),
                false => self.put(40 + 2 * i, &(size as i16).to_le_bytes()),
            }
        }
        let sample = volume.samples().sample_type();
        let code = TYPES.into_iter().find(|t| t.1 == sample && t.2 == 1).map_or(0, |t| t.0 as i16);
        if channels > 1 {
            self.code(68, 504, 1007); // NIFTI_INTENT_VECTOR
        }
        let (types, bits) = if self.two { (12, 14) } else { (70, 72) };
        self.put(types, &code.to_le_bytes());
        self.put(bits, &(8 * sample.bytes() as i16).to_le_bytes());
        let data_at = self.bytes.len();
        match self.two {
            true => self.put(168, &(data_at as i64).to_le_bytes()),
            false => self.put(108, &(data_at as f32).to_le_bytes()),
        }
        self.number(112, 176, 0, 1.0);
        let units = match unit {
            Some("m") => 1,
            Some("mm") => 2,
            Some("um") => 3,
            _ => 0,
        };
        match self.two {
            true => self.put(500, &i32::from(units).to_le_bytes()),
            false => self.put(123, &[units]),
        }
        self.place(volume);
        match self.two {
            true => self.put(4, b"n+2\0\r\n\x1a\n"),
            false => self.put(344, b"n+1\0"),
        }
    }

    fn place(&mut self, volume: &Volume) {
        let affine = volume.affine();
        let spacing = affine.spacing();
        let (bcd, flipped) = quaternion(affine);
        let [hx, hy, hz] = spacing;
        let last = if flipped { -1.0 } else { 1.0 };
        for (i, length) in [last, hx, hy, hz, 1.0, 1.0, 1.0, 1.0].into_iter().enumerate() {
            self.number(76, 104, i, length);
        }
        self.code(254, 348, SCANNER);
        for (i, entry) in affine.rows().into_iter().flatten().enumerate() {
            self.number(280, 400, i, entry);
        }
        // A rotation cannot say a shear: then the sform stands alone.
        let least = 3.0 * if self.two { f64::EPSILON } else { f64::from(f32::EPSILON) };
        let as_read = |x: f64| if self.two { x } else { f64::from(x as f32) };
        let turned = turned(bcd.map(as_read), least, [hx, hy, last * hz], affine.origin());
        let finest = spacing.into_iter().fold(f64::INFINITY, f64::min);
        if turned.is_ok_and(|turned| furthest(affine, &turned, volume.dims()) <= 0.01 * finest) {
            self.code(252, 344, SCANNER);
            for i in 0..3 {
                self.number(256, 352, i, bcd[i]);
                self.number(268, 376, i, affine.origin()[i]);
            }
        }
    }
}

/// NIFTI_XFORM_SCANNER_ANAT
const SCANNER: i16 = 1;

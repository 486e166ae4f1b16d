//! Writing version 1.
use super::{LENGTH_1, TYPES};
use crate::{Volume, VolumeIoError};
use flate2::Compression;
use flate2::write::GzEncoder;
use mser3d_fileio::write_atomically;
use std::io::Write;
use std::path::Path;

/// Writes NIfTI-1; packed if the name ends in `.gz`. Channels become the components of vectors. The
/// affine is kept to the precision of f32, as the format has it.
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

/// The header, and the four bytes that say that no extensions follow.
pub(super) fn header(volume: &Volume) -> Option<Vec<u8>> {
    let mut bytes = vec![0u8; LENGTH_1 + 4];
    let mut put = |at: usize, field: &[u8]| bytes[at..at + field.len()].copy_from_slice(field);
    put(0, &(LENGTH_1 as i32).to_le_bytes());
    let channels = volume.channels();
    let [nx, ny, nz] = volume.dims();
    let axes = if channels == 1 { 3 } else { 5 };
    for (i, size) in [axes, nx, ny, nz, 1, channels, 1, 1].into_iter().enumerate() {
        put(40 + 2 * i, &i16::try_from(size).ok()?.to_le_bytes());
    }
    let sample = volume.samples().sample_type();
    let (code, ..) = TYPES.into_iter().find(|t| t.1 == sample && t.2 == 1)?;
    if channels > 1 {
        put(68, &1007i16.to_le_bytes()); // NIFTI_INTENT_VECTOR
    }
    put(70, &(code as i16).to_le_bytes());
    put(72, &(8 * sample.bytes() as i16).to_le_bytes());
    let affine = volume.affine();
    let [hx, hy, hz] = affine.spacing();
    for (i, length) in [1.0, hx, hy, hz, 1.0, 1.0, 1.0, 1.0].into_iter().enumerate() {
        put(76 + 4 * i, &(length as f32).to_le_bytes());
    }
    put(108, &((LENGTH_1 + 4) as f32).to_le_bytes());
    put(112, &1f32.to_le_bytes());
    put(254, &2i16.to_le_bytes()); // NIFTI_XFORM_ALIGNED_ANAT
    for row in 0..3 {
        for (column, entry) in affine.rows()[row].into_iter().enumerate() {
            put(280 + 16 * row + 4 * column, &(entry as f32).to_le_bytes());
        }
    }
    put(344, b"n+1\0");
    Some(bytes)
}

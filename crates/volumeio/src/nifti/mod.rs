//! NIfTI-1 and NIfTI-2 in one file: the format of neuroimaging (<https://nifti.nimh.nih.gov>).
//!
//! Read here and not by the crate `nifti`: that one needs ndarray to write, and asserts in the wrong
//! places on headers that are damaged.
mod header;
mod write;

pub use write::write_nifti;

use crate::error::Fault;
use crate::sample_type::SampleType;
use crate::volume::{Volume, interleaved, voxel_count};
use crate::{LoadedVolume, Samples, VolumeFormat, World};
use flate2::read::MultiGzDecoder;
use header::Header;
use std::io::{BufRead, Read};

/// Bytes of the header in version 1.
const LENGTH_1: usize = 348;
/// Bytes of the header in version 2.
const LENGTH_2: usize = 540;

/// Codes of the types of numbers, how each is stored, and how many make a voxel.
const TYPES: [(i64, SampleType, usize); 12] = [
    (2, SampleType::U8, 1),
    (4, SampleType::I16, 1),
    (8, SampleType::I32, 1),
    (16, SampleType::F32, 1),
    (64, SampleType::F64, 1),
    (128, SampleType::U8, 3),
    (256, SampleType::I8, 1),
    (512, SampleType::U16, 1),
    (768, SampleType::U32, 1),
    (1024, SampleType::I64, 1),
    (1280, SampleType::U64, 1),
    (2304, SampleType::U8, 4),
];

pub(crate) fn read(mut source: impl BufRead) -> Result<LoadedVolume, Fault> {
    let packed = source.fill_buf()?.starts_with(&[0x1f, 0x8b]);
    if packed { unpacked(MultiGzDecoder::new(source)) } else { unpacked(source) }
}

fn unpacked(mut source: impl Read) -> Result<LoadedVolume, Fault> {
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
        values = Samples::F64(scaled.collect());
    }
    let (channels, values) = match colours {
        1 => (volumes, interleaved(values, volumes)),
        _ if volumes == 1 => (colours, values),
        _ => return Err(Fault::unsupported("several coloured volumes in one file; export one of them")),
    };
    let volume = Volume::new(dims, channels, header.affine, values)?;
    Ok(LoadedVolume { world: World::ras("mm"), ..LoadedVolume::plain(volume, VolumeFormat::Nifti) })
}

#[cfg(test)]
mod tests {
    use super::write::header;
    use super::*;
    use crate::Affine;
    use std::path::Path;

    fn file(volume: &Volume) -> Vec<u8> {
        let mut bytes = header(volume).unwrap();
        volume.samples().write(&mut bytes).unwrap();
        bytes
    }

    fn small() -> Volume {
        Volume::new([2, 1, 2], 1, Affine::default(), vec![1i16, -2, 3, 400]).unwrap()
    }

    fn put(bytes: &mut [u8], at: usize, field: &[u8]) {
        bytes[at..at + field.len()].copy_from_slice(field);
    }

    #[test]
    fn scaled_values_are_what_they_mean() {
        let mut bytes = file(&small());
        put(&mut bytes, 112, &0.5f32.to_le_bytes());
        put(&mut bytes, 116, &10f32.to_le_bytes());
        assert_eq!(*read(&bytes[..]).unwrap().volume.samples(), Samples::F64(vec![10.5, 9.0, 11.5, 210.0]));
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
        let volume = read(&bytes[..]).unwrap().volume;
        let there = volume.affine().position([1.0, 0.0, 0.0]);
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
        assert_eq!(read(&bytes[..]).unwrap().volume, volume);
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

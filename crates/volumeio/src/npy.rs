//! Arrays of NumPy, the first axis x (<https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>).
//!
//! Read here and not by `mser3d-fileio`: volumes come in every type and byte order, features do not.
use crate::error::Fault;
use crate::half::halves;
use crate::sample_type::SampleType;
use crate::volume::allowed_count;
use crate::{Affine, LoadedVolume, Volume, VolumeIoError};
use mser3d_fileio::{ReadLimits, write_atomically};
use std::io::{Read, Write};
use std::path::Path;

const MAGIC: &[u8] = b"\x93NUMPY";

pub(crate) fn read(mut source: impl Read, limits: &ReadLimits) -> Result<LoadedVolume, Fault> {
    let header = header(&mut source)?;
    let kind = element(&header)?;
    let first_axis_fastest = entry(&header, "fortran_order")?.starts_with("True");
    let (dims, channels) = shape(&header)?;
    let count = allowed_count(dims, channels, kind.kept_bytes(), limits)?;
    let values = match kind.half {
        false => kind.sample.read(count, kind.big_endian, source)?,
        true => halves(&SampleType::U16.read(count, kind.big_endian, source)?),
    };
    let [nx, ny, nz] = dims;
    let place = |i: usize| {
        let (voxel, c) = (i / channels, i % channels);
        let [x, y, z] = [voxel % nx, voxel / nx % ny, voxel / (nx * ny)];
        match first_axis_fastest {
            true => voxel + c * nx * ny * nz,
            false => ((x * ny + y) * nz + z) * channels + c,
        }
    };
    let values = if first_axis_fastest && channels == 1 { values } else { values.permuted(place) };
    let volume = Volume::new(dims, channels, Affine::default(), values)?;
    Ok(LoadedVolume::of_array(volume))
}

/// The text that describes the array.
fn header(source: &mut impl Read) -> Result<String, Fault> {
    let mut start = [0; 8];
    source.read_exact(&mut start)?;
    if !start.starts_with(MAGIC) {
        return Err(Fault::invalid("not a .npy file; save the array with numpy.save"));
    }
    let length = if start[6] == 1 {
        let mut length = [0; 2];
        source.read_exact(&mut length)?;
        u16::from_le_bytes(length).into()
    } else {
        let mut length = [0; 4];
        source.read_exact(&mut length)?;
        u32::from_le_bytes(length)
    };
    let mut text = Vec::new();
    source.take(length.into()).read_to_end(&mut text)?;
    if text.len() < length as usize {
        return Err(Fault::invalid("the file ends within its header; copy or export it again"));
    }
    Ok(String::from_utf8_lossy(&text).into_owned())
}

fn entry<'a>(header: &'a str, key: &str) -> Result<&'a str, Fault> {
    let value = header.split_once(&format!("'{key}':")).map(|(_, value)| value.trim_start());
    value.ok_or_else(|| Fault::invalid(format!("the header of the array has no {key}")))
}

/// How a number of the array is stored.
struct Element {
    sample: SampleType,
    big_endian: bool,
    /// Floating-point numbers of 16 bits, which `sample` does not know.
    half: bool,
}

impl Element {
    /// Bytes of a number in memory.
    fn kept_bytes(&self) -> usize {
        // Half numbers are read first, and are two bytes more.
        if self.half { 6 } else { self.sample.bytes() }
    }
}

fn element(header: &str) -> Result<Element, Fault> {
    let entry = entry(header, "descr")?;
    let name = entry.strip_prefix('\'').and_then(|d| d.split_once('\'')).map_or("record", |d| d.0);
    let (order, kind) = name.split_at_checked(1).unwrap_or_default();
    let half = kind == "f2";
    let sample = match kind {
        "b1" | "u1" => SampleType::U8,
        "i1" => SampleType::I8,
        "u2" => SampleType::U16,
        "i2" => SampleType::I16,
        "u4" => SampleType::U32,
        "i4" => SampleType::I32,
        "u8" => SampleType::U64,
        "i8" => SampleType::I64,
        "f2" | "f4" => SampleType::F32,
        "f8" => SampleType::F64,
        _ => {
            return Err(Fault::unsupported(format!(
                "an array of type {name} is not supported; convert it to numbers, as by .astype(float)"
            )));
        }
    };
    Ok(Element { sample, big_endian: order == ">", half })
}

fn shape(header: &str) -> Result<([usize; 3], usize), Fault> {
    let text = entry(header, "shape")?;
    let inside = text.strip_prefix('(').and_then(|s| Some(s.split_once(')')?.0));
    let axes = inside.and_then(|inside| {
        let axes = inside.split(',').map(str::trim).filter(|axis| !axis.is_empty());
        axes.map(|axis| axis.parse().ok()).collect::<Option<Vec<usize>>>()
    });
    let axes = axes.ok_or_else(|| Fault::invalid("the header of the array has no legible shape"))?;
    match *axes {
        [nx, ny] => Ok(([nx, ny, 1], 1)),
        [nx, ny, nz] => Ok(([nx, ny, nz], 1)),
        [nx, ny, nz, channels] => Ok(([nx, ny, nz], channels)),
        _ => Err(Fault::invalid(format!(
            "a volume has the axes x, y, z and perhaps channels; this array has {}",
            axes.len()
        ))),
    }
}

/// Writes `array[x, y, z]`, or `array[x, y, z, channel]` of several channels. The affine is not kept.
///
/// # Errors
/// [`VolumeIoError::File`].
pub fn write_npy(path: &Path, volume: &Volume) -> Result<(), VolumeIoError> {
    let ([nx, ny, nz], channels) = (volume.dims(), volume.channels());
    let place = |i: usize| {
        let (voxel, c) = (i / channels, i % channels);
        let [x, y, z] = [voxel / (ny * nz), voxel / nz % ny, voxel % nz];
        ((z * ny + y) * nx + x) * channels + c
    };
    let kind = match volume.samples().sample_type() {
        SampleType::U8 => "|u1",
        SampleType::I8 => "|i1",
        SampleType::U16 => "<u2",
        SampleType::I16 => "<i2",
        SampleType::U32 => "<u4",
        SampleType::I32 => "<i4",
        SampleType::U64 => "<u8",
        SampleType::I64 => "<i8",
        SampleType::F32 => "<f4",
        SampleType::F64 => "<f8",
    };
    let last = if channels == 1 { String::new() } else { format!(", {channels}") };
    let mut text =
        format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({nx}, {ny}, {nz}{last}), }}");
    // The values begin at a multiple of 64 bytes.
    let padding = 63 - (MAGIC.len() + 4 + text.len()) % 64;
    text.extend(std::iter::repeat_n(' ', padding));
    text.push('\n');
    let values = volume.samples().permuted(place);
    Ok(write_atomically(path, |out| {
        out.write_all(MAGIC)?;
        out.write_all(&[1, 0])?;
        out.write_all(&(text.len() as u16).to_le_bytes())?;
        out.write_all(text.as_bytes())?;
        values.write(out)
    })?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Samples;

    fn file(order: &str, kind: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let text = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((text.len() as u16).to_le_bytes());
        bytes.extend(text.bytes());
        bytes.extend(data);
        bytes
    }

    fn volume(bytes: &[u8]) -> Result<Volume, VolumeIoError> {
        read(bytes, &ReadLimits::default())
            .map(|loaded| loaded.volume)
            .map_err(|fault| fault.in_file(Path::new("m.npy")))
    }

    #[test]
    fn the_first_axis_is_x_in_both_orders_of_memory_and_of_bytes() {
        // array[x, y, z, c] = 1000 x + 100 y + 10 z + c for a shape of (2, 3, 4, 2).
        let [nx, ny, nz, nc] = [2usize, 3, 4, 2];
        let value = |x: usize, y: usize, z: usize, c: usize| (1000 * x + 100 * y + 10 * z + c) as i16;
        let all = nx * ny * nz * nc;
        let rows = (0..all).map(|i| value(i / (ny * nz * nc), i / (nz * nc) % ny, i / nc % nz, i % nc));
        let columns = (0..all).map(|i| value(i % nx, i / nx % ny, i / (nx * ny) % nz, i / (nx * ny * nz)));
        let rows: Vec<u8> = rows.flat_map(i16::to_le_bytes).collect();
        let columns: Vec<u8> = columns.flat_map(i16::to_be_bytes).collect();
        let by_rows = volume(&file("False", "<i2", "(2, 3, 4, 2)", &rows)).unwrap();
        assert_eq!(by_rows, volume(&file("True", ">i2", "(2, 3, 4, 2)", &columns)).unwrap());
        assert_eq!((by_rows.dims(), by_rows.channels()), ([nx, ny, nz], nc));
        let Samples::I16(values) = by_rows.samples() else { panic!() };
        let at = |x, y, z, c| values[((z * ny + y) * nx + x) * nc + c];
        assert_eq!((at(1, 2, 3, 1), at(0, 1, 0, 0), at(1, 0, 2, 1)), (1231, 100, 1021));
    }

    #[test]
    fn every_type_is_read_as_what_it_is() {
        for (kind, bytes, wanted) in [
            ("|b1", vec![1, 0], Samples::U8(vec![1, 0])),
            ("<u8", [u64::MAX.to_le_bytes(), [0; 8]].concat(), Samples::U64(vec![u64::MAX, 0])),
            (">i8", [i64::MIN.to_be_bytes(), [0; 8]].concat(), Samples::I64(vec![i64::MIN, 0])),
            ("<f2", vec![0, 0x3e, 1, 0x80], Samples::F32(vec![1.5, -(2f32.powi(-24))])),
            (">f2", vec![0x7c, 0, 0xc0, 0], Samples::F32(vec![f32::INFINITY, -2.0])),
        ] {
            let read = volume(&file("False", kind, "(2, 1)", &bytes)).unwrap();
            assert_eq!(*read.samples(), wanted, "{kind}");
        }
    }

    #[test]
    fn what_is_no_volume_is_refused() {
        let huge = "(4294967296, 4294967296, 4294967296)";
        for (kind, shape, says) in [
            ("|b1", "(2,)", "has 1"),
            ("|b1", "(1, 1, 1, 1, 2)", "has 5"),
            ("<c8", "(1, 1, 1)", "astype(float)"),
            ("|b1", "(2, 2, 3)", "promises 12 bytes"),
            ("|b1", huge, "more than the limit of"),
            ("|b1", "(0, 2, 2)", "empty"),
            ("|b1", "(2, 2, 2, 0)", "empty"),
            ("|b1", "x", "shape"),
        ] {
            let message = volume(&file("False", kind, shape, &[0; 8])).unwrap_err().to_string();
            assert!(message.starts_with("m.npy: ") && message.contains(says), "{message}");
        }
        let mut cut = b"\x93NUMPY\x02\x00".to_vec();
        cut.write_all(&u32::MAX.to_le_bytes()).unwrap();
        assert!(volume(&cut).unwrap_err().to_string().contains("within its header"));
    }
}

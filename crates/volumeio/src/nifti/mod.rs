//! NIfTI-1 and NIfTI-2 in one file or a pair, and Analyze 7.5 (<https://nifti.nimh.nih.gov>).
//!
//! Read here and not by the crate `nifti`: that one needs ndarray to write, and asserts in the wrong
//! places on headers that are damaged.
mod header;
mod pair;
mod placement;
mod write;

pub use write::{write_nifti, write_nifti_in};

use crate::bytes::{finish, open, skip};
use crate::error::Fault;
use crate::loaded::{ChannelKind, LoadedVolume, World, WorldAxes};
use crate::sample_type::SampleType;
use crate::volume::{Volume, allowed_count, interleaved};
use crate::{Samples, VolumeFormat};
use header::{Header, Version};
use mser3d_fileio::ReadLimits;
use std::io::Read;
use std::path::Path;

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

pub(crate) fn read(path: &Path, limits: &ReadLimits) -> Result<LoadedVolume, Fault> {
    let Some(pair) = pair::files(path, limits)? else {
        let mut source = open(path)?;
        let header = Header::read(&mut source)?;
        if header.pair {
            let reason = "the header of a pair of files; name it .hdr, with the data beside it in .img";
            return Err(Fault::unsupported(reason));
        }
        return volume(header, source, limits);
    };
    let mut source = open(&pair.header)?;
    let mut header = Header::read(&mut source)?;
    if !header.pair {
        return volume(header, source, limits);
    }
    header.length = 0;
    let source = open(&pair.data)?;
    volume(header, source, limits)
}

/// The volume whose values follow after the header.
fn volume(header: Header, mut source: impl Read, limits: &ReadLimits) -> Result<LoadedVolume, Fault> {
    let Header { dims, volumes, sample, colours, mut notes, .. } = header;
    // Analyze has no scaling, but SPM wrote the slope where NIfTI has it.
    let intercept = if header.version == Version::Analyze { 0.0 } else { header.intercept };
    let slope = header.slope;
    let scaled = slope != 0.0 && slope.is_finite() && (slope, intercept) != (1.0, 0.0);
    let kept_bytes = if scaled && colours == 1 { sample.bytes().max(8) } else { sample.bytes() };
    let count = allowed_count(dims, volumes.saturating_mul(colours), kept_bytes, limits)?;
    // Extensions may stand between the header and the data.
    skip(&mut source, header.data_at.saturating_sub(header.length))?;
    let mut values = sample.read(count, header.big_endian, &mut source)?;
    finish(source)?;
    if scaled && colours == 1 {
        if intercept.is_finite() {
            let scaled = values.to_f64().into_iter().map(|x| slope * x + intercept);
            values = Samples::F64(scaled.collect());
            notes.push(format!("values are scaled, as the header says: {slope} x stored + {intercept}"));
        } else {
            notes.push(format!("the intercept of the scaling is {intercept}; values are as stored"));
        }
    }
    let (channels, values) = match colours {
        1 => (volumes, interleaved(values, volumes)),
        _ if volumes == 1 => (colours, values),
        _ => return Err(Fault::unsupported("several coloured volumes in one file; export one of them")),
    };
    let mut loaded =
        LoadedVolume::plain(Volume::new(dims, channels, header.placed.affine, values)?, VolumeFormat::Nifti);
    if colours > 1 {
        loaded.channels = ChannelKind::Colours;
    }
    loaded.world = World {
        axes: if header.placed.anatomical { WorldAxes::Ras } else { WorldAxes::File },
        unit: header.unit.map(str::to_owned),
    };
    loaded.placed_by = header.placed.by;
    loaded.notes = notes;
    Ok(loaded)
}

#[cfg(test)]
mod tests;

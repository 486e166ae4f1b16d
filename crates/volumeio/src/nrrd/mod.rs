//! NRRD, in one file or with its data in others (<https://teem.sourceforge.net/nrrd/format.html>).
mod axes;
mod data;
mod header;
mod segments;
mod vectors;

use crate::VolumeFormat;
use crate::bytes::open_raw;
use crate::error::Fault;
use crate::loaded::{ChannelKind, LoadedVolume};
use crate::volume::{Volume, allowed_count};
use axes::Axes;
use header::Header;
use mser3d_fileio::ReadLimits;
use std::io::BufRead;
use std::path::Path;

pub(crate) fn read(path: &Path, limits: &ReadLimits) -> Result<LoadedVolume, Fault> {
    parse(open_raw(path)?, path, limits)
}

fn parse(mut source: impl BufRead, path: &Path, limits: &ReadLimits) -> Result<LoadedVolume, Fault> {
    let header = Header::read(&mut source)?;
    let mut notes = Vec::new();
    let axes = Axes::of(&header, &mut notes)?;
    let (affine, world, placed_by) = axes.placement(&header, &mut notes)?;
    let (dims, channels) = (axes.dims(), axes.channels().unwrap_or(usize::MAX));
    let count = allowed_count(dims, channels, data::sample(&header)?.bytes(), limits)?;
    let values = data::read(&header, count, source, path, limits)?;
    let volume = Volume::new(dims, channels, affine, axes.arranged(values))?;
    let mut loaded = LoadedVolume::plain(volume, VolumeFormat::Nrrd);
    loaded.segments = segments::of(&header, channels, &mut notes);
    if channels > 1 {
        loaded.channels = match () {
            _ if !loaded.segments.is_empty() => ChannelKind::Layers,
            _ if axes.are_colours() => ChannelKind::Colours,
            _ => ChannelKind::Volumes,
        };
    }
    loaded.world = world;
    loaded.placed_by = placed_by;
    loaded.notes = notes;
    Ok(loaded)
}

#[cfg(test)]
mod tests;

//! MetaImage of ITK and VTK, `.mha` in one file and `.mhd` with the data beside it
//! (<https://docs.itk.org/en/latest/learn/metaio.html>).
mod data;
mod header;

use crate::bytes::open_raw;
use crate::error::Fault;
use crate::loaded::{LoadedVolume, World};
use crate::volume::{Volume, allowed_count};
use crate::{Affine, VolumeFormat};
use data::Coding;
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
    let axes = header.numbers::<usize>(&["NDims"], 1)?.map_or(0, |n| n[0]);
    if !(2..=4).contains(&axes) {
        return Err(Fault::unsupported(format!("NDims is {axes}; a volume has 2 to 4 axes")));
    }
    let sizes = header.numbers::<usize>(&["DimSize"], axes)?;
    let sizes = sizes.ok_or_else(|| Fault::invalid("the header has no DimSize"))?;
    let size = |axis: usize| sizes.get(axis).copied().unwrap_or(1);
    let (dims, volumes) = ([size(0), size(1), size(2)], size(3));
    let components = header.numbers::<usize>(&["ElementNumberOfChannels"], 1)?.map_or(1, |n| n[0]);
    let (affine, placed_by) = placement(&header, axes, &mut notes)?;
    let channels = components.saturating_mul(volumes);
    let coding = Coding::of(&header)?;
    let count = allowed_count(dims, channels, coding.sample.bytes(), limits)?;
    let values = coding.read(&header, count, source, path, limits)?;
    // In the file the components of a voxel stand side by side, and a volume after the other.
    let voxels = count / channels.max(1);
    let values = match volumes {
        0 | 1 => values,
        _ => values.permuted(|i| {
            let (voxel, channel) = (i / channels, i % channels);
            (channel / components * voxels + voxel) * components + channel % components
        }),
    };
    let mut loaded =
        LoadedVolume::plain(Volume::new(dims, channels, affine, values)?, VolumeFormat::MetaImage);
    let unit = header.text(&["DistanceUnits"]).filter(|unit| matches!(*unit, "mm" | "um" | "cm"));
    loaded.world = World::ras(unit.unwrap_or("mm"));
    loaded.placed_by = placed_by;
    loaded.notes = notes;
    Ok(loaded)
}

/// Index to world, turned from ITK's left-posterior-superior to right-anterior-superior.
fn placement(header: &Header, axes: usize, notes: &mut Vec<String>) -> Result<(Affine, String), Fault> {
    let spacing = header.numbers::<f64>(&["ElementSpacing", "ElementSize"], axes)?;
    let offset = header.numbers::<f64>(&["Offset", "Position", "Origin"], axes)?;
    let turned = header.numbers::<f64>(&["TransformMatrix", "Rotation", "Orientation"], axes * axes)?;
    if let Some(centre) = header.numbers::<f64>(&["CenterOfRotation"], axes)?
        && centre.iter().any(|&x| x != 0.0)
    {
        notes.push("CenterOfRotation is left out, as ITK does".to_owned());
    }
    let scale = |names: &[&str], usual: f64| -> Result<bool, Fault> {
        Ok(header.numbers::<f64>(names, 1)?.is_some_and(|n| n[0] != usual))
    };
    if scale(&["ElementToIntensityFunctionSlope"], 1.0)? || scale(&["ElementToIntensityFunctionOffset"], 0.0)?
    {
        notes.push("ElementToIntensityFunction is left out: values are as stored".to_owned());
    }
    let spatial = axes.min(3);
    let sign = |i: usize| if i < 2 { -1.0 } else { 1.0 };
    let step = |axis: usize| {
        let length = spacing.as_ref().and_then(|s| s.get(axis)).copied().unwrap_or(1.0);
        std::array::from_fn(|i| {
            // Row `axis` of the matrix is the direction of that axis.
            let cosine = match &turned {
                Some(matrix) if axis < spatial && i < spatial => matrix[axis * axes + i],
                _ => f64::from(axis == i),
            };
            // No -0.
            sign(i) * cosine * length + 0.0
        })
    };
    let origin = std::array::from_fn(|i| {
        sign(i) * offset.as_ref().and_then(|o| o.get(i)).filter(|_| i < spatial).copied().unwrap_or(0.0) + 0.0
    });
    let by = match (&turned, &offset, &spacing) {
        (Some(_), ..) => "TransformMatrix, LPS turned to RAS",
        (None, Some(_), _) => "Offset, LPS turned to RAS",
        (None, None, Some(_)) => "ElementSpacing alone, LPS turned to RAS",
        _ => "nothing: voxels of size 1, LPS turned to RAS",
    };
    Ok((Affine::from_steps(origin, [step(0), step(1), step(2)])?, by.to_owned()))
}

#[cfg(test)]
mod tests;

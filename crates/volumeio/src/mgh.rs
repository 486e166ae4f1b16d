//! FreeSurfer's `.mgh` and `.mgz` (<https://surfer.nmr.mgh.harvard.edu/fswiki/FsTutorial/MghFormat>).
use crate::bytes::{Fields, finish, open, skip};
use crate::error::Fault;
use crate::loaded::{LoadedVolume, World};
use crate::sample_type::SampleType;
use crate::volume::{allowed_count, interleaved};
use crate::{Affine, Volume, VolumeFormat};
use mser3d_fileio::ReadLimits;
use std::io::Read;
use std::path::Path;

/// Where the values begin. Everything is big-endian.
const DATA_AT: usize = 284;

pub(crate) fn read(path: &Path, limits: &ReadLimits) -> Result<LoadedVolume, Fault> {
    parse(open(path)?, limits)
}

fn parse(mut source: impl Read, limits: &ReadLimits) -> Result<LoadedVolume, Fault> {
    let mut bytes = [0; 90];
    source.read_exact(&mut bytes)?;
    skip(&mut source, (DATA_AT - bytes.len()) as u64)?;
    let fields = Fields { bytes: &bytes, big_endian: true };
    if fields.i32(0) != 1 {
        return Err(Fault::invalid("not a file of FreeSurfer: it does not begin with version 1"));
    }
    let mut sizes = [0usize; 4];
    for (i, size) in sizes.iter_mut().enumerate() {
        let found = fields.i32(4 + 4 * i);
        let length = usize::try_from(found).ok().filter(|&n| n > 0);
        *size = length.ok_or_else(|| Fault::invalid(format!("axis {} has the length {found}", i + 1)))?;
    }
    let [nx, ny, nz, frames] = sizes;
    let sample = match fields.i32(20) {
        0 => SampleType::U8,
        1 => SampleType::I32,
        3 => SampleType::F32,
        4 => SampleType::I16,
        10 => SampleType::U16,
        other => {
            return Err(Fault::unsupported(format!(
                "numbers of FreeSurfer's type {other}; save them as float"
            )));
        }
    };
    let dims = [nx, ny, nz];
    let mut notes = Vec::new();
    let (affine, placed_by) = match fields.i16(28) > 0 {
        true => (vox_to_ras(&fields, dims)?, "direction cosines and c_ras"),
        false => {
            notes.push(
                "the header has no orientation: FreeSurfer's default of coronal slices of 1 mm was taken"
                    .into(),
            );
            let cosines = [[-1., 0., 0.], [0., 0., -1.], [0., 1., 0.]];
            (centred(cosines, dims, [0.0; 3])?, "nothing: FreeSurfer's coronal default")
        }
    };
    let count = allowed_count(dims, frames, sample.bytes(), limits)?;
    let values = sample.read(count, true, &mut source)?;
    finish(source)?;
    let mut loaded = LoadedVolume::plain(
        Volume::new(dims, frames, affine, interleaved(values, frames))?,
        VolumeFormat::Mgh,
    );
    loaded.world = World::ras("mm");
    loaded.placed_by = placed_by.to_owned();
    loaded.notes = notes;
    Ok(loaded)
}

fn vox_to_ras(fields: &Fields, dims: [usize; 3]) -> Result<Affine, Fault> {
    let vector = |at: usize| std::array::from_fn::<f64, 3, _>(|i| fields.f32(at + 4 * i));
    let size = vector(30);
    let steps = std::array::from_fn(|axis| vector(42 + 12 * axis).map(|x| x * size[axis]));
    centred(steps, dims, vector(78))
}

/// The map that puts the middle of the volume, which is voxel `dims / 2`, at `centre`.
fn centred(steps: [[f64; 3]; 3], dims: [usize; 3], centre: [f64; 3]) -> Result<Affine, Fault> {
    let half = dims.map(|n| n as f64 / 2.0);
    let origin = std::array::from_fn(|i| centre[i] - (0..3).map(|a| steps[a][i] * half[a]).sum::<f64>());
    Ok(Affine::from_steps(origin, steps)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Samples;

    fn file(good: i16, frames: i32) -> Vec<u8> {
        let mut bytes = vec![0u8; DATA_AT];
        let mut put = |at: usize, field: &[u8]| bytes[at..at + field.len()].copy_from_slice(field);
        for (i, n) in [1, 2, 1, 2, frames, 4].into_iter().enumerate() {
            put(4 * i, &i32::to_be_bytes(n));
        }
        put(28, &good.to_be_bytes());
        let numbers = [2f32, 3., 4., 0., 1., 0., -1., 0., 0., 0., 0., 1., 10., 20., 30.];
        for (i, x) in numbers.into_iter().enumerate() {
            put(30 + 4 * i, &x.to_be_bytes());
        }
        (0..4 * frames as i16).for_each(|x| bytes.extend((x - 2).to_be_bytes()));
        bytes
    }

    #[test]
    fn the_middle_is_at_c_ras() {
        let loaded = parse(&file(1, 1)[..], &ReadLimits::default()).unwrap();
        assert_eq!(*loaded.volume.samples(), Samples::I16(vec![-2, -1, 0, 1]));
        let affine = loaded.volume.affine();
        assert_eq!(affine.position([1.0, 0.5, 1.0]), [10., 20., 30.]);
        assert_eq!(affine.steps(), [[0., 2., 0.], [-3., 0., 0.], [0., 0., 4.]]);
        let loaded = parse(&file(0, 2)[..], &ReadLimits::default()).unwrap();
        assert_eq!(loaded.volume.affine().axis_codes(), "LIA");
        assert_eq!(*loaded.volume.channel(1).samples(), Samples::I16(vec![2, 3, 4, 5]));
        assert!(loaded.notes[0].contains("no orientation"));
    }

    #[test]
    fn damaged_files_are_errors() {
        let whole = file(1, 1);
        for length in 0..whole.len() {
            assert!(parse(&whole[..length], &ReadLimits::default()).is_err(), "{length} bytes");
        }
        for (at, field, says) in
            [(0, 2, "version 1"), (4, -1, "length -1"), (12, i32::MAX, "promises"), (20, 2, "type 2")]
        {
            let mut bytes = whole.clone();
            bytes[at..at + 4].copy_from_slice(&i32::to_be_bytes(field));
            let error = parse(&bytes[..], &ReadLimits::default())
                .unwrap_err()
                .in_file(Path::new("a.mgz"))
                .to_string();
            assert!(error.contains(says), "{error}");
        }
    }
}

//! Arrays of NumPy, the first axis x.
use crate::error::Fault;
use crate::{Placement, Samples, Volume, VolumeIoError};
use mser3d_fileio::{NpyArray, NpyValues, read_npy};
use std::path::Path;

pub(crate) fn read(path: &Path) -> Result<Volume, VolumeIoError> {
    let (array, first_axis_fastest) = read_npy(path)?;
    volume(array, first_axis_fastest).map_err(|fault| fault.in_file(path))
}

fn volume(array: NpyArray<'static>, first_axis_fastest: bool) -> Result<Volume, Fault> {
    let (dims, channels) = match *array.shape() {
        [nx, ny] => ([nx, ny, 1], 1),
        [nx, ny, nz] => ([nx, ny, nz], 1),
        [nx, ny, nz, channels] => ([nx, ny, nz], channels),
        ref other => {
            let axes = other.len();
            return Err(Fault::invalid(format!(
                "a volume has the axes x, y, z and perhaps channels; this array has {axes}"
            )));
        }
    };
    let values = match array.values().clone() {
        NpyValues::U8(v) => Samples::U8(v.into_owned()),
        NpyValues::I8(v) => Samples::I8(v.into_owned()),
        NpyValues::U16(v) => Samples::U16(v.into_owned()),
        NpyValues::I16(v) => Samples::I16(v.into_owned()),
        NpyValues::U32(v) => Samples::U32(v.into_owned()),
        NpyValues::I32(v) => Samples::I32(v.into_owned()),
        NpyValues::I64(v) => Samples::F64(v.iter().map(|&x| x as f64).collect()),
        NpyValues::F32(v) => Samples::F32(v.into_owned()),
        NpyValues::F64(v) => Samples::F64(v.into_owned()),
        _ => return Err(Fault::unsupported("an array of this type is not supported; use .astype(float)")),
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
    Ok(Volume::new(dims, channels, Placement::default(), values.permuted(place))?)
}

/// Writes `array[x, y, z]`, or `array[x, y, z, channel]` of several channels. The placement is not kept.
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
    let shape = [nx, ny, nz, channels];
    let shape = if channels == 1 { &shape[..3] } else { &shape[..] };
    let array = match volume.samples().permuted(place) {
        Samples::U8(v) => NpyArray::new(shape, v),
        Samples::I8(v) => NpyArray::new(shape, v),
        Samples::U16(v) => NpyArray::new(shape, v),
        Samples::I16(v) => NpyArray::new(shape, v),
        Samples::U32(v) => NpyArray::new(shape, v),
        Samples::I32(v) => NpyArray::new(shape, v),
        Samples::F32(v) => NpyArray::new(shape, v),
        Samples::F64(v) => NpyArray::new(shape, v),
    }?;
    Ok(mser3d_fileio::write_npy(path, &array)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_axis_is_x_in_both_orders() {
        // array[x, y, z, c] = 1000 x + 100 y + 10 z + c for a shape of (2, 3, 4, 2).
        let [nx, ny, nz, nc] = [2usize, 3, 4, 2];
        let value = |x: usize, y: usize, z: usize, c: usize| (1000 * x + 100 * y + 10 * z + c) as i16;
        let all = nx * ny * nz * nc;
        let rows = (0..all).map(|i| value(i / (ny * nz * nc), i / (nz * nc) % ny, i / nc % nz, i % nc));
        let columns = (0..all).map(|i| value(i % nx, i / nx % ny, i / (nx * ny) % nz, i / (nx * ny * nz)));
        let array = |values: Vec<i16>| NpyArray::new(&[nx, ny, nz, nc], values).unwrap();
        let by_rows = volume(array(rows.collect()), false).unwrap();
        assert_eq!(by_rows, volume(array(columns.collect()), true).unwrap());
        assert_eq!((by_rows.dims(), by_rows.channels()), ([nx, ny, nz], nc));
        let Samples::I16(values) = by_rows.samples() else { panic!() };
        let at = |x, y, z, c| values[((z * ny + y) * nx + x) * nc + c];
        assert_eq!((at(1, 2, 3, 1), at(0, 1, 0, 0), at(1, 0, 2, 1)), (1231, 100, 1021));
    }

    #[test]
    fn arrays_of_other_axes_are_refused() {
        for shape in [&[4][..], &[1, 1, 1, 1, 4]] {
            assert!(volume(NpyArray::new(shape, vec![0u8; 4]).unwrap(), false).is_err());
        }
        assert!(volume(NpyArray::new(&[0, 3, 1], Vec::<u8>::new()).unwrap(), false).is_err());
        assert!(volume(NpyArray::new(&[2, 3, 1, 0], Vec::<u8>::new()).unwrap(), false).is_err());
    }
}

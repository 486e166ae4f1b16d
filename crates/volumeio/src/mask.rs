use crate::VolumeIoError;
use crate::error::Fault;
use mser3d_fileio::{NpyArray, NpyValues, read_npy};
use mser3d_shape::BitGrid;
use std::path::Path;

/// Reads a solid as a mask: a three-dimensional `.npy` array of `bool` or `uint8`, in which
/// `array[x, y, z]` is not zero inside. Both of numpy's memory orders are read.
///
/// # Errors
/// [`VolumeIoError::File`], also for a truncated file; [`VolumeIoError::Invalid`] for other shapes or an
/// empty mask; [`VolumeIoError::Unsupported`] for other types.
pub fn read_mask(path: &Path) -> Result<BitGrid, VolumeIoError> {
    let (array, first_axis_fastest) = read_npy(path)?;
    mask(&array, first_axis_fastest).map_err(|fault| fault.in_file(path))
}

fn mask(array: &NpyArray, first_axis_fastest: bool) -> Result<BitGrid, Fault> {
    let &[nx, ny, nz] = array.shape() else {
        let axes = array.shape().len();
        return Err(Fault::invalid(format!("a mask has three axes, x, y and z; this array has {axes}")));
    };
    let NpyValues::U8(values) = array.values() else {
        return Err(Fault::unsupported("a mask is of type bool or uint8; convert it with .astype(bool)"));
    };
    let mut grid = BitGrid::empty([nx, ny, nz]).map_err(|e| Fault::invalid(e.to_string()))?;
    for (at, _) in values.iter().enumerate().filter(|(_, value)| **value != 0) {
        let [i, j, k] = match first_axis_fastest {
            true => [at % nx, at / nx % ny, at / (nx * ny)],
            false => [at / (ny * nz), at / nz % ny, at % nz],
        };
        grid.set([i as u32, j as u32, k as u32], true);
    }
    if grid.count_ones() == 0 {
        return Err(Fault::invalid("the mask is zero everywhere: there is no solid"));
    }
    Ok(grid)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<BitGrid, VolumeIoError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("m.npy");
        std::fs::write(&path, bytes).unwrap();
        read_mask(&path)
    }

    fn file(order: &str, kind: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let text = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((text.len() as u16).to_le_bytes());
        bytes.extend(text.bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn the_first_axis_is_x_in_both_orders() {
        // array[1, 0, 2] and array[0, 1, 0] of shape (2, 2, 3).
        let mut rows = [0u8; 12];
        rows[6 + 2] = 1;
        rows[3] = 255;
        let mut columns = [0u8; 12];
        columns[1 + 2 * 2 * 2] = 1;
        columns[2] = 1;
        for bytes in [file("False", "|u1", "(2, 2, 3)", &rows), file("True", "|b1", "(2, 2, 3)", &columns)] {
            let grid = read(&bytes).unwrap();
            assert_eq!(grid.dims(), [2, 2, 3]);
            assert_eq!(grid.ones().collect::<Vec<_>>(), [[0, 1, 0], [1, 0, 2]]);
        }
    }

    #[test]
    fn what_is_no_mask_is_refused() {
        let huge = "(4294967296, 4294967296, 4294967296)";
        for (kind, shape, says) in [
            ("|b1", "(2, 2)", "three axes"),
            ("<f8", "(1, 1, 1)", "astype(bool)"),
            (">f8", "(1, 1, 1)", "not supported"),
            ("|b1", "(2, 2, 3)", "truncated"),
            ("|b1", huge, "truncated"),
            ("|b1", "(2, 2, 2)", "zero everywhere"),
            ("|b1", "(0, 2, 2)", "zero everywhere"),
            ("|b1", "x", "shape"),
        ] {
            let message = read(&file("False", kind, shape, &[0; 8])).unwrap_err().to_string();
            let (folder, reason) = message.split_once("m.npy: ").unwrap();
            assert!(Path::new(folder).is_absolute() && reason.contains(says), "{message}");
        }
    }
}

//! Small volumes and files of all formats.

use std::io::Write;

use mser3d_volumeio::{Affine, Samples, Volume, write_nifti, write_npy};

/// A turned and stretched box whose numbers f32 holds exactly.
pub fn placed() -> Affine {
    Affine::from_steps([-4.5, 8.0, 0.25], [[0.0, 0.5, 0.0], [-0.75, 0.0, 0.0], [0.0, 0.0, 2.0]]).unwrap()
}

pub fn of_every_type() -> Vec<Samples> {
    let numbers = [0, 1, 2, 3, 100, 5, 6, 7, 8, 9, 10, 127];
    vec![
        Samples::U8(numbers.iter().map(|&x| x as u8).collect()),
        Samples::I8(numbers.iter().map(|&x| -x as i8).collect()),
        Samples::U16(numbers.iter().map(|&x| 400 * x as u16).collect()),
        Samples::I16(numbers.iter().map(|&x| -200 * x as i16).collect()),
        Samples::U32(numbers.iter().map(|&x| 1_000_000 * x as u32).collect()),
        Samples::I32(numbers.iter().map(|&x| -1_000_000 * x).collect()),
        Samples::U64(numbers.iter().map(|&x| u64::MAX - x as u64).collect()),
        Samples::I64(numbers.iter().map(|&x| i64::MIN + i64::from(x)).collect()),
        Samples::F32(numbers.iter().map(|&x| 0.1 * x as f32).collect()),
        Samples::F64(numbers.iter().map(|&x| f64::from(x).exp()).collect()),
    ]
}

/// A small TIFF: little end first, one strip, entries in the order of their tags.
fn tiff() -> Vec<u8> {
    let mut bytes = b"II\x2a\0\x0e\0\0\0\x01\x02\x03\x04\x05\x06".to_vec();
    let entries = [(256u16, 3u32), (257, 2), (258, 8), (262, 1), (273, 8), (278, 2), (279, 6)];
    bytes.extend((entries.len() as u16).to_le_bytes());
    for (tag, value) in entries {
        bytes.extend([tag.to_le_bytes(), 4u16.to_le_bytes()].concat());
        bytes.extend([1u32.to_le_bytes(), value.to_le_bytes()].concat());
    }
    bytes.extend([0; 4]);
    bytes
}

fn mgh() -> Vec<u8> {
    let mut bytes: Vec<u8> = [1, 2, 1, 2, 1, 0].into_iter().flat_map(i32::to_be_bytes).collect();
    bytes.resize(284, 0);
    bytes.extend([1, 2, 3, 4]);
    bytes
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packer.write_all(bytes).unwrap();
    packer.finish().unwrap()
}

/// A whole file of each format.
pub fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let folder = tempfile::tempdir().unwrap();
    let volume = Volume::new([2, 3, 2], 1, placed(), of_every_type().remove(3)).unwrap();
    let written = |name: &str| {
        let path = folder.path().join(name);
        if name.ends_with("npy") { write_npy(&path, &volume) } else { write_nifti(&path, &volume) }.unwrap();
        std::fs::read(path).unwrap()
    };
    let nrrd = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nspacings: 1 1 2\nencoding: ";
    let nrrd = |encoding: &str, data: &[u8]| [nrrd.as_bytes(), encoding.as_bytes(), b"\n\n", data].concat();
    let meta = "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nOffset = 1 2 3\nElementDataFile = LOCAL\n12345678";
    vec![
        ("a.npy", written("a.npy")),
        ("a.nii", written("a.nii")),
        ("b.nii.gz", written("b.nii.gz")),
        ("a.nrrd", nrrd("raw", b"12345678")),
        ("b.nrrd", nrrd("gzip", &packed(b"12345678"))),
        ("c.nrrd", nrrd("hex", b"0102030405060708")),
        ("a.mha", meta.into()),
        ("a.mgh", mgh()),
        ("a.mgz", packed(&mgh())),
        ("a.tif", tiff()),
    ]
}

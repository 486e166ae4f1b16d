//! What a file declares, and what is packed in it, is compared with the limits before memory is taken.

use bzip2::write::BzEncoder;
use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use mser3d_fileio::{FileError, ReadLimits};
use mser3d_volumeio::{VolumeIoError, read_affine, read_label_names, read_volume};
use std::io::Write;
use std::path::Path;

const MB: u64 = 1_000_000;

fn gzip(parts: &[&[u8]]) -> Vec<u8> {
    let mut packer = GzEncoder::new(Vec::new(), Compression::fast());
    parts.iter().for_each(|part| packer.write_all(part).unwrap());
    packer.finish().unwrap()
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut packer = ZlibEncoder::new(Vec::new(), Compression::fast());
    packer.write_all(bytes).unwrap();
    packer.finish().unwrap()
}

fn nifti(dims: [i16; 4]) -> Vec<u8> {
    let mut bytes = vec![0u8; 352];
    let mut put = |at: usize, field: &[u8]| bytes[at..at + field.len()].copy_from_slice(field);
    put(0, &348i32.to_le_bytes());
    for (i, size) in [4].into_iter().chain(dims).enumerate() {
        put(40 + 2 * i, &size.to_le_bytes());
    }
    put(70, &2i16.to_le_bytes());
    put(76, &[0, 0, 128, 63].repeat(4));
    put(108, &352f32.to_le_bytes());
    put(344, b"n+1");
    bytes
}

fn mgh(dims: [i32; 4]) -> Vec<u8> {
    let mut bytes = vec![0u8; 284];
    for (i, field) in [1].into_iter().chain(dims).enumerate() {
        bytes[4 * i..4 * i + 4].copy_from_slice(&i32::to_be_bytes(field));
    }
    bytes
}

fn npy(shape: &str) -> Vec<u8> {
    let header = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': ({shape}), }}\n");
    [&b"\x93NUMPY\x01\0"[..], &(header.len() as u16).to_le_bytes(), header.as_bytes()].concat()
}

fn nrrd(sizes: &str, encoding: &str) -> Vec<u8> {
    let axes = sizes.split(' ').count();
    format!("NRRD0004\ntype: uchar\ndimension: {axes}\nsizes: {sizes}\nencoding: {encoding}\n\n").into_bytes()
}

fn metaimage(sizes: &str, packed: bool) -> Vec<u8> {
    let axes = sizes.split(' ').count();
    let packed = if packed { "True" } else { "False" };
    format!(
        "ObjectType = Image\nNDims = {axes}\nDimSize = {sizes}\nBinaryData = True\nCompressedData = {packed}\n\
         ElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
    )
    .into_bytes()
}

/// Pages of `width` x `height` bytes, packed by a method; all of them have the same strip.
fn tiff(pages: u32, [width, height]: [u32; 2], method: u32, strip: &[u8]) -> Vec<u8> {
    let mut bytes = b"II\x2a\0".to_vec();
    let first = 8 + strip.len() as u32;
    bytes.extend(first.to_le_bytes());
    bytes.extend(strip);
    let entries = [
        (256, width),
        (257, height),
        (258, 8),
        (259, method),
        (262, 1),
        (273, 8),
        (277, 1),
        (278, height),
        (279, strip.len() as u32),
    ];
    let length = 2 + 12 * entries.len() as u32 + 4;
    for page in 0..pages {
        bytes.extend((entries.len() as u16).to_le_bytes());
        for (tag, value) in entries {
            bytes.extend(u16::to_le_bytes(tag));
            bytes.extend(4u16.to_le_bytes());
            bytes.extend(1u32.to_le_bytes());
            bytes.extend(value.to_le_bytes());
        }
        let next = if page + 1 == pages { 0 } else { first + (page + 1) * length };
        bytes.extend(next.to_le_bytes());
    }
    bytes
}

/// Reads a file of these bytes.
fn read(name: &str, bytes: &[u8], limits: &ReadLimits) -> Result<[usize; 3], VolumeIoError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    read_volume(&path, limits).map(|loaded| loaded.volume.dims())
}

fn refusal(name: &str, bytes: &[u8], limits: &ReadLimits) -> String {
    let error = read(name, bytes, limits).unwrap_err();
    assert!(matches!(&error, VolumeIoError::File(FileError::OverLimit { .. })), "{name}: {error}");
    let message = error.to_string();
    assert!(message.contains(name), "{message}");
    message
}

#[test]
fn declared_voxels_are_refused_before_any_is_read() {
    let limits = ReadLimits { max_box_voxels: 1000, ..Default::default() };
    let size = [2000; 4];
    let mut dims = size;
    dims[3] = 1;
    for (name, bytes) in [
        ("a.nii", nifti(dims)),
        ("a.nii.gz", gzip(&[&nifti(dims)])),
        ("a.mgh", mgh(dims.map(i32::from))),
        ("a.mgz", gzip(&[&mgh(dims.map(i32::from))])),
        ("a.npy", npy("2000, 2000, 2000")),
        ("a.nrrd", nrrd("2000 2000 2000", "raw")),
        ("b.nrrd", nrrd("2000 2000 2000", "gzip")),
        ("c.nrrd", nrrd("2000 2000 2000", "bzip2")),
        ("d.nrrd", nrrd("2000 2000 2000", "ascii")),
        ("e.nrrd", nrrd("2000 2000 2000", "hex")),
        ("a.mha", metaimage("2000 2000 2000", false)),
        ("b.mha", metaimage("2000 2000 2000", true)),
    ] {
        let message = refusal(name, &bytes, &limits);
        let says = "it declares 2000 x 2000 x 2000 voxels, more than the limit of 1000 voxels";
        assert!(message.contains(says) && message.contains("--max-box-voxels"), "{message}");
    }
    let message = refusal("a.tif", &tiff(2000, [2000, 2000], 32773, &[0; 4]), &limits);
    assert!(message.contains("2000 x 2000 x 2000 voxels"), "{message}");
    // By default as well.
    let message = refusal("f.nrrd", &nrrd("2000 2000 2000", "raw"), &ReadLimits::default());
    assert!(message.contains("the limit of 4294967296 voxels"), "{message}");
}

#[test]
fn what_is_packed_is_refused_before_memory_is_taken() {
    // 60 MB of zeros in each, which would take twice as much; and what is declared is there.
    let zeros = vec![0u8; 60_000_000];
    let mut packer = BzEncoder::new(Vec::new(), bzip2::Compression::fast());
    packer.write_all(&zeros).unwrap();
    let bzip2 = packer.finish().unwrap();
    let pack_bits = [0x81, 0].repeat(1_000_000_usize.div_ceil(128));
    let files = [
        ("a.nii.gz", gzip(&[&nifti([1000, 1000, 60, 1]), &zeros])),
        ("b.nii.gz", gzip(&[&nifti([100, 100, 60, 100]), &zeros])),
        ("a.mgz", gzip(&[&mgh([1000, 1000, 60, 1]), &zeros])),
        ("a.nrrd", [nrrd("1000 1000 60", "gzip"), gzip(&[&zeros])].concat()),
        ("b.nrrd", [nrrd("1000 1000 60", "bzip2"), bzip2].concat()),
        ("a.mha", [metaimage("1000 1000 60", true), zlib(&zeros)].concat()),
        ("a.tif", tiff(60, [1000, 1000], 8, &zlib(&zeros[..1_000_000]))),
        ("b.tif", tiff(60, [1000, 1000], 32773, &pack_bits)),
    ];
    let little = ReadLimits { memory: 100 * MB, ..Default::default() };
    let enough = ReadLimits { memory: 130 * MB, ..Default::default() };
    for (name, bytes) in &files {
        assert!(bytes.len() < 1_000_000, "{name} is no bomb");
        let message = refusal(name, bytes, &little);
        assert!(message.contains("120 MB, more than the limit of 100 MB"), "{message}");
        assert!(message.contains("--memory-limit"), "{message}");
        let dims = read(name, bytes, &enough).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(dims.iter().product::<usize>(), if *name == "b.nii.gz" { 600_000 } else { 60_000_000 });
    }
    // What the program holds already counts.
    let held = ReadLimits { held: 20 * MB, ..enough };
    let message = refusal("a.nii.gz", &files[0].1, &held);
    assert!(message.contains("120 MB beside the 20 MB that the program holds"), "{message}");
}

#[test]
fn what_goes_on_behind_the_values_comes_to_an_end() {
    // 300 MB of zeros behind two voxels.
    let zeros = vec![0; MB as usize];
    let mut parts = vec![&zeros[..]; 300];
    let header = nifti([2, 1, 1, 1]);
    parts.insert(0, &header);
    let error = read("a.nii.gz", &gzip(&parts), &ReadLimits::default()).unwrap_err().to_string();
    assert!(error.contains("packed behind the values"), "{error}");
}

#[test]
fn a_page_is_no_larger_than_what_is_there() {
    // Its strip is said to hold 4 GB: no memory is taken for what the file does not have.
    let entry = |tag: u16, value: u32| {
        [&tag.to_le_bytes()[..], &4u16.to_le_bytes(), &1u32.to_le_bytes(), &value.to_le_bytes()].concat()
    };
    for method in [1, 5, 8, 32773] {
        let mut bytes = tiff(1, [60_000, 60_000], method, &[7; 1000]);
        let [old, new] = [entry(279, 1000), entry(279, u32::MAX)];
        let at = bytes.windows(12).position(|window| window == old).unwrap();
        bytes[at..at + 12].copy_from_slice(&new);
        let error = read("a.tif", &bytes, &ReadLimits::default()).unwrap_err().to_string();
        assert!(error.contains("promises 3600000000 bytes of values, but there are 1"), "{method}: {error}");
    }
}

#[test]
fn directories_that_share_their_bytes_do_not_fill_the_memory() {
    // 2000 pages, each with the whole of a file of 4 MB as the list of its strips: 8 GB.
    let strip = vec![0; 4_000_000];
    let mut bytes = tiff(2000, [1000, 1000], 1, &strip);
    let entry =
        [&273u16.to_le_bytes()[..], &4u16.to_le_bytes(), &1u32.to_le_bytes(), &8u32.to_le_bytes()].concat();
    let shared =
        [&273u16.to_le_bytes()[..], &4u16.to_le_bytes(), &1_000_000u32.to_le_bytes(), &8u32.to_le_bytes()];
    let shared = shared.concat();
    let mut at = 8 + strip.len();
    let mut changed = 0;
    while let Some(found) = bytes[at..].windows(12).position(|window| window == entry) {
        bytes[at + found..at + found + 12].copy_from_slice(&shared);
        at += found + 12;
        changed += 1;
    }
    assert_eq!(changed, 2000);
    let error = read("a.tif", &bytes, &ReadLimits::default()).unwrap_err().to_string();
    assert!(error.contains("the directories of its pages refer to"), "{error}");
}

#[test]
fn long_texts_and_tables_are_refused() {
    let limits = ReadLimits { memory: 20 * MB, ..Default::default() };
    let folder = tempfile::tempdir().unwrap();
    let sparse = |name: &str, start: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, start).unwrap();
        std::fs::File::options().write(true).open(&path).unwrap().set_len(4_000_000_000).unwrap();
        path
    };
    for encoding in ["ascii", "hex"] {
        let path = sparse(&format!("{encoding}.nrrd"), &nrrd("2 2 2", encoding));
        let error = read_volume(&path, &limits).unwrap_err().to_string();
        assert!(error.contains("its values are a long text"), "{error}");
    }
    let over =
        |error: VolumeIoError| assert!(error.to_string().contains("it has 4000000000 bytes"), "{error}");
    over(read_affine(&sparse("affine.npy", b"\x93NUMPY"), &limits).unwrap_err());
    over(read_affine(&sparse("affine.txt", b"1 0 0 0"), &limits).unwrap_err());
    over(read_label_names(&sparse("labels.csv", b"1,liver\n"), &limits).unwrap_err());
}

#[cfg(unix)]
#[test]
fn data_files_lie_in_the_folder_of_the_header() {
    use std::os::unix::fs::symlink;
    let root = tempfile::tempdir().unwrap();
    let at = |name: &str| root.path().join(name);
    std::fs::create_dir(at("in")).unwrap();
    for name in ["out.raw", "in/a.raw", "out.img"] {
        std::fs::write(at(name), [1, 0]).unwrap();
    }
    symlink(at("out.raw"), at("in/link.raw")).unwrap();
    symlink(at("out.img"), at("in/pair.img")).unwrap();
    let mut pair = nifti([2, 1, 1, 1]);
    pair[344..347].copy_from_slice(b"ni1");
    pair[108..112].copy_from_slice(&0f32.to_le_bytes());
    std::fs::write(at("in/pair.hdr"), &pair[..348]).unwrap();
    let absolute = at("out.raw").display().to_string();
    let strict = ReadLimits::default();
    let free = ReadLimits { allow_outside: true, ..Default::default() };
    let nhdr = |data: &str| {
        format!("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 1\nencoding: raw\ndata file: {data}\n")
    };
    let mhd = |data: &str| {
        format!("NDims = 3\nDimSize = 2 1 1\nElementType = MET_UCHAR\nElementDataFile = {data}\n")
    };
    let check = |path: &Path| {
        let error = read_volume(path, &strict).unwrap_err().to_string();
        assert!(error.contains("outside of its folder") && error.contains("--allow-outside"), "{error}");
        assert_eq!(read_volume(path, &free).unwrap().volume.samples().to_f64(), [1.0, 0.0]);
    };
    for data in ["../out.raw", "link.raw", &absolute, "LIST\n../out.raw"] {
        for (name, text) in [("in/a.nhdr", nhdr(data)), ("in/a.mhd", mhd(data))] {
            std::fs::write(at(name), text).unwrap();
            check(&at(name));
        }
    }
    check(&at("in/pair.hdr"));
    std::fs::write(at("in/a.nhdr"), nhdr("a.raw")).unwrap();
    assert!(read_volume(&at("in/a.nhdr"), &strict).is_ok());
    for special in ["/dev/zero", "/dev/null"] {
        std::fs::write(at("in/a.nhdr"), nhdr(special)).unwrap();
        let error = read_volume(&at("in/a.nhdr"), &free).unwrap_err().to_string();
        assert!(error.contains("no regular file"), "{error}");
    }
}

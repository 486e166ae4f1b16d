//! Volume files, one target for each format.

use std::io::Write;

use mser3d_fileio::ReadLimits;
use mser3d_volumeio::{BodyParameters, LoadedVolume, ValueCounts, read_volume};

use crate::scratch::{check_message, file};

#[path = "../../crates/volumeio/tests/it/good_files.rs"]
mod good_files;

/// Endings of names; an input's first byte chooses among them, and says whether the rest is to be packed by gzip: damaged bytes
/// rarely pass its checksum by themselves.
const ENDINGS: [&[&str]; 6] =
    [&["nii", "hdr", "nii.gz"], &["nrrd", "nhdr"], &["mha", "mhd"], &["mgh", "mgz"], &["tif"], &["npy"]];
pub const NIFTI: usize = 0;
pub const NRRD: usize = 1;
pub const METAIMAGE: usize = 2;
pub const MGH: usize = 3;
pub const TIFF: usize = 4;
pub const NPY: usize = 5;

/// Which bit of the first byte packs the rest.
const PACKED: u8 = 0x80;

pub fn run<const FORMAT: usize>(input: &[u8]) {
    let Some((&choice, bytes)) = input.split_first() else { return };
    let endings = ENDINGS[FORMAT];
    let ending = endings[usize::from(choice & !PACKED) % endings.len()];
    // What a header beside its data may name.
    static DATA: std::sync::Once = std::sync::Once::new();
    DATA.call_once(|| {
        file("volume.raw", &[1, 2, 3, 4, 5, 6, 7, 8]);
        file("volume.img", &[7; 64]);
        file("volume.raw.gz", &packed(&[9; 8]));
    });
    let packed_bytes;
    let bytes = if choice & PACKED == 0 {
        bytes
    } else {
        packed_bytes = packed(bytes);
        &packed_bytes[..]
    };
    let path = file(&format!("volume.{ending}"), bytes);
    // Less than an input may take, so that pages of nothing, which are legal, do not take all the time.
    let limits = ReadLimits { memory: 1 << 27, ..ReadLimits::default() };
    match read_volume(&path, &limits) {
        Ok(loaded) => check(&loaded),
        Err(error) => check_message(&error.to_string(), "volume."),
    }
}

/// What is read can be used: its values fit its size, and each label that is counted is a body of as many voxels.
fn check(loaded: &LoadedVolume) {
    let volume = &loaded.volume;
    let voxels = volume.dims().iter().product::<usize>();
    assert_eq!(volume.samples().len(), voxels * volume.channels());
    assert!(volume.affine().matrix().as_flattened().iter().all(|x| x.is_finite()));
    for channel in 0..volume.channels().min(2) {
        let counts = ValueCounts::of(volume, channel);
        assert!(counts.voxels_of(0.0) <= voxels as u64);
    }
    let _ = loaded.body(&BodyParameters::default()).map_err(|error| check_message(&error.to_string(), ""));
    if let Ok(labels) = loaded.labels(None) {
        let counted: u64 = labels.iter().map(|label| label.voxels).sum();
        // Labels of several layers may hold the same voxel.
        let most = (voxels * volume.channels()) as u64;
        assert!(counted <= most, "{counted} voxels have labels, of {most}");
    }
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(bytes).and_then(|()| packer.finish()).unwrap_or_default()
}

pub fn seeds<const FORMAT: usize>() -> Vec<Vec<u8>> {
    let mut seeds = Vec::new();
    let endings = ENDINGS[FORMAT];
    let mut add = |ending: &str, flag: u8, bytes: &[u8]| {
        if let Some(choice) = endings.iter().position(|known| *known == ending) {
            seeds.push([&[choice as u8 | flag][..], bytes].concat());
        }
    };
    for (name, bytes) in good_files::samples() {
        let ending = name.split_once('.').map_or("", |(_, ending)| ending);
        add(ending, 0, &bytes);
        let unpacked = ending.trim_end_matches(".gz");
        if unpacked == "nii" && !ending.ends_with("gz") {
            add("nii.gz", PACKED, &bytes);
            add("hdr", 0, &bytes);
        } else if unpacked == "mgh" {
            add("mgz", PACKED, &bytes);
        }
    }
    let nrrd = "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 1 2\nspace directions: \
        (0.5,0,0) (0,0.5,0) (0,0,2)\nspace origin: (10,20,30)\nendian: big\nencoding: raw\n";
    add("nhdr", 0, format!("{nrrd}data file: volume.raw\n").as_bytes());
    add("nhdr", 0, format!("{nrrd}data file: LIST\nvolume.raw\n").as_bytes());
    add("nhdr", 0, format!("{nrrd}byte skip: -1\nline skip: 1\ndatafile: volume.%d 1 2 1 2\n").as_bytes());
    let segments = "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 2 1 2\nspace: RAS\nspace directions: none (1,0,0) (0,1,0) \
        (0,0,1)\nspace origin: (0,0,0)\nkinds: list domain domain domain\nencoding: raw\nSegment0_ID:=a\n\
        Segment0_LabelValue:=1\nSegment0_Layer:=0\nSegment0_Name:=liver\n\n";
    add("nrrd", 0, &[segments.as_bytes(), b"\0\x01\x02\0\x01\x01\0\x02"].concat());
    for encoding in ["gzip", "bzip2", "text", "hex"] {
        let head = format!("NRRD0005\ntype: uint8\ndimension: 2\nsizes: 2 2\nencoding: {encoding}\n\n");
        add("nrrd", 0, &[head.as_bytes(), b"1 2 3 4"].concat());
    }
    let meta = "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_SHORT\nElementNumberOfChannels = 1\n\
        BinaryDataByteOrderMSB = True\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nElementSpacing = 1 1 2\nHeaderSize = 0\n\
        AnatomicalOrientation = RAI\n";
    add("mhd", 0, format!("{meta}ElementDataFile = volume.raw\n").as_bytes());
    add("mhd", 0, format!("{meta}ElementDataFile = LIST\nvolume.raw\nvolume.raw\n").as_bytes());
    add("mhd", 0, format!("{meta}ElementDataFile = volume.%d 1 2 1\n").as_bytes());
    add("mha", 0, format!("{meta}BinaryData = False\nElementDataFile = LOCAL\n1 2 3 4 5 6 7 8\n").as_bytes());
    let compressed =
        format!("{meta}CompressedData = True\nCompressedDataSize = 24\nElementDataFile = LOCAL\n");
    add("mha", 0, &[compressed.as_bytes(), &packed(&[1; 16])].concat());
    for (compression, data) in tiff_strips() {
        add("tif", 0, &tiff(compression, &data, 2));
    }
    seeds
}

/// Two pages of 4 x 2 pixels of one byte, with everything that changes how they are read.
fn tiff(compression: u32, strip: &[u8], pages: usize) -> Vec<u8> {
    let mut bytes = b"II\x2a\0\0\0\0\0".to_vec();
    let mut link = 4;
    for _ in 0..pages {
        let at = bytes.len() as u32;
        bytes.extend(strip);
        let description = bytes.len() as u32;
        bytes.extend(b"ImageJ=1.53\nslices=2\nspacing=2.0\nunit=um\n\0");
        let table = bytes.len() as u32;
        bytes[link..link + 4].copy_from_slice(&table.to_le_bytes());
        let length = strip.len() as u32;
        let entries = [
            (256u16, 4u32),
            (257, 2),
            (258, 8),
            (259, compression),
            (262, 1),
            (266, 1),
            (270, description),
            (273, at),
            (277, 1),
            (278, 2),
            (279, length),
            (284, 1),
            (317, 2),
            (339, 1),
        ];
        bytes.extend((entries.len() as u16).to_le_bytes());
        for (tag, value) in entries {
            let (kind, count) = if tag == 270 { (2u16, 43u32) } else { (4, 1) };
            bytes.extend(tag.to_le_bytes());
            bytes.extend(kind.to_le_bytes());
            bytes.extend(count.to_le_bytes());
            bytes.extend(value.to_le_bytes());
        }
        link = bytes.len();
        bytes.extend([0; 4]);
    }
    bytes
}

/// A strip of eight bytes, packed in each way.
fn tiff_strips() -> Vec<(u32, Vec<u8>)> {
    let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    let deflated = zlib.write_all(&[3; 8]).and_then(|()| zlib.finish()).unwrap_or_default();
    vec![
        (1, vec![1, 2, 3, 4, 5, 6, 7, 8]),
        (2, vec![0x2a; 8]),
        (3, vec![0, 0x10, 0x2a, 0x55, 0, 0x10, 1]),
        (4, vec![0x26, 0xa0, 0x01]),
        // Clear, eight literals of nine bits, end.
        (5, vec![0x80, 0x00, 0x40, 0x60, 0x50, 0x38, 0x08, 0x0c, 0x0a, 0x04]),
        (8, deflated),
        (32773, vec![0xf9, 7]),
    ]
}

use super::*;
use crate::Samples;

const FIELDS: &str = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = True\n\
    CompressedData = False\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 10 20 30\nCenterOfRotation = 0 0 0\n\
    AnatomicalOrientation = RAI\nElementSpacing = 2 3 4\nDimSize = 2 1 2\nElementType = MET_SHORT\n\
    ElementDataFile = ";

fn file(fields: &str, data: &[u8]) -> Vec<u8> {
    [fields.as_bytes(), data].concat()
}

fn read_bytes(bytes: &[u8]) -> Result<LoadedVolume, Fault> {
    parse(bytes, Path::new("nowhere/a.mha"), &ReadLimits::default())
}

#[test]
fn values_and_place_as_written() {
    let loaded = read_bytes(&file(&format!("{FIELDS}LOCAL\n"), &[0, 1, 255, 254, 0, 3, 1, 144])).unwrap();
    assert_eq!(*loaded.volume.samples(), Samples::I16(vec![1, -2, 3, 400]));
    // In LPS the first axis runs along y, the second against x.
    let affine = loaded.volume.affine();
    assert_eq!(affine.origin(), [-10., -20., 30.]);
    assert_eq!(affine.steps(), [[0., -2., 0.], [3., 0., 0.], [0., 0., 4.]]);
    assert_eq!((loaded.notes, &loaded.placed_by[..]), (vec![], "TransformMatrix, LPS turned to RAS"));
}

#[test]
fn components_stand_side_by_side_and_volumes_one_after_the_other() {
    let fields = "NDims = 4\nDimSize = 1 1 2 2\nElementNumberOfChannels = 2\nElementType = MET_UCHAR_ARRAY\n\
        BinaryData = False\nElementDataFile = LOCAL\n";
    let loaded = read_bytes(&file(fields, b"1 2 3 4\n5 6 7 8")).unwrap();
    assert_eq!((loaded.volume.dims(), loaded.volume.channels()), ([1, 1, 2], 4));
    assert_eq!(*loaded.volume.samples(), Samples::U8(vec![1, 2, 5, 6, 3, 4, 7, 8]));
}

#[test]
fn data_beside_the_header_in_one_file_or_many() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let mut packer = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    std::io::Write::write_all(&mut packer, &[0, 1, 255, 254, 0, 3, 1, 144]).unwrap();
    std::fs::write(at("a.zraw"), packer.finish().unwrap()).unwrap();
    std::fs::write(at("s0.raw"), [9, 9, 0, 1, 255, 254]).unwrap();
    std::fs::write(at("s1.raw"), [9, 9, 0, 3, 1, 144]).unwrap();
    let packed = FIELDS.replace("CompressedData = False", "CompressedData = True");
    let skipped = |size: i32| format!("HeaderSize = {size}\n{FIELDS}");
    for (name, text) in [
        ("a.mhd", format!("{packed}a.zraw\n")),
        ("b.mhd", format!("{}s%d.raw 0 1 1\n", skipped(2))),
        ("c.mhd", format!("{}LIST\ns0.raw\ns1.raw\n", skipped(-1))),
    ] {
        std::fs::write(at(name), text).unwrap();
        let loaded = read(&at(name), &ReadLimits::default()).unwrap();
        assert_eq!(*loaded.volume.samples(), Samples::I16(vec![1, -2, 3, 400]), "{name}");
    }
    for (last, says) in [
        ("other.raw", "other.raw that it names is missing"),
        ("/tmp/x.raw", "outside of its folder"),
        ("LIST\ns0.raw", "data file s0.raw: the header promises 8 bytes"),
        ("LIST\ns0.raw\ns0.raw\ns1.raw", "3 files"),
        ("s%d.raw 0 x 1", "pattern"),
    ] {
        std::fs::write(at("d.mhd"), format!("{FIELDS}{last}")).unwrap();
        let error = read(&at("d.mhd"), &ReadLimits::default()).unwrap_err().in_file(&at("d.mhd")).to_string();
        assert!(error.contains(says), "{error}");
    }
}

#[test]
fn damaged_files_are_errors() {
    let whole = file(&format!("{FIELDS}LOCAL\n"), &[0; 8]);
    for length in 0..whole.len() {
        assert!(read_bytes(&whole[..length]).is_err(), "{length} bytes");
    }
    for (wrong, right, says) in [
        ("NDims = 7", "NDims = 3", "NDims"),
        ("DimSize = 2 1", "DimSize = 2 1 2", "3 numbers"),
        ("DimSize = 2 1 900000", "DimSize = 2 1 2", "promises"),
        ("DimSize = 0 1 2", "DimSize = 2 1 2", "empty"),
        ("ElementSpacing = 0 1 2", "ElementSpacing = 2 3 4", "no length"),
        ("MET_COLOR", "MET_SHORT", "MET_FLOAT"),
        ("hello", "ObjectType = Image", "no line of a header"),
        ("CompressedData = True", "CompressedData = False", "damaged"),
    ] {
        let text = format!("{FIELDS}LOCAL\n").replace(right, wrong);
        let error = read_bytes(&file(&text, &[0; 8])).unwrap_err().in_file(Path::new("a.mha")).to_string();
        assert!(error.contains(says), "{error}");
    }
}

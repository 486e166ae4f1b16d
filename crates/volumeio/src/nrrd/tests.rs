use super::*;
use crate::{Samples, Segment};

fn file(fields: &str, data: &[u8]) -> Vec<u8> {
    [format!("NRRD0004\n# made by hand\n{fields}\n\n").as_bytes(), data].concat()
}

fn read_bytes(bytes: &[u8]) -> Result<LoadedVolume, Fault> {
    parse(bytes, Path::new("nowhere/a.nrrd"), &ReadLimits::default())
}

const FIELDS: &str = "type: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 1 2\n\
    space directions: (0.5,0,0) (0,0.5,0) (0,0,2)\nspace origin: (10,20,30)\nendian: big\nencoding: raw";
const DATA: [u8; 8] = [0, 1, 255, 254, 0, 3, 1, 144];

fn values() -> Samples {
    Samples::I16(vec![1, -2, 3, 400])
}

#[test]
fn values_and_place_as_written() {
    let loaded = read_bytes(&file(FIELDS, &DATA)).unwrap();
    assert_eq!(*loaded.volume.samples(), values());
    assert_eq!(loaded.volume.affine().spacing(), [0.5, 0.5, 2.0]);
    assert_eq!(loaded.volume.affine().position([1.0, 0.0, 1.0]), [-10.5, -20.0, 32.0]);
    assert_eq!(loaded.placed_by, "space directions, LPS turned to RAS");
    assert!(loaded.notes.is_empty());
}

#[test]
fn every_space_says_what_its_axes_are() {
    for (space, there, world) in [
        ("RAS", [10., 20., 30.], "x right"),
        ("left-anterior-superior", [-10., 20., 30.], "x right"),
        ("LPS", [-10., -20., 30.], "x right"),
        ("scanner-xyz", [10., 20., 30.], "the file's own"),
        ("3D-left-handed", [10., 20., 30.], "the file's own"),
    ] {
        let fields = FIELDS.replace("left-posterior-superior", space) + "\nspace units: \"mm\" \"mm\" \"mm\"";
        let loaded = read_bytes(&file(&fields, &DATA)).unwrap();
        assert_eq!(loaded.volume.affine().origin(), there, "{space}");
        let told = loaded.world.to_string();
        assert!(told.starts_with(world) && told.ends_with("in mm"), "{told}");
        assert_eq!(loaded.notes.len(), usize::from(space == "3D-left-handed"));
    }
    // In time too: the fourth axis and coordinate are no place.
    let fields = FIELDS
        .replace("left-posterior-superior", "left-posterior-superior-time")
        .replace("dimension: 3", "dimension: 4")
        .replace("2 1 2", "2 1 1 2")
        .replace("(0.5,0,0) (0,0.5,0) (0,0,2)", "(0.5,0,0,0) (0,0.5,0,0) (0,0,2,0) (0,0,0,3)")
        .replace("(10,20,30)", "(10,20,30,5)");
    let loaded = read_bytes(&file(&fields, &DATA)).unwrap();
    assert_eq!((loaded.volume.dims(), loaded.volume.channels()), ([2, 1, 1], 2));
    assert_eq!(loaded.volume.affine().origin(), [-10., -20., 30.]);
}

#[test]
fn channels_may_stand_on_any_axis() {
    let fields = |sizes: &str, directions: &str, kinds: &str| {
        format!(
            "type: uchar\ndimension: 4\nsizes: {sizes}\nspace directions: {directions}\nkinds: {kinds}\nencoding: ascii"
        )
    };
    let read = |sizes: &str, directions: &str, kinds: &str, data: &str| {
        read_bytes(&file(&fields(sizes, directions, kinds), data.as_bytes())).unwrap()
    };
    let d = "domain";
    let first =
        read("2 3 1 1", "none (1,0,0) (0,1,0) (0,0,1)", &format!("vector {d} {d} {d}"), "1 10 2 20 3 30");
    let mid =
        read("3 2 1 1", "(1,0,0) none (0,1,0) (0,0,1)", &format!("{d} 2-color {d} {d}"), "1 2 3 10 20 30");
    let last =
        read("3 1 1 2", "(1,0,0) (0,1,0) (0,0,1) none", &format!("{d} {d} {d} list"), "1 2 3 10 20 30");
    for loaded in [&first, &mid, &last] {
        assert_eq!((loaded.volume.dims(), loaded.volume.channels()), ([3, 1, 1], 2));
        assert_eq!(*loaded.volume.samples(), Samples::U8(vec![1, 10, 2, 20, 3, 30]));
    }
    assert_eq!((first.channels, mid.channels), (ChannelKind::Volumes, ChannelKind::Colours));
    // Without directions: by the kinds, by the spacings, or a guess that is noted.
    let plain = |more: &str| {
        let text = format!("type: uchar\ndimension: 4\nsizes: 3 2 1 1\nencoding: ascii\n{more}");
        let loaded = read_bytes(&file(&text, b"1 2 3 10 20 30")).unwrap();
        (loaded.volume.dims(), loaded.volume.channels(), loaded.notes.len())
    };
    assert_eq!(plain("kinds: domain list domain domain"), ([3, 1, 1], 2, 0));
    assert_eq!(plain("spacings: 1 nan 1 1"), ([3, 1, 1], 2, 0));
    assert_eq!(plain("kinds: domain domain domain time"), ([3, 2, 1], 1, 0));
    assert_eq!(plain(""), ([3, 2, 1], 1, 1));
}

#[test]
fn spacings_and_ends_of_axes_place_too() {
    let text = "type: uchar\ndimension: 3\nsizes: 2 2 1\nencoding: hex\n";
    let affine = |more: &str| {
        let loaded = read_bytes(&file(&format!("{text}{more}"), b"0aff 00 7")).unwrap_err();
        assert!(loaded.in_file(Path::new("a")).to_string().contains("promises 4 bytes"));
        let loaded = read_bytes(&file(&format!("{text}{more}"), b"0aff 00\n7F")).unwrap();
        assert_eq!(*loaded.volume.samples(), Samples::U8(vec![10, 255, 0, 127]));
        (loaded.volume.affine().origin(), loaded.volume.affine().spacing(), loaded.placed_by)
    };
    let (origin, spacing, by) = affine("spacings: 2 3 4");
    assert_eq!((origin, spacing, &by[..9]), ([0.0; 3], [2., 3., 4.], "spacings "));
    let ends = "axis mins: 0 10 nan\naxis maxs: 4 13 nan\n";
    let (origin, spacing, _) = affine(&format!("{ends}centers: cell node ???"));
    assert_eq!((origin, spacing), ([1., 10., 0.], [2., 3., 1.]));
    assert_eq!(affine("").2, "nothing: voxels of size 1");
}

#[test]
fn an_image_stands_in_space_as_its_axes_say() {
    let fields = FIELDS
        .replace("dimension: 3", "dimension: 2")
        .replace("2 1 2", "2 2")
        .replace("(0.5,0,0) (0,0.5,0) (0,0,2)", "(0,0.5,0) (0,0,2)");
    let loaded = read_bytes(&file(&fields, &DATA)).unwrap();
    assert_eq!(loaded.volume.dims(), [2, 2, 1]);
    assert_eq!(loaded.volume.affine().steps()[2].map(f64::abs), [1., 0., 0.]);
}

#[test]
fn segments_have_names_values_and_layers() {
    let fields = FIELDS.replace("short", "uchar")
        + "\nSegment0_ID:=a\nSegment0_Name:=left: lung\nSegment0_LabelValue:=3\n\
        Segment0_Layer:=0\nSegment10_ID:=b\nSegment10_LabelValue:=4\nSegment10_Layer:=7\nSegmentation_Source:=x";
    let loaded = read_bytes(&file(&fields, &DATA)).unwrap();
    assert_eq!(loaded.segments, [Segment { value: 3, layer: 0, name: "left: lung".into() }]);
    assert!(loaded.notes[0].contains("segment 10 (b) is left out"), "{:?}", loaded.notes);
    let layers = fields
        .replace("dimension: 3", "dimension: 4")
        .replace("2 1 2", "2 2 1 2")
        .replace("directions: ", "directions: none ")
        .replace("Segment10_Layer:=7\n", "")
        .replace("Segment10", "Segment1");
    let loaded = read_bytes(&file(&layers, &DATA)).unwrap();
    assert_eq!(loaded.channels, ChannelKind::Layers);
    assert_eq!(loaded.segments[1], Segment { value: 4, layer: 1, name: "b".into() });
}

#[test]
fn data_beside_the_header_in_every_encoding() {
    use std::io::Write;
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let put = |name: &str, bytes: &[u8]| std::fs::write(at(name), bytes).unwrap();
    let mut gzip = flate2::write::GzEncoder::new(b"line\n".to_vec(), flate2::Compression::default());
    gzip.write_all(&[&[7, 7][..], &DATA].concat()).unwrap();
    put("a.raw.gz", &gzip.finish().unwrap());
    let mut bzip = bzip2::write::BzEncoder::new(Vec::new(), bzip2::Compression::default());
    bzip.write_all(&DATA).unwrap();
    put("a.bz2", &bzip.finish().unwrap());
    put("a.raw", &[&[9; 5][..], &DATA].concat());
    put("s-01.raw", &DATA[..4]);
    put("s-02.raw", &DATA[4..]);
    let with = |encoding: &str, more: &str| format!("{}\n{more}\n", FIELDS.replace("raw", encoding));
    for (name, fields) in [
        ("gz", with("gzip", "line skip: 1\nbyteskip: 2\ndata file: a.raw.gz")),
        ("bz2", with("bz2", "datafile: a.bz2")),
        ("end", with("raw", "byte skip: -1\ndata file: a.raw")),
        ("list", with("raw", "data file: LIST\ns-01.raw\ns-02.raw")),
        ("pattern", with("raw", "data file: s-%02d.raw 1 2 1 2")),
    ] {
        // No empty line need stand at the end.
        put("a.nhdr", format!("NRRD0005\n{fields}").as_bytes());
        let loaded = super::read(&at("a.nhdr"), &ReadLimits::default())
            .unwrap_or_else(|e| panic!("{name}: {}", e.in_file(Path::new("a"))));
        assert_eq!(*loaded.volume.samples(), values(), "{name}");
    }
    for (fields, says) in [
        (with("raw", "data file: b.raw"), "b.raw that it names is missing"),
        (with("raw", "data file: /a.raw"), "outside of its folder"),
        (with("raw", "data file: s-01.raw"), "data file s-01.raw: the header promises 8"),
        (with("raw", "data file: LIST"), "empty"),
        (with("raw", "data file: LIST\na.raw\na.raw\na.raw"), "3 files"),
        (with("raw", "line skip: 4\ndata file: a.raw"), "line skip"),
    ] {
        put("a.nhdr", format!("NRRD0005\n{fields}").as_bytes());
        let error = super::read(&at("a.nhdr"), &ReadLimits::default())
            .unwrap_err()
            .in_file(&at("a.nhdr"))
            .to_string();
        assert!(error.contains(says), "{error}");
    }
}

#[test]
fn what_is_not_read_says_why() {
    for (wrong, right, says) in [
        ("encoding: lzma", "encoding: raw", "raw or gzip"),
        ("type: block", "type: short", "float"),
        ("sizes: 2 1", "sizes: 2 1 2", "axes"),
        ("sizes: 2 1 900000", "sizes: 2 1 2", "promises"),
        ("sizes: 0 1 2", "sizes: 2 1 2", "empty"),
        ("space origin: 1 2 3", "space origin: (10,20,30)", "(x,y,z)"),
        ("(1,0,0)", "(0,0.5,0)", "plane"),
        ("byte skip: -1", "endian: big", "order of bytes"),
        ("endian: big\nbyte skip: -1", "endian: big", "byte skip -1"),
    ] {
        let bytes = file(&FIELDS.replace(right, wrong), &DATA);
        let error = read_bytes(&bytes).unwrap_err().in_file(Path::new("a.nrrd")).to_string();
        assert!(error.contains(says), "{error}");
    }
    assert!(read_bytes(b"P5").is_err());
    let whole = file(FIELDS, &DATA);
    for length in 0..whole.len() {
        assert!(read_bytes(&whole[..length]).is_err(), "{length} bytes");
    }
}

use super::write::header;
use super::*;
use crate::Affine;

fn file(volume: &Volume) -> Vec<u8> {
    let mut bytes = header(volume, Some("mm"));
    volume.samples().write(&mut bytes).unwrap();
    bytes
}

fn small() -> Volume {
    Volume::new([2, 1, 2], 1, Affine::default(), vec![1i16, -2, 3, 400]).unwrap()
}

fn put(bytes: &mut [u8], at: usize, field: &[u8]) {
    bytes[at..at + field.len()].copy_from_slice(field);
}

fn read_bytes(bytes: &[u8]) -> Result<LoadedVolume, Fault> {
    let mut source = bytes;
    let header = Header::read(&mut source)?;
    volume(header, source, &ReadLimits::default())
}

#[test]
fn scaled_values_are_what_they_mean() {
    let mut bytes = file(&small());
    put(&mut bytes, 112, &0.5f32.to_le_bytes());
    put(&mut bytes, 116, &10f32.to_le_bytes());
    let loaded = read_bytes(&bytes).unwrap();
    assert_eq!(*loaded.volume.samples(), Samples::F64(vec![10.5, 9.0, 11.5, 210.0]));
    assert!(loaded.notes[0].contains("0.5 x stored + 10"), "{:?}", loaded.notes);
}

#[test]
fn sform_then_qform_then_pixdim_places_the_voxels() {
    let affine = Affine::new([[0., -3., 0., 7.], [2., 0., 0., 8.], [0., 0., 4., 9.]]).unwrap();
    let volume = small().with_affine(affine);
    let mut bytes = file(&volume);
    let by_sform = read_bytes(&bytes).unwrap();
    assert_eq!((by_sform.volume, &by_sform.placed_by[..]), (volume, "sform (scanner)"));
    assert_eq!(by_sform.world.to_string(), "x right, y anterior, z superior (RAS+), in mm");
    assert!(by_sform.notes.is_empty());

    put(&mut bytes, 254, &0i16.to_le_bytes());
    put(&mut bytes, 252, &4i16.to_le_bytes());
    let by_qform = read_bytes(&bytes).unwrap();
    assert_eq!(by_qform.placed_by, "qform (MNI 152)");
    let there = by_qform.volume.affine().position([1.0, 1.0, 1.0]);
    let away = (0..3).map(|i| (there[i] - [4., 10., 13.][i]).abs()).fold(0.0, f64::max);
    assert!(away < 1e-6, "{there:?}");

    put(&mut bytes, 252, &0i16.to_le_bytes());
    let by_pixdim = read_bytes(&bytes).unwrap();
    assert_eq!(by_pixdim.volume.affine().position([1.0; 3]), [2., 3., 4.]);
    assert_eq!(by_pixdim.world.to_string(), "the file's own axes, in mm");
    assert!(by_pixdim.placed_by.contains("pixdim alone") && by_pixdim.notes[0].contains("neither"));
}

#[test]
fn statements_that_disagree_or_are_unusable_are_noted() {
    let bytes = file(&small());
    for (at, field, by, says) in [
        (268, 3f32.to_le_bytes(), "sform", "disagree by up to 3.000 (3.0 voxels)"),
        (280, f32::NAN.to_le_bytes(), "qform", "sform is left out"),
        (280, 0f32.to_le_bytes(), "qform", "no length"),
        (84, 0f32.to_le_bytes(), "sform", ""),
    ] {
        let mut bytes = bytes.clone();
        put(&mut bytes, at, &field);
        let loaded = read_bytes(&bytes).unwrap();
        assert!(loaded.placed_by.starts_with(by), "{}", loaded.placed_by);
        assert!(says.is_empty() == loaded.notes.is_empty(), "{:?}", loaded.notes);
        assert!(loaded.notes.iter().all(|note| note.contains(says)), "{:?}", loaded.notes);
    }
}

#[test]
fn far_origins_and_long_axes_are_written_as_version_2() {
    let far = Affine::along_axes([4e6 + 0.2, 0.1, 0.0], [0.1; 3]).unwrap();
    let long = Volume::new([40_000, 1, 1], 1, Affine::default(), vec![0u8; 40_000]).unwrap();
    for volume in [small().with_affine(far), long] {
        let bytes = file(&volume);
        assert_eq!(bytes[..4], 540i32.to_le_bytes());
        let loaded = read_bytes(&bytes).unwrap();
        assert_eq!(loaded.volume, volume);
        assert_eq!(loaded.world.unit.as_deref(), Some("mm"));
        assert!(loaded.notes.is_empty());
    }
    let near = Affine::along_axes([4e3, 0.1, 0.0], [0.5; 3]).unwrap();
    assert_eq!(file(&small().with_affine(near))[..4], 348i32.to_le_bytes());
}

#[test]
fn a_shear_has_no_qform() {
    let sheared = Affine::new([[1., 0.5, 0., 0.], [0., 1., 0., 0.], [0., 0., 1., 0.]]).unwrap();
    // Turned by a right angle: wide enough for the shear to matter.
    let bytes = file(&Volume::new([2, 2, 1], 1, sheared, vec![0u8; 4]).unwrap());
    assert_eq!((bytes[252], bytes[254]), (0, 1));
    assert_eq!(*read_bytes(&bytes).unwrap().volume.affine(), sheared);
    assert_eq!(file(&small())[252], 1);
}

#[test]
fn both_byte_orders_and_version_2() {
    let mut bytes = vec![0u8; LENGTH_2];
    put(&mut bytes, 0, &540i32.to_be_bytes());
    put(&mut bytes, 4, b"n+2\0\r\n\x1a\n");
    put(&mut bytes, 12, &4i16.to_be_bytes());
    for (i, size) in [4i64, 2, 1, 2, 0].into_iter().enumerate() {
        put(&mut bytes, 16 + 8 * i, &size.to_be_bytes());
    }
    put(&mut bytes, 168, &544i64.to_be_bytes());
    bytes.extend([0; 4]);
    [1i16, -2, 3, 400].iter().for_each(|x| bytes.extend(x.to_be_bytes()));
    let loaded = read_bytes(&bytes).unwrap();
    assert_eq!(loaded.volume, small());
    for says in ["axis 4 has the length 0", "pixdim is", "neither sform nor qform"] {
        assert!(loaded.notes.iter().any(|note| note.contains(says)), "{:?}", loaded.notes);
    }
}

#[test]
fn pairs_are_read_from_either_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let whole = file(&small());
    let mut head = whole[..348].to_vec();
    put(&mut head, 344, b"ni1\0");
    put(&mut head, 108, &0f32.to_le_bytes());
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    std::io::Write::write_all(&mut packer, &whole[352..]).unwrap();
    std::fs::write(at("a.HDR"), &head).unwrap();
    std::fs::write(at("a.IMG"), &whole[352..]).unwrap();
    std::fs::write(at("b.hdr"), &head).unwrap();
    std::fs::write(at("b.img.gz"), packer.finish().unwrap()).unwrap();
    for name in ["a.HDR", "a.IMG", "b.hdr", "b.img.gz"] {
        let loaded = read(&at(name), &ReadLimits::default()).unwrap();
        assert_eq!((loaded.volume, loaded.notes), (small(), vec![]), "{name}");
    }
    std::fs::remove_file(at("b.hdr")).unwrap();
    std::fs::remove_file(at("a.IMG")).unwrap();
    for (name, says) in [("b.img.gz", "its header, b.hdr"), ("a.HDR", "its data, a.IMG")] {
        let error = read(&at(name), &ReadLimits::default()).unwrap_err().in_file(&at(name)).to_string();
        assert!(error.contains(says), "{error}");
    }
    // Analyze 7.5 has no letters there, and SPM's slope.
    put(&mut head, 344, &[0; 4]);
    put(&mut head, 112, &2f32.to_le_bytes());
    std::fs::write(at("c.hdr"), &head).unwrap();
    std::fs::write(at("c.img"), &whole[352..]).unwrap();
    let loaded = read(&at("c.img"), &ReadLimits::default()).unwrap();
    assert_eq!(*loaded.volume.samples(), Samples::F64(vec![2.0, -4.0, 6.0, 800.0]));
    assert!(loaded.notes[0].contains("left and right"), "{:?}", loaded.notes);
    // The header of a pair is no whole file.
    put(&mut head, 344, b"ni1\0");
    std::fs::write(at("d.nii"), &head).unwrap();
    assert!(
        matches!(read(&at("d.nii"), &ReadLimits::default()), Err(Fault::Unsupported(reason)) if reason.contains(".hdr"))
    );
}

#[test]
fn damaged_files_are_errors() {
    let whole = file(&small());
    for length in 0..whole.len() {
        assert!(read_bytes(&whole[..length]).is_err(), "{length} bytes");
    }
    for (at, field, says) in [
        (0, &[9u8, 9][..], "not a NIfTI file"),
        (344, b"n+2", "length of NIfTI-1"),
        (40, &[9, 0], "9 axes"),
        (42, &[0, 0], "length 0"),
        (42, &[255, 127], "promises"),
        (70, &[32, 0], "type 32"),
    ] {
        let mut bytes = whole.clone();
        put(&mut bytes, at, field);
        let error = read_bytes(&bytes).unwrap_err().in_file(Path::new("a.nii")).to_string();
        assert!(error.contains(says), "{error}");
    }
}

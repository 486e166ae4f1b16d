//! Whole files: what is written is read again, and what is damaged is an error, not a panic.

use std::path::Path;

use mser3d_fileio::FileError;
use mser3d_shape::{BitGrid, ShapeError};
use mser3d_volumeio::{
    Affine, Samples, Volume, VolumeFormat, VolumeIoError, read_volume, write_nifti, write_npy,
};
use proptest::prelude::*;

use crate::good_files::{of_every_type, placed, samples};

#[test]
fn volumes_survive_a_round_trip() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for values in of_every_type() {
        for (dims, channels) in [([2, 3, 2], 1), ([1, 3, 2], 2)] {
            let volume = Volume::new(dims, channels, placed(), values.clone()).unwrap();
            for name in ["a.nii", "a.nii.gz"] {
                write_nifti(&path(name), &volume).unwrap();
                assert_eq!(
                    read_volume(&path(name), &Default::default()).unwrap().volume,
                    volume,
                    "{name} {}",
                    values.type_name()
                );
            }
            write_npy(&path("a.npy"), &volume).unwrap();
            let flat = Volume::new(dims, channels, Affine::default(), values.clone()).unwrap();
            assert_eq!(
                read_volume(&path("a.npy"), &Default::default()).unwrap().volume,
                flat,
                "{}",
                values.type_name()
            );
        }
    }
}

#[test]
fn a_channel_is_a_volume_and_a_mask_another() {
    let volume = Volume::new([2, 1, 2], 2, placed(), vec![1u8, 2, 3, 4, 5, 6, 7, 8]).unwrap();
    assert_eq!(*volume.channel(1).samples(), Samples::U8(vec![2, 4, 6, 8]));
    assert_eq!(*volume.channel(1).affine(), placed());
    assert_eq!(volume.channel(0).channel(0), volume.channel(0));
    let mut mask = BitGrid::empty([2, 1, 2]).unwrap();
    mask.set([1, 0, 0], true);
    let written = Volume::from_mask(&mask, placed()).unwrap();
    assert_eq!(*written.samples(), Samples::U8(vec![0, 1, 0, 0]));
    assert_eq!(volume.frame().unwrap().centre([0, 0, 0]), placed().origin());
}

#[test]
fn a_sheared_volume_has_no_frame() {
    let sheared = Affine::new([[1., 0.5, 0., 0.], [0., 1., 0., 0.], [0., 0., 1., 0.]]).unwrap();
    let volume = Volume::new([1, 1, 1], 1, sheared, vec![1u8]).unwrap();
    assert!(matches!(volume.frame(), Err(ShapeError::Sheared { .. })));
}

#[test]
fn what_cannot_be_is_refused() {
    for (dims, channels, affine, count) in [
        ([2, 2, 2], 1, Affine::default(), 7),
        ([2, 0, 2], 1, Affine::default(), 0),
        ([usize::MAX, 2, 2], 1, Affine::default(), 4),
    ] {
        let volume = Volume::new(dims, channels, affine, vec![0u8; count]);
        assert!(matches!(volume, Err(VolumeIoError::InvalidVolume { .. })));
    }
    assert!(matches!(
        read_volume(Path::new("a.obj"), &Default::default()),
        Err(VolumeIoError::UnknownFormat { .. })
    ));
    assert!(matches!(
        read_volume(Path::new("nowhere/a.nii"), &Default::default()),
        Err(VolumeIoError::File(FileError::Read { .. }))
    ));
}

#[test]
fn a_file_that_is_cut_short_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in samples() {
        let path = folder.path().join(name);
        for length in (0..=bytes.len()).rev() {
            std::fs::write(&path, &bytes[..length]).unwrap();
            let read = read_volume(&path, &Default::default());
            assert_eq!(read.is_ok(), length == bytes.len(), "{name}: {length} of {} bytes", bytes.len());
        }
    }
}

#[test]
fn a_wrong_checksum_is_an_error_and_padding_is_not() {
    let folder = tempfile::tempdir().unwrap();
    for (name, whole) in
        samples().into_iter().filter(|(name, _)| matches!(*name, "b.nii.gz" | "a.mgz" | "b.nrrd"))
    {
        let path = folder.path().join(name);
        std::fs::write(&path, [&whole[..], &[0; 512]].concat()).unwrap();
        read_volume(&path, &Default::default()).unwrap();
        let mut damaged = whole;
        let at = damaged.len() - 8;
        damaged[at] ^= 1;
        std::fs::write(&path, damaged).unwrap();
        let error = read_volume(&path, &Default::default()).unwrap_err().to_string();
        assert!(error.contains("damaged data"), "{error}");
    }
}

#[test]
fn endings_say_the_format_in_any_case() {
    for (name, format) in [
        ("A.NII.GZ", VolumeFormat::Nifti),
        ("a.hdr", VolumeFormat::Nifti),
        ("a.img.gz", VolumeFormat::Nifti),
        ("a.seg.nrrd", VolumeFormat::Nrrd),
        ("a.nhdr", VolumeFormat::Nrrd),
        ("a.MHD", VolumeFormat::MetaImage),
        ("a.mgz", VolumeFormat::Mgh),
        ("a.ome.tif", VolumeFormat::Tiff),
    ] {
        assert_eq!(VolumeFormat::of(Path::new(name)), Some(format), "{name}");
    }
    assert_eq!(VolumeFormat::of(Path::new("a.gz")), None);
    // What users are told is what there is.
    for ending in VolumeFormat::LIST.split([' ', ',']).filter(|word| word.starts_with('.')) {
        assert!(VolumeFormat::of(Path::new(&format!("a{ending}"))).is_some(), "{ending}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn damaged_files_are_read_or_refused(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let folder = tempfile::tempdir().unwrap();
        for (name, mut bytes) in samples() {
            for (at, byte) in &changes {
                let at = at.index(bytes.len());
                bytes[at] = *byte;
            }
            if let Some(cut) = cut {
                bytes.truncate(cut.index(bytes.len()));
            }
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            if let Err(error) = read_volume(&path, &Default::default()) {
                prop_assert!(error.to_string().contains(name), "{error}");
            }
        }
    }
}

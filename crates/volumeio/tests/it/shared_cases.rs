//! Files that other programs read wrongly or not at all, from `../shared/cases`; expected values are those of nibabel,
//! pynrrd, tifffile and NumPy.

use mser3d_volumeio::{ChannelKind, LoadedVolume, Volume, read_volume};
use std::path::{Path, PathBuf};

/// A file of the cases, if they are there.
fn case(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/cases").join(name);
    if !path.is_file() {
        eprintln!("skipped: {name} is not there");
        return None;
    }
    Some(path)
}

fn load(name: &str) -> Option<LoadedVolume> {
    let path = case(name)?;
    Some(read_volume(&path, &Default::default()).unwrap_or_else(|error| panic!("{error}")))
}

/// How many voxels of a channel are not zero, and the mean of their places.
fn body(volume: &Volume) -> (usize, [f64; 3]) {
    let [nx, ny, _] = volume.dims();
    let (mut count, mut sum) = (0, [0.0; 3]);
    for v in volume.samples().nonzero() {
        let there = volume.affine().position([v % nx, v / nx % ny, v / (nx * ny)].map(|i| i as f64));
        (0..3).for_each(|i| sum[i] += there[i]);
        count += 1;
    }
    (count, sum.map(|x| x / count as f64))
}

#[test]
fn a_body_is_where_its_file_says() {
    for (name, place, by) in [
        ("nifti_orientation/las.nii.gz", [77.245, -112.8838, -44.245], "sform (scanner)"),
        ("nifti_orientation/oblique.nii.gz", [3.3067, 40.0103, 25.5482], "sform (scanner)"),
        (
            "nifti_orientation/slicer_lps.nrrd",
            [-17.0861, -28.7441, 52.204],
            "space directions, LPS turned to RAS",
        ),
        ("tiff_spacing/ij.tif", [7.0861, 7.2868, 22.204], "ImageJ's spacing and the resolution"),
        ("tiff_spacing/ome.ome.tif", [7.0861, 7.2868, 22.204], "OME's PhysicalSize"),
        ("tiff_1bit/bool.tif", [14.1722, 14.5736, 11.102], "nothing: voxels of size 1"),
        ("tiff_1bit/pil1.tif", [14.1722, 14.5736, 11.102], "nothing: voxels of size 1"),
        ("tiff_inverted_lut/miniswhite.tif", [14.1722, 14.5736, 11.102], "nothing: voxels of size 1"),
        ("mask_formats_hint/pair.hdr", [14.1722, 14.5736, 11.102], "sform (aligned to another scan)"),
        ("mask_formats_hint/pair.img", [14.1722, 14.5736, 11.102], "sform (aligned to another scan)"),
        ("batch_folder_masks/u8.npy", [14.1722, 14.5736, 11.102], "nothing: voxels of size 1"),
    ] {
        let Some(loaded) = load(name) else { return };
        let (count, found) = body(&loaded.volume);
        assert_eq!((count, loaded.volume.dims()), (2392, [30, 40, 24]), "{name}");
        assert!((0..3).all(|i| (found[i] - place[i]).abs() < 1e-3), "{name}: {found:?}");
        assert_eq!(loaded.placed_by, by, "{name}");
    }
}

#[test]
fn channels_are_kept_apart_and_said() {
    let Some(loaded) = load("mask_labels_4d/4d2.nii") else { return };
    assert_eq!((loaded.channels, loaded.volume.channels()), (ChannelKind::Volumes, 2));
    assert_eq!([0, 1].map(|c| body(&loaded.volume.channel(c)).0), [2392, 2392]);
    let Some(loaded) = load("mask_labels_4d/two.seg.nrrd") else { return };
    assert_eq!((loaded.channels, loaded.volume.channels()), (ChannelKind::Layers, 2));
    assert_eq!([0, 1].map(|c| body(&loaded.volume.channel(c)).0), [2392, 2392]);
    let segments: Vec<_> = loaded.segments.iter().map(|s| (s.value, s.layer, &s.name[..])).collect();
    assert_eq!(segments, [(1, 0, "a"), (1, 1, "b")]);
    let Some(loaded) = load("mask_labels_4d/labels.nii") else { return };
    let count = |label: f64| loaded.volume.samples().to_f64().into_iter().filter(|&x| x == label).count();
    assert_eq!([0.0, 1.0, 2.0, 3.0].map(count), [26408, 1440, 792, 160]);
}

#[test]
fn stacks_are_whole_and_what_is_guessed_is_noted() {
    let Some(loaded) = load("tiff_one_ifd/imagej_like_over_4gb.tif") else { return };
    assert_eq!((loaded.volume.dims(), body(&loaded.volume).0), ([30, 40, 24], 9600));
    assert!(loaded.notes[0].contains("24 images"), "{:?}", loaded.notes);
    let Some(loaded) = load("tiff_inverted_lut/miniswhite.tif") else { return };
    assert!(loaded.notes[0].contains("white is stored as 0"), "{:?}", loaded.notes);
}

#[test]
fn a_header_without_its_data_says_what_is_missing() {
    let Some(path) = case("mask_formats_hint/det.nhdr") else { return };
    let error = read_volume(&path, &Default::default()).unwrap_err().to_string();
    assert!(error.contains("det.nhdr: the file det.raw.gz that it names is missing"), "{error}");
}

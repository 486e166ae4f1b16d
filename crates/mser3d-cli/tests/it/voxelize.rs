//! `mser3d voxelize`, and masks that come back as solids.

use crate::common::*;
use mser3d_volumeio::{Volume, read_volume};
use std::path::Path;

/// How many voxels are inside.
fn inside(volume: &Volume) -> usize {
    volume.samples().nonzero().count()
}

fn voxelize(input: &Path, output: &Path, options: &str) -> std::process::Output {
    let mut command = vec!["voxelize".into(), input.as_os_str().to_owned(), "-o".into(), output.into()];
    command.extend(options.split_whitespace().map(Into::into));
    mser3d(command)
}

#[test]
fn a_mask_lies_where_the_mesh_does_and_is_its_solid() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = fixtures().join("quadruped_rest.off");
    let mask = folder.path().join("mask.nii.gz");
    let output = voxelize(&mesh, &mask, "--voxels 12000 --json");
    assert!(output.status.success() && !text(&output.stderr).contains("error"), "{}", text(&output.stderr));
    let said: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let volume = read_volume(&mask, &Default::default()).unwrap().volume;
    assert_eq!(said["voxels"], inside(&volume));
    assert_eq!(
        (&said["inside"], &said["topology"]["components"], &said["confidence"]),
        (&"winding".into(), &1.into(), &1.0.into())
    );
    let frame = volume.frame().unwrap();
    for axis in 0..3 {
        assert_eq!(said["dims"][axis], frame.dims()[axis]);
        // NIfTI keeps places as f32.
        let origin = said["origin"][axis].as_f64().unwrap();
        assert!((frame.origin()[axis] - origin).abs() < 1e-6 * origin.abs().max(1.0));
    }
    let options = "--eigenpairs 40 --quiet";
    let of_mask = regions(&mask, &folder.path().join("mask"), options);
    let of_mesh = regions(&mesh, &folder.path().join("mesh"), &format!("--voxels 12000 {options}"));
    assert_eq!(of_mask["input"]["format"], "nifti mask");
    let centroid = |report: &serde_json::Value| -> Vec<f64> {
        (0..3).map(|axis| report["regions"][0]["centroid"][axis].as_f64().unwrap()).collect()
    };
    // Half a voxel: a mask does not keep the links that the surface cuts.
    let near = said["spacing"][0].as_f64().unwrap() / 2.0;
    for (a, b) in centroid(&of_mask).into_iter().zip(centroid(&of_mesh)) {
        assert!((a - b).abs() < near, "{a} {b}");
    }
}

#[test]
fn spacing_and_origin_are_those_given() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = folder.path().join("box.off");
    std::fs::write(&mesh, box_off([1.0, -2.0, 0.0], [5.0, 2.0, 8.0])).unwrap();
    let mask = folder.path().join("mask.nii");
    let output = voxelize(&mesh, &mask, "--spacing 0.5,1,2 --origin -1,-4,-2");
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
    let volume = read_volume(&mask, &Default::default()).unwrap().volume;
    let frame = volume.frame().unwrap();
    assert_eq!(
        (frame.origin(), frame.spacing(), frame.dims()),
        ([-1.0, -4.0, -2.0], [0.5, 1.0, 2.0], [13, 7, 6])
    );
    assert_eq!(inside(&volume), 8 * 4 * 4);
    let array = folder.path().join("mask.npy");
    let output = voxelize(&mesh, &array, "--pitch 1");
    assert!(
        text(&output.stdout).starts_with("128 voxels inside, of 6 x 6 x 10\n"),
        "{}",
        text(&output.stdout)
    );
    assert_eq!(inside(&read_volume(&array, &Default::default()).unwrap().volume), 128);
}

#[test]
fn wrong_use_is_told_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = fixtures().join("human_rest.off");
    let mask = folder.path().join("mask.nii");
    for (options, words) in [
        ("--spacing 1,2", &["--spacing", "three"][..]),
        ("--origin 1,2,3,4", &["--origin", "three"]),
        ("--morphology melt", &["--morphology", "open", "close"]),
        ("--voxels 100 --pitch 1", &["--voxels", "--pitch"]),
    ] {
        assert_fails(&voxelize(&mesh, &mask, options), 2, words);
    }
    assert_fails(&voxelize(&mesh, &folder.path().join("mask.obj"), ""), 2, &["mask.obj", ".npy", ".nii.gz"]);
    assert_fails(&voxelize(&mesh, &mask, "--resolution 900 --max-box-voxels 1000"), 1, &["limit of 1000"]);
    assert!(!mask.exists());
}

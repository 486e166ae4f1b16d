//! `mser3d msv` from a file of grey values to files of regions.

use std::process::Command;

use crate::common::{assert_fails, mser3d, page_head};
use mser3d_volumeio::{Affine, Samples, Volume, read_volume, write_nifti};

fn msv(arguments: &[&std::ffi::OsStr]) -> std::process::Output {
    Command::new(env!("CARGO_BIN_EXE_mser3d")).arg("msv").args(arguments).output().unwrap()
}

#[test]
fn a_dark_ball_and_a_bright_box_are_found_where_they_lie() {
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (folder.path().join("v.nii.gz"), folder.path().join("out"));
    let dims = [24usize, 16, 12];
    let value = |i: usize| {
        let [x, y, z] = [i % 24, i / 24 % 16, i / (24 * 16)];
        let ball = x.abs_diff(6).pow(2) + y.abs_diff(7).pow(2) + z.abs_diff(5).pow(2) < 16;
        let in_box = (14..=20).contains(&x) && (6..=8).contains(&y) && (5..=7).contains(&z);
        if ball {
            40u8
        } else if in_box {
            220
        } else {
            150
        }
    };
    let affine = Affine::along_axes([10.0, 0.0, 0.0], [0.5, 1.0, 1.0]).unwrap();
    let volume = Volume::new(dims, 1, affine, (0..24 * 16 * 12).map(value).collect::<Vec<_>>()).unwrap();
    write_nifti(&path, &volume).unwrap();
    let done = msv(&[path.as_ref(), "-o".as_ref(), out.as_ref()]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert_eq!(String::from_utf8_lossy(&done.stdout), "dark regions: 1\nbright regions: 1\n");

    let json = std::fs::read_to_string(out.join("msv.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let region = |search: usize| json["searches"][search]["regions"][0].clone();
    let numbers = |value: &serde_json::Value| -> Vec<f64> {
        value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
    };
    let close =
        |a: Vec<f64>, b: [f64; 3]| assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6), "{a:?}");
    close(numbers(&region(0)["centre"]), [13.0, 7.0, 5.0]);
    close(numbers(&region(1)["centre"]), [18.5, 7.0, 6.0]);
    assert_eq!(region(1)["voxels"], 63);
    assert_eq!(region(1)["volume"], 31.5);
    // A box of n voxels has the variance (n^2 - 1) / 12, an ellipsoid a fifth of its squared semi-axis.
    let semi_axis = |n: f64, h: f64| h * (5.0 * (n * n - 1.0) / 12.0).sqrt();
    close(numbers(&region(1)["semi_axes"]), [semi_axis(7.0, 0.5), semi_axis(3.0, 1.0), semi_axis(3.0, 1.0)]);

    let labels = read_volume(&out.join("labels.npy"), &Default::default()).unwrap().volume;
    assert_eq!((labels.dims(), labels.channels()), (dims, 2));
    let Samples::I32(labels) = labels.samples() else { panic!("{:?}", labels.samples().type_name()) };
    for (voxel, label) in labels.chunks(2).enumerate() {
        let expected = [if value(voxel) == 40 { 0 } else { -1 }, if value(voxel) == 220 { 0 } else { -1 }];
        assert_eq!(label, expected);
    }
    assert_eq!(std::fs::read_to_string(out.join("regions.csv")).unwrap().lines().count(), 3);
    assert!(out.join("labels.vti").exists());

    // What was found is shown; what needs descriptors says so.
    let word = std::ffi::OsStr::new;
    for command in ["render", "view"] {
        let shown = mser3d([word(command), out.as_os_str()]);
        assert!(shown.status.success(), "{}", String::from_utf8_lossy(&shown.stderr));
    }
    assert!(std::fs::read(out.join("regions.png")).unwrap().starts_with(b"\x89PNG"));
    let page = std::fs::read_to_string(out.join("view.html")).unwrap();
    assert!(page.contains("<title>Stable volumes of v</title>"));
    // The slices are those of the file; without it the page has none, and says so.
    let grey = |page: &str| page_head(page)["shapes"][0]["grey"].clone();
    assert_eq!(grey(&page)["dims"], serde_json::json!(dims));
    std::fs::rename(&path, folder.path().join("elsewhere.nii.gz")).unwrap();
    let shown = mser3d([word("view"), out.as_os_str()]);
    let said = String::from_utf8_lossy(&shown.stderr);
    assert!(
        shown.status.success() && said.contains("grey values are not shown") && said.contains("v.nii"),
        "{said}"
    );
    let page = std::fs::read_to_string(out.join("view.html")).unwrap();
    assert!(grey(&page).is_null() && page.contains("not at hand"));
    let matched = mser3d([word("match"), out.as_os_str(), out.as_os_str()]);
    assert_fails(&matched, 1, &["mser3d msv", "viewed and rendered, but not matched"]);
}

#[test]
fn wrong_use_and_unreadable_volumes_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let path = folder.path().join("v.nii");
    write_nifti(&path, &Volume::new([2, 2, 2], 1, Affine::default(), vec![1u8; 8]).unwrap()).unwrap();
    let code = |arguments: &[&std::ffi::OsStr]| msv(arguments).status.code();
    let output: [&std::ffi::OsStr; 2] = ["-o".as_ref(), out.as_ref()];
    let with = |more: &[&'static str], path: &std::path::Path| {
        let mut all = vec![path.as_os_str()];
        all.extend(output);
        all.extend(more.iter().map(std::ffi::OsStr::new));
        code(&all)
    };
    assert_eq!(with(&["--delta", "-1"], &path), Some(2));
    assert_eq!(with(&["--min-diversity", "3"], &path), Some(2));
    assert_eq!(with(&["--regions", "dark,loud"], &path), Some(2));
    assert_eq!(with(&[], folder.path().join("mesh.obj").as_ref()), Some(2));
    assert_eq!(with(&[], folder.path().join("none.nii").as_ref()), Some(1));
    assert!(!out.exists());
    // All equal: one component, which never changes; no region.
    assert_eq!(with(&["-q"], &path), Some(0));
    let view = mser3d([std::ffi::OsStr::new("view"), out.as_os_str()]);
    assert_fails(&view, 1, &["v.nii: no maximally stable regions", "--delta"]);
}

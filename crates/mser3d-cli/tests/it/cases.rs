//! Inputs that once failed, each standing for a kind, where they are at hand.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::common::*;
use serde_json::Value;

/// A file or folder of the shared cases, if that is there.
pub fn case(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/cases").join(name);
    if !path.exists() {
        eprintln!("skipped: {name} is not there");
        return None;
    }
    Some(path)
}

fn voxelized(path: &Path, out: &Path) -> Value {
    let words = [path.as_os_str(), "-o".as_ref(), out.as_os_str(), "--json".as_ref()];
    let output = mser3d(std::iter::once("voxelize".as_ref()).chain(words));
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn thin_plates_keep_their_volume() {
    let folder = tempfile::tempdir().unwrap();
    for thickness in ["0.012", "0.014", "0.016", "0.02", "0.03"] {
        let Some(path) = case(&format!("thin_plate/plate_{thickness}.off")) else { return };
        let said = voxelized(&path, &folder.path().join("m.npy"));
        let [voxels, mesh] = ["volume", "mesh_volume"].map(|name| said[name].as_f64().unwrap());
        assert!((voxels / mesh - 1.0).abs() < 0.03, "{thickness}: {said}");
    }
}

#[test]
fn bodies_that_touch_are_one_and_bodies_with_a_gap_are_two() {
    let folder = tempfile::tempdir().unwrap();
    // Two unit cubes with 0, 1e-3 and so on between them, or with a common part, or a small one on a large one.
    for (name, dropped) in [
        ("same_face", 0),
        ("same_face_welded", 0),
        ("small_on_large", 0),
        ("overlap", 0),
        ("gap", 1),
        ("gap_tiny", 1),
    ] {
        let Some(path) = case(&format!("touching/{name}.off")) else { return };
        let said = voxelized(&path, &folder.path().join("m.npy"));
        assert_eq!(said["dropped_components"], dropped, "{name}: {said}");
        let of = |field: &str| said[field].as_f64().unwrap();
        let all = of("volume") * (1.0 + of("dropped_voxels") / of("voxels"));
        // What both cover counts twice in the mesh.
        let mesh = of("mesh_volume") - of("overlap_volume");
        assert!((all / mesh - 1.0).abs() < 0.03, "{name}: {said}");
    }
}

#[test]
fn soups_are_refused_at_once_and_inspect_says_so() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["nonmanifold_soup_slow/n10.obj", "inspect_soup/soup.stl"] {
        let Some(path) = case(name) else { return };
        let start = Instant::now();
        let output = detect(&path, &folder.path().join("o"), "");
        assert_fails(&output, 1, &["bound no solid", "--inside vote"]);
        let said = mser3d(["inspect".as_ref(), path.as_os_str()]);
        assert!(
            text(&said.stdout).contains("a run is refused") && !text(&said.stdout).contains("takes about")
        );
        // A second on an idle machine; without the refusal minutes.
        assert!(start.elapsed() < Duration::from_secs(20), "{name}: {:?}", start.elapsed());
    }
}

#[test]
fn six_equal_arms_are_six_regions() {
    let Some(path) = case("six_arms/jack.npy") else { return };
    let folder = tempfile::tempdir().unwrap();
    let report = regions(&path, folder.path(), "--quiet");
    let sizes: Vec<u64> =
        report["regions"].as_array().unwrap().iter().map(|r| r["voxels"].as_u64().unwrap()).collect();
    assert_eq!(sizes, [1024; 6]);
}

#[test]
fn labels_of_grey_values_lie_where_their_centres_do() {
    let Some(path) = case("msv_vti_direction/las_grey.nii.gz") else { return };
    let folder = tempfile::tempdir().unwrap();
    let output = mser3d(["msv".as_ref(), path.as_os_str(), "-o".as_ref(), folder.path().as_os_str()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let bytes = fs::read(folder.path().join("labels.vti")).unwrap();
    let head = String::from_utf8_lossy(&bytes[..600]).into_owned();
    // The first axis runs to the left from 90; a corner lies half a voxel before it.
    assert!(head.contains("Direction=\"-1.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 1.0\""), "{head}");
    let origin = head.split("Origin=\"").nth(1).unwrap().split('"').next().unwrap();
    let origin: Vec<f64> = origin.split(' ').map(|x| x.parse().unwrap()).collect();
    assert!(origin.iter().zip([90.45, -126.45, -73.25]).all(|(a, b)| (a - b).abs() < 1e-6), "{origin:?}");
    let csv = fs::read_to_string(folder.path().join("regions.csv")).unwrap();
    for row in csv.lines().skip(1) {
        let x: f64 = row.split(',').nth(6).unwrap().parse().unwrap();
        assert!((90.0 - 24.0 * 0.9..=90.0).contains(&x), "{row}");
    }
}

#[test]
fn a_batch_takes_all_that_can_be_read_in_a_folder() {
    let Some(path) = case("batch_folder_masks") else { return };
    let folder = tempfile::tempdir().unwrap();
    let words = [path.as_os_str(), "-o".as_ref(), folder.path().as_os_str(), "--quiet".as_ref()];
    let small = ["--voxels", "2000", "--eigenpairs", "40"].map(std::ffi::OsStr::new);
    let output = mser3d(std::iter::once("batch".as_ref()).chain(words).chain(small));
    assert!(output.status.success(), "{}", text(&output.stderr));
    for name in ["plain", "ras_s", "u8"] {
        assert!(folder.path().join(name).join("regions.json").is_file(), "{name}");
    }
}

#[test]
fn damaged_tables_and_results_of_other_versions_are_one_clear_message() {
    let Some(result) = case("result_parent_is_itself") else { return };
    let Some(table) = case("parquet_damaged/regions.parquet") else { return };
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("p.html");
    let view = mser3d(["view".as_ref(), result.as_os_str(), "-o".as_ref(), page.as_os_str()]);
    assert_fails(&view, 1, &["regions.json", "in format 1, this program reads format 4", "detect` again"]);
    fs::copy(table, folder.path().join("regions.parquet")).unwrap();
    let own = folder.path().join("own");
    let mesh = fixtures().join("human_rest.off");
    regions(&mesh, &own, "--voxels 1500 --eigenpairs 20 --quiet");
    let query = mser3d(["query".as_ref(), folder.path().as_os_str(), own.as_os_str()]);
    assert_fails(&query, 1, &["regions.parquet", "batch` again"]);
}

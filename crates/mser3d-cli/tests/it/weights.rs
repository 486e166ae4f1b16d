//! Weights: those with a name, and fields from files.

use std::fs;

use crate::common::*;
use mser3d_fileio::{NpyArray, write_npy};
use serde_json::Value;

/// A coarse figure, its number of vertices, and where files go.
const OPTIONS: &str = "--voxels 1500 --eigenpairs 20 --quiet";
const SURFACE: &str = "--surface --eigenpairs 20 --quiet";
const VERTICES: usize = 3756;

fn heights() -> Vec<f64> {
    let text = fs::read_to_string(fixtures().join("human_rest.off")).unwrap();
    let line = |line: &str| line.split_whitespace().nth(1).unwrap().parse().unwrap();
    text.lines().skip(2).take(VERTICES).map(line).collect()
}

fn altitudes(record: &Value) -> Vec<f64> {
    record["regions"].as_array().unwrap().iter().map(|r| r["altitude"].as_f64().unwrap()).collect()
}

#[test]
fn a_field_of_the_vertices_is_the_weight_and_stands_in_the_record() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, out) = (fixtures().join("human_rest.off"), folder.path().join("out"));
    let field = folder.path().join("height.npy");
    write_npy(&field, &NpyArray::flat(heights())).unwrap();
    for options in [OPTIONS, SURFACE] {
        let record = regions(&mesh, &out, &format!("--weight {} {options}", field.display()));
        assert_eq!(record["parameters"]["weight"], "field");
        assert_eq!(record["parameters"]["polarity"], "superlevel");
        assert_eq!(record["parameters"]["stability"]["altitude"], "linear");
        assert_eq!(record["field"]["path"], field.display().to_string());
        assert_eq!(record["field"]["shape"], serde_json::json!([VERTICES]));
        assert_eq!(record["trees"].as_array().unwrap().len(), 1);
        assert!(record["trees"][0]["time"].is_null());
        // Superlevel sets of the height: a region's altitude is its lowest point, in metres.
        let low = |r: &Value| r["oriented_box"]["centre"][1].as_f64().unwrap();
        let regions = record["regions"].as_array().unwrap();
        assert!(!regions.is_empty());
        for (region, altitude) in regions.iter().zip(altitudes(&record)) {
            assert!(altitude > 0.0 && altitude < low(region), "{altitude} {region}");
        }
    }
    // The same numbers of another type are the same field, but for their last digits.
    let coarse: Vec<f32> = heights().iter().map(|&y| y as f32).collect();
    write_npy(&field, &NpyArray::flat(coarse)).unwrap();
    let record = regions(&mesh, &out, &format!("--weight {} --polarity sublevel {OPTIONS}", field.display()));
    assert_eq!(record["parameters"]["polarity"], "sublevel");
    // Both legs.
    let sides: Vec<f64> =
        record["regions"].as_array().unwrap().iter().map(|r| r["centroid"][0].as_f64().unwrap()).collect();
    assert!(sides.iter().any(|x| *x > 0.05) && sides.iter().any(|x| *x < -0.05), "{sides:?}");
    // Vectors: low where they differ little.
    let places: Vec<f64> = heights().iter().flat_map(|&y| [y.floor(), 0.0]).collect();
    write_npy(&field, &NpyArray::new(&[VERTICES, 2], places).unwrap()).unwrap();
    let record = regions(&mesh, &out, &format!("--weight {} {SURFACE}", field.display()));
    assert_eq!(record["parameters"]["polarity"], "sublevel");
    // Below a metre and above it nothing differs: what is above, the legs, and both hands.
    assert_eq!(altitudes(&record), [0.0; 4]);
    // Without a field there is none in the record.
    assert!(regions(&mesh, &out, OPTIONS)["field"].is_null());
}

#[test]
fn a_field_of_voxels_has_the_shape_of_the_volume() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let dims = [24, 7, 5];
    let inside = |x: usize, y: usize, z: usize| x > 0 && (1..6).contains(&y) && (1..4).contains(&z);
    fs::write(path("mask.npy"), npy(dims, inside)).unwrap();
    // Along x, and nothing outside.
    let value = |i: usize| {
        let (x, y, z) = (i / 35, i / 5 % 7, i % 5);
        if inside(x, y, z) { x as f64 - 10.0 } else { f64::NAN }
    };
    let values: Vec<f64> = (0..24 * 35).map(value).collect();
    write_npy(&path("x.npy"), &NpyArray::new(&dims, &values[..]).unwrap()).unwrap();
    let weight = |name: &str| format!("--weight {} --eigenpairs 20 --quiet", path(name).display());
    let record = regions(&path("mask.npy"), &path("out"), &weight("x.npy"));
    let arrays = mser3d_fileio::read_npz(&path("out/features.npz")).unwrap();
    let mser3d_fileio::NpyValues::F64(tree) = arrays["tree0_altitude"].values() else { panic!() };
    let expected: Vec<f64> = (-9..14).rev().map(f64::from).collect();
    assert_eq!(tree[..], expected[..]);
    assert_eq!(record["field"]["shape"], serde_json::json!(dims));

    // What doesn't fit, or is no weight where the body is.
    let fails = |name: &str, words: &[&str]| {
        let output = detect(&path("mask.npy"), &path("no"), &weight(name));
        assert_fails(&output, 1, words);
        assert!(!path("no").exists());
    };
    write_npy(&path("short.npy"), &NpyArray::new(&[24, 7], vec![1.0; 168]).unwrap()).unwrap();
    fails(
        "short.npy",
        &["short.npy: an array of shape (24, 7) is no weight of this volume", "(24, 7, 5, d)"],
    );
    let mut holed = values;
    holed[10 * 35 + 3 * 5 + 2] = f64::NAN;
    write_npy(&path("holed.npy"), &NpyArray::new(&dims, holed).unwrap()).unwrap();
    fails("holed.npy", &["voxel (10, 3, 2) of ", "holed.npy is NaN", "finite number"]);
    let output = detect(&path("mask.npy"), &path("no"), "--weight curvature --quiet");
    assert_fails(
        &output,
        1,
        &["mask.npy: a mask or solid of voxels has no mesh around it", "another weight"],
    );
}

#[test]
fn weights_that_are_none_are_refused_with_what_is_expected() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (mesh, out) = (fixtures().join("human_rest.off"), path("out"));
    let run = |options: &str| detect(&mesh, &out, &format!("{options} {OPTIONS}"));
    let with = |name: &str| run(&format!("--weight {}", path(name).display()));
    write_npy(&path("few.npy"), &NpyArray::flat(vec![1.0; 100])).unwrap();
    assert_fails(
        &with("few.npy"),
        1,
        &["few.npy: an array of shape (100,)", "(3756,), or (3756, d) for vectors"],
    );
    write_npy(&path("turned.npy"), &NpyArray::new(&[3, VERTICES], vec![1.0; 3 * VERTICES]).unwrap()).unwrap();
    assert_fails(&with("turned.npy"), 1, &["shape (3, 3756)", "(3756, d)"]);
    let mut bad = heights();
    bad[17] = f64::INFINITY;
    write_npy(&path("bad.npy"), &NpyArray::flat(bad)).unwrap();
    assert_fails(&with("bad.npy"), 1, &["bad.npy: value 17 is inf; a weight is a finite number"]);
    let header = "{'descr': '<c16', 'fortran_order': False, 'shape': (1,), }\n";
    let length = (header.len() as u16).to_le_bytes();
    let complex = [b"\x93NUMPY\x01\0", &length[..], header.as_bytes(), &[0; 16]].concat();
    fs::write(path("complex.npy"), complex).unwrap();
    assert_fails(&with("complex.npy"), 1, &["complex.npy: an array of type <c16 is not supported"]);
    fs::write(path("text.npy"), "1 2 3").unwrap();
    assert_fails(&with("text.npy"), 1, &["text.npy: not a .npy file"]);
    assert_fails(&with("none.npy"), 1, &["none.npy: cannot be read"]);
    // Wrong use.
    assert_fails(&run("--weight field"), 2, &["in place of the name, as in --weight height.npy"]);
    assert_fails(&run("--weight thickness"), 2, &["there is no weight \"thickness\"", "ends in .npy"]);
    assert_fails(&run("--weight edge --smooth-weight 0.1"), 2, &["smooth_weight", "one of links"]);
    assert_fails(&run("--weight curvature --altitude log"), 1, &["no logarithm", "--altitude linear"]);
    assert!(!out.exists());
    // Of many shapes.
    write_npy(&path("height.npy"), &NpyArray::flat(heights())).unwrap();
    let (field, out) = (path("height.npy").display().to_string(), out.display().to_string());
    let batch = mser3d(["batch", mesh.to_str().unwrap(), "-o", &out, "--weight", &field]);
    assert_fails(&batch, 2, &["height.npy: a field belongs to one shape", "mser3d detect for each"]);
}

#[test]
fn a_field_of_a_files_repeated_vertices_is_taken_too() {
    let folder = tempfile::tempdir().unwrap();
    let glb = fixtures().join("human.glb");
    let record = regions(&glb, &folder.path().join("plain"), OPTIONS);
    let vertices = record["input"]["diagnosis"]["vertices"].as_u64().unwrap() as usize;
    let arrays = mser3d_fileio::read_npz(&folder.path().join("plain/features.npz")).unwrap();
    let in_file = arrays.get("file_vertex").map_or(vertices, |a| a.values().len());
    for count in [vertices, in_file] {
        let field = folder.path().join("field.npy");
        write_npy(&field, &NpyArray::flat((0..count).map(|i| i as f64).collect::<Vec<_>>())).unwrap();
        let record =
            regions(&glb, &folder.path().join("own"), &format!("--weight {} {OPTIONS}", field.display()));
        assert_eq!(record["field"]["shape"], serde_json::json!([count]));
    }
}

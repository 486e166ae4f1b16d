//! What `detect` writes, and what `inspect` says.

use std::collections::{BTreeMap, HashSet};
use std::fs;
use std::path::Path;

use crate::common::*;
use mser3d_fileio::{NpyArray, NpyValues, read_npz};
use mser3d_meshio::{ReadOptions, read_mesh};
use mser3d_viewer::{PALETTE, Rgb};
use serde_json::Value;
use sha2::{Digest, Sha256};

const COARSE: &str = "--voxels 4000 --eigenpairs 40 --quiet";

/// `features.npz` of a result.
struct Arrays(BTreeMap<String, NpyArray<'static>>);

impl Arrays {
    fn read(folder: &Path) -> Self {
        Self(read_npz(&folder.join("features.npz")).unwrap())
    }

    fn integers(&self, name: &str) -> Vec<i64> {
        match self.0[name].values() {
            NpyValues::I32(v) => v.iter().map(|&x| x.into()).collect(),
            NpyValues::I64(v) => v.to_vec(),
            NpyValues::U32(v) => v.iter().map(|&x| x.into()).collect(),
            other => panic!("{name} holds {other:?}"),
        }
    }

    fn reals(&self, name: &str) -> Vec<f64> {
        match self.0[name].values() {
            NpyValues::F64(v) => v.to_vec(),
            other => panic!("{name} holds {other:?}"),
        }
    }

    /// The members of each region.
    fn members(&self, of: &str) -> Vec<HashSet<i64>> {
        let (all, start) = (self.integers(of), self.integers(&format!("{of}_start")));
        assert_eq!((start[0], *start.last().unwrap()), (0, all.len() as i64));
        start.windows(2).map(|w| all[w[0] as usize..w[1] as usize].iter().copied().collect()).collect()
    }
}

/// The last region that has each element, -1 for none: regions come by size, so it is the smallest.
fn innermost(regions: &[HashSet<i64>], elements: usize) -> Vec<i64> {
    let last = |e: i64| regions.iter().rposition(|members| members.contains(&e));
    (0..elements as i64).map(|e| last(e).map_or(-1, |r| r as i64)).collect()
}

fn close(value: &Value, expected: f64) -> bool {
    (value.as_f64().unwrap() - expected).abs() < 1e-12
}

fn list<'a>(value: &'a Value, key: &str) -> &'a Vec<Value> {
    value[key].as_array().unwrap()
}

#[test]
fn a_volume_writes_files_that_agree() {
    let folder = tempfile::tempdir().unwrap();
    let input = fixtures().join("human_rest.off");
    let report = regions(&input, folder.path(), COARSE);
    let mut names: Vec<_> =
        fs::read_dir(&folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["checksums.json", "features.npz", "regions.json", "surface.ply", "volume.vti"]);

    let bytes = fs::read(&input).unwrap();
    let hash: String = Sha256::digest(&bytes).iter().map(|b| format!("{b:02x}")).collect();
    assert_eq!(report["mser3d"], env!("CARGO_PKG_VERSION"));
    assert_eq!(report["input"]["sha256"], hash);
    assert_eq!(report["input"]["path"], input.to_str().unwrap());
    assert_eq!(report["input"]["diagnosis"]["vertices"], 3756);
    assert_eq!(report["input"]["diagnosis"]["closed"], true);
    assert_eq!(report["parameters"]["spectrum"]["eigenpairs"]["count"], 40);
    assert_eq!(report["parameters"]["voxelize"]["pitch"]["voxels"], 4000);
    assert_eq!(report["parameters"]["stability"]["window"], 0.25);
    assert!(report["warnings"].is_array());
    let stages: Vec<&str> =
        list(&report["run"], "stages").iter().map(|s| s["stage"].as_str().unwrap()).collect();
    assert_eq!(stages, ["voxelize", "spectrum", "regions", "reliability", "descriptors", "parts"]);
    assert!(list(&report["run"], "stages").iter().all(|s| s["seconds"].as_f64().unwrap() >= 0.0));

    let arrays = Arrays::read(folder.path());
    let (vertices, voxels) = (arrays.members("region_vertices"), arrays.members("region_voxels"));
    let index = arrays.integers("voxel_index");
    let affine = arrays.reals("grid_affine");
    assert_eq!(arrays.0["grid_affine"].shape(), [4, 4]);
    let pitch = affine[0];
    let count = index.len() / 3;
    assert_eq!(arrays.0["voxel_index"].shape(), [count, 3]);
    assert_eq!(report["voxelization"]["voxels"], count);
    let found = list(&report, "regions");
    assert!(found.len() >= 10 && voxels.len() == found.len() && vertices.len() == found.len());
    let voxel_of = arrays.integers("vertex_voxel");
    assert_eq!(voxel_of.len(), 3756);
    for (id, region) in found.iter().enumerate() {
        let inside = |v: &i64| voxel_of[*v as usize] >= 0 && voxels[id].contains(&voxel_of[*v as usize]);
        assert_eq!((0..3756).filter(inside).collect::<HashSet<i64>>(), vertices[id]);
        assert_eq!(region["id"], id);
        assert_eq!(region["voxels"], voxels[id].len());
        assert_eq!(region["vertices"], vertices[id].len());
        let volume = region["volume"].as_f64().unwrap();
        assert!((volume / (voxels[id].len() as f64 * pitch.powi(3)) - 1.0).abs() < 1e-9);
        let fraction = region["volume_fraction"].as_f64().unwrap();
        assert!((fraction - voxels[id].len() as f64 / count as f64).abs() < 1e-9);
        assert!(region["altitude"].as_f64().unwrap() > 0.0);
        assert!(region["stability"].is_number() || region["stability"] == "Infinity");
        for axis in 0..3 {
            let sum: f64 = voxels[id].iter().map(|&v| index[3 * v as usize + axis] as f64).sum();
            let centre = affine[4 * axis + 3] + pitch * sum / voxels[id].len() as f64;
            assert!((region["centroid"][axis].as_f64().unwrap() - centre).abs() < 1e-9);
        }
        let contains = |&other: &usize| other != id && voxels[id].is_subset(&voxels[other]);
        let parent = (0..found.len()).filter(contains).min_by_key(|&r| voxels[r].len());
        assert_eq!(region["parent"].as_u64().map(|p| p as usize), parent, "of {id}");
        for other in 0..id {
            if found[other]["tree"] == region["tree"] {
                assert!(contains(&other) || voxels[id].is_disjoint(&voxels[other]), "{id} and {other}");
            }
        }
    }
    assert!(arrays.integers("vertex_region") == innermost(&vertices, 3756));
    assert!(arrays.integers("voxel_region") == innermost(&voxels, count));
    let eigenvalues = arrays.reals("eigenvalues");
    assert!(eigenvalues.len() == 40 && eigenvalues[0] == 0.0 && eigenvalues.is_sorted());
    assert_eq!(arrays.0["region_descriptor"].shape()[0], found.len());

    let (before, after) = [&input, &folder.path().join("surface.ply")]
        .map(|path| read_mesh(path, &ReadOptions::default()).unwrap().mesh)
        .into();
    assert_eq!(before.triangles(), after.triangles());
    for (a, b) in before.vertices().iter().zip(after.vertices()) {
        assert!((0..3).all(|i| (a[i] - b[i]).abs() < 1e-6));
    }
    let vti = fs::read(folder.path().join("volume.vti")).unwrap();
    assert!(vti.starts_with(b"<?xml") || vti.starts_with(b"<VTKFile"));
}

#[test]
fn the_files_do_not_depend_on_the_number_of_threads() {
    let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let input = fixtures().join("human_touch.off");
    let [one, two] = ["1", "2"].map(|threads| {
        let folder = &folders[threads.parse::<usize>().unwrap() - 1];
        let mut report = regions(&input, folder.path(), &format!("{COARSE} --threads {threads}"));
        assert_eq!(report["run"]["threads"].to_string(), threads);
        report.as_object_mut().unwrap().remove("run");
        (
            report,
            ["features.npz", "surface.ply", "volume.vti"].map(|f| fs::read(folder.path().join(f)).unwrap()),
        )
    });
    assert!(one == two);
}

#[test]
fn a_surface_has_no_voxels() {
    let folder = tempfile::tempdir().unwrap();
    let report =
        regions(&fixtures().join("human_rest.off"), folder.path(), "--surface --eigenpairs 40 --quiet");
    assert_eq!(report["domain"], "surface");
    assert!(report["voxelization"].is_null() && !folder.path().join("volume.vti").exists());
    let arrays = Arrays::read(folder.path());
    assert!(!arrays.0.contains_key("voxel_index"));
    let vertices = arrays.members("region_vertices");
    assert!(vertices.len() >= 8 && vertices.len() == list(&report, "regions").len());
    assert!(arrays.integers("vertex_region") == innermost(&vertices, 3756));
    assert!(list(&report, "regions").iter().all(|r| r["voxels"].is_null()));
}

#[test]
fn a_figure_with_repeated_vertices_leads_back_to_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let options = format!("{COARSE} --animation poses --time 1");
    let report = regions(&fixtures().join("human.glb"), folder.path(), &options);
    assert_eq!((&report["input"]["animation"], &report["input"]["time"]), (&"poses".into(), &1.0.into()));
    let arrays = Arrays::read(folder.path());
    let vertices = arrays.integers("vertex_region").len();
    let weld = arrays.integers("file_vertex");
    assert!(weld.len() >= vertices && weld.iter().all(|&v| (v as usize) < vertices));
}

#[test]
fn a_mask_is_a_solid_without_vertices() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("club.npy");
    // A cube with a handle along x, and a speck.
    let inside = |x: usize, y: usize, z: usize| {
        x < 12 || (x < 28 && (4..8).contains(&y) && (4..8).contains(&z)) || (x == 29 && y == 0)
    };
    fs::write(&path, npy([30, 12, 12], inside)).unwrap();
    let out = folder.path().join("out");
    let report = regions(&path, &out, "--pitch 0.5 --eigenpairs 40 --quiet");
    assert!(report["warnings"][0].as_str().unwrap().contains("1 smaller component with 12 voxels"));
    let handle =
        |r: &&Value| r["centroid"][0].as_f64().unwrap() > 8.0 && r["volume_fraction"].as_f64() < Some(0.2);
    assert!(list(&report, "regions").iter().find(handle).is_some());
    let arrays = Arrays::read(&out);
    assert_eq!(arrays.integers("voxel_index").len(), 3 * (12 * 12 * 12 + 16 * 4 * 4));
    let affine = [0.5, 0., 0., 0., 0., 0.5, 0., 0., 0., 0., 0.5, 0., 0., 0., 0., 1.];
    assert_eq!(arrays.reals("grid_affine"), affine);
    assert!(!arrays.0.contains_key("region_vertices") && !out.join("surface.ply").exists());
    // The speck is worth a word to who looks.
    let output = detect(&path, &out, "--eigenpairs 40");
    assert!(
        text(&output.stderr).starts_with("mser3d: warning: ") && text(&output.stderr).contains("club.npy")
    );
}

#[test]
fn standard_output_is_a_table_or_json_or_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let input = fixtures().join("quadruped_rest.off");
    let run = |options: &str| {
        let output = detect(&input, folder.path(), &format!("--voxels 4000 --eigenpairs 40 {options}"));
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout).to_owned()
    };
    assert_eq!(run("--quiet"), "");
    let parsed: Value = serde_json::from_str(&run("--json")).unwrap();
    let written = json(&folder.path().join("regions.json"));
    assert_eq!(parsed, written);
    let table = run("");
    // Head, regions, an empty line, head, parts, how many, how many and where.
    let found = list(&written, "regions").len() + list(&written, "parts").len();
    assert_eq!(table.lines().count(), found + 5, "{table}");
    assert!(table.lines().next().unwrap().contains("centroid") && table.contains("regions in"));
}

/// `inspect` as text and as JSON.
fn inspect(path: &Path) -> (String, Value) {
    let run = |options: &[&str]| {
        let output = mser3d([&["inspect", path.to_str().unwrap()][..], options].concat());
        assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
        text(&output.stdout).to_owned()
    };
    (run(&[]), serde_json::from_str(&run(&["--json"])).unwrap())
}

/// Which of the palette's hues a colour is a tone of.
fn hue(colour: &Value) -> usize {
    let colour: [u8; 3] = serde_json::from_value(colour.clone()).unwrap();
    PALETTE.iter().position(|hue| hue.tones().contains(&Rgb(colour))).unwrap()
}

#[test]
fn parts_are_written_shown_and_exported() {
    let folder = tempfile::tempdir().unwrap();
    let (input, out) = (fixtures().join("human_rest.off"), folder.path().join("out"));
    let output = detect(&input, &out, "--voxels 4000 --eigenpairs 40 --parts 6 --html");
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("\n6 parts\n") && text(&output.stdout).contains(" trunk "));
    let report = json(&out.join("regions.json"));
    assert_eq!(report["parameters"]["parts"]["count"]["count"], 6);
    let parts = list(&report, "parts");
    assert_eq!(parts.len(), 6);
    let arrays = Arrays::read(&out);
    let (vertices, voxels) = (arrays.integers("vertex_part"), arrays.integers("voxel_part"));
    assert_eq!((vertices.len(), voxels.len()), (3756, arrays.integers("voxel_index").len() / 3));
    for (id, part) in parts.iter().enumerate() {
        let count = |labels: &[i64]| labels.iter().filter(|&&label| label == id as i64).count();
        assert_eq!((&part["id"], &part["voxels"]), (&id.into(), &count(&voxels).into()));
        assert_eq!(part["vertices"], count(&vertices));
        for twin in list(part, "twins") {
            assert!(list(&parts[twin.as_u64().unwrap() as usize], "twins").contains(&id.into()));
        }
    }
    let sum: f64 = parts.iter().map(|part| part["volume_fraction"].as_f64().unwrap()).sum();
    assert!((sum - 1.0).abs() < 1e-9);
    let vti = fs::read(out.join("volume.vti")).unwrap();
    assert!(String::from_utf8_lossy(&vti).contains("Name=\"part\""));
    let page = fs::read_to_string(out.join("view.html")).unwrap();
    assert!(page.contains("Parts and stable regions of human_rest"));
    // Twins have one hue, and the page leads from each to the other.
    let head = page_head(&page);
    let shown = list(&head["shapes"][0], "parts");
    for (part, shown) in parts.iter().zip(shown) {
        for name in ["trunk", "region", "twins", "vertices", "voxels"] {
            assert_eq!(part[name], shown[name], "{name}");
        }
        for twin in list(part, "twins") {
            let other = &head["shapes"][0]["parts"][twin.as_u64().unwrap() as usize]["colour"];
            assert_eq!(hue(&shown["colour"]), hue(other));
        }
    }
    let twins = shown.iter().filter(|part| !list(part, "twins").is_empty());
    assert_eq!((shown.len(), twins.count()), (6, 4), "arms and legs have twins");
    assert_eq!(list(&head["shapes"][0], "regions").len(), list(&report, "regions").len());

    let run = |arguments: &[&str]| {
        let output = mser3d([&[arguments[0], out.to_str().unwrap()], &arguments[1..]].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
    };
    // Parts are shown first.
    run(&["render", "--height", "60"]);
    assert!(out.join("parts.png").exists() && !out.join("regions.png").exists());
    run(&["render", "--show", "regions", "--height", "60"]);
    run(&["render", "--show", "each", "--height", "30"]);
    assert!(out.join("regions.png").exists() && out.join("each.png").exists());
    let ply = folder.path().join("parts.ply");
    run(&["export", "--parts", "-o", ply.to_str().unwrap()]);
    assert_eq!(read_mesh(&ply, &ReadOptions::default()).unwrap().mesh.vertices().len(), 3756);

    // Without parts there are none to show, and those of before are gone.
    regions(&input, &out, &format!("{COARSE} --parts none"));
    assert!(!out.join("view.html").exists() && json(&out.join("regions.json"))["parts"].is_null());
    let output = mser3d(["render", out.to_str().unwrap(), "--show", "parts"]);
    assert_fails(&output, 1, &["human_rest.off", "no parts", "--parts auto"]);
    run(&["render", "--height", "50", "-o", out.join("default.png").to_str().unwrap()]);
    run(&["view"]);
    let page = fs::read_to_string(out.join("view.html")).unwrap();
    assert!(page_head(&page)["shapes"][0]["parts"].is_null() && page.contains("<title>Stable regions of"));
    assert_fails(&detect(&input, &out, "--parts 0"), 2, &["auto, none, or a whole number of at least 1"]);
}

#[test]
fn inspect_tells_what_is_wrong_with_a_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let cube = box_off([0.0; 3], [1.0; 3]);
    let lines: Vec<&str> = cube.lines().collect();
    let (vertices, faces) = (lines[2..10].join("\n"), &lines[10..]);
    let write = |name: &str, faces: &[&str]| {
        let path = folder.path().join(name);
        fs::write(&path, format!("OFF\n8 {} 0\n{vertices}\n{}\n", faces.len(), faces.join("\n"))).unwrap();
        path
    };
    let flipped: Vec<String> = faces
        .iter()
        .map(|face| {
            let c: Vec<&str> = face.split(' ').collect();
            format!("3 {} {} {}", c[1], c[3], c[2])
        })
        .collect();
    let flipped: Vec<&str> = flipped.iter().map(String::as_str).collect();

    let (said, found) = inspect(&write("whole.off", faces));
    let d = &found["diagnosis"];
    assert_eq!((&d["closed"], &d["genus"]), (&true.into(), &0.into()));
    assert!(close(&d["volume"], 1.0) && close(&d["area"], 6.0), "{said}");
    assert!(
        said.contains("consistent, outwards") && said.contains("1.000000 x 1.000000 x 1.000000"),
        "{said}"
    );
    assert!((found["pitch"].as_f64().unwrap() - 45_000f64.cbrt().recip()).abs() < 1e-12);
    assert_eq!(found["estimate"]["elements"], 45_000);
    assert!(found["estimate"]["memory_bytes"].as_u64().unwrap() > 10_000_000);
    assert!(found["estimate"]["seconds"].as_f64().unwrap() > 0.1);
    assert_eq!(found["sha256"].as_str().unwrap().len(), 64);

    // One square taken out.
    let (said, found) = inspect(&write("open.off", &faces[2..]));
    let d = &found["diagnosis"];
    assert_eq!(
        (&d["closed"], &d["boundary_edges"], &d["boundary_loops"]),
        (&false.into(), &4.into(), &1.into())
    );
    assert!(said.contains("4 boundary edges in 1 loop"), "{said}");

    let (said, found) = inspect(&write("inside_out.off", &flipped));
    assert_eq!(found["diagnosis"]["inverted_bodies"], 1);
    assert!(close(&found["diagnosis"]["signed_volume"], -1.0), "{said}");
    assert!(said.contains("inwards"), "{said}");

    let (said, found) = inspect(&write("one_turned.off", &[&[flipped[0]][..], &faces[1..]].concat()));
    assert_eq!(
        (&found["diagnosis"]["inconsistent_edges"], &found["diagnosis"]["flipped_triangles"]),
        (&3.into(), &1.into())
    );
    assert!(said.contains("3 edges disagree"), "{said}");

    // On an edge of the cube and a square's diagonal.
    let (said, found) = inspect(&write("fin.off", &[faces, &["3 0 1 6"]].concat()));
    assert_eq!(found["diagnosis"]["non_manifold_edges"], 2, "{said}");

    let (_, found) = inspect(&write("sliver.off", &[faces, &["3 0 0 1", "3 0 2 3"]].concat()));
    assert_eq!(
        (&found["diagnosis"]["degenerate_triangles"], &found["diagnosis"]["duplicate_triangles"]),
        (&1.into(), &1.into())
    );

    let (said, found) = inspect(&fixtures().join("human.glb"));
    assert_eq!((&found["format"], &found["animations"][0]["name"]), (&"GLB".into(), &"poses".into()));
    assert!(said.contains("\"poses\""), "{said}");

    let mask = folder.path().join("mask.npy");
    fs::write(&mask, npy([5, 6, 7], |_, _, z| z > 0)).unwrap();
    let (said, found) = inspect(&mask);
    assert_eq!(
        (&found["volume"]["body"]["voxels"], &found["estimate"]["elements"]),
        (&180.into(), &180.into())
    );
    assert!(
        said.contains("5 x 6 x 7 voxels of 1 x 1 x 1") && said.contains("180 voxels in 1 piece"),
        "{said}"
    );
}

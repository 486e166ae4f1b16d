//! Files that were once read wrongly, where they are at hand.

use mser3d_meshio::{LoadedMesh, ReadOptions, VertexAttributes, read_mesh, write_glb};
use std::path::PathBuf;

fn read(name: &str) -> Option<LoadedMesh> {
    let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/cases")).join(name);
    if !path.exists() {
        eprintln!("skipped: {name} is not there");
        return None;
    }
    Some(read_mesh(&path, &ReadOptions::default()).unwrap())
}

#[test]
fn off_over_line_ends() {
    for (name, vertices, triangles, volume) in
        [("face_over_lines", 4, 4, 1.0 / 6.0), ("oneline", 42, 80, 3.658712177)]
    {
        let Some(read) = read(&format!("off_line_breaks/{name}.off")) else { return };
        assert_eq!(
            (read.mesh.vertices().len(), read.mesh.triangles().len()),
            (vertices, triangles),
            "{name}"
        );
        assert!((read.mesh.signed_volume() - volume).abs() < 1e-8, "{name}: {}", read.mesh.signed_volume());
        assert!(read.notes.is_empty());
    }
}

#[test]
fn stl_whose_counts_disagree() {
    let counted = "77 triangles are declared, but the file holds 80; 80 are read";
    let joined = "2 STL files of 80 and 80 triangles follow one another; all are read";
    for (name, triangles, note) in
        [("bin_cntless", 80, Some(counted)), ("binbin", 160, Some(joined)), ("bom", 80, None)]
    {
        let Some(read) = read(&format!("stl_count/{name}.stl")) else { return };
        assert_eq!(read.mesh.triangles().len(), triangles, "{name}");
        assert_eq!(read.notes, Vec::from_iter(note.map(str::to_owned)), "{name}");
        let volume = read.mesh.signed_volume() / (triangles / 80) as f64;
        assert!((volume - 3.6587).abs() < 1e-3, "{name}: {volume}");
    }
}

#[test]
fn soups_are_read_as_they_are() {
    let Some(read) = read("inspect_soup/soup.stl") else { return };
    assert_eq!(read.mesh.triangles().len(), 100);
    assert!(read.notes.is_empty());
}

#[test]
fn glb_far_from_the_origin() {
    let Some(far) = read("glb_far_from_origin/utm.off") else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("utm.glb");
    let notes = write_glb(&path, &far.mesh, &VertexAttributes::default()).unwrap();
    assert!(notes.is_empty(), "{notes:?}");
    let back = read_mesh(&path, &ReadOptions::default()).unwrap();
    assert_eq!(back.mesh.vertices().len(), 3756);
    assert_eq!(back.mesh.triangles(), far.mesh.triangles());
    let extent = far.mesh.bounding_box().unwrap().extent().into_iter().fold(0.0, f64::max);
    let pairs = back.mesh.vertices().iter().zip(far.mesh.vertices());
    let error = pairs.flat_map(|(a, b)| (0..3).map(|i| (a[i] - b[i]).abs())).fold(0.0, f64::max);
    assert!(error <= 6e-8 * extent, "{error} of {extent}");
}

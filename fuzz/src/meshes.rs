//! Mesh files, one target for each format.

use std::path::Path;

use mser3d_meshio::{LoadedMesh, MeshFormat, ReadOptions, read_mesh_from};

use crate::scratch::check_message;

#[path = "../../crates/meshio/tests/it/common.rs"]
mod common;
#[path = "../../crates/meshio/tests/it/good_files.rs"]
mod good_files;

const FORMATS: [MeshFormat; 11] = [
    MeshFormat::Obj,
    MeshFormat::Off,
    MeshFormat::Ply,
    MeshFormat::Stl,
    MeshFormat::Vtu,
    MeshFormat::Vtp,
    MeshFormat::Vtk,
    MeshFormat::Msh,
    MeshFormat::Medit,
    MeshFormat::Gltf,
    MeshFormat::Glb,
];
pub const OBJ: usize = 0;
pub const OFF: usize = 1;
pub const PLY: usize = 2;
pub const STL: usize = 3;
pub const VTU: usize = 4;
pub const VTP: usize = 5;
pub const VTK: usize = 6;
pub const MSH: usize = 7;
pub const MEDIT: usize = 8;
pub const GLTF: usize = 9;
pub const GLB: usize = 10;

/// A name in a folder that is not there: buffers beside the file are never found.
const NAME: &str = "nowhere/damaged";

pub fn run<const FORMAT: usize>(bytes: &[u8]) {
    let format = FORMATS[FORMAT];
    let rest = read(format, bytes, ReadOptions::default());
    if matches!(format, MeshFormat::Gltf | MeshFormat::Glb) {
        for (animation, time) in [("0", 0.0), ("0", 0.7), ("1", 2.0)] {
            let posed = read(
                format,
                bytes,
                ReadOptions { animation: Some(animation.into()), time, ..Default::default() },
            );
            // All frames share vertices and triangles.
            if let (Some(rest), Some(posed)) = (&rest, posed) {
                assert_eq!(rest.weld, posed.weld);
                assert_eq!(rest.mesh.triangles(), posed.mesh.triangles());
            }
        }
    }
}

fn read(format: MeshFormat, bytes: &[u8], options: ReadOptions) -> Option<LoadedMesh> {
    match read_mesh_from(format, bytes, Path::new(NAME), &options) {
        Ok(loaded) => {
            check(&loaded);
            Some(loaded)
        }
        Err(error) => {
            check_message(&error.to_string(), "damaged");
            None
        }
    }
}

fn check(loaded: &LoadedMesh) {
    let count = loaded.mesh.vertices().len();
    assert!(loaded.mesh.vertices().iter().flatten().all(|x| x.is_finite()));
    assert!(loaded.mesh.triangles().iter().flatten().all(|&v| (v as usize) < count));
    assert!(!loaded.mesh.triangles().is_empty());
    let numbers: Vec<usize> = (0..count).collect();
    let of_file = loaded.per_file_vertex(&numbers).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(of_file.len(), loaded.weld.as_ref().map_or(count, Vec::len));
}

pub fn seeds<const FORMAT: usize>() -> Vec<Vec<u8>> {
    let format = FORMATS[FORMAT];
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let good = good_files::good_files(&root.join("crates/meshio/tests/files"));
    let mut seeds: Vec<Vec<u8>> =
        good.into_iter().filter(|(of, _)| *of == format).map(|(_, bytes)| bytes).collect();
    let bad = std::fs::read_dir(root.join("fixtures/bad")).into_iter().flatten().flatten();
    let mut bad: Vec<_> = bad.map(|entry| entry.path()).collect();
    bad.sort();
    bad.retain(|path| MeshFormat::from_extension(path) == Some(format));
    seeds.extend(bad.iter().filter_map(|path| std::fs::read(path).ok()));
    seeds
}

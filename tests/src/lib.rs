//! What the tests in `tests/` beside this file share: shapes, settings, and regions as vertex sets.

/// The examples of the book, compiled and run with the tests of this documentation.
#[cfg(doctest)]
#[doc = include_str!("../../docs/crates.md")]
mod book {}

use std::path::{Path, PathBuf};

use mser3d::shape::{IndexSet, TriangleMesh};
use mser3d::voxelize::Pitch;
use mser3d::{Detector, Features, Input, Parameters};
use mser3d_meshio::{ReadOptions, read_mesh};

/// A mesh of the folder `fixtures`.
///
/// # Panics
/// When it cannot be read.
pub fn fixture(name: &str) -> TriangleMesh {
    read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures").join(name))
}

/// The mirror vertex of each vertex of a figure of the folder `fixtures`.
///
/// # Panics
/// When the file cannot be read.
pub fn mirror(figure: &str) -> Vec<u32> {
    let name = format!("../fixtures/{figure}_symmetry.txt");
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap();
    text.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

/// Real shapes, where they are at hand; a test that goes without them says so.
pub fn real_shapes() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    if !folder.is_dir() {
        eprintln!("skipped: there are no real shapes at {}", folder.display());
        return None;
    }
    Some(folder)
}

/// Any mesh file.
///
/// # Panics
/// When it cannot be read.
pub fn read(path: &Path) -> TriangleMesh {
    read_mesh(path, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}")).mesh
}

/// The default parameters on a coarser grid with fewer eigenpairs, for speed.
pub fn coarse(voxels: usize, eigenpairs: usize) -> Parameters {
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(voxels);
    parameters.spectrum.eigenpairs = eigenpairs.into();
    parameters.reliability.deformations = Some(0);
    parameters
}

/// The features of any input.
///
/// # Panics
/// When there are none.
pub fn features(input: Input, parameters: &Parameters) -> Features {
    Detector::new(parameters.clone()).detect(input).unwrap_or_else(|e| panic!("{e}"))
}

/// The features of the solid inside a mesh.
///
/// # Panics
/// When there are none.
pub fn solid_features(mesh: &TriangleMesh, parameters: &Parameters) -> Features {
    features(Input::Volume(mesh), parameters)
}

/// The regions as sets of the mesh's vertices.
///
/// # Panics
/// Never: vertices of regions are vertices of the mesh.
pub fn vertex_sets(features: &Features) -> Vec<IndexSet> {
    let vertices = features.shape.element_of_vertex().len();
    let set = |r: &mser3d::Region| IndexSet::from_members(vertices, r.vertices.iter().copied()).unwrap();
    features.regions.iter().map(set).collect()
}

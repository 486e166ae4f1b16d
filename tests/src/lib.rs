//! What the tests in `tests/` beside this file share: shapes, settings, and regions as vertex sets.

/// The examples of the book, compiled and run with the tests of this documentation.
#[cfg(doctest)]
#[doc = include_str!("../../docs/crates.md")]
mod book {}

use std::path::{Path, PathBuf};

use mser3d::shape::{Domain, TriangleMesh};
use mser3d::voxelize::Pitch;
use mser3d::{Features, Parameters, detect, no_progress};
use mser3d_meshio::{ReadOptions, read_mesh};
use mser3d_shrec11::VertexSet;

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

/// Real shapes, where they are at hand.
pub fn real_shapes() -> Option<PathBuf> {
    Some(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data")).filter(|path| path.is_dir())
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
    parameters
}

/// The features of the solid inside a mesh.
///
/// # Panics
/// When there are none.
pub fn solid_features(mesh: &TriangleMesh, parameters: &Parameters) -> Features {
    detect(mesh, Domain::Volume, parameters, &no_progress).unwrap_or_else(|e| panic!("{e}"))
}

/// The regions as sets of the mesh's vertices.
///
/// # Panics
/// Never: vertices of regions are vertices of the mesh.
pub fn vertex_sets(features: &Features) -> Vec<VertexSet> {
    let vertices = features.body.element_of_vertex().len();
    let members = |region: &mser3d::Region| region.vertices.iter().map(|&v| v as usize).collect::<Vec<_>>();
    features.regions.iter().map(|r| VertexSet::from_members(vertices, members(r)).unwrap()).collect()
}

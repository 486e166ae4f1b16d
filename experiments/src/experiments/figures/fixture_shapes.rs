//! The shapes that the figures are made from, and their regions as sets.

use std::error::Error;
use std::path::{Path, PathBuf};

use mser3d::Region;
use mser3d::shape::TriangleMesh;
use mser3d_evaluation::IndexSet;

use crate::solved::mesh;

/// A shape of fixtures/.
pub(super) fn fixture(name: &str) -> Result<TriangleMesh, Box<dyn Error>> {
    mesh(&fixture_path(name))
}

/// Its file.
pub(super) fn fixture_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures").join(name)
}

/// The vertices of each region.
pub(super) fn sets(mesh: &TriangleMesh, regions: &[Region]) -> Result<Vec<IndexSet>, Box<dyn Error>> {
    let of = |r: &Region| IndexSet::from_members(mesh.vertices().len(), r.vertices.iter().copied());
    Ok(regions.iter().map(of).collect::<Result<_, _>>()?)
}

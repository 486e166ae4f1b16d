//! Meshes and voxels to files.

mod glb;
mod moving_glb;
mod off;
mod ply;
mod vti;
mod vtk;
mod vtp;

pub use glb::write_glb;
pub use moving_glb::{Moment, write_moving_glb};
pub use off::write_off;
pub use ply::write_ply;
pub use vti::{VoxelField, VoxelValues, write_vti};
pub use vtp::write_vtp;

use crate::MeshIoError;
use mser3d_shape::{ShapeError, TriangleMesh};

/// What to write beside each vertex's position: one value per vertex each, or none.
#[derive(Clone, Copy, Debug, Default)]
pub struct VertexAttributes<'a> {
    /// Colour, sRGB.
    pub colors: Option<&'a [[u8; 3]]>,
    /// Number of the region, -1 for none.
    pub regions: Option<&'a [i32]>,
    /// Unit normal.
    pub normals: Option<&'a [[f64; 3]]>,
}

impl VertexAttributes<'_> {
    fn check(&self, mesh: &TriangleMesh) -> Result<(), MeshIoError> {
        let needed = mesh.vertices().len();
        for (what, found) in [
            ("vertex colors", self.colors.map(<[_]>::len)),
            ("vertex regions", self.regions.map(<[_]>::len)),
            ("vertex normals", self.normals.map(<[_]>::len)),
        ] {
            check_length(what, found.unwrap_or(needed), needed)?;
        }
        Ok(())
    }
}

pub(crate) fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), MeshIoError> {
    if found != expected {
        return Err(ShapeError::SizeMismatch { what, found, expected }.into());
    }
    Ok(())
}

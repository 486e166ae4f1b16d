//! The surface with triangles no larger than a voxel: borders of regions don't depend on the mesh.

use std::path::Path;

use mser3d::SurfacePoints;
use mser3d_meshio::write_ply;
use mser3d_shape::{Subdivision, TriangleMesh, VoxelGrid};

use crate::{Results, ResultsError};

/// Triangles beyond which edges are not split any more.
const MOST_TRIANGLES: usize = 4_000_000;

/// A surface in smaller triangles.
pub(crate) struct FineSurface {
    pub divided: Subdivision,
    /// The voxel that each of its vertices after those of the mesh takes.
    voxels: Vec<Option<u32>>,
}

impl FineSurface {
    /// One label per vertex, from those of the mesh's vertices and of the voxels; -1 where there is none.
    pub fn labels(&self, vertices: &[i32], voxels: &[i32]) -> Vec<i32> {
        let of_voxel = |voxel: &Option<u32>| voxel.map_or(-1, |voxel| voxels[voxel as usize]);
        vertices.iter().copied().chain(self.voxels.iter().map(of_voxel)).collect()
    }
}

impl Results {
    /// The surface with edges no longer than a voxel, and for each vertex the innermost region that holds the voxel that it sees, -1 for none.
    /// The vertices of the mesh come first, with the regions that they have there. `path` is what errors are about.
    ///
    /// # Errors
    /// [`ResultsError::Export`] without voxels or without a mesh.
    pub fn fine_surface(&self, path: &Path) -> Result<(TriangleMesh, Vec<i32>), ResultsError> {
        let refuse = |reason| ResultsError::Export { path: path.to_owned(), reason };
        let grid = self.grid.as_ref().ok_or_else(|| {
            refuse("the regions were found on a surface, whose vertices are all there is; write .ply")
        })?;
        if self.mesh_of_voxels {
            return Err(refuse("the input is voxels, whose faces are as fine as can be; write .ply"));
        }
        let fine = self.divided(grid, 1.0)?;
        let labels = fine.labels(&self.vertex_region(), &self.voxel_region());
        Ok((fine.divided.into_mesh(), labels))
    }

    /// The surface with edges no longer than so many voxels.
    pub(crate) fn divided(&self, grid: &VoxelGrid, voxels: f64) -> Result<FineSurface, ResultsError> {
        let longest = voxels * grid.frame().spacing().into_iter().fold(0.0, f64::max);
        let divided = Subdivision::new(&self.mesh, longest, MOST_TRIANGLES)?;
        let points = SurfacePoints::at(divided.places()[self.mesh.vertices().len()..].to_vec());
        Ok(FineSurface { voxels: points.voxels(&self.mesh, grid)?, divided })
    }

    /// Writes [`Results::fine_surface`] with colour and region of each vertex.
    pub(crate) fn write_fine_surface(&self, path: &Path) -> Result<(), ResultsError> {
        let (mesh, labels) = self.fine_surface(path)?;
        Ok(self.with_labels(&labels, |attributes| write_ply(path, &mesh, attributes))?)
    }
}

use mser3d::voxelize::{GridTopology, InsideTest, Voxelization};
use serde::{Deserialize, Serialize};

/// How a mesh became voxels. Lengths are in the mesh's units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct VoxelizationRecord {
    /// How inside was told from outside.
    pub inside: InsideTest,
    /// Why so.
    pub reason: String,
    /// The part of the voxels about which there is no doubt: 1 on closed meshes.
    pub confidence: f64,
    /// Voxels that could be called otherwise.
    pub ambiguous_voxels: usize,
    /// Voxels in the solid.
    pub voxels: usize,
    /// Voxels of the grid along each axis.
    pub dims: [usize; 3],
    /// First corner of the grid.
    pub origin: [f64; 3],
    /// Lengths of a voxel.
    pub spacing: [f64; 3],
    /// Volume of the solid.
    pub volume: f64,
    /// Components, tunnels and cavities of the solid.
    pub topology: GridTopology,
    /// Components that were dropped because another is larger.
    pub dropped_components: usize,
    /// Voxels in them.
    pub dropped_voxels: usize,
    /// Links between neighbours that the surface cuts.
    pub cut_links: usize,
    /// Volume that is covered more than once.
    pub overlap_volume: f64,
    /// Volume of the mesh, what it covers twice counted twice; none where it is open.
    pub mesh_volume: Option<f64>,
}

impl From<&Voxelization> for VoxelizationRecord {
    fn from(v: &Voxelization) -> Self {
        let frame = v.grid.frame();
        Self {
            inside: v.inside,
            reason: v.reason.to_string(),
            confidence: v.confidence,
            ambiguous_voxels: v.ambiguous_voxels,
            voxels: v.grid.len(),
            dims: frame.dims(),
            origin: frame.origin(),
            spacing: frame.spacing(),
            volume: v.grid.volume(),
            topology: v.topology,
            dropped_components: v.dropped_components,
            dropped_voxels: v.dropped_voxels,
            cut_links: v.cut_links,
            overlap_volume: v.overlap_volume,
            mesh_volume: v.mesh_volume,
        }
    }
}

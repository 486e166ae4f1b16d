//! Links to the 20 neighbours that share only an edge or a corner.

use crate::error::VoxelizeError;
use crate::parameters::VoxelizeParameters;
use crate::surface::Surface;
use mser3d_shape::{Connectivity, VoxelGrid};

pub(crate) fn determine(
    grid: VoxelGrid,
    _surface: &Surface,
    parameters: &VoxelizeParameters,
) -> Result<VoxelGrid, VoxelizeError> {
    if parameters.connectivity == Connectivity::Six || grid.cut_diagonals().is_some() {
        return Ok(grid);
    }
    Ok(grid.with_cut_diagonals(Vec::new())?)
}

use mser3d_laplace::cotangent_laplacian;
use mser3d_shape::{Connectivity, Domain, TriangleMesh, VoxelGrid};
use mser3d_spectral::{
    Extent, Spectrum, SpectrumParameters, smallest_eigenpairs, smallest_eigenpairs_of_grid,
};
use mser3d_voxelize::{Voxelization, VoxelizeParameters, voxelize};

use crate::Error;
use crate::progress::{Progress, ProgressFn, Stage};

/// What heat flows on: linked voxels, or the vertices of a surface.
///
/// Its *elements* are the voxels or the vertices.
#[derive(Clone, Debug)]
pub struct Body {
    graph: Graph,
    /// Where each element is: centres of voxels, positions of vertices.
    positions: Vec<[f64; 3]>,
    /// The element of each vertex of the mesh: its nearest voxel, or itself.
    element_of_vertex: Vec<u32>,
}

/// How the elements of a [`Body`] hang together.
// A grid is large beside a mesh, but there is one for each shape.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug)]
pub enum Graph {
    /// Voxels, neighbours as linked by the voxelizer.
    Voxels {
        /// The grid.
        grid: VoxelGrid,
        /// Neighbours that the component tree uses; the Laplacian always has 6.
        connectivity: Connectivity,
    },
    /// Vertices and edges of a mesh.
    Surface {
        /// The mesh.
        mesh: TriangleMesh,
        /// Its vertices and edges.
        edges: mser3d_shape::Graph,
    },
}

impl Body {
    /// The solid inside a mesh, and how it was voxelized.
    ///
    /// # Errors
    /// [`Error::Voxelize`].
    pub fn volume(
        mesh: &TriangleMesh,
        parameters: &VoxelizeParameters,
    ) -> Result<(Self, Voxelization), Error> {
        let voxelization = voxelize(mesh, parameters)?;
        let mut body = Self::solid(voxelization.grid.clone(), parameters.connectivity);
        body.element_of_vertex = voxelization.grid.nearest_voxels(mesh.vertices());
        Ok((body, voxelization))
    }

    /// A solid that is voxels from the start. It has no mesh, so its regions have no vertices.
    pub fn solid(grid: VoxelGrid, connectivity: Connectivity) -> Self {
        let positions = grid.voxels().map(|v| grid.frame().centre(v)).collect();
        Self { graph: Graph::Voxels { grid, connectivity }, positions, element_of_vertex: Vec::new() }
    }

    /// The surface of a mesh.
    pub fn surface(mesh: &TriangleMesh) -> Self {
        let element_of_vertex = (0..mesh.vertices().len() as u32).collect();
        let positions = mesh.vertices().to_vec();
        let graph = Graph::Surface { mesh: mesh.clone(), edges: mesh.edge_graph() };
        Self { graph, positions, element_of_vertex }
    }

    /// How the elements hang together.
    pub fn graph(&self) -> &Graph {
        &self.graph
    }

    /// The voxel grid of a volume.
    pub fn grid(&self) -> Option<&VoxelGrid> {
        match &self.graph {
            Graph::Voxels { grid, .. } => Some(grid),
            Graph::Surface { .. } => None,
        }
    }

    /// Volume or surface.
    pub fn domain(&self) -> Domain {
        match self.graph {
            Graph::Voxels { .. } => Domain::Volume,
            Graph::Surface { .. } => Domain::Surface,
        }
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are no elements.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Where each element is: centres of voxels, positions of vertices.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// The element that each vertex of the mesh takes its region from: its nearest voxel, or itself.
    pub fn element_of_vertex(&self) -> &[u32] {
        &self.element_of_vertex
    }

    /// The smallest eigenpairs of the Laplacian. They serve any number of weights.
    ///
    /// # Errors
    /// [`Error::Laplace`], [`Error::Spectral`], [`Error::Scale`], [`Error::Cancelled`].
    pub fn spectrum(&self, parameters: &SpectrumParameters, progress: ProgressFn) -> Result<Spectrum, Error> {
        let length = match &self.graph {
            Graph::Voxels { grid, .. } => grid.frame().spacing()[0] * (grid.len() as f64).cbrt(),
            Graph::Surface { mesh, .. } => mesh.bounding_box().map_or(0.0, |b| b.diagonal()),
        };
        // Shapes of no size at all are the solver's to refuse.
        if length > 0.0 && !(1e-20..=1e20).contains(&length) {
            return Err(Error::Scale { length });
        }
        let report = |done: usize| {
            let total = match parameters.eigenpairs {
                Extent::Count(total) => total,
                // How many there are is known when all are.
                _ => done,
            };
            progress(Progress { stage: Stage::Spectrum, done, total })
        };
        let spectrum = match &self.graph {
            Graph::Voxels { grid, .. } => smallest_eigenpairs_of_grid(grid, parameters, &report),
            Graph::Surface { mesh, .. } => {
                smallest_eigenpairs(&cotangent_laplacian(mesh)?, parameters, &report)
            }
        };
        spectrum.map_err(|error| match error {
            mser3d_spectral::SpectralError::Cancelled => Error::Cancelled,
            other => other.into(),
        })
    }
}

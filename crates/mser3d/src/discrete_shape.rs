use mser3d_laplace::cotangent_laplacian;
use mser3d_shape::{Connectivity, Domain, Graph, TriangleMesh, VoxelGrid};
use mser3d_spectral::{
    EigenpairRange, SpectralError, Spectrum, SpectrumParameters, smallest_eigenpairs,
    smallest_eigenpairs_of_grid,
};
use mser3d_voxelize::{Voxelization, VoxelizeParameters, voxelize};

use crate::Error;
use crate::progress::{Progress, ProgressFn, Stage};

/// A shape as heat sees it: the linked voxels of a solid, or the vertices of a surface. Either are its *elements*.
#[derive(Clone, Debug)]
pub struct DiscreteShape {
    elements: Elements,
    /// Where each element is: centres of voxels, positions of vertices.
    positions: Vec<[f64; 3]>,
    /// The element of each vertex of the mesh: its nearest voxel, or itself.
    element_of_vertex: Vec<u32>,
}

/// The elements of a [`DiscreteShape`], and which of them are neighbours.
// A grid is large beside a mesh, but there is one for each shape.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug)]
pub enum Elements {
    /// Voxels, neighbours as linked by the voxelizer.
    Voxels {
        /// The grid.
        grid: VoxelGrid,
        /// Neighbours that the component tree uses; the Laplacian always has 6.
        connectivity: Connectivity,
    },
    /// Vertices and edges of a mesh.
    Vertices {
        /// The mesh.
        mesh: TriangleMesh,
        /// Its vertices and edges.
        edges: Graph,
    },
}

impl DiscreteShape {
    /// The solid inside a mesh, and how it was voxelized.
    ///
    /// # Errors
    /// [`Error::Voxelize`].
    pub fn volume(
        mesh: &TriangleMesh,
        parameters: &VoxelizeParameters,
    ) -> Result<(Self, Voxelization), Error> {
        let voxelization = voxelize(mesh, parameters)?;
        let mut shape = Self::solid(voxelization.grid.clone(), parameters.connectivity);
        shape.element_of_vertex = voxelization.grid.nearest_voxels(mesh.vertices());
        Ok((shape, voxelization))
    }

    /// A solid that is voxels from the start. It has no mesh, so its regions have no vertices.
    pub fn solid(grid: VoxelGrid, connectivity: Connectivity) -> Self {
        let positions = grid.voxels().map(|v| grid.frame().centre(v)).collect();
        Self { elements: Elements::Voxels { grid, connectivity }, positions, element_of_vertex: Vec::new() }
    }

    /// The surface of a mesh.
    pub fn surface(mesh: &TriangleMesh) -> Self {
        let element_of_vertex = (0..mesh.vertices().len() as u32).collect();
        let positions = mesh.vertices().to_vec();
        let elements = Elements::Vertices { mesh: mesh.clone(), edges: mesh.edge_graph() };
        Self { elements, positions, element_of_vertex }
    }

    /// The elements, and which of them are neighbours.
    pub fn elements(&self) -> &Elements {
        &self.elements
    }

    /// The voxel grid of a volume.
    pub fn grid(&self) -> Option<&VoxelGrid> {
        match &self.elements {
            Elements::Voxels { grid, .. } => Some(grid),
            Elements::Vertices { .. } => None,
        }
    }

    /// Volume or surface.
    pub fn domain(&self) -> Domain {
        match self.elements {
            Elements::Voxels { .. } => Domain::Volume,
            Elements::Vertices { .. } => Domain::Surface,
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
        let length = match &self.elements {
            Elements::Voxels { grid, .. } => grid.frame().spacing()[0] * (grid.len() as f64).cbrt(),
            Elements::Vertices { mesh, .. } => mesh.bounding_box().map_or(0.0, |b| b.diagonal()),
        };
        // Shapes of no size at all are the solver's to refuse.
        if length > 0.0 && !(1e-20..=1e20).contains(&length) {
            return Err(Error::Scale { length });
        }
        let report = |done: usize| {
            let total = match parameters.eigenpairs {
                EigenpairRange::Count(count) => count,
                EigenpairRange::AtMost(most) => most.min(self.len()),
                // How many there are is known when all are.
                _ => done,
            };
            progress(Progress { stage: Stage::Spectrum, done, total })
        };
        let spectrum = match &self.elements {
            Elements::Voxels { grid, .. } => smallest_eigenpairs_of_grid(grid, parameters, &report),
            Elements::Vertices { mesh, .. } => {
                smallest_eigenpairs(&cotangent_laplacian(mesh)?, parameters, &report)
            }
        };
        spectrum.map_err(|error| match error {
            SpectralError::Cancelled => Error::Cancelled,
            other => other.into(),
        })
    }
}

use std::sync::Arc;

use mser3d_laplace::{Operator, cotangent_laplacian, grid_laplacian, mean_curvature};
use mser3d_shape::{
    Connectivity, Domain, Eigenbasis, FunctionsView, Graph, SplitMix64, TriangleMesh, VoxelGrid,
};
use mser3d_spectral::{
    SpectralError, Spectrum, SpectrumParameters, smallest_eigenpairs, smallest_eigenpairs_of_grid,
};
use mser3d_voxelize::{Voxelization, VoxelizeParameters};

use crate::bodies::Bodies;
use crate::progress::{NO_PROGRESS, Progress, ProgressFn, Stage};
use crate::solid::SolidOfMesh;
use crate::weld::weld;
use crate::{Error, Field, Positions};

/// A shape as heat sees it: the linked voxels of a solid, or the vertices of a surface. Either are its *elements*.
#[derive(Clone, Debug)]
pub struct DiscreteShape {
    elements: Elements,
    /// The element of each vertex of the mesh: the nearest voxel that it sees from inside, or the vertex that it
    /// was welded to.
    element_of_vertex: Vec<Option<u32>>,
    /// The mesh that voxels are the inside of.
    mesh: Option<Arc<TriangleMesh>>,
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
        /// The mesh, vertices at equal positions welded.
        mesh: TriangleMesh,
        /// Its vertices and edges.
        edges: Graph,
    },
}

impl DiscreteShape {
    /// The solid inside a mesh, and how it was voxelized: its largest component, or all of them if `largest_only` is
    /// off.
    ///
    /// # Errors
    /// [`Error::Voxelize`], and [`Error::Shape`] if diagonal neighbours are asked of a grid that doesn't know them.
    pub fn volume(
        mesh: &TriangleMesh,
        parameters: &VoxelizeParameters,
    ) -> Result<(Self, Voxelization), Error> {
        let bodies = parameters.largest_only.then_some(Bodies::Largest);
        let solid = SolidOfMesh::new(mesh, parameters, bodies, NO_PROGRESS)?;
        Ok((solid.shape, solid.voxelization))
    }

    /// A solid that is voxels from the start. It has no mesh, so its regions have no vertices.
    pub fn solid(grid: VoxelGrid, connectivity: Connectivity) -> Self {
        Self::solid_in_mesh(grid, connectivity, Vec::new(), None)
    }

    /// A solid, the voxel of each vertex of the mesh around it, and the mesh.
    pub(crate) fn solid_in_mesh(
        grid: VoxelGrid,
        connectivity: Connectivity,
        element_of_vertex: Vec<Option<u32>>,
        mesh: Option<Arc<TriangleMesh>>,
    ) -> Self {
        Self { elements: Elements::Voxels { grid, connectivity }, element_of_vertex, mesh }
    }

    /// The surface of a mesh, all pieces of it. Vertices at equal positions are one element, numbered by the first of
    /// them.
    ///
    /// # Errors
    /// [`Error::Shape`]: in theory, since part of a mesh is a mesh.
    pub fn surface(mesh: &TriangleMesh) -> Result<Self, Error> {
        let (welded, element) = weld(mesh)?;
        Ok(Self::of_surface(welded, element.into_iter().map(Some).collect()))
    }

    fn of_surface(mesh: TriangleMesh, element_of_vertex: Vec<Option<u32>>) -> Self {
        let edges = mesh.edge_graph();
        Self { elements: Elements::Vertices { mesh, edges }, element_of_vertex, mesh: None }
    }

    /// Some of the components as a shape on its own; `keep` says which elements.
    pub(crate) fn restrict(&self, keep: impl Fn(u32) -> bool) -> Result<Self, Error> {
        let mut kept = 0;
        let number: Vec<Option<u32>> = (0..self.len() as u32)
            .map(|element| {
                keep(element).then(|| {
                    kept += 1;
                    kept - 1
                })
            })
            .collect();
        let renumbered = |element: &Option<u32>| element.and_then(|e| number[e as usize]);
        let element_of_vertex = self.element_of_vertex.iter().map(renumbered).collect();
        Ok(match &self.elements {
            Elements::Voxels { grid, connectivity } => {
                let mesh = self.mesh.clone();
                Self::solid_in_mesh(grid.restrict(keep), *connectivity, element_of_vertex, mesh)
            }
            Elements::Vertices { mesh, .. } => {
                let positions = mesh.vertices().iter().zip(&number).filter_map(|(p, n)| n.map(|_| *p));
                let renumber = |t: &[u32; 3]| -> Option<[u32; 3]> {
                    let [a, b, c] = t.map(|v| number[v as usize]);
                    Some([a?, b?, c?])
                };
                let triangles = mesh.triangles().iter().filter_map(renumber).collect();
                Self::of_surface(TriangleMesh::new(positions.collect(), triangles)?, element_of_vertex)
            }
        })
    }

    /// Each body as a shape on its own, from the elements of each; without the mesh's vertices.
    pub(crate) fn split(&self, bodies: &[Vec<u32>]) -> Result<Vec<Self>, Error> {
        let mut labels = vec![u32::MAX; self.len()];
        for (body, elements) in (0..).zip(bodies) {
            elements.iter().for_each(|&e| labels[e as usize] = body);
        }
        match &self.elements {
            Elements::Voxels { grid, connectivity } => {
                let grids = grid.split(&labels, bodies.len())?;
                Ok(grids.into_iter().map(|grid| Self::solid(grid, *connectivity)).collect())
            }
            Elements::Vertices { .. } => {
                let body = |label: u32| self.restrict(|e| labels[e as usize] == label);
                (0..bodies.len() as u32).map(body).collect()
            }
        }
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

    /// The mesh of a surface, vertices welded and only what is searched, or the whole mesh that a solid is the inside of. None of a
    /// solid that is voxels from the start, and of bodies taken out of one.
    pub fn mesh(&self) -> Option<&TriangleMesh> {
        match &self.elements {
            Elements::Voxels { .. } => self.mesh.as_deref(),
            Elements::Vertices { mesh, .. } => Some(mesh),
        }
    }

    /// The mean curvature of each element, in length^-1: of a surface that of its vertices
    /// ([`mser3d_laplace::mean_curvature`]), of the solid in a mesh that of its surface, [carried](Self::carry) inside.
    ///
    /// # Errors
    /// [`Error::NoMesh`] of a solid that is voxels from the start, [`Error::Laplace`].
    pub fn mean_curvature(&self) -> Result<Field, Error> {
        match (&self.elements, &self.mesh) {
            (Elements::Vertices { mesh, .. }, _) => Field::scalar(mean_curvature(mesh)?),
            (Elements::Voxels { .. }, None) => Err(Error::NoMesh),
            (Elements::Voxels { .. }, Some(mesh)) => {
                let (welded, number) = weld(mesh)?;
                let curvature = mean_curvature(&welded)?;
                self.carry(&Field::scalar(number.into_iter().map(|v| curvature[v as usize]).collect())?)
            }
        }
    }

    /// Its Laplacian.
    pub(crate) fn operator(&self) -> Result<Operator, Error> {
        Ok(match &self.elements {
            Elements::Voxels { grid, .. } => grid_laplacian(grid),
            Elements::Vertices { mesh, .. } => cotangent_laplacian(mesh)?,
        })
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
        self.positions().len()
    }

    /// Whether there are no elements.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where each element is: centres of voxels, positions of vertices.
    pub fn positions(&self) -> Positions<'_> {
        match &self.elements {
            Elements::Voxels { grid, .. } => Positions::of_voxels(grid),
            Elements::Vertices { mesh, .. } => Positions::of_vertices(mesh.vertices()),
        }
    }

    /// The element that each vertex of the mesh takes its region from: the nearest voxel that it sees from inside (where limbs
    /// touch, the nearest of all may be of the other one), or the first vertex at its position. None where the vertex
    /// belongs to a body that is not part of this shape.
    pub fn element_of_vertex(&self) -> &[Option<u32>] {
        &self.element_of_vertex
    }

    /// How far a basis is from eigenpairs of this shape's Laplacian `W phi = lambda M phi`; infinite where it has other masses, or
    /// numbers that are not finite. For a spectrum that comes from elsewhere, such as a file.
    ///
    /// It is measured on a random combination f of the eigenfunctions, with unit coefficients c: the larger of
    /// `|W f - M Phi Lambda c|` (in the norm of M^-1, over the largest eigenvalue and 1e-9 of the bound of the spectrum) and
    /// `|Phi^T M f - c|`. A solver's result has about its tolerance; one wrong value of 45,000 x 100 is seen. Time: O(n k), a hundredth of
    /// solving.
    ///
    /// W makes rounding larger, and the more so the more voxels there are. So for eigenfunctions in single precision `|W f - M Phi Lambda c|`
    /// is taken without the part that their rounding explains, 2^-24 of the bound of the spectrum.
    ///
    /// # Errors
    /// [`Error::Laplace`].
    pub fn eigenpair_error(&self, basis: &Eigenbasis) -> Result<f64, Error> {
        let operator = self.operator()?;
        let (mass, values, k) = (operator.mass(), basis.eigenvalues(), basis.eigenvalues().len());
        if basis.domain() != self.domain() || basis.mass() != mass || k == 0 {
            return Ok(f64::INFINITY);
        }
        let mut random = SplitMix64::new(k as u64);
        let c: Vec<f64> = (0..k).map(|_| if random.next_u64() & 1 == 0 { -1.0 } else { 1.0 }).collect();
        let size = (k as f64).sqrt();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let scaled: Vec<f64> = values.iter().zip(&c).map(|(value, c)| value * c).collect();
        let mut scratch = Vec::new();
        let f: Vec<f64> = (0..basis.len()).map(|v| dot(basis.row(v, 0..k, &mut scratch), &c)).collect();
        let mut back = vec![0.0; k];
        let (mut square, mut bound) = (0.0, 0.0f64);
        for (v, row) in operator.stiffness().outer_iterator().enumerate().filter(|(v, _)| mass[*v] > 0.0) {
            let functions = basis.row(v, 0..k, &mut scratch);
            functions.iter().zip(&mut back).for_each(|(phi, sum)| *sum += phi * mass[v] * f[v]);
            let applied: f64 = row.iter().map(|(u, w)| w * f[u]).sum();
            square += (applied - mass[v] * dot(functions, &scaled)).powi(2) / mass[v];
            let weights: f64 = row.iter().map(|(_, w)| w.abs()).sum();
            bound = bound.max(weights / mass[v]);
        }
        let rounding = match basis.functions() {
            FunctionsView::Double(_) => 0.0,
            FunctionsView::Single(_) => f64::from(f32::EPSILON) / 2.0 * bound,
        };
        let residual = (square.sqrt() / size - rounding) / (values[k - 1] + 1e-9 * bound);
        let lost = back.iter().zip(&c).map(|(b, c)| (b - c).powi(2)).sum::<f64>().sqrt() / size;
        // The larger of them would hide a NaN.
        let error = residual + lost;
        Ok(if error.is_finite() { residual.max(lost) } else { f64::INFINITY })
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
        let report = |done: f64| progress(Progress { stage: Stage::Spectrum, done, overall: done });
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

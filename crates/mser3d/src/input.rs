use mser3d_shape::{Domain, TriangleMesh, VoxelGrid};
use mser3d_voxelize::{Pitch, Voxelization};

use crate::bodies::Parts;
use crate::progress::{NO_PROGRESS, ProgressFn};
use crate::shells::largest_share;
use crate::solid::SolidOfMesh;
use crate::{Bodies, DiscreteShape, Elements, Error, Parameters, Warning};

/// What regions are searched in.
#[derive(Clone, Debug)]
pub enum Input<'a> {
    /// The solid inside a mesh. Holes are closed by the winding number.
    Volume(&'a TriangleMesh),
    /// The surface of a mesh, vertices at equal positions welded.
    Surface(&'a TriangleMesh),
    /// A solid that is voxels from the start, such as a mask ([`VoxelGrid::solid`]). Of the parameters of the
    /// voxelizer it needs `connectivity` alone.
    Solid(&'a VoxelGrid),
    /// A shape that was made before, to serve several weights. It is taken as it is, and nothing left out, unless
    /// [`Bodies::All`] asks for each body on its own.
    Shape(Box<DiscreteShape>),
}

/// An input, made ready for the Laplacian.
pub(crate) struct Prepared {
    pub shape: DiscreteShape,
    /// The elements of each body that is searched on its own, the largest first.
    pub bodies: Vec<Vec<u32>>,
    pub voxelization: Option<Voxelization>,
    pub warnings: Vec<Warning>,
}

impl Input<'_> {
    /// Volume or surface.
    pub fn domain(&self) -> Domain {
        match self {
            Self::Volume(_) | Self::Solid(_) => Domain::Volume,
            Self::Surface(_) => Domain::Surface,
            Self::Shape(shape) => shape.domain(),
        }
    }

    /// About how many elements the shape will have: voxels as the pitch says, or vertices; of the bodies that will be
    /// searched. Bodies whose boxes meet are taken for one.
    pub fn expected_elements(&self, parameters: &Parameters) -> usize {
        let (bodies, pitch) = (parameters.bodies, parameters.voxelize.pitch);
        let mesh = match self {
            Self::Solid(grid) => return grid.len(),
            Self::Shape(shape) => return shape.len(),
            Self::Surface(mesh) => {
                let prepared = DiscreteShape::surface(mesh).and_then(|s| Prepared::some_bodies(s, bodies));
                return prepared.map_or(mesh.vertices().len(), |p| p.shape.len());
            }
            Self::Volume(mesh) => mesh,
        };
        let volume = mesh.signed_volume().abs();
        let share = if bodies == Bodies::Largest { largest_share(mesh) } else { 1.0 };
        let voxels = |pitch: f64| (share * volume / pitch.powi(3)).min(1e12) as usize;
        match pitch {
            Pitch::Voxels(n) => (share * n as f64) as usize,
            Pitch::Size(pitch) => voxels(pitch),
            Pitch::Spacing(lengths) => voxels(lengths.into_iter().product::<f64>().cbrt()),
            Pitch::Resolution(n) => {
                let extent = mesh.bounding_box().map_or([0.0; 3], |b| b.extent());
                voxels(extent.into_iter().fold(0.0, f64::max) / n as f64)
            }
        }
    }

    pub(crate) fn prepare(self, parameters: &Parameters, progress: ProgressFn) -> Result<Prepared, Error> {
        let (bodies, connectivity) = (parameters.bodies, parameters.voxelize.connectivity);
        match self {
            Self::Volume(mesh) => {
                Ok(SolidOfMesh::new(mesh, &parameters.voxelize, Some(bodies), progress)?.into())
            }
            Self::Surface(mesh) => {
                let shape = DiscreteShape::surface(mesh)?;
                let merged = mesh.vertices().len() - shape.len();
                let mut prepared = Prepared::some_bodies(shape, bodies)?;
                if merged > 0 {
                    prepared.warnings.insert(0, Warning::MergedVertices { vertices: merged });
                }
                Ok(prepared)
            }
            Self::Solid(grid) => {
                Prepared::some_bodies(DiscreteShape::solid(grid.clone(), connectivity), bodies)
            }
            Self::Shape(shape) if bodies == Bodies::All => Prepared::some_bodies(*shape, bodies),
            Self::Shape(shape) => {
                let everything = vec![(0..shape.len() as u32).collect()];
                Ok(Prepared { shape: *shape, bodies: everything, voxelization: None, warnings: Vec::new() })
            }
        }
    }
}

impl From<SolidOfMesh> for Prepared {
    fn from(solid: SolidOfMesh) -> Self {
        let SolidOfMesh { shape, voxelization, bodies, warnings } = solid;
        Self { shape, bodies, voxelization: Some(voxelization), warnings }
    }
}

impl Prepared {
    /// The bodies of a shape that are searched.
    fn some_bodies(shape: DiscreteShape, bodies: Bodies) -> Result<Self, Error> {
        let parts = Parts::of(&shape, bodies)?;
        let warnings = parts.warning(shape.domain()).into_iter().collect();
        let shape = if parts.keeps_all() { shape } else { shape.restrict(|element| parts.keeps(element))? };
        Ok(Self { shape, bodies: parts.searched(), voxelization: None, warnings })
    }
}

impl Parameters {
    /// The same parameters with the scale of one input, for shapes that are to be compared with it, such as poses of
    /// one body: times and descriptors refer to its volume (or area), and meshes get its pitch. Where bodies are
    /// searched each on its own, the largest is the measure of all.
    ///
    /// # Errors
    /// [`Error::Voxelize`] when the input has no solid, and the other errors of reading an input.
    pub fn with_scale_of(&self, input: Input) -> Result<Self, Error> {
        let Prepared { shape, bodies, voxelization, .. } = input.prepare(self, NO_PROGRESS)?;
        let mut parameters = self.clone();
        parameters.reference_measure = Some(match shape.elements() {
            Elements::Voxels { grid, .. } => bodies[0].len() as f64 * grid.frame().voxel_volume(),
            Elements::Vertices { mesh, .. } => {
                let areas = mesh.vertex_areas();
                bodies[0].iter().map(|&v| areas[v as usize]).sum()
            }
        });
        if let Some(voxelization) = voxelization {
            parameters.voxelize.pitch = Pitch::Size(voxelization.grid.frame().spacing()[0]);
        }
        Ok(parameters)
    }
}

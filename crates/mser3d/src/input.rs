use mser3d_shape::{Domain, TriangleMesh, VoxelGrid};
use mser3d_voxelize::{Pitch, Voxelization, VoxelizeParameters};

use crate::{DiscreteShape, Elements, Error, Parameters, Warning};

/// What regions are searched in.
#[derive(Clone, Debug)]
pub enum Input<'a> {
    /// The solid inside a mesh. Holes are closed by the winding number.
    Volume(&'a TriangleMesh),
    /// The surface of a mesh.
    Surface(&'a TriangleMesh),
    /// A solid that is voxels from the start, such as a mask ([`VoxelGrid::solid`]). Of the parameters of the
    /// voxelizer it needs `connectivity` and `largest_only` alone.
    Solid(&'a VoxelGrid),
    /// A shape that was made before, to serve several weights; it is taken as it is.
    Shape(Box<DiscreteShape>),
}

/// An input, made ready for the Laplacian.
pub(crate) struct Prepared {
    pub shape: DiscreteShape,
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

    /// About how many elements the shape will have: voxels as the pitch says, or the vertices.
    pub fn expected_elements(&self, pitch: Pitch) -> usize {
        let mesh = match self {
            Self::Solid(grid) => return grid.len(),
            Self::Shape(shape) => return shape.len(),
            Self::Surface(mesh) => return mesh.vertices().len(),
            Self::Volume(mesh) => mesh,
        };
        let volume = mesh.signed_volume().abs();
        let voxels = |pitch: f64| (volume / pitch.powi(3)).min(1e12) as usize;
        match pitch {
            Pitch::Voxels(n) => n,
            Pitch::Size(pitch) => voxels(pitch),
            Pitch::Spacing(lengths) => voxels(lengths.into_iter().product::<f64>().cbrt()),
            Pitch::Resolution(n) => {
                let extent = mesh.bounding_box().map_or([0.0; 3], |b| b.extent());
                voxels(extent.into_iter().fold(0.0, f64::max) / n as f64)
            }
        }
    }

    pub(crate) fn prepare(self, parameters: &Parameters) -> Result<Prepared, Error> {
        let VoxelizeParameters { connectivity, largest_only, .. } = parameters.voxelize;
        let plain = |shape| Prepared { shape, voxelization: None, warnings: Vec::new() };
        Ok(match self {
            Self::Volume(mesh) => {
                let (shape, voxelization) = DiscreteShape::volume(mesh, &parameters.voxelize)?;
                let warnings = voxelization.warnings.iter().cloned().map(Warning::Voxelize).collect();
                Prepared { shape, voxelization: Some(voxelization), warnings }
            }
            Self::Surface(mesh) => plain(DiscreteShape::surface(mesh)),
            Self::Shape(shape) => plain(*shape),
            Self::Solid(grid) if !largest_only => plain(DiscreteShape::solid(grid.clone(), connectivity)),
            Self::Solid(grid) => {
                let (largest, components, voxels) = grid.clone().largest_component();
                let fraction = voxels as f64 / grid.len() as f64;
                let dropped = Warning::SmallerComponents { components, voxels, fraction };
                let warnings = if voxels > 0 { vec![dropped] } else { Vec::new() };
                Prepared { warnings, ..plain(DiscreteShape::solid(largest, connectivity)) }
            }
        })
    }
}

impl Parameters {
    /// The same parameters with the scale of one input, for shapes that are to be compared with it, such as poses of
    /// one body: times and descriptors refer to its volume (or area), and meshes get its pitch.
    ///
    /// # Errors
    /// [`Error::Voxelize`] when the input has no solid.
    pub fn with_scale_of(&self, input: Input) -> Result<Self, Error> {
        let Prepared { shape, voxelization, .. } = input.prepare(self)?;
        let mut parameters = self.clone();
        parameters.reference_measure = Some(match shape.elements() {
            Elements::Voxels { grid, .. } => grid.volume(),
            Elements::Vertices { mesh, .. } => mesh.vertex_areas().iter().sum(),
        });
        if let Some(voxelization) = voxelization {
            parameters.voxelize.pitch = Pitch::Size(voxelization.grid.frame().spacing()[0]);
        }
        Ok(parameters)
    }
}

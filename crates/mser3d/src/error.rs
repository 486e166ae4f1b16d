use mser3d_shape::InvalidParameter;

/// Why there are no features: the error of the stage that failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The mesh is no solid, or the grid too coarse or too fine for it.
    #[error(transparent)]
    Voxelize(#[from] mser3d_voxelize::VoxelizeError),
    /// The surface has no Laplacian.
    #[error(transparent)]
    Laplace(#[from] mser3d_laplace::LaplaceError),
    /// The eigenpairs could not be computed.
    #[error(transparent)]
    Spectral(#[from] mser3d_spectral::SpectralError),
    /// The component tree could not be built or searched.
    #[error(transparent)]
    Tree(#[from] mser3d_comptree::TreeError),
    /// A weight or a descriptor could not be computed.
    #[error(transparent)]
    Descriptor(#[from] mser3d_descriptors::DescriptorError),
    /// The data does not fit together.
    #[error(transparent)]
    Shape(#[from] mser3d_shape::ShapeError),
    /// Coordinates so large or small that volumes or eigenvalues over- or underflow.
    #[error(
        "the shape measures about {length:.1e} across in its own units; \
         scale it so that this is between 1e-20 and 1e20 (its regions don't depend on the unit)"
    )]
    Scale {
        /// Cube root of the volume, or the surface's diagonal.
        length: f64,
    },
    /// A parameter of the pipeline itself is out of range.
    #[error(transparent)]
    InvalidParameter(#[from] InvalidParameter),
    /// The caller's progress function asked to stop.
    #[error("cancelled")]
    Cancelled,
}

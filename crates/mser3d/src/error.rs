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
    /// A field for another shape.
    #[error("the field has {found} values, but there are {expected} {what}; it needs one value for each")]
    FieldLength {
        /// Values of the field.
        found: usize,
        /// How many are needed.
        expected: usize,
        /// What needs them.
        what: &'static str,
    },
    /// A field whose numbers are no whole number of vectors.
    #[error("{values} numbers are no whole number of vectors of {width}")]
    FieldWidth {
        /// Numbers of the field.
        values: usize,
        /// Numbers of a vector.
        width: usize,
    },
    /// A value that is no weight.
    #[error("{place} is {value}; a weight is a finite number of at most 1e100 in size, so fill gaps first")]
    FieldValue {
        /// Which value, in words.
        place: String,
        /// The number.
        value: f64,
    },
    /// A field is to be the weight, and none was given.
    #[error(
        "the weight is a field, and none was given; give one by Detector::with_weight or find_regions_of_field"
    )]
    NoField,
    /// What needs a mesh was asked of a solid that is voxels from the start.
    #[error(
        "a mask or solid of voxels has no mesh around it, whose curvature or values could be taken; choose another weight, or a \
         field of its voxels"
    )]
    NoMesh,
    /// Altitudes on a log scale, and a weight that has no logarithm.
    #[error(
        "the weight is {value:e} in some place, which has no logarithm; choose linear altitudes (--altitude linear) or a \
         weight that is positive"
    )]
    NoLogarithm {
        /// The lowest weight.
        value: f64,
    },
    /// A run that would take more memory than it is allowed.
    #[error(
        "a run takes about {needed_mb} MB of memory ({elements} elements, {eigenpairs} eigenpairs), more than the limit of \
         {limit_mb} MB; use fewer voxels (--voxels) or eigenpairs (--eigenpairs), or raise --memory-limit"
    )]
    TooMuchMemory {
        /// Voxels or vertices, about.
        elements: usize,
        /// Eigenpairs, about.
        eigenpairs: usize,
        /// What it would take, by [`Parameters::estimate`](crate::Parameters::estimate).
        needed_mb: u64,
        /// The limit: `memory_limit` of the spectrum's parameters.
        limit_mb: u64,
    },
    /// A parameter of the pipeline itself is out of range.
    #[error(transparent)]
    InvalidParameter(#[from] InvalidParameter),
    /// The caller's progress function asked to stop.
    #[error("cancelled")]
    Cancelled,
}

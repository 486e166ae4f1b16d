use std::fmt;

/// What the user of a result should know of its input and how it was read.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// What the voxelizer found.
    Voxelize(mser3d_voxelize::Warning),
    /// Components of a solid given as voxels were dropped, because another is larger.
    SmallerComponents {
        /// How many.
        components: usize,
        /// Voxels in them.
        voxels: usize,
        /// The part of all voxels.
        fraction: f64,
    },
    /// The shape is so small that it has fewer eigenpairs than are used by default.
    FewEigenpairs {
        /// How many are used by default.
        wanted: usize,
        /// How many it has.
        available: usize,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Voxelize(warning) => warning.fmt(f),
            Self::SmallerComponents { components, voxels, fraction } => write!(
                f,
                "{components} smaller components with {voxels} voxels ({:.2} %) were dropped",
                100.0 * fraction
            ),
            Self::FewEigenpairs { wanted, available } => write!(
                f,
                "there are only {available} eigenpairs in so small a shape, not {wanted}; its descriptors compare \
                 only with those of shapes with --eigenpairs {available}"
            ),
        }
    }
}

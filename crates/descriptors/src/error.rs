use std::fmt::Display;

use mser3d_shape::InvalidParameter;

/// Why weights, descriptors or matches cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DescriptorError {
    /// A parameter is outside its range.
    #[error(transparent)]
    InvalidParameter(#[from] InvalidParameter),
    /// The eigenbasis has no vertices or no eigenpairs.
    #[error(
        "the eigenbasis has {vertices} vertices and {eigenpairs} eigenpairs; at least one of each is needed"
    )]
    EmptyBasis {
        /// Number of vertices or voxels.
        vertices: usize,
        /// Number of eigenpairs.
        eigenpairs: usize,
    },
    /// All eigenvalues are zero, so nothing is left when the zero modes are dropped.
    #[error(
        "all {eigenpairs} eigenvalues are zero: the shape has at least as many components; compute more eigenpairs or keep one component"
    )]
    OnlyZeroModes {
        /// Number of eigenpairs.
        eigenpairs: usize,
    },
    /// An edge, a region or a selection names a vertex that is not there.
    #[error("{element} {number} names vertex {index}, but there are {vertices} vertices (numbered from 0)")]
    IndexOutOfRange {
        /// What names the vertex: `"edge"`, `"region"`, `"point"` or `"selection entry"`.
        element: &'static str,
        /// Its number, from 0.
        number: usize,
        /// The vertex it names.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// Two arrays that belong together differ in size.
    #[error("{what}: found {found}, expected {expected}")]
    SizeMismatch {
        /// What the array is.
        what: &'static str,
        /// Its size.
        found: usize,
        /// The size it should have.
        expected: usize,
    },
    /// A descriptor holds NaN or an infinity, so that distances to it mean nothing.
    #[error("descriptor {row} holds a value that is not finite")]
    NotFinite {
        /// Its row, from 0.
        row: usize,
    },
    /// A region has no vertices, or all its vertices have mass zero: it has no mean.
    #[error("region {region} has no volume or area; drop empty regions first")]
    EmptyRegion {
        /// Its number, from 0.
        region: usize,
    },
    /// Fewer different descriptors than the operation needs.
    #[error(
        "{needed} different descriptors are needed, but there are {found}; take fewer words or more shapes"
    )]
    TooFewDescriptors {
        /// How many are needed.
        needed: usize,
        /// How many there are.
        found: usize,
    },
}

impl DescriptorError {
    pub(crate) fn parameter(name: &'static str, value: impl Display, expected: &'static str) -> Self {
        InvalidParameter::new(name, value, expected).into()
    }
}

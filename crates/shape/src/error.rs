use std::fmt;

use crate::InvalidParameter;

/// Why data cannot be a mesh, a grid, a graph or an eigenbasis.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ShapeError {
    /// A parameter out of its range.
    InvalidParameter(InvalidParameter),
    /// A triangle or an edge names a vertex that is not there.
    IndexOutOfRange {
        /// `"triangle"` or `"edge"`.
        element: &'static str,
        /// Number of the triangle or edge, from 0.
        number: usize,
        /// The vertex it names.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    NotFinite {
        /// Number of the vertex, from 0.
        vertex: usize,
    },
    /// More items than a 32-bit index counts.
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        count: u128,
        /// How many there may be.
        limit: u128,
    },
    /// Two arrays that belong together differ in size.
    SizeMismatch {
        /// What the array is.
        what: &'static str,
        /// Its size.
        found: usize,
        /// The size it should have.
        expected: usize,
    },
    /// The spacing of a grid is not a positive finite length.
    BadSpacing {
        /// The spacing along x, y and z.
        spacing: [f64; 3],
    },
    /// A matrix is no map from voxels to the world.
    BadAffine {
        /// What is wrong.
        reason: &'static str,
    },
    /// The axes of a grid are not at right angles.
    Sheared {
        /// The largest cosine between two axes.
        cosine: f64,
    },
    /// A link of a voxel grid leads to or from an empty voxel.
    DanglingLink {
        /// The voxel that the link starts from.
        voxel: [u32; 3],
        /// The axis it runs along: 0, 1 or 2.
        axis: usize,
    },
    /// 26 neighbours were asked of a grid whose diagonal links were never determined.
    DiagonalsUnknown,
    /// Eigenvalues that do not ascend, or a mass that is not positive.
    BadEigenbasis {
        /// What is wrong.
        reason: &'static str,
    },
}

impl fmt::Display for ShapeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IndexOutOfRange { element, number, index, vertices } => write!(
                f,
                "{element} {number} names vertex {index}, but there are {vertices} vertices (numbered from 0)"
            ),
            Self::NotFinite { vertex } => {
                write!(f, "vertex {vertex} has a coordinate that is NaN or infinite; remove or repair it")
            }
            Self::TooMany { what, count, limit } => {
                write!(f, "{count} {what} are more than the {limit} supported; use a coarser shape")
            }
            Self::SizeMismatch { what, found, expected } => {
                write!(f, "{what}: {found} given, {expected} needed")
            }
            Self::BadSpacing { spacing } => {
                write!(f, "grid spacing {spacing:?} must be positive and finite along each axis")
            }
            Self::BadAffine { reason } => {
                write!(f, "not a map from voxels to the world (voxel-to-world affine): {reason}")
            }
            Self::Sheared { cosine } => write!(
                f,
                "the voxels' axes are not at right angles (off by {:.1} degrees); resample the volume to a grid with right \
                 angles, by nearest neighbour for labels",
                cosine.clamp(-1.0, 1.0).asin().to_degrees()
            ),
            Self::DanglingLink { voxel, axis } => {
                write!(f, "the link of voxel {voxel:?} along axis {axis} has an empty voxel at one end")
            }
            Self::DiagonalsUnknown => f.write_str(
                "the grid has no diagonal links; voxelize with 26-connectivity to use 26 neighbours",
            ),
            Self::InvalidParameter(error) => error.fmt(f),
            Self::BadEigenbasis { reason } => write!(f, "not an eigenbasis: {reason}"),
        }
    }
}

impl std::error::Error for ShapeError {}

impl From<InvalidParameter> for ShapeError {
    fn from(error: InvalidParameter) -> Self {
        Self::InvalidParameter(error)
    }
}

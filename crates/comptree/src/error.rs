/// Why a tree cannot be built or its regions not be selected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TreeError {
    /// A weight is NaN, which no order has a place for.
    #[error("the weight of {what} {index} is NaN; replace it, for example by infinity to make it enter last")]
    NotANumber {
        /// `"vertex"` or `"edge"`.
        what: &'static str,
        /// Its number, from 0.
        index: usize,
    },
    /// A volume is negative, infinite or NaN.
    #[error("the volume of vertex {vertex} is {volume}; volumes must be finite and not negative")]
    BadVolume {
        /// Number of the vertex, from 0.
        vertex: usize,
        /// Its volume.
        volume: f64,
    },
    /// Two arrays that belong together differ in size.
    #[error("{what}: {found} given, {expected} needed")]
    SizeMismatch {
        /// What the array is.
        what: &'static str,
        /// Its size.
        found: usize,
        /// The size it should have.
        expected: usize,
    },
    /// An edge names a vertex that is not there.
    #[error("edge {edge} names vertex {index}, but there are {vertices} vertices (numbered from 0)")]
    IndexOutOfRange {
        /// Number of the edge, from 0.
        edge: usize,
        /// The vertex it names.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// More vertices or edges than 32-bit numbers count.
    #[error("{count} {what} are more than the {limit} supported; use a coarser grid or split it")]
    TooMany {
        /// `"vertices"` or `"edges"`.
        what: &'static str,
        /// How many there are.
        count: u128,
        /// How many there may be.
        limit: u128,
    },
    /// 26 neighbours were asked of a voxel grid whose diagonal links were never determined.
    #[error("the grid has no diagonal links; voxelize with 26-connectivity to use 26 neighbours")]
    DiagonalsUnknown,
    /// A graph or grid that cannot be.
    #[error(transparent)]
    Shape(#[from] mser3d_shape::ShapeError),
    /// A parameter is out of its range.
    #[error(transparent)]
    InvalidParameter(#[from] mser3d_shape::InvalidParameter),
}

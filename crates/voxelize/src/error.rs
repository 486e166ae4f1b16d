use mser3d_shape::{InvalidParameter, Readable, ShapeError};

/// Why a mesh cannot be voxelized.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VoxelizeError {
    /// A parameter is out of its range.
    #[error(transparent)]
    InvalidParameter(#[from] InvalidParameter),
    /// The mesh has no triangles.
    #[error("the mesh has no triangles; a solid needs a surface around it")]
    NoTriangles,
    /// More triangles than are supported.
    #[error("{count} triangles are more than the {limit} supported; decimate the mesh")]
    TooManyTriangles {
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// The mesh encloses nothing.
    #[error(
        "the surface encloses no volume ({triangles} triangles, {boundary_edges} boundary edges); \
         voxelization needs a surface around a solid"
    )]
    NoVolume {
        /// Triangles of the mesh.
        triangles: usize,
        /// Edges with one triangle.
        boundary_edges: usize,
    },
    /// Triangles that bound nothing: their winding numbers are fractions all over.
    #[error(
        "the {triangles} triangles bound no solid: with {boundary_edges} boundary edges and {non_manifold_edges} \
         edges of more than two triangles, their winding numbers are far from whole; repair the mesh, or count \
         crossings along three axes (the inside test `vote`)"
    )]
    Soup {
        /// Triangles of the mesh.
        triangles: usize,
        /// Edges with one triangle.
        boundary_edges: usize,
        /// Edges with more than two triangles.
        non_manifold_edges: usize,
    },
    /// No voxel centre lies inside.
    #[error(
        "no voxel centre lies inside the surface: at pitch {} the shape is thinner than a voxel; \
         a pitch of at most {:.4} should resolve it", Readable(*pitch), Readable(*advice)
    )]
    Thin {
        /// The pitch used, in the mesh's units.
        pitch: f64,
        /// A finer pitch.
        advice: f64,
    },
    /// Every voxel inside is covered more than once, and such voxels are left out.
    #[error(
        "all {voxels} voxels inside are covered more than once and were left out as an overlap; remove the \
         surfaces that repeat others, or join overlaps (`join`)"
    )]
    Doubled {
        /// Voxels covered more than once.
        voxels: usize,
    },
    /// The grid given by the user misses the solid.
    #[error("no voxel centre of the given grid lies inside the surface; check its origin and spacing")]
    OutsideFrame,
    /// A grid that is too large.
    #[error(
        "a pitch of {} needs a box of {} voxels, more than the limit of {limit}; {}raise max_box_voxels",
        Readable(*pitch), many(*voxels), coarser(*advice)
    )]
    TooLarge {
        /// The pitch asked for, in the mesh's units.
        pitch: f64,
        /// Voxels in the box.
        voxels: f64,
        /// The limit.
        limit: u64,
        /// The finest pitch within the limit, about; infinite where no box is as small as that.
        advice: f64,
    },
    /// Voxels smaller than the coordinates' own precision.
    #[error(
        "a pitch of {} is below the precision of coordinates as large as {}; \
         move the mesh to the origin or use a coarser pitch", Readable(*pitch), Readable(*reach)
    )]
    Imprecise {
        /// The pitch, in the mesh's units.
        pitch: f64,
        /// The largest coordinate.
        reach: f64,
    },
    /// The check that was given said to stop.
    #[error("cancelled")]
    Cancelled,
    /// The grid cannot be made.
    #[error(transparent)]
    Shape(#[from] ShapeError),
}

/// A number of voxels in words.
fn many(voxels: f64) -> String {
    match voxels {
        count if count < 1e6 => format!("{count:.0}"),
        count if count.is_finite() => format!("{count:.3e}"),
        _ => "more than 10^308".to_owned(),
    }
}

/// What else can be done about a box that is too large.
fn coarser(advice: f64) -> String {
    if advice.is_finite() {
        format!("use a pitch of at least {:.4} or ", Readable(advice))
    } else {
        String::new()
    }
}

use crate::VoxelizeError;
use mser3d_shape::{Connectivity, Frame};

/// The size of a voxel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pitch {
    /// About this many voxels in the solid: pitch = (|V| / n)^(1/3) for a closed mesh of signed
    /// volume V, to the last bit; V is estimated where the mesh is not closed.
    Voxels(usize),
    /// This many voxels along the longest side of the bounding box.
    Resolution(usize),
    /// The pitch itself, a length in the mesh's units.
    Size(f64),
    /// Lengths of a voxel along x, y and z, in the mesh's units.
    Spacing([f64; 3]),
}

/// How to tell inside from outside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// Let the [diagnosis](crate::diagnose) choose.
    #[default]
    Auto,
    /// Crossings along x, counted modulo 2. Needs no orientation; every hole leaks a line of voxels,
    /// and overlapping bodies cancel.
    Parity,
    /// Parity along x, y and z, and the majority of the three.
    Vote,
    /// The winding number, after neighbouring triangles were given one orientation: exact integers on
    /// closed surfaces, the generalized winding number (Jacobson et al. 2013) where there are holes.
    Winding,
}

/// What to do where solids overlap.
///
/// A voxel is in the solid once or not at all, so that a grid stays a mask with links and each voxel has one number.
/// An immersed solid, in which a cell that two limbs cover stands twice, once in each (Li and Barbič, *Immersion of
/// self-intersecting solids and surfaces*, 2018), would keep the volume that parting loses. It is left out for two
/// reasons: which copies of neighbouring cells belong together is decided by following the surface's sheets around
/// each curve of self-intersection, and a surface that is not the image of a solid (an open one, one that is
/// turned over in part, most scans) has no consistent answer; and every reader of a grid would have to know that
/// a place is no longer a voxel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Overlap {
    /// One connected surface that overlaps itself is limbs in contact: parted. Different bodies
    /// that overlap are a union: joined.
    #[default]
    Auto,
    /// Voxels that are covered twice are left out, whoever covers them.
    Part,
    /// Voxels that are covered twice belong to the solid and link to all their neighbours.
    Join,
}

/// A change of the solid by one voxel, against artefacts of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Morphology {
    /// Erosion, then dilation, by the 6-neighbourhood: drops what is thinner than three voxels.
    Open,
    /// Dilation, then erosion, by the 6-neighbourhood: fills slits and pits a voxel wide.
    Close,
}

/// Parameters of [`voxelize`](crate::voxelize).
#[derive(Clone, Debug, PartialEq)]
pub struct VoxelizeParameters {
    /// Size of a voxel. Default: [`Pitch::Voxels`]`(45_000)`. Ignored when `frame` is given.
    pub pitch: Pitch,
    /// How to tell inside from outside. Default: [`Method::Auto`].
    pub method: Method,
    /// What to do where solids overlap. Default: [`Overlap::Auto`].
    pub overlap: Overlap,
    /// Whether neighbours that the surface parts are not linked. Default: true.
    pub cut_links: bool,
    /// Neighbours that links are determined for. With [`Connectivity::TwentySix`] the diagonal
    /// ones too. Default: [`Connectivity::Six`].
    pub connectivity: Connectivity,
    /// The first corner of the grid, which reaches from there to one voxel beyond the mesh, in the mesh's units.
    /// Default: none, the lowest coordinates less one voxel. Ignored when `frame` is given.
    pub origin: Option<[f64; 3]>,
    /// The grid to use, to share it with other shapes or tools. Default: none, a grid around the mesh.
    pub frame: Option<Frame>,
    /// A change of the solid by one voxel. Default: none.
    pub morphology: Option<Morphology>,
    /// Whether to keep only the largest linked component. Default: true.
    pub largest_only: bool,
    /// Voxels in the grid's box beyond which to refuse, before memory is taken: a grid takes half a
    /// byte for each. Default: 2^32.
    pub max_box_voxels: u64,
}

impl Default for VoxelizeParameters {
    fn default() -> Self {
        Self {
            pitch: Pitch::Voxels(45_000),
            method: Method::Auto,
            overlap: Overlap::Auto,
            cut_links: true,
            connectivity: Connectivity::Six,
            origin: None,
            frame: None,
            morphology: None,
            largest_only: true,
            max_box_voxels: 1 << 32,
        }
    }
}

impl VoxelizeParameters {
    /// Checks each value on its own.
    ///
    /// # Errors
    /// [`VoxelizeError::BadParameter`], naming the parameter.
    pub fn validate(&self) -> Result<(), VoxelizeError> {
        let bad = |parameter, reason: String| Err(VoxelizeError::BadParameter { parameter, reason });
        match self.pitch {
            Pitch::Voxels(0) => return bad("voxels", "at least one voxel is needed".into()),
            Pitch::Resolution(0) => return bad("resolution", "at least one voxel is needed".into()),
            Pitch::Size(h) if !(h.is_finite() && h > 0.0) => {
                return bad("pitch", format!("{h} is not a positive length"));
            }
            Pitch::Spacing(spacing) if !spacing.iter().all(|h| h.is_finite() && *h > 0.0) => {
                return bad("spacing", format!("{spacing:?} are not three positive lengths"));
            }
            _ => {}
        }
        if self.origin.is_some_and(|origin| !origin.iter().all(|x| x.is_finite())) {
            return bad("origin", "its coordinates must be finite".into());
        }
        if self.frame.is_some_and(|f| f.dims().contains(&0)) {
            return bad("frame", "it has no voxels along an axis".into());
        }
        if self.max_box_voxels == 0 {
            return bad("max_box_voxels", "at least one voxel is needed".into());
        }
        Ok(())
    }
}

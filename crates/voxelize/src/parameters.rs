use crate::error::VoxelizeError;
use crate::inside_test::InsideTest;
use crate::morphology::Morphology;
use mser3d_shape::{Connectivity, Frame, InvalidParameter};

/// The size of a voxel.
///
/// Voxels are cubes, with two exceptions: [`Pitch::Spacing`], and bodies with flat sides along the axes whose
/// volume would be more than 3 % wrong, such as thin plates. For these [`Pitch::Voxels`] and
/// [`Pitch::Resolution`] stretch the voxels so that the sides fall between them, at the cost of a count up to
/// a third off, and [`Warning::Fitted`](crate::Warning::Fitted) says so.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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

mser3d_shape::choice! {
    /// What to do where solids overlap.
    ///
    /// A voxel is in the solid once or not at all, so that a grid stays a mask with links and each voxel
    /// has one number. An immersed solid, in which a cell that two limbs cover stands twice, once in each
    /// (Li and Barbič, *Immersion of self-intersecting solids and surfaces*, 2018), would keep the volume
    /// that parting loses. It is not offered, for two reasons: which copies of neighbouring cells belong
    /// together is decided by following the surface's sheets around each curve of self-intersection, and a
    /// surface that is not the image of a solid (an open one, one that is turned over in part, most scans)
    /// has no consistent answer; and every reader of a grid would have to know that a place is no longer a
    /// voxel.
    pub enum Overlap("overlap policy") {
        /// A surface that overlaps itself is parted, different bodies are joined
        ///
        /// One connected surface that overlaps or touches itself is taken for limbs in contact, bodies that
        /// overlap or touch for a union. Bodies touch when the gap is at most 1e-9 of the grid's longest side.
        #[default]
        Auto = "auto",
        /// Voxels that are covered twice are left out
        ///
        /// Whether one body covers them twice or two bodies once each.
        Part = "part",
        /// Voxels that are covered twice belong to the solid
        ///
        /// They link to all their neighbours.
        Join = "join",
    }
}

/// Parameters of [`voxelize`](crate::voxelize).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct VoxelizeParameters {
    /// Size of a voxel. Default: [`Pitch::Voxels`]`(45_000)`. Ignored when `frame` is given.
    pub pitch: Pitch,
    /// How to tell inside from outside. Default: [`InsideTest::Auto`].
    pub inside: InsideTest,
    /// What to do where solids overlap. Default: [`Overlap::Auto`].
    pub overlap: Overlap,
    /// Whether to cut the links between neighbours that the surface runs between. Default: true.
    pub cut_links: bool,
    /// Neighbours for which links are determined: with [`Connectivity::TwentySix`] the diagonal
    /// ones too. Default: [`Connectivity::Six`].
    pub connectivity: Connectivity,
    /// The first corner of the grid, which reaches from there to one voxel beyond the mesh, in the mesh's
    /// units. Default: none, a grid centred on the middle of the mesh's bounding box. Ignored when `frame` is
    /// given.
    pub origin: Option<[f64; 3]>,
    /// The grid to use, to share it with other shapes or tools. Default: none, a grid around the mesh.
    pub frame: Option<Frame>,
    /// A change of the solid by one voxel. Default: none.
    pub morphology: Option<Morphology>,
    /// Whether to keep only the largest linked component. Default: true.
    pub largest_only: bool,
    /// Boxes of more voxels than this are refused before memory is taken: a grid takes half a byte for
    /// each voxel. Default: 2^32.
    // It refuses work, and never changes a solid.
    #[cfg_attr(feature = "serde", serde(skip, default = "default_max_box_voxels"))]
    pub max_box_voxels: u64,
}

fn default_max_box_voxels() -> u64 {
    1 << 32
}

impl Default for VoxelizeParameters {
    fn default() -> Self {
        Self {
            pitch: Pitch::Voxels(45_000),
            inside: InsideTest::Auto,
            overlap: Overlap::Auto,
            cut_links: true,
            connectivity: Connectivity::Six,
            origin: None,
            frame: None,
            morphology: None,
            largest_only: true,
            max_box_voxels: default_max_box_voxels(),
        }
    }
}

impl VoxelizeParameters {
    /// Checks each value on its own.
    ///
    /// # Errors
    /// [`VoxelizeError::InvalidParameter`], naming the parameter.
    pub fn validate(&self) -> Result<(), VoxelizeError> {
        let positive = |h: f64| h.is_finite() && h > 0.0;
        match self.pitch {
            Pitch::Voxels(n) => InvalidParameter::unless(n > 0, "voxels", n, "at least 1")?,
            Pitch::Resolution(n) => InvalidParameter::unless(n > 0, "resolution", n, "at least 1")?,
            Pitch::Size(h) => InvalidParameter::unless(positive(h), "pitch", h, "a positive length")?,
            Pitch::Spacing(spacing) => {
                let valid = spacing.iter().all(|&h| positive(h));
                InvalidParameter::unless(valid, "spacing", format!("{spacing:?}"), "three positive lengths")?;
            }
        }
        if let Some(origin) = self.origin {
            let valid = origin.iter().all(|x| x.is_finite());
            InvalidParameter::unless(valid, "origin", format!("{origin:?}"), "three finite coordinates")?;
        }
        if let Some(frame) = self.frame {
            let dims = frame.dims();
            let valid = !dims.contains(&0);
            InvalidParameter::unless(
                valid,
                "frame",
                format!("{dims:?} voxels"),
                "at least one voxel along each axis",
            )?;
        }
        let along = self.frame.is_none_or(|frame| frame.is_along_axes());
        InvalidParameter::unless(along, "frame", "turned", "a grid along x, y and z; turn the mesh instead")?;
        Ok(InvalidParameter::unless(
            self.max_box_voxels > 0,
            "max_box_voxels",
            self.max_box_voxels,
            "at least 1",
        )?)
    }
}

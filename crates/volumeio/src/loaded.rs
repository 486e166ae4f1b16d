//! A volume together with what its file says of it.
use crate::{Volume, VolumeFormat};
use std::fmt;

mser3d_shape::choice! {
    /// What the channels of a volume are.
    pub enum ChannelKind("kind of channels") {
        /// A number for each voxel
        #[default]
        One = "one",
        /// The colours of a voxel: grey and alpha, RGB or RGBA
        Colours = "colours",
        /// Several volumes on one grid: points in time, frames, components, dyes
        Volumes = "volumes",
        /// The layers of a segmentation: each is a label map, and bodies of different layers may overlap
        Layers = "layers",
    }
}

mser3d_shape::choice! {
    /// What the axes x, y and z of a volume's world are.
    pub enum WorldAxes("kind of world axes") {
        /// x runs to the right of the patient, y to the front, z to the head, as in NIfTI
        Ras = "ras",
        /// x runs along a row, y down the rows and z along the pages, as in TIFF
        Image = "image",
        /// x, y and z are the axes of the array, as in NumPy
        Array = "array",
        /// The file has axes of its own and does not say which way they run, as NRRD without an anatomical space
        #[default]
        File = "file",
    }
}

/// The space that the affine of a volume leads to.
///
/// ```
/// use mser3d_volumeio::{World, WorldAxes};
/// let world = World { axes: WorldAxes::Ras, unit: Some("mm".to_owned()) };
/// assert_eq!(world.to_string(), "x right, y anterior, z superior (RAS+), in mm");
/// assert_eq!(World::default().to_string(), "the file's own axes; the file names no unit");
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct World {
    /// What the axes are.
    pub axes: WorldAxes,
    /// The unit of length, if the file says one: `mm`, `um`, `m`, `cm`, `inch`, ...
    pub unit: Option<String>,
}

impl World {
    /// Right, anterior, superior, in a unit.
    pub(crate) fn ras(unit: impl Into<String>) -> Self {
        Self { axes: WorldAxes::Ras, unit: Some(unit.into()) }
    }
}

impl fmt::Display for World {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.axes {
            WorldAxes::Ras => "x right, y anterior, z superior (RAS+)",
            WorldAxes::Image => "x along a row, y down the rows, z along the pages",
            WorldAxes::Array => "x, y and z are the axes of the array",
            WorldAxes::File => "the file's own axes",
        })?;
        match (&self.unit, self.axes) {
            (Some(unit), _) => write!(f, ", in {unit}"),
            (None, WorldAxes::Ras) => f.write_str("; the file names no unit (mm is usual)"),
            (None, _) => f.write_str("; the file names no unit"),
        }
    }
}

/// A label of a segmentation that has a name in the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Segment {
    /// The value of its voxels.
    pub value: i64,
    /// The channel of the volume that it is in; 0 where there are no layers.
    pub layer: usize,
    /// Its name.
    pub name: String,
}

/// What a file of a volume holds.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LoadedVolume {
    /// The voxels and where they lie.
    pub volume: Volume,
    /// The format it was read as.
    pub format: VolumeFormat,
    /// What the channels of the volume are.
    pub channels: ChannelKind,
    /// What the axes of its world are, and their unit.
    pub world: World,
    /// Which of the file's statements placed it, such as `sform (scanner)`.
    pub placed_by: String,
    /// The labels that the file has names for.
    pub segments: Vec<Segment>,
    /// What its user should know: what was guessed, what disagrees, what was left out. Each is a sentence.
    pub notes: Vec<String>,
}

impl LoadedVolume {
    /// A volume that is known as an array, as from a `.npy` file: its axes are those of the world.
    pub fn of_array(volume: Volume) -> Self {
        let world = World { axes: WorldAxes::Array, unit: None };
        Self { world, ..Self::plain(volume, VolumeFormat::Npy) }
    }

    /// A volume of which the file says no more.
    pub(crate) fn plain(volume: Volume, format: VolumeFormat) -> Self {
        let channels = match volume.channels() {
            1 => ChannelKind::One,
            _ => ChannelKind::Volumes,
        };
        let placed_by = "nothing: voxels of size 1".to_owned();
        Self {
            volume,
            format,
            channels,
            world: World::default(),
            placed_by,
            segments: Vec::new(),
            notes: Vec::new(),
        }
    }
}

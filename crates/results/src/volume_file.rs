use std::path::{Path, PathBuf};

use mser3d_fileio::{FileError, InputFile};
use mser3d_shape::{BitGrid, ShapeError, VoxelGrid};
use mser3d_volumeio::{
    Affine, Body, BodyParameters, ChannelKind, LabelCount, LoadedVolume, Volume, VolumeFormat, VolumeIoError,
    World, WorldAxes, read_volume_as,
};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::shape_file::{Contents, ShapeFile, hex};
use crate::{ResultsError, ShapeOptions};

/// A file with a volume that was read: a mask, or a label map, of which each label is a shape.
///
/// ```no_run
/// use mser3d_results::{ShapeOptions, VolumeFile};
/// let file = VolumeFile::read("seg.nii.gz".as_ref(), &ShapeOptions::default())?;
/// for label in file.labels(None)? {
///     let shape = file.label(&label)?;
/// }
/// # Ok::<(), mser3d_results::ResultsError>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct VolumeFile {
    /// The file, or the name of what is in memory.
    pub path: PathBuf,
    /// SHA-256 of the file; of data in a second file, see [`BodyRecord::sha256`]. None of what was in memory.
    pub sha256: Option<String>,
    /// Its size; none of what was in memory.
    pub bytes: Option<u64>,
    /// Its format; none of what was in memory.
    pub format: Option<VolumeFormat>,
    /// What it holds.
    pub loaded: LoadedVolume,
}

/// A solid that was read from a volume.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SolidVolume {
    /// The format of its file; none of what was in memory.
    pub format: Option<VolumeFormat>,
    /// Its voxels, on the grid of the whole volume.
    pub grid: VoxelGrid,
    /// What a record says of it.
    pub record: VolumeRecord,
    /// What reading it said.
    pub notes: Vec<String>,
}

/// What a record says of a volume: its grid, and which of its voxels are the body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct VolumeRecord {
    /// Voxels along the axes of the array.
    pub dims: [usize; 3],
    /// Index to world, 4 x 4: the centre of voxel (i, j, k) is `affine (i, j, k, 1)`.
    pub affine: Affine,
    /// The way each axis of the array runs, as in nibabel: `LPS`; none where the world has no right and left.
    pub axis_codes: Option<String>,
    /// What the world's axes are, and their unit.
    pub world: World,
    /// Which of the file's statements placed it.
    pub placed_by: String,
    /// Type of the values, as Rust calls it.
    pub value_type: String,
    /// Values of a voxel: volumes, colours or layers.
    pub channels: usize,
    /// What the channels are.
    pub channel_kind: ChannelKind,
    /// Which voxels are the body; none where that has to be chosen first.
    pub body: Option<BodyRecord>,
}

/// Which voxels of a volume are the body, all pieces of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct BodyRecord {
    /// The volume of several that it was taken from, from 0.
    pub volume_number: usize,
    /// Its label, if it was chosen by one.
    pub label: Option<i64>,
    /// The label's name.
    pub name: Option<String>,
    /// The value from which on voxels are inside, if it was chosen by one.
    pub threshold: Option<f64>,
    /// Its voxels.
    pub voxels: usize,
    /// Its volume in length^3: mm^3 where the unit is mm.
    pub volume: f64,
    /// Its centre of mass in the world.
    pub centroid: [f64; 3],
    /// Components under 6 neighbours.
    pub components: usize,
    /// SHA-256 of its voxels.
    pub sha256: String,
}

impl VolumeFile {
    /// Reads a volume, places it and names its labels.
    ///
    /// # Errors
    /// [`ResultsError::File`], [`ResultsError::Volume`], [`ResultsError::Placement`], naming the file.
    pub fn read(path: &Path, options: &ShapeOptions) -> Result<Self, ResultsError> {
        options.placement.validate()?;
        let format = options.volume_format(path);
        let format = format.ok_or_else(|| VolumeIoError::UnknownFormat { path: path.to_owned() })?;
        // First, so that what is refused is refused at once.
        let loaded = read_volume_as(format, path, options.limits())?;
        let (sha256, bytes) = file_sha256(path)?;
        let (path, sha256, bytes) = (path.to_owned(), Some(sha256), Some(bytes));
        let file = Self { path, sha256, bytes, format: Some(format), loaded };
        file.placed(options)
    }

    /// A volume that is in memory, placed, and its labels named; `name` tells people where it came from.
    ///
    /// # Errors
    /// [`ResultsError::Placement`], [`ResultsError::InvalidParameter`].
    pub fn of_volume(volume: Volume, name: &str, options: &ShapeOptions) -> Result<Self, ResultsError> {
        options.placement.validate()?;
        let loaded = LoadedVolume::of_array(volume);
        Self { path: name.into(), sha256: None, bytes: None, format: None, loaded }.placed(options)
    }

    fn placed(self, options: &ShapeOptions) -> Result<Self, ResultsError> {
        let loaded = self.loaded.with_label_names(&options.label_names);
        let loaded = loaded.placed(&options.placement).map_err(|e| misplaced(&self.path, e))?;
        Ok(Self { loaded, ..self })
    }

    /// The labels of a label map but 0, of one of several volumes or of all layers.
    ///
    /// # Errors
    /// [`ResultsError::Body`].
    pub fn labels(&self, volume: Option<usize>) -> Result<Vec<LabelCount>, ResultsError> {
        self.loaded.labels(volume).map_err(|error| ResultsError::Body { path: self.path.clone(), error })
    }

    /// The shape of a label.
    ///
    /// # Errors
    /// As [`VolumeFile::shape`].
    pub fn label(&self, label: &LabelCount) -> Result<ShapeFile, ResultsError> {
        self.shape(&BodyParameters { volume: Some(label.volume), ..BodyParameters::of_label(label.value) })
    }

    /// The shape of the body.
    ///
    /// # Errors
    /// [`ResultsError::Body`] where the body has to be chosen, [`ResultsError::Placement`] for axes that are not at right
    /// angles.
    pub fn shape(&self, parameters: &BodyParameters) -> Result<ShapeFile, ResultsError> {
        let path = &self.path;
        let body = self.loaded.body(parameters);
        let body = body.map_err(|error| ResultsError::Body { path: path.clone(), error })?;
        let frame = self.loaded.volume.frame().map_err(|e| misplaced(path, e))?;
        let mut record = self.record();
        let Body { mask, notes, .. } = &body;
        let grid = VoxelGrid::solid(frame, mask.clone())?;
        record.body = Some(body_record(&body, &grid, &record.affine, parameters.threshold));
        let notes = self.loaded.notes.iter().chain(notes).cloned().collect();
        let solid = SolidVolume { format: self.format, grid, record, notes };
        Ok(ShapeFile {
            path: path.clone(),
            sha256: self.sha256.clone(),
            bytes: self.bytes,
            pose: Default::default(),
            contents: Contents::Volume(Box::new(solid)),
        })
    }

    /// What a record says of the volume, without a body.
    pub fn record(&self) -> VolumeRecord {
        let LoadedVolume { volume, world, placed_by, channels, .. } = &self.loaded;
        let affine = *volume.affine();
        VolumeRecord {
            dims: volume.dims(),
            affine,
            axis_codes: (world.axes == WorldAxes::Ras).then(|| affine.axis_codes()),
            world: world.clone(),
            placed_by: placed_by.clone(),
            value_type: volume.samples().type_name().to_owned(),
            channels: volume.channels(),
            channel_kind: *channels,
            body: None,
        }
    }
}

/// The hash of a file, and its size, without holding it.
fn file_sha256(path: &Path) -> Result<(String, u64), FileError> {
    let fault = |source| FileError::Read { path: path.to_path_buf(), source };
    let mut hash = Sha256::new();
    let bytes = std::io::copy(&mut InputFile::open(path).map_err(fault)?, &mut hash).map_err(fault)?;
    Ok((hex(hash.finalize()), bytes))
}

fn misplaced(path: &Path, error: ShapeError) -> ResultsError {
    ResultsError::Placement { path: path.to_owned(), error }
}

fn body_record(body: &Body, grid: &VoxelGrid, affine: &Affine, threshold: Option<f64>) -> BodyRecord {
    // Whole numbers: the sum is exact.
    let mut sum = [0.0; 3];
    body.mask.ones().for_each(|v| (0..3).for_each(|a| sum[a] += f64::from(v[a])));
    let voxels = grid.len();
    BodyRecord {
        volume_number: body.volume,
        label: body.label,
        name: body.name.clone(),
        threshold,
        voxels,
        volume: voxels as f64 * affine.determinant().abs(),
        centroid: affine.position(sum.map(|s| s / voxels as f64)),
        components: grid.components().len(),
        sha256: mask_sha256(&body.mask),
    }
}

fn mask_sha256(mask: &BitGrid) -> String {
    let mut hash = Sha256::new();
    mask.dims().iter().for_each(|&d| hash.update((d as u64).to_le_bytes()));
    mask.words().iter().for_each(|word| hash.update(word.to_le_bytes()));
    hex(hash.finalize())
}

impl VolumeRecord {
    /// Grid, place and type in words, a name and a value each.
    pub(crate) fn describe(&self) -> Vec<(&'static str, String)> {
        let [x, y, z] = self.dims;
        // Headers have them as f32; more digits are noise.
        let [hx, hy, hz] = self.affine.spacing().map(|h| h as f32);
        // Not -0.
        let [ox, oy, oz] = self.affine.origin().map(|x| x + 0.0);
        let unit = self.world.unit.as_deref().map_or(String::new(), |unit| format!(" {unit}"));
        let mut lines = vec![("grid", format!("{x} x {y} x {z} voxels of {hx} x {hy} x {hz}{unit}"))];
        let channels = match self.channels {
            1 => String::new(),
            n => format!(", {n} {}", self.channel_kind),
        };
        lines.push(("values", format!("{}{channels}", self.value_type)));
        let codes = self.axis_codes.as_ref().map_or(String::new(), |codes| format!("{codes}, "));
        let turned = match self.affine.is_along_axes() {
            true => "",
            false => ", oblique",
        };
        lines.push(("orientation", format!("{codes}first voxel at {ox}, {oy}, {oz}{turned}")));
        lines.push(("world", self.world.to_string()));
        lines.push(("placed by", self.placed_by.clone()));
        lines
    }
}

//! What `tracks.json` says: regions that are followed through a sequence.

use std::path::Path;

use mser3d_fileio::{InputFile, write_text};
use mser3d_shape::InvalidParameter;
use serde::{Deserialize, Serialize};

use crate::load::parse;
use crate::{Checksums, FORMAT, ResultsError};

/// How regions are followed through a sequence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrackParameters {
    /// Where frames have the same vertices: the least overlap at which a region of one is that of another, above 0 and at most 1.
    /// Default 0.5.
    pub min_overlap: f64,
    /// Where they have not: the least likeness, above 0 and at most 1. Default 0.2.
    pub min_likeness: f64,
    /// In how many frames in a row a region may be missing and keep its identity. Default 3.
    pub max_gap: usize,
    /// Points on the surface on which overlaps are measured, from 100 to a million. Default 4096.
    pub points: usize,
    /// Over how many frames before and after one a region's reliability is averaged. Default 3.
    pub reliability_frames: usize,
}

impl Default for TrackParameters {
    fn default() -> Self {
        Self { min_overlap: 0.5, min_likeness: 0.2, max_gap: 3, points: 4096, reliability_frames: 3 }
    }
}

impl TrackParameters {
    /// Checks every range.
    ///
    /// # Errors
    /// [`InvalidParameter`] for the first value out of its range.
    pub fn validate(&self) -> Result<(), InvalidParameter> {
        for (name, value) in [("min_overlap", self.min_overlap), ("min_likeness", self.min_likeness)] {
            InvalidParameter::unless(value > 0.0 && value <= 1.0, name, value, "above 0 and at most 1")?;
        }
        let points = self.points;
        InvalidParameter::unless((100..=1_000_000).contains(&points), "points", points, "from 100 to 1000000")
    }
}

mser3d_shape::choice! {
    /// What regions of two frames are compared by.
    pub enum Identity("identity") {
        /// Places on the surface: the frames have the same triangles, so vertex i is the same place of the body in both
        #[default]
        Vertices = "vertices",
        /// Descriptors and where they are in space
        Descriptors = "descriptors",
    }
}

/// What `tracks.json` says. Its JSON Schema is `docs/tracks.schema.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct TracksRecord {
    /// The version of mser3d that followed the regions.
    pub mser3d: String,
    /// The layout of the file: [`FORMAT`]. Programs refuse others.
    pub format: u32,
    /// How they were followed.
    pub parameters: TrackParameters,
    /// The frames, in their order.
    pub frames: Vec<TrackedFrame>,
    /// The tracks, by first frame, then by descending volume.
    pub tracks: Vec<Track>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// A frame of a sequence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrackedFrame {
    /// Its name, the folder of its result.
    pub name: String,
    /// The file.
    pub path: String,
    /// When in the animation, in seconds; none for a file of its own.
    pub time: Option<f64>,
    /// How many regions it has; none where it has no result.
    pub regions: Option<usize>,
    /// By what its regions were compared with those of the frame before; none of the first.
    pub identity: Option<Identity>,
}

/// A region that is followed through a sequence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Track {
    /// Its place in the list.
    pub id: u32,
    /// Its colour in all pictures of all frames: red, green, blue from 0 to 255.
    pub colour: [u8; 3],
    /// The frame in which it is first found.
    pub first_frame: usize,
    /// The frame in which it is last found.
    pub last_frame: usize,
    /// The track whose colour it has: of those that are the same piece of the body in a wider or narrower form, at the same time or one
    /// after the other, the one that is found longest. Itself, mostly.
    pub colour_of: u32,
    /// In how many frames it is found.
    pub found: usize,
    /// Mean of the overlaps of its sightings; none where it has none.
    pub mean_overlap: Option<f64>,
    /// Mean of the reliability of its sightings; none where it was not measured.
    pub reliability: Option<f64>,
    /// Where it was found, by frame.
    pub sightings: Vec<Sighting>,
}

/// A region of a frame as part of a track.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Sighting {
    /// The frame.
    pub frame: usize,
    /// The region of that frame's result.
    pub region: u32,
    /// Its overlap with the sighting before, on the surface; none of the first, and where the frames have other vertices.
    pub overlap: Option<f64>,
    /// Its likeness to the sighting before; none of the first, and where the frames have the same vertices.
    pub likeness: Option<f64>,
    /// How surely it is found again, 0 to 1: from the deformed copies of this frame and of those around it. None where it was
    /// not measured.
    pub reliability: Option<f64>,
    /// Volume in length^3, or area in length^2.
    pub volume: f64,
    /// Volume over that of its body.
    pub volume_fraction: f64,
    /// Centre of mass.
    pub centroid: [f64; 3],
}

impl TracksRecord {
    /// The name of the file.
    pub const FILE: &'static str = "tracks.json";

    /// The tracks of these frames.
    pub fn new(parameters: TrackParameters, frames: Vec<TrackedFrame>, tracks: Vec<Track>) -> Self {
        let mser3d = env!("CARGO_PKG_VERSION").to_owned();
        Self { mser3d, format: FORMAT, parameters, frames, tracks, warnings: Vec::new() }
    }

    /// Reads the file in a folder.
    ///
    /// # Errors
    /// [`ResultsError::Io`], [`ResultsError::OtherFormat`], [`ResultsError::Damaged`], [`ResultsError::Broken`].
    pub fn load(folder: &Path) -> Result<Self, ResultsError> {
        let path = folder.join(Self::FILE);
        let text =
            InputFile::read_all(&path).map_err(|error| ResultsError::Io { path: path.clone(), error })?;
        Checksums::load(folder)?.check(folder, Self::FILE)?;
        let record: Self = parse(&path, &text, FORMAT)?;
        match record.check() {
            Ok(()) => Ok(record),
            Err(reason) => Err(ResultsError::Broken { path, reason }),
        }
    }

    /// Writes the file into a folder.
    ///
    /// # Errors
    /// [`ResultsError::Io`], [`ResultsError::File`].
    pub fn write(&self, folder: &Path) -> Result<(), ResultsError> {
        let path = folder.join(Self::FILE);
        let json = serde_json::to_string_pretty(self)
            .map_err(|error| ResultsError::Io { path: path.clone(), error: error.into() })?;
        Ok(write_text(&path, &(json + "\n"))?)
    }
}

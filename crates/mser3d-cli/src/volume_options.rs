//! Command-line options that say which voxels of a volume are the body, and where they lie.

use std::path::PathBuf;

use mser3d_meshio::ReadOptions;
use mser3d_results::ShapeOptions;
use mser3d_volumeio::{BodyParameters, Label, PlacementParameters, read_affine, read_label_names};

use crate::error::CliError;

/// Which voxels of a volume are the body. A mask of 0 and one other value needs none of it.
#[derive(clap::Args, Clone, Debug, Default)]
#[command(next_help_heading = "Volume")]
pub struct VolumeOptions {
    /// Which volume of a file that holds several (times, frames, components), from 0
    #[arg(long, value_name = "N")]
    volume: Option<usize>,
    /// The body is this label, by number or name; all: each label is a shape of its own
    #[arg(long, value_name = "N|NAME|all", conflicts_with = "threshold", allow_hyphen_values = true)]
    label: Option<String>,
    /// The body is the voxels of at least this value
    #[arg(long, value_name = "T")]
    threshold: Option<f64>,
    /// Table with the names of labels, a line each: 3,liver
    #[arg(long, value_name = "FILE")]
    labels: Option<PathBuf>,
    /// Voxel-to-world map in place of the file's: a text or .npy file of 4 x 4 numbers
    #[arg(long, value_name = "FILE")]
    affine: Option<PathBuf>,
}

impl VolumeOptions {
    /// Whether each label is a shape.
    pub fn all_labels(&self) -> bool {
        self.label.as_deref() == Some("all")
    }

    /// How a shape is read. `spacing` and `origin` are those of a volume.
    pub fn shape(
        &self,
        pose: ReadOptions,
        spacing: Option<[f64; 3]>,
        origin: Option<[f64; 3]>,
    ) -> Result<ShapeOptions, CliError> {
        let label = self.label.as_deref().filter(|_| !self.all_labels());
        let label = label.map(|label| label.parse::<Label>().unwrap_or_else(|never| match never {}));
        let affine = self.affine.as_deref().map(|path| read_affine(path, &pose.limits)).transpose()?;
        let label_names = match &self.labels {
            Some(path) => read_label_names(path, &pose.limits)?,
            None => Vec::new(),
        };
        let options = ShapeOptions {
            format: None,
            pose,
            body: BodyParameters { volume: self.volume, label, threshold: self.threshold },
            placement: PlacementParameters { spacing, origin, affine },
            label_names,
        };
        options.placement.validate().map_err(|e| CliError::Usage(format!("wrong parameter: {e}")))?;
        Ok(options)
    }
}

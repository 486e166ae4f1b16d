//! The input file: a mesh, or a solid as a voxel mask.

use std::path::{Path, PathBuf};

use mser3d_fileio::file_stem;
use mser3d_meshio::{MeshIoError, ReadOptions};
use mser3d_results::{ResultsError, ShapeFile, ShapeOptions};

use crate::error::CliError;

/// Which file, and which pose in it.
#[derive(clap::Args, Clone, Debug)]
pub struct InputArgs {
    /// Mesh (.obj .gltf .glb .off .ply .stl .vtk .vtu .msh and others), or a volume: a mask, a label map (--label) or grey
    /// values (--threshold) as .nii, .nrrd, .mha, .mgz, .tif or .npy, indexed [x, y, z]
    pub input: PathBuf,
    /// glTF animation that poses the figure, by name or number from 0
    #[arg(long, value_name = "NAME", help_heading = "Input")]
    pub animation: Option<String>,
    /// When in the animation, in seconds
    #[arg(long, value_name = "SECONDS", default_value_t = ReadOptions::default().time, help_heading = "Input")]
    pub time: f64,
}

impl InputArgs {
    /// The frame of an animation.
    pub fn pose(&self) -> ReadOptions {
        ReadOptions { animation: self.animation.clone(), time: self.time, ..Default::default() }
    }

    pub fn read(&self, options: &ShapeOptions) -> Result<ShapeFile, CliError> {
        ShapeFile::read(&self.input, options).map_err(reading)
    }
}

/// An error of reading a shape.
pub fn reading(error: ResultsError) -> CliError {
    match error {
        // Its options are named after it.
        ResultsError::Mesh(MeshIoError::InvalidParameter(error)) => CliError::Usage(format!("--{error}")),
        error => error.into(),
    }
}

/// The output that is meant when none is named: after the input, in the current folder.
pub fn output_beside(input: &Path, ending: &str) -> PathBuf {
    let stem = file_stem(input);
    PathBuf::from(format!("{stem}{ending}"))
}

/// The same for a folder. One that is there and holds something else is not written into unasked.
pub fn folder_beside(input: &Path, ours: &[&str]) -> Result<PathBuf, CliError> {
    let folder = output_beside(input, "");
    let is_ours = ours.iter().any(|name| folder.join(name).exists());
    let is_empty = std::fs::read_dir(&folder).is_ok_and(|mut entries| entries.next().is_none());
    if folder.exists() && !is_ours && !is_empty {
        let name = folder.display();
        return Err(CliError::Usage(format!(
            "{name} is there already and holds no result; say with -o where the results go"
        )));
    }
    Ok(folder)
}

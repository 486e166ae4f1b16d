//! The input file: a mesh, or a solid as a voxel mask.

use std::path::{Path, PathBuf};

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use mser3d_fileio::{STDIN, file_stem, take_stdin};
use mser3d_meshio::{MeshIoError, ReadOptions};
use mser3d_results::{ResultsError, ShapeFile, ShapeFormat, ShapeOptions};

use crate::error::CliError;

/// The format of the input.
#[derive(clap::Args, Clone, Debug)]
pub struct FormatOption {
    /// Format of the input, whatever its name says; standard input, -, has none
    #[arg(long, value_name = "FORMAT", value_parser = format(), help_heading = "Input", hide_possible_values = true)]
    pub format: Option<ShapeFormat>,
}

/// The names of all formats.
fn format() -> impl TypedValueParser<Value = ShapeFormat> {
    let names = ShapeFormat::all().map(|format| PossibleValue::new(format.name()));
    PossibleValuesParser::new(names).try_map(|name| name.parse())
}

/// The file that is meant. `-` and `/dev/stdin` are standard input, which is read here, so that it can be read like a file from now on
/// by the path that is returned.
pub fn take_input(path: &Path) -> Result<PathBuf, CliError> {
    if path != Path::new("-") && path != Path::new(STDIN) {
        return Ok(path.to_owned());
    }
    // What is made of it takes memory too.
    take_stdin(mser3d::available_memory().map_or(u64::MAX, |free| free / 4))?;
    Ok(STDIN.into())
}

/// Which file, and which pose in it.
#[derive(clap::Args, Clone, Debug)]
pub struct InputArgs {
    /// Mesh (.obj .gltf .glb .off .ply .stl .vtk .vtu .msh and others), or a volume: a mask, a label map (--label) or grey
    /// values (--threshold) as .nii, .nrrd, .mha, .mgz, .tif or .npy, indexed [x, y, z]; - is standard input
    pub input: PathBuf,
    #[command(flatten)]
    pub format: FormatOption,
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
        ShapeFile::read(&take_input(&self.input)?, options).map_err(reading)
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

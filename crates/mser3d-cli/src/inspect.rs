//! `mser3d inspect`: what a file holds, before any work is done on it.

use mser3d::Parameters;
use mser3d::voxelize::Pitch;
use mser3d_meshio::ReadOptions;
use mser3d_results::{Inspection, ShapeOptions};

use crate::error::{CliError, print, print_json};
use crate::input::{InputArgs, reading, take_input};
use crate::limit_options::LimitOptions;
use crate::numbers::count;
use crate::volume_options::VolumeOptions;

#[derive(clap::Args)]
pub struct InspectArgs {
    #[command(flatten)]
    pub input: InputArgs,
    #[command(flatten)]
    pub volume: VolumeOptions,
    /// Voxels that the estimate of memory and time is for [default: those of a run, or of the mask]
    #[arg(long, value_name = "N", value_parser = count)]
    pub voxels: Option<usize>,
    /// Eigenpairs that the estimate is for [default: those of a run]
    #[arg(long, value_name = "K", value_parser = count)]
    pub eigenpairs: Option<usize>,
    #[command(flatten)]
    pub limits: LimitOptions,
    /// Print as JSON
    #[arg(long)]
    pub json: bool,
}

pub fn run(args: &InspectArgs) -> Result<(), CliError> {
    let mut parameters = Parameters::default();
    if let Some(voxels) = args.voxels {
        parameters.voxelize.pitch = Pitch::Voxels(voxels);
    }
    if let Some(eigenpairs) = args.eigenpairs {
        parameters.spectrum.eigenpairs = eigenpairs.into();
    }
    parameters.voxelize.max_box_voxels = args.limits.max_box_voxels;
    let _watch = args.limits.watch(&args.input.input);
    let pose = ReadOptions { limits: args.limits.reading(), ..args.input.pose() };
    let options = args.volume.shape(pose, None, None)?;
    let options = ShapeOptions { format: args.input.format.format, ..options };
    let inspection =
        Inspection::of_file(&take_input(&args.input.input)?, &options, &parameters).map_err(reading)?;
    if args.json { print_json(&inspection) } else { print(&inspection.describe()) }
}

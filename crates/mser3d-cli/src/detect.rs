//! `mser3d detect`: from a file to its regions.

use std::path::PathBuf;

use mser3d::shape::{Frame, VoxelGrid};
use mser3d::{Body, Domain, Features, Parameters, detect, detect_on};

use crate::error::CliError;
use crate::input::{Contents, Input, InputArgs};
use crate::options::{RegionOptions, use_threads};
use crate::output::{OutputFolder, Report};
use crate::progress::Meter;
use crate::table;

#[derive(clap::Args)]
pub struct DetectArgs {
    #[command(flatten)]
    pub input: InputArgs,
    /// Folder for the results; made if it isn't there
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Print the regions as JSON instead of a table
    #[arg(long)]
    pub json: bool,
    /// No progress on stderr, no table on stdout
    #[arg(short, long)]
    pub quiet: bool,
    /// Threads to use; the result is the same for any number [default: all cores]
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    #[command(flatten)]
    pub options: RegionOptions,
}

pub fn run(args: &DetectArgs) -> Result<(), CliError> {
    use_threads(args.threads)?;
    let parameters = args.options.parameters()?;
    let input = Input::read(&args.input)?;
    let folder = OutputFolder::create(&args.output)?;
    let meter = Meter::new(args.quiet);
    let result = features(&input, &args.options, &parameters, &meter);
    meter.finish();
    let features = result?;
    let report = Report::new(&input, &args.input, &parameters, &features, &meter);
    folder.write(&input, &features, &report)?;
    if args.json {
        report.print()
    } else if !args.quiet {
        table::print(&features, &args.output)
    } else {
        Ok(())
    }
}

fn features(
    input: &Input,
    options: &RegionOptions,
    parameters: &Parameters,
    meter: &Meter,
) -> Result<Features, CliError> {
    let progress = |p| meter.report(p);
    let result = match &input.contents {
        Contents::Mesh(loaded) => detect(&loaded.mesh, options.domain(), parameters, &progress),
        Contents::Mask(_) if options.domain() == Domain::Surface => {
            return Err(CliError::Usage("--surface needs a mesh; a voxel mask has no surface mesh".into()));
        }
        Contents::Mask(mask) => {
            let frame = Frame::new(mask.dims(), [0.0; 3], [options.pitch.unwrap_or(1.0); 3]);
            frame
                .and_then(|frame| VoxelGrid::solid(frame, mask.clone()))
                .map(|grid| {
                    let parts = grid.components();
                    let largest = parts.largest();
                    grid.restrict(|v| Some(parts.labels[v as usize]) == largest)
                })
                .map_err(mser3d::Error::from)
                .and_then(|grid| {
                    detect_on(Body::solid(grid, parameters.voxelize.connectivity), parameters, &progress)
                })
        }
    };
    result.map_err(|source| CliError::Shape { path: input.path.clone(), source })
}

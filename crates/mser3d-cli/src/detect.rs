//! `mser3d detect`: from a file to its regions.

use std::path::PathBuf;

use mser3d::Detector;
use mser3d_results::{Results, ResultsFolder, Up};

use crate::error::{CliError, print};
use crate::input::{InputArgs, folder_beside};
use crate::interrupt;
use crate::options::RegionOptions;
use crate::progress::Meter;
use crate::run_options::RunOptions;
use crate::table;
use crate::view::write_page;

#[derive(clap::Args)]
pub struct DetectArgs {
    #[command(flatten)]
    pub input: InputArgs,
    /// Folder for the results; made if it isn't there [default: the input's name]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Write a page for the browser too, view.html in the folder
    #[arg(long)]
    pub html: bool,
    /// Print the regions as JSON instead of a table
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub run: RunOptions,
    #[command(flatten)]
    pub options: RegionOptions,
}

pub fn run(args: &DetectArgs) -> Result<(), CliError> {
    args.run.use_threads()?;
    interrupt::listen();
    let parameters = args.options.parameters()?;
    let file = args.input.read()?.with_pitch(parameters.voxelize.pitch)?;
    args.options.check(&file)?;
    let output = match &args.output {
        Some(folder) => folder.clone(),
        None => folder_beside(&file.path, &["regions.json"])?,
    };
    let folder = ResultsFolder::create(&output)?;
    let meter = Meter::new(args.run.quiet);
    let (cache, progress) = (args.options.cache()?, |p| meter.report(p));
    let spectra = cache.as_ref().map(|cache| cache.source(|what| meter.warn(what)));
    let mut detector = Detector::new(parameters).with_progress(&progress);
    if let Some(spectra) = &spectra {
        detector.spectra = spectra;
    }
    let features = detector.detect(file.input(args.options.domain())?);
    meter.finish();
    let features = features.map_err(|source| CliError::detection(&file.path, source))?;
    let results = Results::of_file(&features, &file)?;
    folder.write(&results)?;
    tracing::info!(folder = %output.display(), "wrote");
    if !args.run.quiet {
        let warn = |what: &String| eprintln!("mser3d: warning: {}: {what}", file.path.display());
        results.record.warnings.iter().for_each(warn);
    }
    if args.html {
        write_page(&output, &output.join("view.html"), Up::default())?;
    }
    if args.json {
        print(&results.record.to_json().map_err(|e| CliError::Stdout(e.into()))?)
    } else if !args.run.quiet {
        print(&table::regions(&features, &output))
    } else {
        Ok(())
    }
}

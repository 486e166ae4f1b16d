//! `mser3d batch`: many shapes, each with a folder of its own, and tables of them all.

use std::path::{Path, PathBuf};

use mser3d::{Detector, Parameters};
use mser3d_collection::{
    BatchParameters, BatchSummary, Event, Frames, Plan, PlanParameters, Shard, Tables, build_tables, plan,
    run_batch,
};
use mser3d_meshio::ReadOptions;
use mser3d_results::{ShapeFile, ShapeOptions};

use crate::error::{CliError, print, print_json};
use crate::input::reading;
use crate::options::RegionOptions;
use crate::output::folder;
use crate::progress::BatchMeter;
use crate::run_options::{ManyOptions, RunOptions};
use crate::volume_options::VolumeOptions;

#[derive(clap::Args)]
pub struct BatchArgs {
    /// Shapes: files, folders, patterns ("scans/*.ply"), or lists (.txt, one path a line, relative to the
    /// list)
    #[arg(required_unless_present = "merge", conflicts_with = "merge")]
    pub inputs: Vec<PathBuf>,
    /// Folder of the collection; made if it isn't there
    #[arg(short, long, value_name = "DIR", value_parser = folder())]
    pub output: PathBuf,
    /// Do only part I of N, for job arrays; --merge makes the tables when all are done
    #[arg(long, value_name = "I/N", conflicts_with = "merge")]
    pub shard: Option<String>,
    /// Only make the tables, of the results that are there
    #[arg(long)]
    pub merge: bool,
    /// Look into the folders in a folder, too
    #[arg(long)]
    pub recursive: bool,
    /// Print the summary as JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub many: ManyOptions,
    /// Make a shape of every frame of this glTF animation, by name or number from 0
    #[arg(long, value_name = "NAME", requires = "fps", help_heading = "Input")]
    pub animation: Option<String>,
    /// Frames per second
    #[arg(long, value_name = "F", requires = "animation", help_heading = "Input")]
    pub fps: Option<f64>,
    /// Give all shapes the pitch and the reference measure of this one, as poses of one body need; "first"
    /// for the first shape [default: each its own]
    #[arg(long, value_name = "FILE", conflicts_with = "reference_measure", help_heading = "Method")]
    pub reference: Option<PathBuf>,
    #[command(flatten)]
    pub volume: VolumeOptions,
    #[command(flatten)]
    pub options: RegionOptions,
}

pub fn run(args: &BatchArgs) -> Result<(), CliError> {
    args.many.run.use_threads()?;
    if args.merge {
        let tables = build_tables(&args.output)?;
        let summary = BatchSummary { tables: Some(tables), ..Default::default() };
        return tell(&args.many.run, args.json, &args.output, &Plan::default(), &summary);
    }
    let shard = args.shard.as_deref().map(str::parse::<Shard>).transpose();
    let shard = shard.map_err(|e| CliError::Usage(e.to_string()))?;
    args.options.refuse_field()?;
    let mut parameters = args.options.parameters()?;
    let frames = args.animation.clone().zip(args.fps).map(|(animation, rate)| Frames { animation, rate });
    let planned = PlanParameters {
        frames,
        all_labels: args.volume.all_labels(),
        recursive: args.recursive,
        volumes: args.options.shape(&args.volume, ReadOptions::default())?,
    };
    let plan = plan(&args.inputs, &planned)?;
    if let Some(reference) = &args.reference {
        let file = match plan.jobs.first() {
            Some(job) if reference == Path::new("first") => job.read()?,
            _ => ShapeFile::read(reference, &ShapeOptions::default()).map_err(reading)?,
        };
        let scaled = parameters.with_scale_of(file.input(args.options.domain())?);
        parameters = scaled.map_err(|e| CliError::detection(&file.path, e))?;
    }
    let batch = BatchParameters {
        workers: args.many.workers(),
        memory: parameters.spectrum.memory_limit.unwrap_or(u64::MAX),
        extras: args.many.write.clone(),
        shard,
    };
    let summary = run_plan(&args.many.run, &args.options, &args.output, &plan, parameters, &batch)?;
    tell(&args.many.run, args.json, &args.output, &plan, &summary)
}

/// Runs a plan, and tells how far it is.
pub fn run_plan(
    run: &RunOptions,
    options: &RegionOptions,
    output: &Path,
    plan: &Plan,
    parameters: Parameters,
    batch: &BatchParameters,
) -> Result<BatchSummary, CliError> {
    let meter = BatchMeter::new(run.quiet);
    let detector = Detector::new(parameters);
    let (heard, warn) = (|event: Event| meter.report(&event), |what: &str| meter.warn(what));
    let summary = run_detector(options, output, plan, &detector, batch, (&heard, &warn));
    meter.finish();
    summary
}

/// Who hears how far a batch is, and what is wrong with its cache.
pub type Listeners<'a> = (&'a (dyn Fn(Event) + Sync), &'a (dyn Fn(&str) + Sync));

/// Runs a plan with a detector that takes spectra from the cache, if there is one.
pub fn run_detector(
    options: &RegionOptions,
    output: &Path,
    plan: &Plan,
    detector: &Detector,
    batch: &BatchParameters,
    (heard, warn): Listeners,
) -> Result<BatchSummary, CliError> {
    let cache = options.cache()?;
    let spectra = cache.as_ref().map(|cache| cache.source(warn));
    let mut detector = detector.clone();
    if let Some(spectra) = &spectra {
        detector.spectra = spectra;
    }
    Ok(run_batch(output, plan, options.domain(), &detector, batch, heard)?)
}

/// Says what became of all shapes.
pub fn tell(
    run: &RunOptions,
    json: bool,
    output: &Path,
    plan: &Plan,
    summary: &BatchSummary,
) -> Result<(), CliError> {
    let BatchSummary { computed, kept, failed, tables } = summary;
    if !run.quiet {
        for label in &plan.skipped {
            let (path, name) = (&label.path, label.name.as_deref().unwrap_or_default());
            eprintln!(
                "mser3d: note: {path}: label {} {name} has only {} voxels and was left out",
                label.label, label.voxels
            );
        }
    }
    if json {
        print_json(summary)?;
    } else if !run.quiet {
        let folder = output.display();
        let tables = match tables {
            Some(Tables { shapes, regions, failures }) => format!(
                "{folder} has {regions} regions of {shapes} shapes in regions.parquet and shapes.parquet, \
                 {failures} failures in failures.json\n"
            ),
            None => format!("when all shards are done: mser3d batch --merge -o {folder}\n"),
        };
        if computed + kept + failed.len() > 0 {
            print(&format!("{computed} shapes computed, {kept} kept, {} failed\n", failed.len()))?;
        }
        print(&tables)?;
    }
    tell_failures(summary)
}

/// An error where shapes have failed.
pub fn tell_failures(summary: &BatchSummary) -> Result<(), CliError> {
    let BatchSummary { computed, kept, failed, .. } = summary;
    if failed.is_empty() {
        return Ok(());
    }
    let first = failed.iter().take(3).map(|f| format!("\n  {}: {}", f.name, f.error)).collect::<String>();
    let more = if failed.len() > 3 { format!("\n  and {} more", failed.len() - 3) } else { String::new() };
    Err(CliError::Incomplete(format!(
        "{} of {} shapes failed; correct them and run again:{first}{more}",
        failed.len(),
        computed + kept + failed.len(),
    )))
}

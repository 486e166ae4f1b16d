//! `mser3d batch`: many shapes, each with a folder of its own, and tables of them all.

use std::path::{Path, PathBuf};

use mser3d::Detector;
use mser3d_collection::{
    BatchParameters, BatchSummary, Frames, Shard, Tables, build_tables, plan, run_batch,
};

use crate::error::{CliError, print, print_json};
use crate::input::InputArgs;
use crate::numbers::count;
use crate::options::RegionOptions;
use crate::progress::BatchMeter;
use crate::run_options::RunOptions;

#[derive(clap::Args)]
pub struct BatchArgs {
    /// Shapes: files, folders, patterns ("scans/*.ply"), or lists (.txt, one path a line, relative to the
    /// list)
    #[arg(required_unless_present = "merge", conflicts_with = "merge")]
    pub inputs: Vec<PathBuf>,
    /// Folder of the collection; made if it isn't there
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Do only part I of N, for job arrays; --merge makes the tables when all are done
    #[arg(long, value_name = "I/N", conflicts_with = "merge")]
    pub shard: Option<String>,
    /// Only make the tables, of the results that are there
    #[arg(long)]
    pub merge: bool,
    /// Shapes in parallel, as far as memory allows [default: one a thread]
    #[arg(long, value_name = "N", value_parser = count)]
    pub workers: Option<usize>,
    /// Print the summary as JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub run: RunOptions,
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
    pub options: RegionOptions,
}

pub fn run(args: &BatchArgs) -> Result<(), CliError> {
    args.run.use_threads()?;
    if args.merge {
        let tables = build_tables(&args.output)?;
        return tell(args, &BatchSummary { tables: Some(tables), ..Default::default() });
    }
    let shard = args.shard.as_deref().map(str::parse::<Shard>).transpose();
    let shard = shard.map_err(|e| CliError::Usage(e.to_string()))?;
    let mut parameters = args.options.parameters()?;
    let frames = args.animation.clone().zip(args.fps).map(|(animation, rate)| Frames { animation, rate });
    let jobs = plan(&args.inputs, frames.as_ref())?;
    let domain = args.options.domain();
    if let Some(reference) = &args.reference {
        let file = match jobs.first() {
            Some(job) if reference == Path::new("first") => job.read()?,
            _ => InputArgs { input: reference.clone(), animation: None, time: 0.0 }.read()?,
        };
        let scaled = parameters.with_scale_of(file.input(domain)?);
        parameters = scaled.map_err(|e| CliError::detection(&file.path, e))?;
    }
    let batch = BatchParameters {
        workers: args.workers.unwrap_or_else(rayon::current_num_threads),
        memory: parameters.spectrum.memory_limit.unwrap_or(u64::MAX),
        shard,
    };
    let meter = BatchMeter::new(args.run.quiet);
    let cache = args.options.cache()?;
    let spectra = cache.as_ref().map(|cache| cache.source(|what| meter.warn(what)));
    let mut detector = Detector::new(parameters);
    if let Some(spectra) = &spectra {
        detector.spectra = spectra;
    }
    let summary = run_batch(&args.output, jobs, domain, &detector, &batch, &|event| meter.report(&event));
    meter.finish();
    tell(args, &summary?)
}

fn tell(args: &BatchArgs, summary: &BatchSummary) -> Result<(), CliError> {
    let BatchSummary { computed, kept, failed, tables } = summary;
    if args.json {
        print_json(summary)?;
    } else if !args.run.quiet {
        let folder = args.output.display();
        let tables = match tables {
            Some(Tables { shapes, regions, failures }) => format!(
                "{folder} has {regions} regions of {shapes} shapes in regions.parquet and shapes.parquet, \
                 {failures} failures in failures.json\n"
            ),
            None => format!("when all shards are done: mser3d batch --merge -o {folder}\n"),
        };
        if !args.merge {
            print(&format!("{computed} shapes computed, {kept} kept, {} failed\n", failed.len()))?;
        }
        print(&tables)?;
    }
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

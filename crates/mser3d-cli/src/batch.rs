//! `mser3d batch`: many shapes, each with a folder of its own, and tables of them all.

use std::path::{Path, PathBuf};

use mser3d::{Detector, Parameters, ProgressFn};
use mser3d_collection::{
    BatchParameters, BatchSummary, CollectionError, CollectionFolder, DamagedShape, Event, Frames, Job, Plan,
    PlanParameters, ScheduledShape, Shard, Tables, build_tables, plan, run_batch_in,
};
use mser3d_meshio::ReadOptions;
use mser3d_results::{ShapeFile, ShapeOptions};

use crate::error::{CliError, print, print_json};
use crate::input::reading;
use crate::interrupt;
use crate::message;
use crate::options::RegionOptions;
use crate::output::folder;
use crate::progress::BatchMeter;
use crate::run_options::{ManyOptions, RunOptions};
use crate::volume_options::VolumeOptions;

/// What `mser3d batch` is told.
#[derive(clap::Args, Clone, Debug)]
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
    pub(crate) many: ManyOptions,
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
    pub(crate) volume: VolumeOptions,
    #[command(flatten)]
    pub(crate) options: RegionOptions,
}

impl BatchArgs {
    /// The shapes, and the parameters that all of them have.
    ///
    /// # Errors
    /// [`CliError::Usage`] for values out of range, [`CliError::Collection`] for inputs that name nothing, and those of
    /// reading the shape of reference.
    pub fn plan(&self) -> Result<(Plan, Parameters), CliError> {
        self.options.refuse_field()?;
        let mut parameters = self.options.parameters(&self.many.write)?;
        let frames = self.animation.clone().zip(self.fps);
        let planned = PlanParameters {
            frames: frames.map(|(animation, rate)| Frames { animation, rate }),
            all_labels: self.volume.all_labels(),
            recursive: self.recursive,
            volumes: self.volumes()?,
        };
        let plan = plan(&self.inputs, &planned)?;
        if let Some(reference) = &self.reference {
            let file = match plan.jobs.first() {
                Some(job) if reference == Path::new("first") => job.read()?,
                _ => ShapeFile::read(reference, &planned.volumes.limits_alone()).map_err(reading)?,
            };
            let scaled = parameters.with_scale_of(file.input(self.options.domain())?);
            parameters = scaled.map_err(|e| CliError::detection(&file.path, e))?;
        }
        Ok((plan, parameters))
    }

    /// How volumes are read.
    ///
    /// # Errors
    /// [`CliError::Usage`] for values out of range, [`CliError::Volume`] for files beside the volume's.
    pub fn volumes(&self) -> Result<ShapeOptions, CliError> {
        self.options.shape(&self.volume, ReadOptions::default())
    }

    /// Whether each label of a label map is a shape.
    pub fn all_labels(&self) -> bool {
        self.volume.all_labels()
    }

    /// The number of threads that is asked for.
    ///
    /// # Errors
    /// [`CliError::Usage`] for one out of range.
    pub fn threads(&self) -> Result<Option<usize>, CliError> {
        self.many.run.threads()
    }

    /// Has work done on one shape of the batch, by a detector with these parameters that takes spectra from the cache, if there
    /// is one. `warn` hears what is wrong with the cache.
    ///
    /// # Errors
    /// Those of the work and of the cache.
    pub fn on_shape<T>(
        &self,
        job: &Job,
        parameters: Parameters,
        progress: ProgressFn,
        warn: &(dyn Fn(&str) + Sync),
        work: impl FnOnce(&ScheduledShape) -> Result<T, CollectionError>,
    ) -> Result<T, CliError> {
        let cache = self.options.cache()?;
        let spectra = cache.as_ref().map(|cache| cache.source(warn));
        let mut detector = Detector::new(parameters).with_progress(progress);
        if let Some(spectra) = &spectra {
            detector.spectra = spectra;
        }
        let (folder, domain, extras) = (&self.output, self.options.domain(), &self.many.write);
        let time_limit = self.options.limits.time();
        Ok(work(&ScheduledShape { folder, job, domain, detector: &detector, extras, time_limit })?)
    }
}

pub(crate) fn run(args: &BatchArgs) -> Result<(), CliError> {
    args.many.run.use_threads()?;
    if args.merge {
        let tables = build_tables(&args.output)?;
        let summary = BatchSummary { tables: Some(tables), ..Default::default() };
        return tell(&args.many.run, args.json, &args.output, &Plan::default(), &summary);
    }
    let shard = args.shard.as_deref().map(str::parse::<Shard>).transpose();
    let shard = shard.map_err(|e| CliError::Usage(e.to_string()))?;
    let (plan, parameters) = args.plan()?;
    let batch = BatchParameters {
        workers: args.many.workers(),
        memory: parameters.spectrum.memory_limit.unwrap_or(u64::MAX),
        time_limit: args.options.limits.time(),
        extras: args.many.write.clone(),
        shard,
    };
    let folder = CollectionFolder::open(&args.output, batch.shard)?;
    let summary = run_plan(&args.many.run, &args.options, &folder, &plan, parameters, &batch)?;
    tell(&args.many.run, args.json, &args.output, &plan, &summary)
}

/// Runs a plan, and tells how far it is.
pub(crate) fn run_plan(
    run: &RunOptions,
    options: &RegionOptions,
    folder: &CollectionFolder,
    plan: &Plan,
    parameters: Parameters,
    batch: &BatchParameters,
) -> Result<BatchSummary, CliError> {
    interrupt::keeps_what_is_done();
    let meter = BatchMeter::new(run.quiet);
    let stop = |_| interrupt::go_on();
    let detector = Detector::new(parameters).with_progress(&stop);
    let (heard, warn) = (|event: Event| meter.report(&event), |what: &str| meter.warn(what));
    let summary = run_detector(options, folder, plan, &detector, batch, (&heard, &warn));
    meter.finish();
    summary
}

/// Who hears how far a batch is, and what is wrong with its cache.
pub(crate) type Listeners<'a> = (&'a (dyn Fn(Event) + Sync), &'a (dyn Fn(&str) + Sync));

/// Runs a plan with a detector that takes spectra from the cache, if there is one.
pub(crate) fn run_detector(
    options: &RegionOptions,
    folder: &CollectionFolder,
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
    Ok(run_batch_in(folder, plan, options.domain(), &detector, batch, heard)?)
}

/// Says what became of all shapes.
pub(crate) fn tell(
    run: &RunOptions,
    json: bool,
    output: &Path,
    plan: &Plan,
    summary: &BatchSummary,
) -> Result<(), CliError> {
    let BatchSummary { computed, kept, damaged, failed, tables } = summary;
    if !run.quiet {
        for label in &plan.skipped {
            let (path, name) = (&label.path, label.name.as_deref().unwrap_or_default());
            message::tell(&format!(
                "note: {path}: label {} {name} has only {} voxels and was left out",
                label.label, label.voxels
            ));
        }
    }
    for DamagedShape { name, damage } in damaged {
        message::tell(&format!("warning: {name}: computed again, because its result is damaged: {damage}"));
    }
    if json {
        print_json(summary)?;
    } else if !run.quiet {
        let folder = message::name(&output.to_string_lossy());
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
pub(crate) fn tell_failures(summary: &BatchSummary) -> Result<(), CliError> {
    let BatchSummary { computed, kept, failed, .. } = summary;
    if failed.is_empty() {
        return Ok(());
    }
    let kept_one = |kept: bool| if kept { " (its earlier result is kept)" } else { "" };
    let first = failed.iter().take(3);
    let first = first.map(|f| format!("\n  {}: {}{}", f.name, f.error, kept_one(f.kept))).collect::<String>();
    let more = if failed.len() > 3 { format!("\n  and {} more", failed.len() - 3) } else { String::new() };
    Err(CliError::Incomplete(format!(
        "{} of {} shapes failed; correct them and run again:{first}{more}",
        failed.len(),
        computed + kept + failed.len(),
    )))
}

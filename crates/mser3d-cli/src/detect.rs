//! `mser3d detect`: from a file to its regions.

use std::path::{Path, PathBuf};

use mser3d::{Detector, Features, FieldSource, Parameters, ProgressFn};
use mser3d_collection::{BatchParameters, CollectionFolder, Job, PlanParameters, plan, write_label_map};
use mser3d_results::{Extra, FieldFile, Results, ResultsFolder, ShapeFile, ShapeOptions, Up, VolumeFile};

use crate::batch::{self, run_plan};
use crate::choice::choice;
use crate::error::{CliError, print};
use crate::input::{InputArgs, folder_beside, take_input};
use crate::interrupt;
use crate::message::tell;
use crate::options::RegionOptions;
use crate::output::folder;
use crate::progress::Meter;
use crate::run_options::RunOptions;
use crate::table;
use crate::view::write_page;
use crate::volume_options::VolumeOptions;

/// What `mser3d detect` is told.
#[derive(clap::Args, Clone, Debug)]
pub struct DetectArgs {
    #[command(flatten)]
    pub(crate) input: InputArgs,
    #[command(flatten)]
    pub(crate) volume: VolumeOptions,
    /// Folder for the results; made if it isn't there [default: the input's name]
    #[arg(short, long, value_name = "DIR", value_parser = folder())]
    pub output: Option<PathBuf>,
    /// Write a page for the browser too, view.html in the folder
    #[arg(long)]
    pub html: bool,
    /// Write this too
    #[arg(long, value_name = "WHAT,...", value_parser = choice::<Extra>(), value_delimiter = ',')]
    pub write: Vec<Extra>,
    /// Print the regions as JSON instead of a table
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub(crate) run: RunOptions,
    #[command(flatten)]
    pub(crate) options: RegionOptions,
}

impl DetectArgs {
    /// The parameters of the detector.
    ///
    /// # Errors
    /// [`CliError::Usage`] for values out of range.
    pub fn parameters(&self) -> Result<Parameters, CliError> {
        self.options.parameters(&self.write)
    }

    /// How the shape is read.
    ///
    /// # Errors
    /// [`CliError::Usage`] for values out of range, [`CliError::Volume`] for files beside the shape's.
    pub fn shape_options(&self) -> Result<ShapeOptions, CliError> {
        let options = self.options.shape(&self.volume, self.input.pose())?;
        Ok(ShapeOptions { format: self.input.format.format, ..options })
    }

    /// The file of the shape.
    pub fn input(&self) -> &Path {
        &self.input.input
    }

    /// The number of threads that is asked for.
    ///
    /// # Errors
    /// [`CliError::Usage`] for one out of range.
    pub fn threads(&self) -> Result<Option<usize>, CliError> {
        self.run.threads()
    }

    /// Whether each label of a label map is to be a shape, which [`find`](Self::find) does not do.
    pub fn all_labels(&self) -> bool {
        self.volume.all_labels()
    }

    /// The file with the weight, if it has one.
    ///
    /// # Errors
    /// [`CliError::Results`].
    pub fn field(&self) -> Result<Option<FieldFile>, CliError> {
        self.options.field()
    }

    /// Refuses options that the shape has no use for.
    ///
    /// # Errors
    /// [`CliError::Usage`], [`CliError::Results`].
    pub fn check(&self, file: &ShapeFile) -> Result<(), CliError> {
        self.options.check(file)?;
        if self.write.contains(&Extra::FineSurface) && (self.options.surface || file.mesh().is_none()) {
            let why = "--write fine-surface needs a mesh that is searched as a volume; here the surface is as fine as it can be";
            return Err(CliError::Usage(why.into()));
        }
        if self.write.contains(&Extra::Fields) && self.options.surface {
            let why = "--write fields needs voxels, and --surface has none; write eigenfunctions,signatures";
            return Err(CliError::Usage(why.into()));
        }
        Ok(())
    }

    /// Finds the regions of a shape. `extras` will be written besides, `progress` hears how far the work is and can cancel
    /// it, `warn` what is wrong with the cache.
    ///
    /// # Errors
    /// [`CliError::Shape`], [`CliError::TimeLimit`], [`CliError::Interrupted`], and those of the cache and the field.
    pub fn find(
        &self,
        file: &ShapeFile,
        field: Option<&FieldFile>,
        extras: &[Extra],
        progress: ProgressFn,
        warn: &(dyn Fn(&str) + Sync),
    ) -> Result<(Features, Results), CliError> {
        let deadline = self.options.limits.deadline();
        let progress = |told| {
            deadline.go_on()?;
            progress(told)
        };
        let values = field.map(|field| field.on(file)).transpose()?;
        let cache = self.options.cache()?;
        let spectra = cache.as_ref().map(|cache| cache.source(warn));
        let mut detector = Detector::new(self.parameters()?).with_progress(&progress);
        if let Some(spectra) = &spectra {
            detector.spectra = spectra;
        }
        detector.field = values.as_ref().map(|values| values as FieldSource);
        let features = detector.detect(file.input(self.options.domain())?);
        if let Err(mser3d::Error::Cancelled) = features {
            CliError::in_time(&deadline, &file.path)?;
        }
        let features = features.map_err(|source| CliError::detection(&file.path, source))?;
        let mut results = Results::of_file(&features, file)?.with_extras(&features, extras);
        results.record.field = field.map(|field| field.record().clone());
        Ok((features, results))
    }
}

pub(crate) fn run(args: &DetectArgs) -> Result<(), CliError> {
    args.run.use_threads()?;
    let parameters = args.parameters()?;
    let options = args.shape_options()?;
    if args.all_labels() {
        args.options.refuse_field()?;
        return all_labels(args, parameters, options);
    }
    let _watch = args.options.limits.watch(&args.input.input);
    let file = args.input.read(&options)?;
    args.check(&file)?;
    let field = args.field()?;
    // What is wrong with it is said before a folder is made.
    field.as_ref().map(|field| field.on(&file)).transpose()?;
    let output = match &args.output {
        Some(folder) => folder.clone(),
        None => folder_beside(&file.path, &["regions.json"])?,
    };
    let folder = ResultsFolder::create(&output)?;
    interrupt::take_away(folder.made());
    let meter = Meter::new(args.run.quiet);
    let (report, warn) = (|told| meter.report(told), |what: &str| meter.warn(what));
    // On one of rayon's threads: each loop is then begun and ended there, instead of handed over and waited for.
    let found = rayon::scope(|_| args.find(&file, field.as_ref(), &args.write, &report, &warn));
    meter.finish();
    let (features, results) = found?;
    folder.write_found(&results, &features, &args.write)?;
    tracing::info!(folder = %output.display(), "wrote");
    if !args.run.quiet {
        let warn = |what: &String| tell(&format!("warning: {}: {what}", file.path.display()));
        results.record.warnings.iter().for_each(warn);
    }
    if args.html {
        write_page(&output, &output.join("view.html"), Up::default())?;
    }
    if args.json {
        print(&results.record.to_json().map_err(|e| CliError::Stdout(e.into()))?)
    } else if !args.run.quiet {
        print(&table::found(&features, &output))
    } else {
        Ok(())
    }
}

/// Each label of a label map as a shape of its own, in a collection of its own.
fn all_labels(args: &DetectArgs, parameters: Parameters, volumes: ShapeOptions) -> Result<(), CliError> {
    if args.write.contains(&Extra::FineSurface) {
        return Err(CliError::Usage(
            "--write fine-surface needs a mesh; a label map is voxels already".into(),
        ));
    }
    if args.html || args.options.surface {
        return Err(CliError::Usage(
            "--html and --surface are for one shape; view each label's folder with mser3d view".into(),
        ));
    }
    let file = &take_input(&args.input.input)?;
    if let Some(option) = args.options.voxels.first_given() {
        return Err(CliError::Usage(format!("{option} needs a mesh; a volume is voxels already")));
    }
    // What is wrong with the file is said before a folder is made.
    VolumeFile::read(file, &volumes)?.labels(volumes.body.volume)?;
    let output = match &args.output {
        Some(folder) => folder.clone(),
        None => folder_beside(file, &["labels.csv"])?,
    };
    let plan = plan(
        std::slice::from_ref(file),
        &PlanParameters { all_labels: true, volumes, ..Default::default() },
    )?;
    let batch = BatchParameters {
        workers: rayon::current_num_threads(),
        memory: parameters.spectrum.memory_limit.unwrap_or(u64::MAX),
        time_limit: args.options.limits.time(),
        extras: args.write.clone(),
        shard: None,
    };
    let collection = CollectionFolder::open(&output, None)?;
    let summary = run_plan(&args.run, &args.options, &collection, &plan, parameters, &batch)?;
    let on_grid = args.write.iter().any(|extra| [Extra::Nifti, Extra::Landmarks].contains(extra));
    if on_grid && summary.computed + summary.kept > 0 {
        let done = |job: &&Job| !summary.failed.iter().any(|f| f.name == job.name);
        let shapes: Vec<String> = plan.jobs.iter().filter(done).map(|job| job.name.clone()).collect();
        let contested = write_label_map(&output, &shapes)?;
        if contested > 0 && !args.run.quiet {
            tell(&format!(
                "warning: {contested} voxels are in regions of several layers; regions.nii.gz has the last"
            ));
        }
    }
    batch::tell(&args.run, args.json, &output, &plan, &summary)
}

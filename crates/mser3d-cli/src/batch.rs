//! `mser3d batch`: many shapes, each with a folder of its own, and tables of them all.

use std::io::Write;
use std::path::{Path, PathBuf};

use mser3d::shape::Domain;
use mser3d::voxelize::Pitch;
use mser3d::{Body, Parameters, estimate};
use mser3d_collection::{
    BatchParameters, BatchSummary, Frames, Job, Ready, Shard, Tables, Work, build_tables, plan, run_batch,
};
use serde_json::json;

use crate::detect::detect_into;
use crate::error::CliError;
use crate::input::{Contents, Input, InputArgs};
use crate::options::{RegionOptions, count};
use crate::output::identity;
use crate::progress::{BatchMeter, Meter};
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
    if let Some(reference) = &args.reference {
        let first = reference == Path::new("first");
        let input = match jobs.first() {
            Some(job) if first => input_of(job),
            _ => InputArgs { input: reference.clone(), animation: None, time: 0.0 },
        };
        share_scale(&mut parameters, &input, &args.options)?;
    }
    let work = Detection { options: &args.options, parameters: &parameters };
    let batch = BatchParameters {
        workers: args.workers.unwrap_or_else(rayon::current_num_threads),
        memory: parameters.spectrum.memory_limit.unwrap_or(u64::MAX),
        shard,
    };
    let meter = BatchMeter::new(args.run.quiet);
    let summary = run_batch(&args.output, jobs, &work, &batch, &|event| meter.report(&event));
    meter.finish();
    tell(args, &summary?)
}

/// Gives all shapes the pitch and the measure of one.
fn share_scale(
    parameters: &mut Parameters,
    args: &InputArgs,
    options: &RegionOptions,
) -> Result<(), CliError> {
    let input = Input::read(args)?;
    let Some(mesh) = input.mesh() else {
        return Err(CliError::Usage(
            "--reference needs a mesh; give masks --pitch and --reference-measure".into(),
        ));
    };
    match options.domain() {
        Domain::Surface => parameters.reference_measure = Some(mesh.vertex_areas().iter().sum()),
        Domain::Volume => {
            let failed = |source| CliError::Shape { path: args.input.clone(), source };
            let (_, solid) = Body::volume(mesh, &parameters.voxelize).map_err(failed)?;
            parameters.voxelize.pitch = Pitch::Size(solid.grid.frame().spacing()[0]);
            parameters.reference_measure = Some(solid.grid.volume());
        }
    }
    Ok(())
}

fn input_of(job: &Job) -> InputArgs {
    InputArgs { input: job.path.clone(), animation: job.animation.clone(), time: job.time }
}

/// `mser3d detect` on each shape of a batch.
struct Detection<'a> {
    options: &'a RegionOptions,
    parameters: &'a Parameters,
}

impl Work for Detection<'_> {
    type Input = Input;

    fn read(&self, job: &Job) -> Result<Ready<Input>, String> {
        let args = input_of(job);
        let input = Input::read(&args).map_err(|e| e.to_string())?;
        let identity = identity(&input, &args, self.options.domain(), self.parameters);
        let elements = elements(&input, self.options.domain(), self.parameters.voxelize.pitch);
        let eigenpairs = self.parameters.spectrum.eigenpairs.about(self.options.domain());
        let memory = estimate(elements, eigenpairs).memory;
        Ok(Ready { input, identity, memory })
    }

    fn run(&self, job: &Job, input: Input, folder: &Path) -> Result<(), String> {
        let _shape = tracing::info_span!("shape", name = job.name).entered();
        let meter = Meter::new(true);
        let done = detect_into(folder, &input, &input_of(job), self.options, self.parameters, &meter);
        done.map(drop).map_err(|e| e.to_string())
    }
}

/// Voxels or vertices, about.
fn elements(input: &Input, domain: Domain, pitch: Pitch) -> usize {
    let mesh = match &input.contents {
        Contents::Mask(mask, _) => return mask.count_ones(),
        Contents::Mesh(loaded) => &loaded.mesh,
    };
    if domain == Domain::Surface {
        return mesh.vertices().len();
    }
    let volume = mesh.signed_volume().abs();
    let voxels = |pitch: f64| (volume / pitch.powi(3)).min(1e12) as usize;
    match pitch {
        Pitch::Voxels(n) => n,
        Pitch::Size(pitch) => voxels(pitch),
        Pitch::Spacing(lengths) => voxels(lengths.into_iter().product::<f64>().cbrt()),
        Pitch::Resolution(n) => {
            let extent = mesh.bounding_box().map_or([0.0; 3], |b| b.extent());
            voxels(extent.into_iter().fold(0.0, f64::max) / n as f64)
        }
    }
}

fn tell(args: &BatchArgs, summary: &BatchSummary) -> Result<(), CliError> {
    let BatchSummary { done, kept, failed, tables } = summary;
    let text = if args.json {
        let failed: Vec<_> =
            failed.iter().map(|(name, error)| json!({"name": name, "error": error})).collect();
        let tables =
            tables.map(|t| json!({"shapes": t.shapes, "regions": t.regions, "failures": t.failures}));
        format!("{:#}\n", json!({"computed": done, "kept": kept, "failed": failed, "tables": tables}))
    } else if args.run.quiet {
        String::new()
    } else {
        let folder = args.output.display();
        let tables = match tables {
            Some(Tables { shapes, regions, failures }) => format!(
                "{folder} has {regions} regions of {shapes} shapes in regions.parquet and shapes.parquet, \
                 {failures} failures in failures.json\n"
            ),
            None => format!("when all shards are done: mser3d batch --merge -o {folder}\n"),
        };
        match args.merge {
            true => tables,
            false => format!("{done} shapes computed, {kept} kept, {} failed\n{tables}", failed.len()),
        }
    };
    std::io::stdout().lock().write_all(text.as_bytes()).map_err(CliError::Stdout)?;
    if failed.is_empty() {
        return Ok(());
    }
    let first: Vec<String> = failed.iter().take(3).map(|(name, why)| format!("\n  {name}: {why}")).collect();
    let more = if failed.len() > 3 { format!("\n  and {} more", failed.len() - 3) } else { String::new() };
    Err(CliError::Incomplete(format!(
        "{} of {} shapes failed; run again when they are mended:{}{more}",
        failed.len(),
        done + kept + failed.len(),
        first.concat()
    )))
}

//! The shapes of a batch that another program hands out: what there is to do, and one shape of it.
//!
//! A process knows a shape by plain values, [`Settings`] that all shapes have and a [`Place`] of its own, so that they can be
//! sent to where it is computed.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use mser3d::{Parameters, ProgressFn};
use mser3d_cli::{BatchArgs, CliError};
use mser3d_collection::{CollectionError, Job, Need, Outcome, Plan, ScheduledBatch, ScheduledShape};
use mser3d_volumeio::{BodyParameters, Label, VolumeFormat};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{exception, usage};
use crate::options::words;
use crate::run::{Call, Told, run};

/// What all shapes have: the folder, the words of the command line, and the parameters as JSON.
type Settings = (PathBuf, Vec<OsString>, String);
/// A shape: its name and file, the volume and the label of a label map, the animation of a glTF file and the time in it.
type Place = (String, PathBuf, Option<(usize, i64)>, Option<(String, f64)>);

fn told<T>(words: &[OsString], folder: &Path, inputs: &[PathBuf]) -> PyResult<T>
where
    T: mser3d_cli::clap::Args,
{
    let mut all = words.to_vec();
    let mut output = OsString::from("--output=");
    output.push(folder);
    all.extend([output, "--".into()]);
    all.extend(inputs.iter().map(Into::into));
    mser3d_cli::parse("batch", all).map_err(exception)
}

/// What a batch is to do, and its folder while it is under way.
#[pyclass(frozen, module = "mser3d._native")]
pub struct BatchPlan {
    settings: Settings,
    plan: Plan,
    places: Vec<Place>,
    under_way: Mutex<Option<ScheduledBatch>>,
}

#[pymethods]
impl BatchPlan {
    /// Lists the shapes, as `mser3d batch` does.
    #[new]
    #[pyo3(signature = (inputs, folder, keywords, reference=None, write=Vec::new()))]
    fn new(
        py: Python<'_>,
        inputs: Vec<PathBuf>,
        folder: PathBuf,
        keywords: &Bound<'_, PyDict>,
        reference: Option<PathBuf>,
        write: Vec<String>,
    ) -> PyResult<Self> {
        let mut words = words("batch", keywords)?;
        if let Some(reference) = reference {
            let mut word = OsString::from("--reference=");
            word.push(reference);
            words.push(word);
        }
        if !write.is_empty() {
            words.push(format!("--write={}", write.join(",")).into());
        }
        let args: BatchArgs = told(&words, &folder, &inputs)?;
        let call = Call { progress: None, threads: args.threads().map_err(exception)? };
        let (plan, parameters, places) = run(py, &call, move |_| {
            let (plan, parameters) = args.plan()?;
            let places = plan.jobs.iter().map(|job| place(&args, job)).collect();
            Ok((plan, parameters, places))
        })?;
        let parameters = serde_json::to_string(&parameters).map_err(|e| exception(usage(e)))?;
        Ok(Self { settings: (folder, words, parameters), plan, places, under_way: Mutex::new(None) })
    }

    /// What all shapes have: to be handed on.
    #[getter]
    fn settings(&self) -> Settings {
        self.settings.clone()
    }

    /// A tuple for each shape, to be handed on; the first of it is the name.
    #[getter]
    fn shapes(&self) -> Vec<Place> {
        self.places.clone()
    }

    /// Labels that are too small to be searched: path, label, voxels.
    #[getter]
    fn skipped(&self) -> Vec<(String, i64, u64)> {
        self.plan.skipped.iter().map(|label| (label.path.clone(), label.label, label.voxels)).collect()
    }

    /// Makes the folder and keeps other batches out of it.
    fn begin(&self) -> PyResult<()> {
        let batch = ScheduledBatch::begin(&self.settings.0).map_err(|e| exception(e.into()))?;
        *self.held()? = Some(batch);
        Ok(())
    }

    /// Lets other batches in, without tables.
    fn abandon(&self) -> PyResult<()> {
        *self.held()? = None;
        Ok(())
    }

    /// Makes the tables: rows of shapes, rows of regions, failures.
    fn finish(&self, py: Python<'_>) -> PyResult<(usize, usize, usize)> {
        let Some(batch) = self.held()?.take() else {
            return Err(PyValueError::new_err("finish: the batch has not begun"));
        };
        let tables = py.detach(|| batch.finish(&self.plan)).map_err(|e| exception(e.into()))?;
        Ok((tables.shapes, tables.regions, tables.failures))
    }
}

impl BatchPlan {
    fn held(&self) -> PyResult<std::sync::MutexGuard<'_, Option<ScheduledBatch>>> {
        self.under_way.lock().map_err(|_| PyValueError::new_err("the batch has failed in another thread"))
    }
}

fn place(args: &BatchArgs, job: &Job) -> Place {
    let body = &job.options.body;
    let label = match (&body.label, body.volume) {
        (Some(Label::Value(label)), Some(volume)) if args.all_labels() => Some((volume, *label)),
        _ => None,
    };
    let pose = &job.options.pose;
    (
        job.name.clone(),
        job.path.clone(),
        label,
        pose.animation.clone().map(|animation| (animation, pose.time)),
    )
}

fn job(args: &BatchArgs, place: Place) -> Result<Job, CliError> {
    let (name, path, label, frame) = place;
    let is_volume = VolumeFormat::of(&path).is_some();
    let volumes = args.volumes()?;
    let mut options = if is_volume { volumes } else { volumes.limits_alone() };
    if let Some((volume, label)) = label {
        options.body = BodyParameters { volume: Some(volume), ..BodyParameters::of_label(label) };
    }
    if let Some((animation, time)) = frame {
        options.pose.animation = Some(animation);
        options.pose.time = time;
    }
    Ok(Job { name, path, options, parameters: None })
}

/// What one shape's work hands back, with what is wrong with the cache.
fn on_shape<T: Send + 'static>(
    py: Python<'_>,
    settings: Settings,
    place: Place,
    memory_limit: Option<u64>,
    work: impl FnOnce(&ScheduledShape) -> Result<T, CollectionError> + Send + 'static,
) -> PyResult<(T, Vec<String>)> {
    let (folder, words, parameters) = settings;
    let args: BatchArgs = told(&words, &folder, std::slice::from_ref(&place.1))?;
    let mut parameters: Parameters =
        serde_json::from_str(&parameters).map_err(|e| exception(usage(format!("parameters: {e}"))))?;
    if memory_limit.is_some() {
        parameters.spectrum.memory_limit = memory_limit;
    }
    let call = Call { progress: None, threads: args.threads().map_err(exception)? };
    run(py, &call, move |told: &Told| {
        let job = job(&args, place)?;
        let progress: ProgressFn = &|p| told.report(p);
        let done = args.on_shape(&job, parameters, progress, &|what| told.warn(what), work)?;
        Ok((done, told.warnings()))
    })
}

/// What became of a shape: "kept", "done" or "failed", and why.
type Said = (&'static str, Option<String>);

fn said(outcome: Outcome) -> Said {
    match outcome {
        Outcome::Kept => ("kept", None),
        Outcome::Done | Outcome::Redone(_) => ("done", None),
        Outcome::Failed(why) => ("failed", Some(why)),
    }
}

/// Whether a shape has to be computed: what became of it, or none and the bytes and seconds that it takes.
#[pyfunction]
pub fn examine_shape(py: Python<'_>, settings: Settings, shape: Place) -> PyResult<(Option<Said>, u64, f64)> {
    let (need, _) = on_shape(py, settings, shape, None, |shape| shape.examine())?;
    Ok(match need {
        Need::Through(outcome) => (Some(said(outcome)), 0, 0.0),
        Need::Run(estimate) => (None, estimate.memory_bytes, estimate.seconds),
    })
}

/// Computes a shape, with at most so many bytes: what became of it, and what is wrong with the cache.
#[pyfunction]
#[pyo3(signature = (settings, shape, memory_limit=None))]
pub fn compute_shape(
    py: Python<'_>,
    settings: Settings,
    shape: Place,
    memory_limit: Option<u64>,
) -> PyResult<(Said, Vec<String>)> {
    let (outcome, mut warnings) = on_shape(py, settings, shape, memory_limit, |shape| shape.run())?;
    if let Outcome::Redone(what) = &outcome {
        warnings.push(format!("computed again, because the result is damaged: {what}"));
    }
    Ok((said(outcome), warnings))
}

/// Records a shape as failed.
#[pyfunction]
pub fn fail_shape(py: Python<'_>, settings: Settings, shape: Place, why: String) -> PyResult<()> {
    on_shape(py, settings, shape, None, move |shape| shape.fail(&why)).map(|_| ())
}

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use mser3d::{Detector, Domain};
use mser3d_results::Extra;
use mser3d_shape::InvalidParameter;
use serde::Serialize;

use crate::advance::Advance;
use crate::budget::Budget;
use crate::folder::CollectionFolder;
use crate::recent_volumes::RecentVolumes;
use crate::shape_run::{Outcome, ShapeRun};
use crate::{CollectionError, Failure, Job, Plan, Shard, Tables, tables};

/// How a batch runs.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchParameters {
    /// Shapes in parallel, at least 1. Default: 1.
    pub workers: usize,
    /// Bytes of memory that they share; one that needs more runs alone. Default: no limit.
    pub memory: u64,
    /// What is written for each shape besides. Default: nothing.
    pub extras: Vec<Extra>,
    /// Only a part of the shapes; the tables are then left to [`build_tables`](crate::build_tables).
    pub shard: Option<Shard>,
}

impl Default for BatchParameters {
    fn default() -> Self {
        Self { workers: 1, memory: u64::MAX, extras: Vec::new(), shard: None }
    }
}

/// How far a batch is: a shape that it is through with, or one that is under way.
pub struct Event<'a> {
    /// The shape.
    pub job: &'a Job,
    /// What became of it; `None` while it is under way.
    pub outcome: Option<&'a Outcome>,
    /// Share of the work that is done, 0 to 1: of all shapes but those that are kept, each as much as it is expected to take,
    /// and those that have not begun as much as the others. Never falls.
    pub share: f64,
    /// Shapes that are through.
    pub through: usize,
    /// Shapes in all.
    pub total: usize,
}

/// What became of all shapes.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BatchSummary {
    /// Shapes computed.
    pub computed: usize,
    /// Shapes that had a result already.
    pub kept: usize,
    /// Shapes without a result, by name.
    pub failed: Vec<Failure>,
    /// The tables that were made; none by a shard.
    pub tables: Option<Tables>,
}

/// Runs a detector over many shapes, their volumes or their surfaces, each with a result in a folder of its own, and
/// makes tables of them.
///
/// Each result appears as a whole or not at all, so a batch that is killed can be run again: it keeps
/// what is there, and ends with the same bytes as one that was never disturbed (times in `regions.json`
/// aside). Results of another input, other parameters or another version are redone ([`mser3d_results::Record::is_of`]).
///
/// `heard` is called from the working threads, one call at a time: now and then, and after each shape.
///
/// # Errors
/// [`CollectionError::Busy`] when another batch is at it, [`CollectionError::Io`] and
/// [`CollectionError::NotACollection`] when results cannot be put where they belong,
/// [`CollectionError::Cancelled`] when the detector's progress function says so, and what
/// [`build_tables`](crate::build_tables) returns. Shapes that fail are no error, but part of the summary.
pub fn run_batch(
    folder: &Path,
    plan: &Plan,
    domain: Domain,
    detector: &Detector,
    parameters: &BatchParameters,
    heard: &(dyn Fn(Event) + Sync),
) -> Result<BatchSummary, CollectionError> {
    InvalidParameter::unless(parameters.workers > 0, "workers", parameters.workers, "at least 1")?;
    let folder = CollectionFolder::open(folder, parameters.shard)?;
    let jobs: Vec<&Job> = match parameters.shard {
        Some(shard) => shard.of(plan.jobs.iter().collect()),
        None => {
            folder.sweep()?;
            plan.jobs.iter().collect()
        }
    };
    let volumes = RecentVolumes::default();
    let budget = Budget::new(parameters.memory);
    let next = AtomicUsize::new(0);
    let advance = Mutex::new(Advance::new(jobs.len()));
    let fatal = Mutex::new(None);
    let outcomes: Vec<Mutex<Option<Outcome>>> = jobs.iter().map(|_| Mutex::new(None)).collect();
    let worker = || {
        while let Some((number, job, slot)) = {
            let number = next.fetch_add(1, Ordering::Relaxed);
            jobs.get(number).zip(outcomes.get(number)).map(|(job, slot)| (number, *job, slot))
        } {
            let own =
                job.parameters.as_deref().map(|own| Detector { parameters: own.clone(), ..detector.clone() });
            // Locked while it is told, so that no thread overtakes another.
            let tell = |change: &dyn Fn(&mut Advance), outcome: Option<&Outcome>| {
                let mut advance = advance.lock().unwrap_or_else(PoisonError::into_inner);
                change(&mut advance);
                let (share, through, total) = (advance.share(), advance.through(), jobs.len());
                heard(Event { job, outcome, share, through, total });
            };
            let progress = |seconds: f64, done: f64| {
                tell(&|advance| advance.is_at(number, seconds, done), None);
            };
            let detector = own.as_ref().unwrap_or(detector);
            let shape = ShapeRun { folder: &folder, job, domain, detector, extras: &parameters.extras };
            match shape.run(&|| volumes.read(job), &budget, &progress) {
                Ok(outcome) => {
                    tell(&|advance| advance.ends(number, outcome == Outcome::Kept), Some(&outcome));
                    *slot.lock().unwrap_or_else(PoisonError::into_inner) = Some(outcome);
                }
                Err(error) => {
                    // Nobody starts anything new.
                    next.store(jobs.len(), Ordering::Relaxed);
                    fatal.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                }
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..parameters.workers.min(jobs.len()) {
            // Where the system gives no more threads, those that are there do all the work.
            if std::thread::Builder::new().spawn_scoped(scope, worker).is_err() {
                break;
            }
        }
        worker();
    });
    if let Some(error) = fatal.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error);
    }
    let mut summary = BatchSummary::default();
    for (job, outcome) in jobs.iter().zip(outcomes) {
        match outcome.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(Outcome::Done) => summary.computed += 1,
            Some(Outcome::Kept) => summary.kept += 1,
            Some(Outcome::Failed(why)) => summary.failed.push(Failure::new(job, why)),
            None => {}
        }
    }
    if parameters.shard.is_none() {
        summary.tables = Some(tables::build(&folder, &plan.skipped)?);
    }
    Ok(summary)
}

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use mser3d::{Detector, Domain};
use mser3d_results::Extra;
use mser3d_shape::InvalidParameter;
use rayon::ThreadPoolBuilder;
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
    /// How long a shape may take; one that takes longer has failed. Waiting for memory does not count. Default: no limit.
    pub time_limit: Option<Duration>,
    /// What is written for each shape besides. Default: nothing.
    pub extras: Vec<Extra>,
    /// Only a part of the shapes; the tables are then left to [`build_tables`](crate::build_tables).
    pub shard: Option<Shard>,
}

impl Default for BatchParameters {
    fn default() -> Self {
        Self { workers: 1, memory: u64::MAX, time_limit: None, extras: Vec::new(), shard: None }
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
    /// Shapes of those computed that had a result which is damaged, by name.
    pub damaged: Vec<DamagedShape>,
    /// Shapes that failed, by name.
    pub failed: Vec<Failure>,
    /// The tables that were made; none by a shard.
    pub tables: Option<Tables>,
}

/// A shape whose result was damaged, and was computed again.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DamagedShape {
    /// Its name in the collection.
    pub name: String,
    /// What was damaged.
    pub damage: String,
}

/// Runs a detector over many shapes, their volumes or their surfaces, each with a result in a folder of its own, and
/// makes tables of them.
///
/// Each result appears as a whole or not at all, so a batch that is killed can be run again: it keeps
/// what is there, and ends with the same bytes as one that was never disturbed (times in `regions.json`
/// aside). Results of another input, other parameters or another version are redone ([`mser3d_results::Record::is_of`]), and those
/// that are damaged. A shape that fails keeps the result that it has from an earlier run; its failure stands beside it.
///
/// The workers share rayon's global threads; called from a thread of another pool, each has an equal share of as many
/// threads as that pool has.
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
    let folder = CollectionFolder::open(folder, parameters.shard)?;
    run_batch_in(&folder, plan, domain, detector, parameters, heard)
}

/// [`run_batch`] in a folder that is held already, and is held for what comes after.
///
/// # Errors
/// As [`run_batch`], but for [`CollectionError::Busy`].
pub fn run_batch_in(
    folder: &CollectionFolder,
    plan: &Plan,
    domain: Domain,
    detector: &Detector,
    parameters: &BatchParameters,
    heard: &(dyn Fn(Event) + Sync),
) -> Result<BatchSummary, CollectionError> {
    InvalidParameter::unless(parameters.workers > 0, "workers", parameters.workers, "at least 1")?;
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
    let work = || {
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
            let (extras, time_limit) = (&parameters.extras[..], parameters.time_limit);
            let shape = ShapeRun { folder, job, domain, detector, extras, time_limit };
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
    let workers = parameters.workers.min(jobs.len()).max(1);
    // Not that pool itself: a worker waiting for its threads could be given another's shape meanwhile, whose memory it would then wait for.
    let threads = rayon::current_thread_index().map(|_| (rayon::current_num_threads() / workers).max(1));
    let worker = || match threads.map(|n| ThreadPoolBuilder::new().num_threads(n).build()) {
        Some(Ok(pool)) => pool.install(work),
        _ => work(),
    };
    std::thread::scope(|scope| {
        for _ in 1..workers {
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
            Some(Outcome::Redone(what)) => {
                summary.computed += 1;
                summary.damaged.push(DamagedShape { name: job.name.clone(), damage: what });
            }
            Some(Outcome::Kept) => summary.kept += 1,
            Some(Outcome::Failed(why)) => {
                summary.failed.push(Failure::new(job, why, folder.has_result(&job.name)));
            }
            None => {}
        }
    }
    if parameters.shard.is_none() {
        summary.tables = Some(tables::build(folder, &plan.skipped)?);
    }
    Ok(summary)
}

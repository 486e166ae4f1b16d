use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use mser3d_meshio::write_atomically;
use serde_json::{Value, json};

use crate::budget::Budget;
use crate::folder::CollectionFolder;
use crate::{CollectionError, Job, Shard, Tables, tables};

/// What a batch does with each shape.
pub trait Work: Sync {
    /// What is read before the work starts.
    type Input: Send;

    /// Reads a shape, and says what its result depends on and what it will need.
    ///
    /// # Errors
    /// Why the shape cannot be read, in words; it is recorded, and the rest go on.
    fn read(&self, job: &Job) -> Result<Ready<Self::Input>, String>;

    /// Writes the shape's result, `regions.json` among it, into an empty folder.
    ///
    /// # Errors
    /// Why there is no result, in words; it is recorded, and the rest go on.
    fn run(&self, job: &Job, input: Self::Input, folder: &Path) -> Result<(), String>;
}

/// A shape that was read.
pub struct Ready<T> {
    /// What was read.
    pub input: T,
    /// What the result depends on, as part of `regions.json`: a result that says otherwise is redone.
    pub identity: Value,
    /// Bytes of memory that the work will take, about.
    pub memory: u64,
}

/// How a batch runs.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchParameters {
    /// Shapes in parallel, at least 1. Default: 1.
    pub workers: usize,
    /// Bytes of memory that they share; one that needs more runs alone. Default: no limit.
    pub memory: u64,
    /// Only a part of the shapes; the tables are then left to [`build_tables`](crate::build_tables).
    pub shard: Option<Shard>,
}

impl Default for BatchParameters {
    fn default() -> Self {
        Self { workers: 1, memory: u64::MAX, shard: None }
    }
}

/// What became of a shape.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// There was a result already, of the same input and parameters.
    Kept,
    /// It was computed.
    Done,
    /// There is no result, for this reason.
    Failed(String),
}

/// A shape that a batch is through with.
pub struct Event<'a> {
    /// The shape.
    pub job: &'a Job,
    /// What became of it.
    pub outcome: &'a Outcome,
    /// Shapes that are through, this one included.
    pub through: usize,
    /// Shapes in all.
    pub total: usize,
}

/// What became of all shapes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BatchSummary {
    /// Shapes computed.
    pub done: usize,
    /// Shapes that had a result already.
    pub kept: usize,
    /// Names of shapes without a result, and why, by name.
    pub failed: Vec<(String, String)>,
    /// The tables that were made; none by a shard.
    pub tables: Option<Tables>,
}

/// Computes the results of many shapes, each in a folder of its own, and makes tables of them.
///
/// Each result appears as a whole or not at all, so a batch that is killed can be run again: it keeps
/// what is there, and ends with the same bytes as one that was never disturbed (times in `regions.json`
/// aside). Results whose `regions.json` contradicts [`Ready::identity`] are redone.
///
/// `progress` is called from the working threads, after each shape.
///
/// # Errors
/// [`CollectionError::Busy`] when another batch is at it, [`CollectionError::Io`] and
/// [`CollectionError::NotACollection`] when results cannot be put where they belong, and what
/// [`build_tables`](crate::build_tables) returns. Shapes that fail are no error, but part of the summary.
pub fn run_batch<W: Work>(
    folder: &Path,
    jobs: Vec<Job>,
    work: &W,
    parameters: &BatchParameters,
    progress: &(dyn Fn(Event) + Sync),
) -> Result<BatchSummary, CollectionError> {
    if parameters.workers == 0 {
        let (value, expected) = ("0".to_owned(), "at least 1");
        return Err(CollectionError::BadParameter { name: "workers", value, expected });
    }
    let folder = CollectionFolder::open(folder, parameters.shard)?;
    let jobs = match parameters.shard {
        Some(shard) => shard.of(jobs),
        None => {
            folder.sweep()?;
            jobs
        }
    };
    let budget = Budget::new(parameters.memory);
    let (next, through) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let fatal = Mutex::new(None);
    let outcomes: Vec<Mutex<Option<Outcome>>> = jobs.iter().map(|_| Mutex::new(None)).collect();
    let worker = || {
        while let Some((job, slot)) = {
            let number = next.fetch_add(1, Ordering::Relaxed);
            jobs.get(number).zip(outcomes.get(number))
        } {
            match one(&folder, job, work, &budget) {
                Ok(outcome) => {
                    let through = through.fetch_add(1, Ordering::Relaxed) + 1;
                    progress(Event { job, outcome: &outcome, through, total: jobs.len() });
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
            scope.spawn(worker);
        }
        worker();
    });
    if let Some(error) = fatal.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error);
    }
    let mut summary = BatchSummary::default();
    for (job, outcome) in jobs.iter().zip(outcomes) {
        match outcome.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(Outcome::Done) => summary.done += 1,
            Some(Outcome::Kept) => summary.kept += 1,
            Some(Outcome::Failed(why)) => summary.failed.push((job.name.clone(), why)),
            None => {}
        }
    }
    if parameters.shard.is_none() {
        summary.tables = Some(tables::build(&folder)?);
    }
    Ok(summary)
}

/// Deals with one shape. Errors are those of the collection's folder, not of the shape.
fn one<W: Work>(
    folder: &CollectionFolder,
    job: &Job,
    work: &W,
    budget: &Budget,
) -> Result<Outcome, CollectionError> {
    let attempt = catch_unwind(AssertUnwindSafe(|| work.read(job)));
    let ready = match attempt.unwrap_or_else(|panic| Err(said(&*panic))) {
        Ok(ready) => ready,
        Err(why) => return failed(folder, job, why),
    };
    if is_current(&folder.result(&job.name), &ready.identity) {
        return Ok(Outcome::Kept);
    }
    folder.remove_tables()?;
    let partial = folder.begin(&job.name)?;
    let share = budget.take(ready.memory);
    let attempt = catch_unwind(AssertUnwindSafe(|| work.run(job, ready.input, &partial)));
    drop(share);
    match attempt.unwrap_or_else(|panic| Err(said(&*panic))) {
        Ok(()) => {
            folder.publish(&job.name, &partial)?;
            Ok(Outcome::Done)
        }
        Err(why) => failed(folder, job, why),
    }
}

/// Records a failure in place of a result.
fn failed(folder: &CollectionFolder, job: &Job, why: String) -> Result<Outcome, CollectionError> {
    folder.remove_tables()?;
    let partial = folder.begin(&job.name)?;
    let failure = json!({
        "name": job.name,
        "path": job.path.to_string_lossy(),
        "animation": job.animation,
        "time": job.time,
        "error": why,
    });
    write_atomically(&partial.join("failure.json"), |out| {
        use std::io::Write;
        writeln!(out, "{failure:#}")
    })?;
    folder.publish(&job.name, &partial)?;
    Ok(Outcome::Failed(why))
}

/// Whether a folder holds a result that says all that `identity` says.
fn is_current(folder: &Path, identity: &Value) -> bool {
    let read = |text: &[u8]| serde_json::from_slice::<Value>(text).ok();
    let record = std::fs::read(folder.join("regions.json")).ok().and_then(|text| read(&text));
    // Numbers that were written and read compare with numbers that were written and read.
    record.zip(read(identity.to_string().as_bytes())).is_some_and(|(record, wanted)| says(&record, &wanted))
}

fn says(record: &Value, wanted: &Value) -> bool {
    match wanted {
        Value::Object(wanted) => {
            wanted.iter().all(|(key, value)| record.get(key).is_some_and(|r| says(r, value)))
        }
        _ => record == wanted,
    }
}

/// What a panic said.
fn said(panic: &(dyn Any + Send)) -> String {
    let message = panic.downcast_ref::<&str>().copied();
    let message = message.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    format!("a bug in mser3d, please report it: {}", message.unwrap_or("panic"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_is_part_of_the_record() {
        let record = json!({"input": {"sha256": "ab", "bytes": 3}, "parameters": {"k": 0.1}, "run": 1});
        assert!(says(&record, &json!({"input": {"sha256": "ab"}, "parameters": {"k": 0.1}})));
        assert!(!says(&record, &json!({"input": {"sha256": "cd"}})));
        assert!(!says(&record, &json!({"mser3d": "0.1.0"})));
    }
}

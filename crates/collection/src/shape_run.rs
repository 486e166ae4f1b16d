//! One shape of a batch: its result is kept, computed, or its failure recorded.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::Duration;

use mser3d::{Deadline, DeadlinePassed, Detector, Domain, Progress};
use mser3d_fileio::write_text;
use mser3d_results::{Extra, Record, Results, ResultsError, ResultsFolder, ShapeFile, first_damage};

use crate::budget::Budget;
use crate::failure::FAILURE;
use crate::folder::{CollectionFolder, remove_file};
use crate::{CollectionError, Failure, Job};

/// What became of a shape.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// There was a result already, of the same input and parameters.
    Kept,
    /// It was computed.
    Done,
    /// It was computed again, because the result that was there is damaged, as this says.
    Redone(String),
    /// There is no result, for this reason.
    Failed(String),
}

/// Whether a shape has to be computed.
pub(crate) enum Look {
    /// No: it has a result, or cannot be read.
    Through(Outcome),
    /// Yes, and it was read. If there is a result that is damaged, what is wrong with it.
    ToDo(Box<ShapeFile>, Option<String>),
}

/// A shape, and all of the batch that it needs.
pub(crate) struct ShapeRun<'a> {
    pub folder: &'a CollectionFolder,
    pub job: &'a Job,
    pub domain: Domain,
    pub detector: &'a Detector<'a>,
    pub extras: &'a [Extra],
    /// How long the shape may take.
    pub time_limit: Option<Duration>,
}

/// Bytes of memory for a byte of a file that is read, about.
const READING: u64 = 4;

/// Reads the shape.
pub(crate) type ReadShape<'a> = &'a dyn Fn() -> Result<ShapeFile, ResultsError>;

impl ShapeRun<'_> {
    /// Reads the shape and looks whether its result is there. One that cannot be read has failed. Errors are those of the
    /// collection's folder.
    pub fn look(&self, read: ReadShape) -> Result<Look, CollectionError> {
        let file = match guarded(|| Ok(read()?)) {
            Ok(file) => file,
            Err(why) => return Ok(Look::Through(self.fail(why.to_string())?)),
        };
        let result = self.folder.result(&self.job.name);
        let parameters = &self.detector.parameters;
        let is_same = |record: &Record| record.is_of(&file.identity(), self.domain, parameters);
        let damage = match Record::load(&result) {
            Ok(record) if is_same(&record) => {
                let extras = self.extras.iter().map(|extra| result.join(extra.file_name()));
                let damage = first_damage(&result);
                if damage.is_none() && extras.into_iter().all(|extra| extra.is_file()) {
                    self.forget_failure(&result)?;
                    return Ok(Look::Through(Outcome::Kept));
                }
                damage.map(|finding| finding.text)
            }
            // What is of other parameters, or of an earlier version, is replaced whatever it is like.
            Ok(_) | Err(ResultsError::NotAResult { .. } | ResultsError::OtherFormat { .. }) => None,
            Err(error) => Some(error.to_string()),
        };
        Ok(Look::ToDo(Box::new(file), damage))
    }

    /// Takes away what a run with other parameters says of its failure beside a result that is kept.
    fn forget_failure(&self, result: &Path) -> Result<(), CollectionError> {
        let failure = result.join(FAILURE);
        if failure.is_file() {
            self.folder.remove_tables()?;
            remove_file(&failure)?;
        }
        Ok(())
    }

    /// Deals with the shape; `progress` hears how many seconds it is expected to take, and what share of it is done. Errors
    /// are those of the collection's folder and of a cancelled batch, not of the shape.
    pub fn run(
        &self,
        read: ReadShape,
        budget: &Budget,
        progress: &(dyn Fn(f64, f64) + Sync),
    ) -> Result<Outcome, CollectionError> {
        let _shape = tracing::info_span!("shape", name = self.job.name).entered();
        // While it is read, a file takes a few times its size.
        let bytes = std::fs::metadata(&self.job.path).map_or(0, |found| found.len());
        let share = budget.take(bytes.saturating_mul(READING));
        let deadline = Deadline::new(self.time_limit);
        let looked = self.look(read)?;
        drop(share);
        let (file, damage) = match looked {
            Look::Through(outcome) => return Ok(outcome),
            Look::ToDo(file, damage) => (file, damage),
        };
        self.folder.remove_tables()?;
        let partial = self.folder.begin(&self.job.name)?;
        let done = guarded(|| {
            let input = file.input(self.domain)?;
            let estimate = self.detector.parameters.estimate(&input);
            deadline.check()?;
            // Waiting for others does not count.
            let before = deadline.left();
            let share = budget.take(estimate.memory_bytes);
            let deadline = deadline.resumed(before);
            let told = |told: Progress| {
                progress(estimate.seconds, told.overall);
                deadline.go_on()?;
                (self.detector.progress)(told)
            };
            let features = self.detector.clone().with_progress(&told).detect(input);
            if let Err(mser3d::Error::Cancelled) = features {
                deadline.check()?;
            }
            let features = features?;
            let results = Results::of_file(&features, &file)?.with_extras(&features, self.extras);
            ResultsFolder::create(partial.path())?.write_found(&results, &features, self.extras)?;
            drop(share);
            Ok(())
        });
        match done {
            Ok(()) => {
                self.folder.publish(&self.job.name, partial)?;
                Ok(damage.map_or(Outcome::Done, Outcome::Redone))
            }
            Err(Trouble::Detect(mser3d::Error::Cancelled)) => Err(CollectionError::Cancelled),
            Err(why) => {
                drop(partial);
                self.fail(why.to_string())
            }
        }
    }

    /// Records a failure: in place of a result, or beside one of an earlier run, which stays.
    pub fn fail(&self, why: String) -> Result<Outcome, CollectionError> {
        self.folder.remove_tables()?;
        let kept = self.folder.has_result(&self.job.name);
        let json = serde_json::to_string_pretty(&Failure::new(self.job, why.clone(), kept));
        let write = |folder: &Path| {
            let path = folder.join(FAILURE);
            let json = json.map_err(|e| CollectionError::io(&path)(e.into()))?;
            Ok::<(), CollectionError>(write_text(
                &path,
                &(json
                    + "\
"),
            )?)
        };
        if kept {
            write(&self.folder.result(&self.job.name))?;
        } else {
            let partial = self.folder.begin(&self.job.name)?;
            write(partial.path())?;
            self.folder.publish(&self.job.name, partial)?;
        }
        Ok(Outcome::Failed(why))
    }
}

/// Why one shape has no result.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Trouble {
    #[error(transparent)]
    Results(#[from] ResultsError),
    #[error(transparent)]
    Detect(#[from] mser3d::Error),
    #[error(transparent)]
    Deadline(#[from] DeadlinePassed),
    #[error("a bug in mser3d, please report it: {0}")]
    Panic(String),
}

/// Does some work; a panic is an error, so that one shape cannot end a batch.
pub(crate) fn guarded<T>(work: impl FnOnce() -> Result<T, Trouble>) -> Result<T, Trouble> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| Err(Trouble::Panic(said(&*panic))))
}

/// What a panic said.
fn said(panic: &(dyn Any + Send)) -> String {
    let message = panic.downcast_ref::<&str>().copied();
    let message = message.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    message.unwrap_or("panic").to_owned()
}

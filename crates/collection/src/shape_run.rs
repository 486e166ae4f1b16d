//! One shape of a batch: its result is kept, computed, or its failure recorded.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use mser3d::{Detector, Domain, Progress};
use mser3d_fileio::write_text;
use mser3d_results::{Extra, Record, Results, ResultsError, ResultsFolder, ShapeFile};

use crate::budget::Budget;
use crate::folder::CollectionFolder;
use crate::{CollectionError, Failure, Job};

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

/// Whether a shape has to be computed.
pub(crate) enum Look {
    /// No: it has a result, or cannot be read.
    Through(Outcome),
    /// Yes, and it was read.
    ToDo(Box<ShapeFile>),
}

/// A shape, and all of the batch that it needs.
pub(crate) struct ShapeRun<'a> {
    pub folder: &'a CollectionFolder,
    pub job: &'a Job,
    pub domain: Domain,
    pub detector: &'a Detector<'a>,
    pub extras: &'a [Extra],
}

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
        let whole = self.extras.iter().all(|extra| result.join(extra.file_name()).is_file());
        let parameters = &self.detector.parameters;
        let is_same = |record: Record| record.is_of(&file.identity(), self.domain, parameters);
        if whole && Record::load(&result).is_ok_and(is_same) {
            return Ok(Look::Through(Outcome::Kept));
        }
        Ok(Look::ToDo(Box::new(file)))
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
        let file = match self.look(read)? {
            Look::Through(outcome) => return Ok(outcome),
            Look::ToDo(file) => file,
        };
        self.folder.remove_tables()?;
        let partial = self.folder.begin(&self.job.name)?;
        let done = guarded(|| {
            let input = file.input(self.domain)?;
            let estimate = self.detector.parameters.estimate(&input);
            let share = budget.take(estimate.memory_bytes);
            let told = |told: Progress| {
                progress(estimate.seconds, told.overall);
                (self.detector.progress)(told)
            };
            let features = self.detector.clone().with_progress(&told).detect(input)?;
            let results = Results::of_file(&features, &file)?.with_extras(&features, self.extras);
            ResultsFolder::create(partial.path())?.write(&results, self.extras)?;
            drop(share);
            Ok(())
        });
        match done {
            Ok(()) => {
                self.folder.publish(&self.job.name, partial)?;
                Ok(Outcome::Done)
            }
            Err(Trouble::Detect(mser3d::Error::Cancelled)) => Err(CollectionError::Cancelled),
            Err(why) => {
                drop(partial);
                self.fail(why.to_string())
            }
        }
    }

    /// Records a failure in place of a result.
    pub fn fail(&self, why: String) -> Result<Outcome, CollectionError> {
        self.folder.remove_tables()?;
        let partial = self.folder.begin(&self.job.name)?;
        let path = partial.path().join("failure.json");
        let json = serde_json::to_string_pretty(&Failure::new(self.job, why.clone()));
        let json = json.map_err(|e| CollectionError::io(&path)(e.into()))?;
        write_text(&path, &(json + "\n"))?;
        self.folder.publish(&self.job.name, partial)?;
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

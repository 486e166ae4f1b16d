//! A batch whose shapes another program hands out, to processes on any machines that share the file system.

use std::path::Path;
use std::time::Duration;

use mser3d::{Detector, Domain, Estimate};
use mser3d_results::Extra;

use crate::budget::Budget;
use crate::folder::CollectionFolder;
use crate::shape_run::{Look, Outcome, ShapeRun, guarded};
use crate::{CollectionError, Job, Plan, Tables, tables};

/// The folder of a batch whose shapes are computed by other processes, each by a [`ScheduledShape`]. As long as this is held,
/// no other batch can begin in the folder.
pub struct ScheduledBatch {
    folder: CollectionFolder,
}

impl ScheduledBatch {
    /// Makes the folder, and removes what batches that were killed left behind.
    ///
    /// # Errors
    /// [`CollectionError::Busy`] when another batch is at it, [`CollectionError::Io`].
    pub fn begin(folder: &Path) -> Result<Self, CollectionError> {
        CollectionFolder::open(folder, None)?.sweep()?;
        Ok(Self { folder: CollectionFolder::join(folder)? })
    }

    /// Makes the tables, when nothing is under way any more. The same bytes as those of [`run_batch`](crate::run_batch).
    ///
    /// # Errors
    /// [`CollectionError::Busy`] when a shape is still computed, and those of [`build_tables`](crate::build_tables).
    pub fn finish(self, plan: &Plan) -> Result<Tables, CollectionError> {
        let path = self.folder.path().to_owned();
        drop(self);
        let folder = CollectionFolder::open(&path, None)?;
        folder.sweep()?;
        tables::build(&folder, &plan.skipped)
    }
}

/// What it takes to be through with a shape.
#[derive(Clone, Debug, PartialEq)]
pub enum Need {
    /// Nothing: this became of it.
    Through(Outcome),
    /// A run that takes about this.
    Run(Estimate),
}

/// A shape of a [`ScheduledBatch`]. Processes may do the same one at the same time, as happens when one was believed dead:
/// the result is still whole, and one of them may get an error.
pub struct ScheduledShape<'a> {
    /// The folder of the batch.
    pub folder: &'a Path,
    /// The shape.
    pub job: &'a Job,
    /// Whether its volume is searched, or its surface.
    pub domain: Domain,
    /// What searches it.
    pub detector: &'a Detector<'a>,
    /// What is written besides.
    pub extras: &'a [Extra],
    /// How long it may take; a shape that takes longer has failed.
    pub time_limit: Option<Duration>,
}

impl ScheduledShape<'_> {
    /// Whether it has to be computed, and what that takes. A shape that cannot be read is recorded as failed.
    ///
    /// # Errors
    /// [`CollectionError::Io`], [`CollectionError::Busy`], [`CollectionError::NotACollection`].
    pub fn examine(&self) -> Result<Need, CollectionError> {
        self.within(|shape| match shape.look(&|| self.job.read())? {
            Look::Through(outcome) => Ok(Need::Through(outcome)),
            Look::ToDo(file, _) => {
                let estimate = guarded(|| Ok(shape.detector.parameters.estimate(&file.input(self.domain)?)));
                match estimate {
                    Ok(estimate) => Ok(Need::Run(estimate)),
                    Err(why) => Ok(Need::Through(shape.fail(why.to_string())?)),
                }
            }
        })
    }

    /// Computes it, if that has not been done, or records why it fails.
    ///
    /// # Errors
    /// As [`examine`](Self::examine), and [`CollectionError::Cancelled`].
    pub fn run(&self) -> Result<Outcome, CollectionError> {
        let alone = Budget::new(u64::MAX);
        self.within(|shape| shape.run(&|| self.job.read(), &alone, &|_, _| {}))
    }

    /// Records that it failed for a reason that its process could not tell: it was killed.
    ///
    /// # Errors
    /// As [`examine`](Self::examine).
    pub fn fail(&self, why: &str) -> Result<Outcome, CollectionError> {
        self.within(|shape| shape.fail(why.to_owned()))
    }

    fn within<T>(
        &self,
        work: impl FnOnce(&ShapeRun) -> Result<T, CollectionError>,
    ) -> Result<T, CollectionError> {
        let Self { job, domain, detector, extras, time_limit, .. } = *self;
        let folder = &CollectionFolder::join(self.folder)?;
        work(&ShapeRun { folder, job, domain, detector, extras, time_limit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_other_batch_begins_while_shapes_are_scheduled() {
        let folder = tempfile::tempdir().unwrap();
        let batch = ScheduledBatch::begin(folder.path()).unwrap();
        assert!(matches!(ScheduledBatch::begin(folder.path()), Err(CollectionError::Busy { .. })));
        drop(batch);
        assert!(ScheduledBatch::begin(folder.path()).is_ok());
    }

    #[test]
    fn what_cannot_be_read_is_a_failure_of_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let job = Job {
            name: "a".into(),
            path: folder.path().join("missing.off"),
            options: Default::default(),
            parameters: None,
        };
        let out = folder.path().join("out");
        let batch = ScheduledBatch::begin(&out).unwrap();
        let detector = Detector::default();
        let shape = ScheduledShape {
            folder: &out,
            job: &job,
            domain: Domain::Volume,
            detector: &detector,
            extras: &[],
            time_limit: None,
        };
        for outcome in [shape.examine().unwrap(), Need::Through(shape.run().unwrap())] {
            assert!(
                matches!(&outcome, Need::Through(Outcome::Failed(why)) if why.contains("missing.off")),
                "{outcome:?}"
            );
        }
        shape.fail("killed").unwrap();
        assert!(std::fs::read_to_string(out.join("a/failure.json")).unwrap().contains("killed"));
        assert_eq!(batch.finish(&Plan::default()).unwrap(), Tables { shapes: 0, regions: 0, failures: 1 });
    }
}

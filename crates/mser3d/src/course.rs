//! How far a run is, from how far its stages are.

use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

use mser3d_shape::Choice;

use crate::progress::{Progress, ProgressFn, Stage};
use crate::{Error, StageSeconds};

impl StageSeconds {
    fn of(&mut self, stage: Stage) -> &mut f64 {
        match stage {
            Stage::Voxelize => &mut self.voxelize,
            Stage::Spectrum => &mut self.spectrum,
            Stage::Regions => &mut self.regions,
            Stage::Reliability => &mut self.reliability,
            Stage::Descriptors => &mut self.descriptors,
            Stage::Parts => &mut self.parts,
        }
    }

    /// The share of all work that is done when this share of a stage is, and all stages before it are.
    pub(crate) fn share(mut self, stage: Stage, done: f64) -> f64 {
        let before: f64 = Stage::ALL.iter().take_while(|s| **s != stage).map(|s| *self.of(*s)).sum();
        (before + *self.of(stage) * done.clamp(0.0, 1.0)) / self.sum().max(f64::MIN_POSITIVE)
    }
}

/// Tells of the whole run what its stages tell of themselves, one after the other.
pub(crate) struct Course<'a> {
    progress: ProgressFn<'a>,
    state: Mutex<State>,
}

struct State {
    seconds: StageSeconds,
    /// What was told last.
    last: Option<Progress>,
}

impl<'a> Course<'a> {
    /// With the time that each stage is expected to take.
    pub fn new(progress: ProgressFn<'a>, seconds: StageSeconds) -> Self {
        Self { progress, state: Mutex::new(State { seconds, last: None }) }
    }

    /// Corrects what a stage that has not begun is expected to take.
    pub fn expect(&self, stage: Stage, seconds: f64) {
        *self.lock().seconds.of(stage) = seconds;
    }

    /// Ends a stage. One that told nothing took no time: its eigenpairs were there already.
    pub fn end(&self, stage: Stage) -> Result<(), Error> {
        let mut state = self.lock();
        if state.last.is_none_or(|last| last.stage != stage) {
            *state.seconds.of(stage) = 0.0;
        }
        drop(state);
        match self.hear(Progress { stage, done: 1.0, overall: 1.0 }) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Error::Cancelled),
        }
    }

    /// Hears a stage. Locked while it is told, so that no thread overtakes another.
    pub fn hear(&self, told: Progress) -> ControlFlow<()> {
        let mut state = self.lock();
        let overall = state.seconds.share(told.stage, told.done);
        let next = match state.last {
            Some(last) => Progress {
                done: if last.stage == told.stage { told.done.max(last.done) } else { told.done },
                overall: overall.max(last.overall),
                ..told
            },
            None => Progress { overall, ..told },
        };
        state.last = Some(next);
        (self.progress)(next)
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expected() -> StageSeconds {
        StageSeconds {
            voxelize: 1.0,
            spectrum: 5.0,
            regions: 2.0,
            descriptors: 2.0,
            ..StageSeconds::default()
        }
    }

    fn heard(use_it: impl FnOnce(&Course)) -> Vec<(f64, f64)> {
        let heard = Mutex::new(Vec::new());
        let hear = |p: Progress| {
            heard.lock().unwrap().push((p.done, p.overall));
            ControlFlow::Continue(())
        };
        use_it(&Course::new(&hear, expected()));
        heard.into_inner().unwrap()
    }

    fn tell(course: &Course, stage: Stage, done: f64) {
        assert!(course.hear(Progress { stage, done, overall: done }).is_continue());
    }

    #[test]
    fn stages_count_as_much_as_they_are_expected_to_take() {
        let told = heard(|course| {
            tell(course, Stage::Voxelize, 0.5);
            course.end(Stage::Voxelize).unwrap();
            tell(course, Stage::Spectrum, 0.4);
            // Another thread is not as far.
            tell(course, Stage::Spectrum, 0.2);
            course.end(Stage::Spectrum).unwrap();
            tell(course, Stage::Regions, 0.5);
            course.end(Stage::Descriptors).unwrap();
        });
        let overall = [0.05, 0.1, 0.3, 0.3, 0.6, 0.7];
        assert_eq!(told[..6].iter().map(|t| t.1).collect::<Vec<_>>(), overall);
        assert_eq!(told.iter().map(|t| t.0).collect::<Vec<_>>(), [0.5, 1.0, 0.4, 0.4, 1.0, 0.5, 1.0]);
        assert_eq!(told[6].1, 1.0);
    }

    #[test]
    fn a_stage_that_tells_nothing_takes_nothing_and_a_correction_never_goes_back() {
        let told = heard(|course| {
            course.end(Stage::Voxelize).unwrap();
            course.end(Stage::Spectrum).unwrap();
            tell(course, Stage::Regions, 0.5);
            course.expect(Stage::Reliability, 96.0);
            tell(course, Stage::Regions, 1.0);
            tell(course, Stage::Reliability, 0.5);
        });
        // Of 4 seconds in all: nothing at first, then 1 of them; later 2, and 50, of 100.
        assert_eq!(told.iter().map(|t| t.1).collect::<Vec<_>>(), [0.0, 0.0, 0.25, 0.25, 0.5]);
    }
}

//! Progress bars on stderr.

use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use mser3d::shape::Choice;
use mser3d::{Progress, Stage};
use mser3d_collection::{Event, Outcome};

use crate::interrupt;
use crate::log;
use crate::message::{self, tell};

/// Steps of a bar.
const STEPS: u64 = 1000;
/// Before this share is done, and this many seconds have gone by, nothing is said of the time left.
const FIRST_SHARE: f64 = 0.02;
const FIRST_SECONDS: f64 = 0.5;

/// Bars are for terminals, and for users who asked neither for quiet nor for a log.
fn target(quiet: bool) -> ProgressDrawTarget {
    if quiet || log::is_on() { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() }
}

fn position(share: f64) -> u64 {
    (STEPS as f64 * share.clamp(0.0, 1.0)) as u64
}

/// The time that is left when a share of the work took so many seconds.
fn left(share: f64, seconds: f64) -> Option<f64> {
    (share >= FIRST_SHARE && seconds >= FIRST_SECONDS).then(|| seconds / share * (1.0 - share))
}

/// Listens to a [`mser3d::Detector`].
pub struct Meter {
    bar: ProgressBar,
    start: Instant,
    /// The stage under way, and the share of all work that was done when it began.
    stage: Mutex<(Stage, f64)>,
}

impl Meter {
    /// Draws on stderr if that is a terminal and the user did not ask for quiet.
    pub fn new(quiet: bool) -> Self {
        let bar = ProgressBar::with_draw_target(Some(STEPS), target(quiet));
        if let Ok(style) =
            ProgressStyle::with_template("{msg:24} [{bar:30}] {percent:>3} % {elapsed}{prefix}")
        {
            bar.set_style(style.progress_chars("=> "));
        }
        Self { bar, start: Instant::now(), stage: Mutex::new((Stage::default(), 0.0)) }
    }

    pub fn report(&self, progress: Progress) -> ControlFlow<()> {
        let Progress { stage, done, overall } = progress;
        let began = {
            let mut known = self.stage.lock().unwrap_or_else(PoisonError::into_inner);
            if known.0 != stage {
                *known = (stage, overall);
            }
            known.1
        };
        self.bar.set_message(format!("{} {:.0} %", stage.name(), 100.0 * done));
        self.bar.set_position(position(overall));
        self.bar.set_prefix(time_left(progress, began, self.start.elapsed().as_secs_f64()));
        interrupt::go_on()
    }

    /// Tells the user something, beside the bar.
    pub fn warn(&self, what: &str) {
        self.bar.suspend(|| tell(&format!("warning: {what}")));
    }

    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// The time left, of the stage and in all, of a stage that began at a share of all work.
fn time_left(progress: Progress, began: f64, seconds: f64) -> String {
    let Progress { stage, done, overall } = progress;
    let Some(all) = left(overall, seconds) else { return String::new() };
    let duration = |seconds: f64| HumanDuration(Duration::from_secs_f64(seconds.max(0.0).round()));
    // At the pace of all work so far.
    let of_stage = (done >= FIRST_SHARE).then(|| (overall - began) / done * (1.0 - done) * seconds / overall);
    match of_stage {
        Some(own) if own < all => {
            format!(", about {:#} left of {}, {:#} in all", duration(own), stage.name(), duration(all))
        }
        _ => format!(", about {:#} left", duration(all)),
    }
}

/// Progress of a batch: a bar with the time left, or where there is no terminal a line per shape.
pub struct BatchMeter {
    bar: ProgressBar,
    lines: bool,
    start: Instant,
}

impl BatchMeter {
    pub fn new(quiet: bool) -> Self {
        let bar = ProgressBar::with_draw_target(Some(STEPS), target(quiet));
        if let Ok(style) = ProgressStyle::with_template("{msg} [{bar:30}] {percent:>3} % {elapsed}{prefix}") {
            bar.set_style(style.progress_chars("=> "));
        }
        let lines = !quiet && bar.is_hidden();
        Self { bar, lines, start: Instant::now() }
    }

    pub fn report(&self, event: &Event) {
        let remaining = left(event.share, self.start.elapsed().as_secs_f64()).filter(|_| event.share < 1.0);
        let remaining = remaining.map_or(String::new(), |seconds| {
            format!(", about {} left", HumanDuration(Duration::from_secs_f64(seconds)))
        });
        if let Some(outcome) = event.outcome {
            let what = match outcome {
                Outcome::Kept => "kept".to_owned(),
                Outcome::Done => "done".to_owned(),
                Outcome::Redone(_) => "done again".to_owned(),
                Outcome::Failed(why) => format!("failed: {why}"),
            };
            let name = message::name(&event.job.name);
            if self.lines {
                let line = format!("{}/{} {name}: {what}{remaining}", event.through, event.total);
                eprintln!("{}", message::shown(&line));
            } else if let Outcome::Failed(_) = outcome {
                self.bar.println(message::shown(&format!("{name}: {what}")));
            }
        }
        self.bar.set_message(format!("{}/{} shapes", event.through, event.total));
        self.bar.set_position(position(event.share));
        self.bar.set_prefix(remaining);
    }

    /// Tells the user something, beside the bar.
    pub fn warn(&self, what: &str) {
        self.bar.suspend(|| tell(&format!("warning: {what}")));
    }

    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_left_is_told_of_the_stage_and_of_all() {
        let at = |done, overall| Progress { stage: Stage::Spectrum, done, overall };
        assert_eq!(time_left(at(0.5, 0.01), 0.0, 9.0), "");
        assert_eq!(time_left(at(0.5, 0.5), 0.0, 0.1), "");
        // 10 seconds for 4 tenths of all, 2 of them in this stage, which is 4: 15 s in all and 5 s of the stage.
        assert_eq!(time_left(at(0.5, 0.4), 0.2, 10.0), ", about 5s left of spectrum, 15s in all");
        assert_eq!(time_left(at(0.0, 0.4), 0.4, 10.0), ", about 15s left");
        // The last stage.
        assert_eq!(time_left(at(0.5, 0.8), 0.6, 12.0), ", about 3s left");
    }
}

//! Progress bars on stderr.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use mser3d::Progress;
use mser3d::shape::Choice;
use mser3d_collection::{Event, Outcome};

use crate::interrupt;
use crate::log;

/// Bars are for terminals, and for users who asked neither for quiet nor for a log.
fn target(quiet: bool) -> ProgressDrawTarget {
    if quiet || log::is_on() { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() }
}

/// Listens to a [`mser3d::Detector`].
pub struct Meter {
    bar: ProgressBar,
}

impl Meter {
    /// Draws on stderr if that is a terminal and the user did not ask for quiet.
    pub fn new(quiet: bool) -> Self {
        let bar = ProgressBar::with_draw_target(Some(1), target(quiet));
        if let Ok(style) = ProgressStyle::with_template("{msg:12} [{bar:30}] {pos}/{len} {elapsed}") {
            bar.set_style(style.progress_chars("=> "));
        }
        Self { bar }
    }

    pub fn report(&self, progress: Progress) -> ControlFlow<()> {
        self.bar.set_length(progress.total as u64);
        self.bar.set_position(progress.done as u64);
        self.bar.set_message(progress.stage.name());
        if interrupt::is_requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Tells the user something, beside the bar.
    pub fn warn(&self, what: &str) {
        self.bar.suspend(|| eprintln!("mser3d: warning: {what}"));
    }

    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Progress of a batch: a bar with the time left, or where there is no terminal a line per shape.
pub struct BatchMeter {
    bar: ProgressBar,
    lines: bool,
    start: Instant,
    computed: AtomicUsize,
}

impl BatchMeter {
    pub fn new(quiet: bool) -> Self {
        let bar = ProgressBar::with_draw_target(None, target(quiet));
        if let Ok(style) = ProgressStyle::with_template("[{bar:30}] {pos}/{len} shapes {elapsed}{msg}") {
            bar.set_style(style.progress_chars("=> "));
        }
        let lines = !quiet && bar.is_hidden();
        Self { bar, lines, start: Instant::now(), computed: AtomicUsize::new(0) }
    }

    pub fn report(&self, event: &Event) {
        // What is kept takes no time, so it says nothing about the time left.
        let kept = *event.outcome == Outcome::Kept;
        let computed = self.computed.fetch_add(usize::from(!kept), Ordering::Relaxed) + usize::from(!kept);
        let left = event.total - event.through;
        let remaining = (computed > 0 && left > 0).then(|| {
            let seconds = self.start.elapsed().as_secs_f64() / computed as f64 * left as f64;
            format!(", about {} left", HumanDuration(Duration::from_secs_f64(seconds)))
        });
        let remaining = remaining.unwrap_or_default();
        let what = match event.outcome {
            Outcome::Kept => "kept".to_owned(),
            Outcome::Done => "done".to_owned(),
            Outcome::Failed(why) => format!("failed: {why}"),
        };
        let name = &event.job.name;
        if self.lines {
            eprintln!("{}/{} {name}: {what}{remaining}", event.through, event.total);
            return;
        }
        if let Outcome::Failed(_) = event.outcome {
            self.bar.println(format!("{name}: {what}"));
        }
        self.bar.set_length(event.total as u64);
        self.bar.set_position(event.through as u64);
        self.bar.set_message(remaining);
    }

    /// Tells the user something, beside the bar.
    pub fn warn(&self, what: &str) {
        self.bar.suspend(|| eprintln!("mser3d: warning: {what}"));
    }

    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

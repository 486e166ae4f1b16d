//! Progress bars on stderr, and a note of the memory each stage took.

use std::ops::ControlFlow;
use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use mser3d::{Progress, Stage};

use crate::machine::peak_memory;

/// Listens to [`mser3d::detect`].
pub struct Meter {
    bar: ProgressBar,
    seen: Mutex<Vec<(Stage, Option<u64>)>>,
}

impl Meter {
    /// Draws on stderr if that is a terminal and the user did not ask for quiet.
    pub fn new(quiet: bool) -> Self {
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(1), target);
        if let Ok(style) = ProgressStyle::with_template("{msg:12} [{bar:30}] {pos}/{len} {elapsed}") {
            bar.set_style(style.progress_chars("=> "));
        }
        Self { bar, seen: Mutex::new(Vec::new()) }
    }

    pub fn report(&self, progress: Progress) -> ControlFlow<()> {
        self.bar.set_length(progress.total as u64);
        self.bar.set_position(progress.done as u64);
        self.bar.set_message(progress.stage.name());
        if let Ok(mut seen) = self.seen.lock() {
            let peak = peak_memory();
            match seen.iter_mut().find(|(stage, _)| *stage == progress.stage) {
                Some(entry) => entry.1 = peak,
                None => {
                    // The first word of a stage ends the one before.
                    if let Some(last) = seen.last_mut() {
                        last.1 = peak;
                    }
                    seen.push((progress.stage, peak));
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// The most memory held up to the end of a stage, in bytes.
    pub fn peak_until(&self, stage: Stage) -> Option<u64> {
        let seen = self.seen.lock().ok()?;
        seen.iter().find(|(s, _)| *s == stage).and_then(|(_, peak)| *peak)
    }

    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

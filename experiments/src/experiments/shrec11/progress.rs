//! How far a long run is.

use std::fmt::Display;
use std::sync::Mutex;
use std::time::Instant;

/// Writes a line for each task that is done, with the time left if the others take as long.
pub struct Progress {
    start: Instant,
    total: usize,
    done: Mutex<usize>,
}

impl Progress {
    pub fn new(total: usize) -> Self {
        Self { start: Instant::now(), total, done: Mutex::new(0) }
    }

    /// A task is done; what went wrong with it is written below.
    pub fn done(&self, task: impl Display, problems: &[String]) {
        // A count is right whatever happened to the thread that held it.
        let mut done = self.done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        *done += 1;
        let elapsed = self.start.elapsed().as_secs_f64();
        let left = elapsed / *done as f64 * (self.total - *done) as f64;
        eprintln!("{:3}/{} {task}, {} left", *done, self.total, clock(left));
        for problem in problems {
            eprintln!("warning: {task}: {problem}");
        }
    }
}

/// Minutes and seconds.
fn clock(seconds: f64) -> String {
    let seconds = seconds.round() as u64;
    format!("{}:{:02}", seconds / 60, seconds % 60)
}

#[cfg(test)]
mod tests {
    #[test]
    fn times_are_minutes_and_seconds() {
        assert_eq!(super::clock(59.6), "1:00");
        assert_eq!(super::clock(725.0), "12:05");
    }
}

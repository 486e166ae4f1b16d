//! Command-line options that bound what a command takes, and where it may go.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use mser3d::{Deadline, available_memory, used_memory};
use mser3d_fileio::ReadLimits;

use crate::error::CliError;
use crate::interrupt;
use crate::numbers::positive;

/// How soon it is looked again how much memory the process holds, and what time it is. A look costs time, and takes some from
/// whoever asks for memory meanwhile.
const SOONEST: Duration = Duration::from_millis(10);
const LATEST: Duration = Duration::from_millis(50);

/// How fast a process can take memory, in bytes a second.
const FASTEST: f64 = 2e10;

/// When to look again, with so many bytes left.
fn pause(left: u64) -> Duration {
    Duration::from_secs_f64(left as f64 / FASTEST).clamp(SOONEST, LATEST)
}

/// What a command may take. What is known before is refused before.
#[derive(clap::Args, Clone, Debug)]
#[command(next_help_heading = "Limits")]
pub struct LimitOptions {
    /// Refuse what takes more memory, in MB: a file, a grid, a spectrum [default: 80 % of what is free, within the limits of
    /// the system and of control groups]
    #[arg(long, value_name = "MB")]
    memory_limit: Option<u64>,
    /// Refuse boxes of more voxels than this, of a mesh's grid and of a file; a grid takes half a byte for each
    #[arg(long, value_name = "N", default_value_t = ReadLimits::default().max_box_voxels)]
    pub max_box_voxels: u64,
    /// End with an error when the work takes longer; of many shapes, each [default: no limit]
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    time_limit: Option<f64>,
    /// Read files outside of its folder too that a file names: buffers of glTF, data of NRRD and MetaImage
    #[arg(long)]
    allow_outside: bool,
}

impl LimitOptions {
    /// Bytes that the process may hold; `None` where the system does not tell.
    pub fn memory(&self) -> Option<u64> {
        let given = self.memory_limit.map(|mb| mb.saturating_mul(1_000_000));
        given.or_else(|| {
            // What is held already is no longer free.
            let all = available_memory()?.saturating_add(used_memory().unwrap_or(0));
            Some(all / 5 * 4)
        })
    }

    /// What reading may take.
    pub fn reading(&self) -> ReadLimits {
        ReadLimits {
            max_box_voxels: self.max_box_voxels,
            memory: self.memory().unwrap_or(u64::MAX),
            held: used_memory().unwrap_or(0),
            allow_outside: self.allow_outside,
        }
    }

    /// Refuses work that takes so many bytes beside those that are held already.
    ///
    /// # Errors
    /// [`CliError::MemoryLimit`]; `what` is the work.
    pub fn check_memory(
        &self,
        path: &Path,
        bytes: f64,
        what: impl FnOnce() -> String,
    ) -> Result<(), CliError> {
        let needed = bytes + used_memory().unwrap_or(0) as f64;
        match self.memory() {
            Some(limit) if needed > limit as f64 => Err(CliError::MemoryLimit {
                path: path.to_owned(),
                what: what(),
                needed_mb: (needed / 1e6).ceil() as u64,
                limit_mb: limit / 1_000_000,
            }),
            _ => Ok(()),
        }
    }

    /// How long the work may take.
    pub fn time(&self) -> Option<Duration> {
        // Longer than a Duration can be is no limit.
        self.time_limit.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
    }

    /// The deadline of work that begins now.
    pub fn deadline(&self) -> Deadline {
        Deadline::new(self.time())
    }
}

/// As long as it is there, the program ends with an error when it goes beyond its limits.
pub struct Watch(Arc<AtomicBool>);

impl Drop for Watch {
    fn drop(&mut self) {
        self.0.store(true, Ordering::SeqCst);
    }
}

impl LimitOptions {
    /// Ends the program when work on a file goes beyond its limits: what could not be known before, and stages that do not
    /// look at the time.
    pub fn watch(&self, path: &Path) -> Watch {
        self.start_watch(path, self.memory())
    }

    /// The same of time alone, where shapes wait for each other's memory.
    pub fn watch_time(&self, path: &Path) -> Watch {
        self.start_watch(path, None)
    }

    fn start_watch(&self, path: &Path, memory: Option<u64>) -> Watch {
        let ended = Arc::new(AtomicBool::new(false));
        let watch = Watch(Arc::clone(&ended));
        let (deadline, path) = (self.deadline(), path.display().to_string());
        let look = move || {
            let mut left = 0;
            while !ended.load(Ordering::SeqCst) {
                std::thread::sleep(pause(left));
                let held = memory.and_then(|_| used_memory());
                left = memory.unwrap_or(u64::MAX).saturating_sub(held.unwrap_or(0));
                if let (Some(limit), Some(held)) = (memory, held)
                    && held > limit
                    && !ended.load(Ordering::SeqCst)
                {
                    let (held, limit) = (held.div_ceil(1_000_000), limit / 1_000_000);
                    let advice =
                        "use fewer voxels (--voxels) or eigenpairs (--eigenpairs), or raise --memory-limit";
                    let what = format!(
                        "{path}: the work takes {held} MB of memory already, more than the limit of {limit} MB; {advice}"
                    );
                    interrupt::leave(&what, 1);
                }
                if let Err(passed) = deadline.check() {
                    // Most stages look themselves.
                    std::thread::sleep(interrupt::PATIENCE);
                    if !ended.load(Ordering::SeqCst) {
                        interrupt::leave(&format!("{path}: {passed}"), 1);
                    }
                    return;
                }
            }
        };
        if self.time().is_some() || memory.is_some() {
            std::thread::spawn(look);
        }
        watch
    }
}

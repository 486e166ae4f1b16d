//! Stopping long work half-way.

use crate::error::VoxelizeError;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// Asked now and then, from any working thread, many times a second; break to stop.
pub type CheckFn<'a> = &'a (dyn Fn() -> ControlFlow<()> + Sync);

/// Never stops.
pub(crate) const NEVER: CheckFn<'static> = &|| ControlFlow::Continue(());

/// A check that, once it has said stop, says so for good. Loops then run out without work, and what they made is
/// thrown away by [`Stop::check`] at the end of the stage.
pub(crate) struct Stop<'a> {
    ask: CheckFn<'a>,
    stopped: AtomicBool,
}

impl<'a> Stop<'a> {
    pub fn new(ask: CheckFn<'a>) -> Self {
        Self { ask, stopped: AtomicBool::new(false) }
    }

    /// Whether to do no more work.
    pub fn now(&self) -> bool {
        if self.stopped.load(Ordering::Relaxed) {
            return true;
        }
        let stop = (self.ask)().is_break();
        if stop {
            self.stopped.store(true, Ordering::Relaxed);
        }
        stop
    }

    pub fn check(&self) -> Result<(), VoxelizeError> {
        if self.now() { Err(VoxelizeError::Cancelled) } else { Ok(()) }
    }
}

//! What reading a mesh has taken of the memory that it may take.

use crate::error::Fault;
use mser3d_fileio::ReadLimits;
use std::cell::Cell;

/// Counts bytes before they are taken.
#[derive(Debug)]
pub(crate) struct Budget<'a> {
    pub limits: &'a ReadLimits,
    taken: Cell<u64>,
}

impl<'a> Budget<'a> {
    pub(crate) fn new(limits: &'a ReadLimits) -> Self {
        Self { limits, taken: Cell::new(0) }
    }

    /// Takes bytes for good; `what` they are for is a whole statement.
    pub(crate) fn take(&self, bytes: u64, what: impl FnOnce() -> String) -> Result<(), Fault> {
        let all = self.taken.get().saturating_add(bytes);
        self.limits.check_memory(all, what)?;
        self.taken.set(all);
        Ok(())
    }

    /// How many bytes are left.
    pub(crate) fn left(&self) -> u64 {
        self.limits.left().saturating_sub(self.taken.get())
    }
}

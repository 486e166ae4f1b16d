//! What the caller hears while bodies are solved.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::{SpectralError, Spectrum};

/// Progress that never goes back, over bodies that are solved one after the other, and iterations that are repeated.
pub(crate) struct Heard<'a> {
    progress: &'a (dyn Fn(usize) -> ControlFlow<()> + Sync),
    wanted: usize,
    /// Pairs of the bodies before.
    before: AtomicUsize,
    most: AtomicUsize,
}

impl<'a> Heard<'a> {
    pub fn new(wanted: usize, progress: &'a (dyn Fn(usize) -> ControlFlow<()> + Sync)) -> Self {
        Self { progress, wanted, before: AtomicUsize::new(0), most: AtomicUsize::new(0) }
    }

    /// Solves for `count` pairs of the next body.
    pub fn next(
        &self,
        count: usize,
        solve: impl FnOnce(&(dyn Fn(usize) -> ControlFlow<()> + Sync)) -> Result<Spectrum, SpectralError>,
    ) -> Result<Spectrum, SpectralError> {
        let before = self.before.load(Ordering::Relaxed);
        let spectrum = solve(&|converged| {
            let all = (before + converged).min(self.wanted);
            (self.progress)(self.most.fetch_max(all, Ordering::Relaxed).max(all))
        })?;
        self.before.fetch_add(count, Ordering::Relaxed);
        Ok(spectrum)
    }

    /// All are there.
    pub fn end(&self, spectrum: Result<Spectrum, SpectralError>) -> Result<Spectrum, SpectralError> {
        if spectrum.is_ok() && (self.progress)(self.wanted).is_break() {
            return Err(SpectralError::Cancelled);
        }
        spectrum
    }
}

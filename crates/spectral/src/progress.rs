//! What the caller is told while components are solved.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::{SpectralError, Spectrum};

/// Progress that never goes back, over components that are solved one after the other, and repeated
/// iterations.
pub(crate) struct Heard<'a> {
    progress: &'a (dyn Fn(usize) -> ControlFlow<()> + Sync),
    wanted: usize,
    /// Eigenpairs of the components solved before.
    before: AtomicUsize,
    /// The largest number told so far.
    most: AtomicUsize,
}

impl<'a> Heard<'a> {
    pub fn new(wanted: usize, progress: &'a (dyn Fn(usize) -> ControlFlow<()> + Sync)) -> Self {
        Self { progress, wanted, before: AtomicUsize::new(0), most: AtomicUsize::new(0) }
    }

    /// Solves for `count` eigenpairs of the next component.
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

    /// Tells that all are found, if they are.
    pub fn end(&self, spectrum: Result<Spectrum, SpectralError>) -> Result<Spectrum, SpectralError> {
        if spectrum.is_ok() && (self.progress)(self.wanted).is_break() {
            return Err(SpectralError::Cancelled);
        }
        spectrum
    }
}

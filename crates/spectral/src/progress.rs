//! What the caller is told while components are solved.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::{SpectralError, Spectrum};

/// The most that is told before all is done.
const ALMOST: f64 = 0.999;
/// Up to this share the work goes on as foreseen; from here on more may be needed than was.
const FORESEEN: f64 = 0.9;

/// The share of the work that is done. Past nine tenths of what is expected it rises ever more slowly, without a jump, and
/// never reaches 1.
pub(crate) fn foreseen(done: f64, expected: f64) -> f64 {
    let share = done / expected.max(f64::MIN_POSITIVE);
    if share <= FORESEEN {
        share
    } else {
        1.0 - (1.0 - FORESEEN) * (-(share - FORESEEN) / (1.0 - FORESEEN)).exp()
    }
}

/// Progress that never goes back, over components that are solved one after the other, and repeated
/// iterations.
pub(crate) struct Heard<'a> {
    progress: &'a (dyn Fn(f64) -> ControlFlow<()> + Sync),
    /// Share of the components solved before, as bits: of positive numbers they have the same order.
    before: AtomicU64,
    /// The largest share told so far, as bits.
    most: AtomicU64,
}

impl<'a> Heard<'a> {
    pub fn new(progress: &'a (dyn Fn(f64) -> ControlFlow<()> + Sync)) -> Self {
        Self { progress, before: AtomicU64::new(0), most: AtomicU64::new(0) }
    }

    /// Solves the next component, which is this share of all work; on one of rayon's threads. From outside, each of thousands of
    /// short loops would be handed over to them and waited for, which costs two wake-ups: a sixth of the time at 45,000 voxels.
    pub fn next(
        &self,
        part: f64,
        solve: impl FnOnce(&(dyn Fn(f64) -> ControlFlow<()> + Sync)) -> Result<Spectrum, SpectralError> + Send,
    ) -> Result<Spectrum, SpectralError> {
        let before = f64::from_bits(self.before.load(Ordering::Relaxed));
        let tell = |share: f64| {
            let all = (before + part * share).clamp(0.0, ALMOST).to_bits();
            (self.progress)(f64::from_bits(self.most.fetch_max(all, Ordering::Relaxed).max(all)))
        };
        let spectrum = rayon::scope(|_| solve(&tell))?;
        self.before.store((before + part).to_bits(), Ordering::Relaxed);
        Ok(spectrum)
    }

    /// Tells that all are found, if they are.
    pub fn end(&self, spectrum: Result<Spectrum, SpectralError>) -> Result<Spectrum, SpectralError> {
        if spectrum.is_ok() && (self.progress)(1.0).is_break() {
            return Err(SpectralError::Cancelled);
        }
        spectrum
    }
}

#[cfg(test)]
mod tests {
    use super::foreseen;

    #[test]
    fn what_takes_longer_than_foreseen_slows_down_and_never_ends() {
        assert_eq!(foreseen(3.0, 4.0), 0.75);
        let shares: Vec<f64> = (0..40).map(|i| foreseen(f64::from(i), 20.0)).collect();
        assert!(shares.windows(2).all(|w| w[0] < w[1] && w[1] - w[0] < 0.0501));
        assert!(shares[20] > 0.95 && shares[39] < 1.0);
    }
}

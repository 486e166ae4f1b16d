//! All eigenpairs below a bound, whose number is only known about.

use crate::{SpectralError, Spectrum};

/// All eigenpairs below `bound`, at least one, by asking `solve` for more until one lies beyond it. `guess`
/// is about how many there are, of `available`.
pub(crate) fn all_below(
    bound: f64,
    guess: usize,
    available: usize,
    solve: impl Fn(usize) -> Result<Spectrum, SpectralError>,
) -> Result<Spectrum, SpectralError> {
    let mut asked = guess.clamp(1, available);
    loop {
        let spectrum = solve(asked)?;
        let inside = spectrum.basis.eigenvalues().partition_point(|&value| value < bound);
        if inside < asked || asked == available {
            return Ok(first(spectrum, inside.max(1)));
        }
        asked = (asked + asked / 2 + 8).min(available);
    }
}

/// The first `count` eigenpairs.
fn first(mut spectrum: Spectrum, count: usize) -> Spectrum {
    spectrum.basis.truncate(count);
    spectrum.report.zero_modes = spectrum.report.zero_modes.min(count);
    spectrum
}

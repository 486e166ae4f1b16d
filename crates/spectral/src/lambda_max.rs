//! All eigenpairs below a bound, whose number is only known about.

use mser3d_shape::Eigenbasis;

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
            return first(spectrum, inside.max(1));
        }
        asked = (asked + asked / 2 + 8).min(available);
    }
}

/// The first `count` eigenpairs.
fn first(spectrum: Spectrum, count: usize) -> Result<Spectrum, SpectralError> {
    let basis = &spectrum.basis;
    let all = basis.eigenvalues().len();
    if count == all {
        return Ok(spectrum);
    }
    let rows = basis.functions().chunks_exact(all);
    let functions = rows.flat_map(|row| row[..count].iter().copied()).collect();
    let values = basis.eigenvalues()[..count].to_vec();
    let mut report = spectrum.report;
    report.zero_modes = report.zero_modes.min(count);
    let basis = Eigenbasis::new(basis.domain(), basis.mass().to_vec(), values, functions)
        .map_err(|_| SpectralError::Overflow)?;
    Ok(Spectrum { basis, report })
}

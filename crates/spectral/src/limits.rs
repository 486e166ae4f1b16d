//! What is refused before any work: too much memory, and sizes that overflow.

use crate::SpectralError;

/// Whether so many numbers fit within the limit.
pub(crate) fn check_memory(
    limit: Option<u64>,
    work: String,
    rows: usize,
    numbers: usize,
) -> Result<(), SpectralError> {
    let needed = numbers as u64 * 8;
    match limit {
        Some(limit) if needed > limit => Err(SpectralError::TooMuchMemory { work, rows, needed, limit }),
        _ => Ok(()),
    }
}

/// Whether a measure and the operator's bound are numbers that can be computed with.
pub(crate) fn check_size(measure: f64, bound: f64) -> Result<(), SpectralError> {
    // A bound of zero is an operator of one row.
    if measure.is_normal() && bound.is_finite() { Ok(()) } else { Err(SpectralError::Overflow) }
}

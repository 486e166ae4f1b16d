//! Levels counted into equal parts.

/// A map from levels to equal parts of a span, which never falls.
#[derive(Clone, Copy)]
pub(super) struct Scale {
    low: f64,
    /// Parts for a unit of level.
    factor: f64,
}

impl Scale {
    /// A span too short or too long to divide is one part.
    pub fn new(low: f64, high: f64, parts: u32) -> Self {
        let factor = f64::from(parts) / (high - low);
        Self { low, factor: if factor.is_finite() { factor } else { 0.0 } }
    }

    /// Parts of length 1.
    pub fn unit(low: f64) -> Self {
        Self { low, factor: 1.0 }
    }

    pub fn is_unit(&self) -> bool {
        self.factor == 1.0
    }

    #[inline(always)]
    pub fn part(&self, level: f64, parts: u32) -> u32 {
        (((level - self.low) * self.factor) as u32).min(parts - 1)
    }
}

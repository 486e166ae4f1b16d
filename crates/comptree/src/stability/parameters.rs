use crate::TreeError;

/// How the stability of a component is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mode {
    /// Change of volume over a window of altitude, within branches that end at real merges.
    ///
    /// A tree's chains are cut wherever a child of at least the minimum volume joins; between two cuts
    /// a region only grows at its border. On such a branch, from its first node to the altitude of the
    /// merge that ends it, the instability of a node of altitude l is
    ///
    /// `(vol(min(l + window, end)) - vol(max(l - window, start))) / vol(l) / clipped width`,
    ///
    /// and a node is maximally stable if none within the window, and no neighbour on the branch, is more
    /// stable. The ends of the branch count; neighbours that tie are one maximum, and the largest stands
    /// for it.
    ///
    /// The last node of a branch that a real merge ends is always a candidate: it is where a limb meets
    /// the body, and how much it grew just before depends on how blunt the limb is, not on whether it is
    /// one. Without it, limbs of some poses are lost to a maximum next to it.
    Windowed {
        /// Half the width of the window, in units of the altitude on its scale (for
        /// [`AltitudeScale::Log`] a factor of e^window). Default 0.2; 0.05 finds more and finer regions.
        window: f64,
    },
    /// As published (eq. 5): the change of volume from a node to its parent, and maxima among
    /// neighbouring nodes. Kept to check the paper; a quarter of all nodes are such maxima on real shapes.
    Paper,
    /// No stability at all: keep a node whose parent is larger by the minimum diversity or more. What
    /// any measure of stability has to beat.
    Baseline,
}

/// On which scale altitude is measured. The components do not depend on it, their stability does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum AltitudeScale {
    /// ln(weight): stability does not depend on the unit of the weight, hence not on a shape's size.
    /// Weights below 1e-300, negative ones included, count as 1e-300.
    #[default]
    Log,
    /// The weight itself, as for grey values.
    Linear,
}

/// What makes a component a stable region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilityParameters {
    /// How stability is measured. Default: windowed, 0.2.
    pub mode: Mode,
    /// On which scale altitude is measured. Default: logarithmic.
    pub scale: AltitudeScale,
    /// Smallest volume of a region as a fraction of the total, 0 to 1. Default 0.01.
    pub min_volume_fraction: f64,
    /// Largest volume of a region as a fraction of the total, 0 or more. Default 0.75.
    pub max_volume_fraction: f64,
    /// A region goes if its nearest surviving ancestor is less than 1/(1 - this) times as large;
    /// 0 to 1. Default 0.2.
    pub min_diversity: f64,
    /// Least stability, in units of the altitude on its scale. Default: none.
    pub min_stability: Option<f64>,
    /// What the fractions refer to, in units of volume. Default: the tree's own total.
    pub total_volume: Option<f64>,
}

impl Default for StabilityParameters {
    fn default() -> Self {
        Self {
            mode: Mode::Windowed { window: 0.2 },
            scale: AltitudeScale::Log,
            min_volume_fraction: 0.01,
            max_volume_fraction: 0.75,
            min_diversity: 0.2,
            min_stability: None,
            total_volume: None,
        }
    }
}

impl StabilityParameters {
    /// Checks every range.
    ///
    /// # Errors
    /// [`TreeError::BadParameter`] for the first value out of its range.
    pub fn validate(&self) -> Result<(), TreeError> {
        let window = match self.mode {
            Mode::Windowed { window } => window,
            Mode::Paper | Mode::Baseline => 1.0,
        };
        let fraction = |x: f64| (0.0..=1.0).contains(&x);
        let checks = [
            (window.is_finite() && window > 0.0, "window", window, "positive and finite"),
            (
                fraction(self.min_volume_fraction),
                "min_volume_fraction",
                self.min_volume_fraction,
                "between 0 and 1",
            ),
            (self.max_volume_fraction >= 0.0, "max_volume_fraction", self.max_volume_fraction, "0 or more"),
            (fraction(self.min_diversity), "min_diversity", self.min_diversity, "between 0 and 1"),
            (!self.min_stability.is_some_and(f64::is_nan), "min_stability", f64::NAN, "a number"),
            (
                self.total_volume.is_none_or(|v| v.is_finite() && v > 0.0),
                "total_volume",
                self.total_volume.unwrap_or(0.0),
                "positive and finite",
            ),
        ];
        match checks.into_iter().find(|check| !check.0) {
            Some((_, name, value, requirement)) => Err(TreeError::BadParameter { name, value, requirement }),
            None => Ok(()),
        }
    }
}

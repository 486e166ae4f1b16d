//! What makes a component a stable region: the rules of eq. 5 and section 4.2, as named parameters.
use mser3d_shape::InvalidParameter;

use crate::TreeError;

mser3d_shape::choice! {
    /// How the stability of a component is measured, and which components are candidates.
    pub enum StabilityRule("stability rule") {
        /// Change of volume over a window of altitude, within branches that end at real merges
        ///
        /// A chain of nodes is cut wherever a child of at least the minimum volume joins it; between two cuts
        /// a region only grows at its border. On such a branch, from its first node to the altitude of the
        /// merge that ends it, the stability of a node of altitude l is
        ///
        /// `s(l) = vol(l) (above - below) / (vol(above) - vol(below))`,
        ///
        /// with `above = min(l + window, end of the branch)`, `below = max(l - window, its start)`, and
        /// vol(x) the volume of the component at level x. A node is maximally stable if none within the
        /// window, and no neighbour on the branch, is more stable. The ends of the branch count. Neighbours
        /// that tie are one maximum, represented by the largest.
        ///
        /// The last node of a branch that a real merge ends is a candidate too: it is where a limb meets
        /// the body, and how much it grew just before depends on how blunt the limb is, not on whether it is
        /// one. Without it, limbs of some poses are lost to a maximum next to it.
        ///
        /// A branch that lasts less than the minimum lifetime is no part. What it began and ended with are one merge;
        /// or, if it began with none, it is a bump on the part that it joins. On the logarithmic scale a candidate must
        /// also have a border ([`sharp_borders`](StabilityParameters::sharp_borders)), sharper than a shape without parts has anywhere: a stability above 0.2 (the corner of a
        /// solid) before a merge with other parts, and above 0.65 (the end of a rod) elsewhere. So nothing is found on a
        /// ball, a brick, a torus or a cylinder.
        #[default]
        Windowed = "windowed",
        /// The published rule (eq. 5): change of volume from a node to its parent
        ///
        /// `s = vol (l' - l) / (vol' - vol)` with the parent's l' and vol'; candidates are the maxima among
        /// neighbouring nodes. Kept to check the paper: a quarter of all nodes are such maxima on real
        /// shapes.
        Paper = "paper",
        /// No stability: every node whose parent is clearly larger
        ///
        /// Larger by the minimum diversity or more. What any measure of stability has to beat.
        Baseline = "baseline",
    }
}

mser3d_shape::choice! {
    /// On which scale altitude is measured. The components do not depend on it, their stability does.
    pub enum AltitudeScale("altitude scale") {
        /// ln(weight): stability does not depend on the unit of the weight
        ///
        /// Hence not on a shape's size either. Weights below 1e-300, negative ones included, count as 1e-300.
        #[default]
        Log = "log",
        /// The weight itself, as for grey values
        Linear = "linear",
    }
}

/// What makes a component a stable region.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StabilityParameters {
    /// How stability is measured. Default: windowed.
    pub rule: StabilityRule,
    /// Half the width of the window of [`StabilityRule::Windowed`], in units of the altitude on its scale
    /// (for [`AltitudeScale::Log`] a factor of e^window). The other rules have no window. Default 0.25;
    /// 0.1 finds more and finer regions.
    pub window: f64,
    /// Least lifetime of a part, in units of the altitude on its scale; only in [`StabilityRule::Windowed`]. Default:
    /// none given, which is 0.1 for [`AltitudeScale::Log`] and 0 for [`AltitudeScale::Linear`], whose unit is that of the
    /// weight.
    pub min_lifetime: Option<f64>,
    /// Whether a region must have a border that is sharper than a shape without parts has anywhere; only in
    /// [`StabilityRule::Windowed`] on the logarithmic scale. Default: yes.
    pub sharp_borders: bool,
    /// On which scale altitude is measured. Default: logarithmic.
    pub altitude: AltitudeScale,
    /// Smallest volume of a region as a fraction of the total, 0 to 1. Default 0.01.
    pub min_volume_fraction: f64,
    /// Largest volume of a region as a fraction of the total, not below the smallest. Default 0.75.
    pub max_volume_fraction: f64,
    /// A region is dropped if the nearest kept region around it is less than 1/(1 - this) times as large;
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
            rule: StabilityRule::Windowed,
            window: 0.25,
            min_lifetime: None,
            sharp_borders: true,
            altitude: AltitudeScale::Log,
            min_volume_fraction: 0.01,
            max_volume_fraction: 0.75,
            min_diversity: 0.2,
            min_stability: None,
            total_volume: None,
        }
    }
}

impl StabilityParameters {
    /// The least lifetime of a part: as given, or the default of the scale.
    pub fn min_lifetime(&self) -> f64 {
        self.min_lifetime.unwrap_or(match self.altitude {
            AltitudeScale::Log => 0.1,
            AltitudeScale::Linear => 0.0,
        })
    }

    /// Checks every range.
    ///
    /// # Errors
    /// [`TreeError::InvalidParameter`] for the first value out of its range.
    pub fn validate(&self) -> Result<(), TreeError> {
        let fraction = |x: f64| (0.0..=1.0).contains(&x);
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let (smallest, largest) = (self.min_volume_fraction, self.max_volume_fraction);
        let unless = InvalidParameter::unless;
        if self.rule == StabilityRule::Windowed {
            unless(positive(self.window), "window", self.window, "positive and finite")?;
        }
        let lifetime = self.min_lifetime();
        unless(lifetime >= 0.0, "min_lifetime", lifetime, "0 or more")?;
        unless(fraction(smallest), "min_volume_fraction", smallest, "between 0 and 1")?;
        unless(largest >= 0.0, "max_volume_fraction", largest, "0 or more")?;
        let expected = format!("at most max_volume_fraction ({largest}), or no region has such a size");
        unless(smallest <= largest, "min_volume_fraction", smallest, &expected)?;
        unless(fraction(self.min_diversity), "min_diversity", self.min_diversity, "between 0 and 1")?;
        let is_nan = self.min_stability.is_some_and(f64::is_nan);
        unless(!is_nan, "min_stability", f64::NAN, "a number")?;
        let total = self.total_volume;
        unless(total.is_none_or(positive), "total_volume", total.unwrap_or(0.0), "positive and finite")?;
        Ok(())
    }
}

//! The altitude of a node on the scale that stability is measured on.

use super::parameters::AltitudeScale;
use crate::ComponentTree;

/// Altitudes on the scale that stability is measured on, rising towards the root, all finite.
pub(super) struct Levels<'a> {
    pub tree: &'a ComponentTree,
    pub scale: AltitudeScale,
}

impl Levels<'_> {
    #[inline]
    pub fn of(&self, node: u32) -> f64 {
        let altitude = self.tree.altitude(node);
        let level = match self.scale {
            AltitudeScale::Log => altitude.clamp(1e-300, 1e300).ln(),
            AltitudeScale::Linear => altitude.clamp(-1e300, 1e300),
        };
        self.tree.polarity().orient(level)
    }
}

//! A surface on the lattice of voxel centres: the rules for its crossings with grid lines.

use crate::axis_sweep::{AxisSweep, Crossing};
use crate::cancel::Stop;
use crate::centre_lattice::{CentreLattice, PlacedVertex};
use crate::hole_corrections::HoleCorrections;
use crate::inside_rule::InsideRule;
use crate::surface::Surface;

/// A surface on a lattice, ready to be swept.
pub(crate) struct PlacedSurface<'a> {
    pub lattice: &'a CentreLattice,
    pub surface: &'a Surface<'a>,
    pub rule: InsideRule,
    pub holes: Option<HoleCorrections>,
    placed: Vec<PlacedVertex>,
    pub cut_links: bool,
    pub stop: &'a Stop<'a>,
}

impl<'a> PlacedSurface<'a> {
    pub fn new(
        surface: &'a Surface<'a>,
        lattice: &'a CentreLattice,
        rule: InsideRule,
        cut_links: bool,
        stop: &'a Stop<'a>,
    ) -> Self {
        let holes = HoleCorrections::new(surface, lattice, stop);
        let placed = lattice.place(&surface.vertices);
        Self { lattice, surface, rule, holes, placed, cut_links, stop }
    }

    /// All crossings with the grid lines along an axis.
    pub fn sweep(&self, axis: usize) -> AxisSweep<'_> {
        let (vertices, triangles) = (&self.surface.vertices, &self.surface.triangles);
        AxisSweep::new(self.lattice, vertices, &self.placed, triangles, axis, self.stop)
    }

    /// Whether a crossing changes the integer winding number.
    #[inline]
    pub fn counts(&self, crossing: Crossing) -> bool {
        !self.surface.shells[self.surface.shell_of(crossing.triangle())].scattered
    }

    /// Whether a crossing separates neighbours: it is with the surface, not with the cap of a larger hole.
    #[inline]
    pub fn parts(&self, crossing: Crossing) -> bool {
        crossing.triangle() < self.surface.patched
    }

    /// Whether any two crossings separate neighbours: with one shell, or with shells that are not told apart.
    pub fn any_two_part(&self) -> bool {
        matches!(self.rule, InsideRule::Parity | InsideRule::Total { join: false })
    }
}

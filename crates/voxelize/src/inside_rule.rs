//! From crossings to inside: how often a point is covered, by whom, and what that means.

use crate::axis_sweep::Crossing;
use crate::hole_corrections::{HoleCorrections, UNCLEAR};
use crate::surface::Surface;

/// What makes a point belong to the solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum InsideRule {
    /// An odd number of crossings on the way in.
    Parity,
    /// The winding number of all shells together is 1 or, when overlaps are joined, more.
    Total { join: bool },
    /// Some shell covers the point once, and no cavity takes that away. A shell that covers it twice
    /// overlaps itself there and does not count.
    Shells,
}

/// The winding numbers at a point that moves along a grid line.
#[derive(Clone)]
pub(crate) struct RunningWinding<'a> {
    surface: &'a Surface<'a>,
    rule: InsideRule,
    /// Sum over all shells.
    total: i32,
    /// Shells with winding numbers other than 0; used by [`InsideRule::Shells`].
    shells: Vec<(u32, i32)>,
}

impl<'a> RunningWinding<'a> {
    pub fn new(surface: &'a Surface<'a>, rule: InsideRule) -> Self {
        Self { surface, rule, total: 0, shells: Vec::new() }
    }

    /// Back to the start of a line, outside everything.
    pub fn reset(&mut self) {
        self.total = 0;
        self.shells.clear();
    }

    /// Passes through a triangle.
    #[inline]
    pub fn cross(&mut self, crossing: Crossing) {
        match self.rule {
            InsideRule::Parity => self.total ^= 1,
            InsideRule::Total { .. } => self.total += crossing.step(),
            InsideRule::Shells => {
                self.total += crossing.step();
                self.add(self.surface.shell_of(crossing.triangle()) as u32, crossing.step());
            }
        }
    }

    fn add(&mut self, shell: u32, step: i32) {
        match self.shells.iter().position(|b| b.0 == shell) {
            Some(at) if self.shells[at].1 + step == 0 => {
                self.shells.swap_remove(at);
            }
            Some(at) => self.shells[at].1 += step,
            None => self.shells.push((shell, step)),
        }
    }

    /// Whether the point belongs to the solid.
    #[inline]
    pub fn inside(&self) -> bool {
        match self.rule {
            InsideRule::Parity => self.total == 1,
            InsideRule::Total { join: false } => self.total == 1,
            InsideRule::Total { join: true } => self.total >= 1,
            InsideRule::Shells => self.shells.iter().map(|&(b, w)| self.cover(b, w)).sum::<i32>() >= 1,
        }
    }

    fn cover(&self, shell: u32, winding: i32) -> i32 {
        if self.surface.shells[shell as usize].volume < 0.0 {
            -i32::from(winding < 0)
        } else {
            i32::from(winding == 1)
        }
    }

    /// Whether the point is covered more than once.
    #[inline]
    pub fn doubled(&self) -> bool {
        self.rule != InsideRule::Parity && self.total >= 2
    }

    /// The state at a voxel of the marked block at `place`, where holes matter: each open shell's integer, less what its caps add.
    /// Also whether some winding number is too close to call.
    pub fn corrected(&self, holes: &HoleCorrections, place: usize, voxel: [usize; 3]) -> (Self, bool) {
        let mut state = self.clone();
        let mut unclear = false;
        let mut round = |winding: f64| {
            unclear |= [0.5, 1.5].iter().any(|level| (winding - level).abs() < UNCLEAR);
            (winding - 0.5).ceil() as i32
        };
        if state.rule == InsideRule::Shells {
            for (shell, correction) in holes.corrections(place, voxel) {
                let integer = state.shells.iter().find(|b| b.0 == shell).map_or(0, |b| b.1);
                let step = round(f64::from(integer) + correction) - integer;
                if step != 0 {
                    state.add(shell, step);
                    state.total += step;
                }
            }
        } else {
            let correction: f64 = holes.corrections(place, voxel).map(|c| c.1).sum();
            state.total = round(f64::from(self.total) + correction);
        }
        (state, unclear)
    }
}

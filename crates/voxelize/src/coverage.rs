//! From crossings to inside: how often a point is covered, by whom, and what that means.

use crate::holes::HoleField;
use crate::surface::Surface;
use crate::sweep::Crossing;

/// What makes a point belong to the solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rule {
    /// An odd number of crossings on the way in.
    Parity,
    /// The winding number of all bodies together is 1 or, when overlaps are joined, more.
    Total { join: bool },
    /// Some body covers the point once, and no cavity takes that away. A body that covers it twice
    /// overlaps itself there and does not count.
    Bodies,
}

/// The winding numbers at a point that moves along a grid line.
#[derive(Clone)]
pub(crate) struct State<'a> {
    surface: &'a Surface<'a>,
    rule: Rule,
    /// Sum over all bodies.
    total: i32,
    /// Bodies with winding numbers other than 0; used by [`Rule::Bodies`].
    bodies: Vec<(u32, i32)>,
}

impl<'a> State<'a> {
    pub fn new(surface: &'a Surface<'a>, rule: Rule) -> Self {
        Self { surface, rule, total: 0, bodies: Vec::new() }
    }

    /// Back to the start of a line, outside everything.
    pub fn reset(&mut self) {
        self.total = 0;
        self.bodies.clear();
    }

    /// Passes through a triangle.
    #[inline]
    pub fn cross(&mut self, crossing: Crossing) {
        match self.rule {
            Rule::Parity => self.total ^= 1,
            Rule::Total { .. } => self.total += crossing.step(),
            Rule::Bodies => {
                self.total += crossing.step();
                self.add(self.surface.body_of(crossing.triangle()) as u32, crossing.step());
            }
        }
    }

    fn add(&mut self, body: u32, step: i32) {
        match self.bodies.iter().position(|b| b.0 == body) {
            Some(at) if self.bodies[at].1 + step == 0 => {
                self.bodies.swap_remove(at);
            }
            Some(at) => self.bodies[at].1 += step,
            None => self.bodies.push((body, step)),
        }
    }

    /// Whether the point belongs to the solid.
    #[inline]
    pub fn inside(&self) -> bool {
        match self.rule {
            Rule::Parity => self.total == 1,
            Rule::Total { join: false } => self.total == 1,
            Rule::Total { join: true } => self.total >= 1,
            Rule::Bodies => self.bodies.iter().map(|&(b, w)| self.cover(b, w)).sum::<i32>() >= 1,
        }
    }

    fn cover(&self, body: u32, winding: i32) -> i32 {
        if self.surface.bodies[body as usize].volume < 0.0 {
            -i32::from(winding < 0)
        } else {
            i32::from(winding == 1)
        }
    }

    /// Whether the point is covered more than once.
    #[inline]
    pub fn doubled(&self) -> bool {
        self.rule != Rule::Parity && self.total >= 2
    }

    /// The state at a marked voxel, where holes matter: each open body's integer, less what its caps add.
    /// Also whether some winding number is too close to call.
    pub fn corrected(&self, field: &HoleField, voxel: [usize; 3]) -> (Self, bool) {
        let mut state = self.clone();
        let mut unclear = false;
        let mut round = |winding: f64| {
            unclear |= [0.5, 1.5].iter().any(|level| (winding - level).abs() < UNCLEAR);
            (winding - 0.5).ceil() as i32
        };
        if state.rule == Rule::Bodies {
            for (body, correction) in field.corrections(voxel) {
                let integer = state.bodies.iter().find(|b| b.0 == body).map_or(0, |b| b.1);
                let step = round(f64::from(integer) + correction) - integer;
                if step != 0 {
                    state.add(body, step);
                    state.total += step;
                }
            }
        } else {
            let correction: f64 = field.corrections(voxel).map(|c| c.1).sum();
            state.total = round(f64::from(self.total) + correction);
        }
        (state, unclear)
    }
}

/// A winding number this close to 1/2 or 3/2 is ambiguous.
pub(crate) const UNCLEAR: f64 = 0.2;

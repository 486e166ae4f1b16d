use crate::order::NONE;

/// The chain of arcs from the largest tree's root down to a minimum, each time to the child with more
/// basins.
///
/// In noise nearly every vertex ends on it, high up: it is entered by a table instead of by climbing.
pub(super) struct Trunk {
    /// Its arcs, from the minimum up.
    arcs: Vec<u32>,
    births: Vec<f64>,
    /// For equal steps of level the first arc that may span a level there.
    table: Vec<u32>,
    low: f64,
    scale: f64,
}

impl Trunk {
    /// The trunk, and for each arc the level from which on it is part of the trunk; infinite for arcs of
    /// other trees.
    pub fn new(parents: &[u32], births: &[f64], of_basin: &[u32]) -> (Self, Vec<f64>) {
        let count = parents.len();
        let mut basins = vec![0u32; count];
        of_basin.iter().for_each(|&arc| basins[arc as usize] += 1);
        let mut heavy = vec![NONE; count];
        let mut root = NONE;
        for arc in 0..count as u32 {
            let size = basins[arc as usize];
            let larger = |other: u32| other == NONE || basins[other as usize] < size;
            match parents[arc as usize] {
                NONE if larger(root) => root = arc,
                NONE => {}
                parent => {
                    if larger(heavy[parent as usize]) {
                        heavy[parent as usize] = arc;
                    }
                    basins[parent as usize] += size;
                }
            }
        }
        let mut arcs: Vec<u32> = std::iter::successors((root != NONE).then_some(root), |&arc| {
            Some(heavy[arc as usize]).filter(|&a| a != NONE)
        })
        .collect();
        arcs.reverse();
        let mut joins = vec![f64::INFINITY; count];
        arcs.iter().for_each(|&arc| joins[arc as usize] = births[arc as usize]);
        let mut next = arcs.iter().rev().peekable();
        for arc in (0..count as u32).rev() {
            if next.next_if(|&&on_trunk| on_trunk == arc).is_none() && parents[arc as usize] != NONE {
                joins[arc as usize] = joins[parents[arc as usize] as usize];
            }
        }
        (Self::index(arcs, births), joins)
    }

    fn index(arcs: Vec<u32>, births: &[f64]) -> Self {
        let births: Vec<f64> = arcs.iter().map(|&arc| births[arc as usize]).collect();
        let finite = |level: f64| level.clamp(-1e307, 1e307);
        let low = births.first().map_or(0.0, |&b| finite(b));
        let high = births.last().map_or(0.0, |&b| finite(b));
        let scale = births.len() as f64 / (high - low);
        let mut trunk = Self { table: vec![0; arcs.len() + 1], arcs, low, scale: 0.0, births };
        if scale.is_finite() {
            trunk.scale = scale;
        }
        // The last arc born in an earlier step, or the first of all.
        let mut at = 0;
        for (arc, &birth) in trunk.births.iter().enumerate() {
            let step = trunk.step(birth);
            while at < step {
                at += 1;
                trunk.table[at] = arc.saturating_sub(1) as u32;
            }
        }
        let last = trunk.births.len().saturating_sub(1) as u32;
        trunk.table[at + 1..].fill(last);
        trunk
    }

    #[inline]
    fn step(&self, level: f64) -> usize {
        (((level.clamp(-1e307, 1e307) - self.low) * self.scale) as usize).min(self.births.len())
    }

    /// The arc of the trunk that spans a level, which must not lie below its minimum, and where it ends.
    #[inline]
    pub fn at(&self, level: f64) -> (u32, f64) {
        let mut arc = self.table[self.step(level)] as usize;
        loop {
            match self.births.get(arc + 1) {
                Some(&next) if next <= level => arc += 1,
                Some(&next) => return (self.arcs[arc], next),
                None => return (self.arcs[arc], f64::INFINITY),
            }
        }
    }
}

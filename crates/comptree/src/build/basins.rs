//! Step 1 of the construction: the basins of steepest descent, as in ExTreeM (Lukasczyk et al. 2024) and
//! watersheds.
use std::hint::select_unpredictable;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use rayon::prelude::*;

use super::filtration::Filtration;

/// Marks a pointer that has become the number of a basin.
const FOUND: u32 = 1 << 31;

/// The basin that each vertex descends to.
pub(super) struct Basins {
    /// Number of each vertex's basin.
    pub labels: Vec<u32>,
    /// The minimum of each basin, ascending.
    pub minima: Vec<u32>,
}

/// Steepest descent from every vertex.
///
/// Threads share the pointers: whatever they read of each other, a pointer not yet followed or its
/// end, leads to the same minimum.
pub(super) fn find<R: Filtration>(filtration: &R, parts: usize) -> Basins {
    let ranges = filtration.split(parts);
    let pointers: Vec<AtomicU32> = vec![0; filtration.len()].into_iter().map(AtomicU32::new).collect();
    let point = |range: &Range<usize>| {
        let mut minima = Vec::new();
        filtration.descend(range.clone(), |v, target| {
            // Pointers back were set before and go further down at once. Which go back cannot be guessed, so
            // something is loaded for all, from memory that has been written.
            let known = (target < v) & (target as usize >= range.start);
            let at = select_unpredictable(known, target as usize, range.start);
            let to = select_unpredictable(known, pointers[at].load(Relaxed), target);
            pointers[v as usize].store(to, Relaxed);
            if target == v {
                minima.push(v);
            }
        });
        minima
    };
    let minima: Vec<u32> = ranges.par_iter().map(point).collect::<Vec<_>>().concat();
    for (basin, &v) in minima.iter().enumerate() {
        pointers[v as usize].store(basin as u32 | FOUND, Relaxed);
    }
    // From the last vertex down, most pointers forward have been followed before.
    ranges.par_iter().for_each(|range| {
        for v in range.clone().rev() {
            let mut at = pointers[v].load(Relaxed);
            if at & FOUND != 0 {
                continue;
            }
            let basin = loop {
                let next = pointers[at as usize].load(Relaxed);
                if next & FOUND != 0 {
                    break next;
                }
                at = next;
            };
            let mut at = v;
            loop {
                let next = pointers[at].swap_to(basin);
                if next & FOUND != 0 {
                    break;
                }
                at = next as usize;
            }
        }
    });
    let labels = pointers.into_iter().map(|p| p.into_inner() & !FOUND).collect();
    Basins { labels, minima }
}

trait SwapTo {
    /// A load and a store; cheaper than an atomic exchange, which is not needed.
    fn swap_to(&self, value: u32) -> u32;
}

impl SwapTo for AtomicU32 {
    #[inline]
    fn swap_to(&self, value: u32) -> u32 {
        let old = self.load(Relaxed);
        self.store(value, Relaxed);
        old
    }
}

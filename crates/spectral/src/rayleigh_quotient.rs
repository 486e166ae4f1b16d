//! Rayleigh quotients and residuals of vectors on a grid.

use rayon::prelude::*;

use crate::row::{Block, LANES, Row};
use crate::stencil::SlicedStencil;
use crate::temporal_blocking::{self, Tiling};

/// Rows that a thread sums up at a time.
const SUMMED_ROWS: usize = 1 << 13;

/// `x^T A x` of each column of some blocks and `|A x - lambda x| / lambda`; `work` holds A x of the last one afterwards.
pub(crate) fn rayleigh_quotients<R: Row>(
    stencil: &SlicedStencil,
    blocks: &mut [Block<R>],
    work: &mut Block<R>,
) -> (Vec<f64>, Vec<f64>) {
    let tiling = Tiling::new::<R>(stencil);
    let (mut values, mut residuals) = (Vec::new(), Vec::new());
    for block in blocks {
        work.resize(block.len(), R::ZERO);
        temporal_blocking::apply(stencil, tiling, block, work);
        let energy = sum_over_rows(block, work, |x, y, _| x * y);
        let square = sum_over_rows(block, work, |x, y, l| (y - energy[l] * x).powi(2));
        values.extend(energy);
        residuals.extend((0..LANES).map(|l| square[l].sqrt() / energy[l].max(f64::MIN_POSITIVE)));
    }
    (values, residuals)
}

/// The sum over all rows of a term in the entries x and y of each lane.
fn sum_over_rows<R: Row>(
    x: &Block<R>,
    y: &Block<R>,
    term: impl Fn(f64, f64, usize) -> f64 + Sync,
) -> [f64; LANES] {
    let partial = |(x, y): (&[R], &[R])| {
        let mut sums = [0.0; LANES];
        for (x, y) in x.iter().zip(y) {
            let (x, y) = (x.wide().0, y.wide().0);
            (0..LANES).for_each(|l| sums[l] += term(x[l], y[l], l));
        }
        sums
    };
    let partials: Vec<_> = x.par_chunks(SUMMED_ROWS).zip(y.par_chunks(SUMMED_ROWS)).map(partial).collect();
    partials.iter().fold([0.0; LANES], |sums, part| std::array::from_fn(|l| sums[l] + part[l]))
}

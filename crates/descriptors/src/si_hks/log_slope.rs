//! `d/dtau log H` of many vertices at many times (eq. 9): nearly all the work of the signature.

use crate::spectrum;
use std::f64::consts::LN_2;

/// Samples in a tile: one or two vector registers.
const LANES: usize = 8;
/// Vertices that share each load of the table.
const VERTICES: usize = 4;
/// Vertices in a block: their squares and one tile stay in the first-level cache.
pub(super) const BLOCK: usize = 32;

/// The exponentials at a few neighbouring samples, for the modes that count there.
struct Tile {
    /// For each mode: `e = exp(-(lambda - lambda_0) t)` and `ln 2 lambda t e` at each sample.
    modes: Vec<[[f64; LANES]; 2]>,
}

/// The exponentials at all samples.
pub(super) struct SlopeTable {
    tiles: Vec<Tile>,
    samples: usize,
    arch: pulp::Arch,
}

impl SlopeTable {
    /// `times` ascend.
    pub(super) fn new(eigenvalues: &[f64], times: &[f64]) -> Self {
        let slowest = eigenvalues.first().copied().unwrap_or(0.0);
        let tile = |times: &[f64]| {
            let live = &eigenvalues[..spectrum::live_modes(eigenvalues, times[0])];
            let modes = live.iter().map(|l| {
                let mut entry = [[0.0; LANES]; 2];
                for (lane, t) in times.iter().enumerate() {
                    // The common factor exp(-lambda_0 t) cancels, so it cannot underflow either.
                    let decay = (-(l - slowest) * t).exp();
                    entry[0][lane] = decay;
                    entry[1][lane] = LN_2 * l * t * decay;
                }
                entry
            });
            Tile { modes: modes.collect() }
        };
        let tiles = times.chunks(LANES).map(tile).collect();
        Self { tiles, samples: times.len(), arch: pulp::Arch::new() }
    }

    /// Writes `count <= BLOCK` rows of slopes; `phi(i)` gives the values of all modes at the i-th vertex.
    pub(super) fn slopes<'a>(&self, count: usize, phi: impl Fn(usize) -> &'a [f64], rows: &mut [f64]) {
        let modes = self.tiles.first().map_or(0, |tile| tile.modes.len());
        let groups = count.div_ceil(VERTICES);
        // phi^2, mode by mode within each group of vertices; a group's missing vertices stay zero.
        let mut squares = vec![[0.0; VERTICES]; groups * modes];
        for i in 0..count {
            let group = &mut squares[i / VERTICES * modes..][..modes];
            for (square, phi) in group.iter_mut().zip(phi(i)) {
                square[i % VERTICES] = phi * phi;
            }
        }
        self.arch.dispatch(|| self.fill(count, modes, &squares, rows));
    }

    #[inline(always)]
    fn fill(&self, count: usize, modes: usize, squares: &[[f64; VERTICES]], rows: &mut [f64]) {
        for (number, tile) in self.tiles.iter().enumerate() {
            let first = number * LANES;
            let width = LANES.min(self.samples - first);
            for (group, squares) in squares.chunks_exact(modes).enumerate() {
                let slopes = tile_slopes(&tile.modes, squares);
                for (i, slope) in slopes.iter().enumerate().take(count - group * VERTICES) {
                    let row = (group * VERTICES + i) * self.samples + first;
                    rows[row..row + width].copy_from_slice(&slope[..width]);
                }
            }
        }
    }
}

/// One tile of samples for one group of vertices. The modes are added in ascending order in each lane, so
/// that the sum doesn't depend on the width of the machine's registers.
#[inline(always)]
fn tile_slopes(modes: &[[[f64; LANES]; 2]], squares: &[[f64; VERTICES]]) -> [[f64; LANES]; VERTICES] {
    let mut heat = [[0.0; LANES]; VERTICES];
    let mut loss = [[0.0; LANES]; VERTICES];
    for ([decay, rate], square) in modes.iter().zip(squares) {
        for v in 0..VERTICES {
            for lane in 0..LANES {
                heat[v][lane] += square[v] * decay[lane];
                loss[v][lane] += square[v] * rate[lane];
            }
        }
    }
    let mut slope = [[0.0; LANES]; VERTICES];
    for v in 0..VERTICES {
        for lane in 0..LANES {
            slope[v][lane] = if heat[v][lane] > 0.0 { -loss[v][lane] / heat[v][lane] } else { 0.0 };
        }
    }
    slope
}

//! `d/dtau log H` of many vertices at many times (eq. 9): nearly all the work of the signature.
//!
//! A product of two matrices, phi^2 (vertices x modes) and the exponentials (modes x samples), except that a
//! mode takes part only until it has decayed: a third of all pairs. Small tiles of the result are kept in
//! registers; written with explicit vectors, since the plain loops came out three times slower.

use crate::spectral_sums;
use mser3d_shape::EigenbasisView;
use pulp::{Arch, Simd, WithSimd};
use std::f64::consts::LN_2;

/// Samples in a tile: two registers of four, or one of eight.
const LANES: usize = 8;
/// Vertices in a tile, which share each load of the exponentials.
const VERTICES: usize = 4;
/// Vertices in a block: their squares and one tile's exponentials stay in the first-level cache.
pub(super) const BLOCK: usize = 32;

/// At the samples of one tile, for each mode that counts there: `e = exp(-(lambda - lambda_0) t)` and
/// `ln 2 lambda t e`. The common factor `exp(-lambda_0 t)` cancels in the slope, so it cannot underflow.
type Exponentials = Vec<[[f64; LANES]; 2]>;

/// The exponentials at all samples.
pub(super) struct SlopeTable {
    tiles: Vec<Exponentials>,
    samples: usize,
    arch: Arch,
}

impl SlopeTable {
    /// `times` ascend.
    pub(super) fn new(eigenvalues: &[f64], times: &[f64]) -> Self {
        let slowest = eigenvalues.first().copied().unwrap_or(0.0);
        let tile = |times: &[f64]| -> Exponentials {
            let live = &eigenvalues[..spectral_sums::live_modes(eigenvalues, times[0])];
            let entry = |lambda: &f64| {
                let mut entry = [[0.0; LANES]; 2];
                for (lane, t) in times.iter().enumerate() {
                    entry[0][lane] = (-(lambda - slowest) * t).exp();
                    entry[1][lane] = LN_2 * lambda * t * entry[0][lane];
                }
                entry
            };
            live.iter().map(entry).collect()
        };
        let tiles = times.chunks(LANES).map(tile).collect();
        Self { tiles, samples: times.len(), arch: Arch::new() }
    }

    /// Writes the slopes of up to [`BLOCK`] vertices, a row each.
    pub(super) fn slopes(
        &self,
        basis: EigenbasisView<'_>,
        vertices: impl ExactSizeIterator<Item = usize>,
        rows: &mut [f64],
    ) {
        let modes = self.tiles.first().map_or(0, Vec::len);
        let count = vertices.len();
        // Mode by mode within each group of vertices; the last group's missing vertices stay zero.
        let mut squares = vec![[0.0; VERTICES]; count.div_ceil(VERTICES) * modes];
        let mut scratch = Vec::new();
        for (i, vertex) in vertices.enumerate() {
            let group = &mut squares[i / VERTICES * modes..][..modes];
            for (square, phi) in group.iter_mut().zip(basis.row(vertex, 0..modes, &mut scratch)) {
                square[i % VERTICES] = phi * phi;
            }
        }
        self.arch.dispatch(Block { table: self, modes, squares: &squares, rows });
    }
}

struct Block<'a> {
    table: &'a SlopeTable,
    modes: usize,
    squares: &'a [[f64; VERTICES]],
    rows: &'a mut [f64],
}

impl WithSimd for Block<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for (number, tile) in self.table.tiles.iter().enumerate() {
            let first = number * LANES;
            let width = LANES.min(self.table.samples - first);
            for (group, squares) in self.squares.chunks_exact(self.modes).enumerate() {
                let slopes = match S::F64_LANES {
                    8 => tile_slopes::<S, 1>(simd, tile, squares),
                    4 => tile_slopes::<S, 2>(simd, tile, squares),
                    2 => tile_slopes::<S, 4>(simd, tile, squares),
                    _ => tile_slopes::<S, 8>(simd, tile, squares),
                };
                let rows = self.rows.chunks_exact_mut(self.table.samples).skip(group * VERTICES);
                for (row, slopes) in rows.zip(&slopes) {
                    row[first..first + width].copy_from_slice(&slopes[..width]);
                }
            }
        }
    }
}

/// One tile: R registers make up its samples. Each lane adds the modes in ascending order, multiplication and
/// addition rounded apart, so that all machines get the same bits.
#[inline(always)]
fn tile_slopes<S: Simd, const R: usize>(
    simd: S,
    modes: &[[[f64; LANES]; 2]],
    squares: &[[f64; VERTICES]],
) -> [[f64; LANES]; VERTICES] {
    let registers = |values: &[f64; LANES]| -> [S::f64s; R] {
        let (vectors, _) = S::as_simd_f64s(values);
        std::array::from_fn(|r| vectors[r])
    };
    let zero = simd.splat_f64s(0.0);
    let mut heat = [[zero; R]; VERTICES];
    let mut loss = [[zero; R]; VERTICES];
    for ([decay, rate], square) in modes.iter().zip(squares) {
        let (decay, rate) = (registers(decay), registers(rate));
        for v in 0..VERTICES {
            let square = simd.splat_f64s(square[v]);
            for r in 0..R {
                heat[v][r] = simd.add_f64s(heat[v][r], simd.mul_f64s(square, decay[r]));
                loss[v][r] = simd.add_f64s(loss[v][r], simd.mul_f64s(square, rate[r]));
            }
        }
    }
    let mut slopes = [[0.0; LANES]; VERTICES];
    for v in 0..VERTICES {
        let (vectors, _) = S::as_mut_simd_f64s(&mut slopes[v]);
        for r in 0..R {
            vectors[r] = simd.div_f64s(loss[v][r], heat[v][r]);
        }
        // No heat at all: 0/0, which is defined as no slope.
        slopes[v] = slopes[v].map(|x| if x.is_nan() { 0.0 } else { -x });
    }
    slopes
}

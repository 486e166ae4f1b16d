//! The parity of crossings along each axis, and the majority of three.

use crate::axis_sweep::SlabLines;
use crate::placed_surface::PlacedSurface;
use mser3d_shape::{BitGrid, ShapeError};
use rayon::prelude::*;

impl PlacedSurface<'_> {
    /// For each voxel centre, whether the line to it along an axis crosses the surface an odd number of
    /// times.
    pub fn parity_along(&self, axis: usize) -> Result<BitGrid, ShapeError> {
        let mut bits = BitGrid::empty(self.lattice.dims)?;
        let sweep = self.sweep(axis);
        let axes = sweep.axes();
        let toggles: Vec<Vec<[u32; 3]>> = (0..sweep.slabs())
            .into_par_iter()
            .map_init(SlabLines::default, |lines, slab| {
                let mut toggles = Vec::new();
                sweep.for_each_line(slab, lines, false, |u, v, crossings| {
                    for crossing in crossings.iter().filter(|c| c.cell() < self.lattice.dims[axis]) {
                        let mut voxel = [0; 3];
                        (voxel[axes.u], voxel[axes.v]) = (u as u32, v as u32);
                        voxel[axes.d] = crossing.cell() as u32;
                        toggles.push(voxel);
                    }
                });
                toggles
            })
            .collect();
        for voxel in toggles.into_iter().flatten() {
            let (word, bit) = bits.position(voxel);
            bits.words_mut()[word] ^= 1 << bit;
        }
        prefix_xor(&mut bits, axis);
        Ok(bits)
    }
}

/// Replaces each bit by the parity of the bits up to it along an axis.
fn prefix_xor(bits: &mut BitGrid, axis: usize) {
    let ([nx, ny, nz], row) = (bits.dims(), bits.row_words());
    if row == 0 {
        return;
    }
    let words = bits.words_mut();
    match axis {
        0 => {
            for line in words.chunks_mut(row) {
                let mut carry = 0;
                for word in line.iter_mut() {
                    for shift in [1, 2, 4, 8, 16, 32] {
                        *word ^= *word << shift;
                    }
                    *word ^= carry;
                    carry = if *word >> 63 == 1 { u64::MAX } else { 0 };
                }
                if nx % 64 != 0 {
                    line[row - 1] &= (1 << (nx % 64)) - 1;
                }
            }
        }
        _ => {
            let stride = if axis == 1 { row } else { row * ny };
            for word in 0..row * ny * nz {
                let place = if axis == 1 { word / row % ny } else { word / (row * ny) };
                if place > 0 {
                    words[word] ^= words[word - stride];
                }
            }
        }
    }
}

/// The voxels set in at least two of three grids, and how many are not set alike in all three.
pub(crate) fn majority(a: &BitGrid, b: &BitGrid, c: &BitGrid) -> (BitGrid, usize) {
    let mut result = a.clone();
    let mut disagreements = 0;
    for (i, word) in result.words_mut().iter_mut().enumerate() {
        let (a, b, c) = (a.words()[i], b.words()[i], c.words()[i]);
        *word = a & b | b & c | c & a;
        disagreements += ((a ^ b) | (b ^ c)).count_ones() as usize;
    }
    (result, disagreements)
}

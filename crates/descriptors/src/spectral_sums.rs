//! Sums over a spectrum, `sum_i w_i phi_i^2`: which modes count, and a fixed order.

use crate::{DescriptorError, vertex_subset::VertexSubset};
use mser3d_shape::EigenbasisView;
use pulp::Arch;
use rayon::prelude::*;
use std::ops::Range;

/// Modes that have decayed by `exp(-41.5) = 1e-18` against the slowest one are left out: below the rounding
/// of the sum, even where their eigenfunction peaks.
pub(crate) const NEGLIGIBLE_DECAY: f64 = 41.5;

/// How many of the (ascending) eigenvalues count at time t.
pub(crate) fn live_modes(eigenvalues: &[f64], t: f64) -> usize {
    let Some(&slowest) = eigenvalues.first() else { return 0 };
    eigenvalues.partition_point(|l| (l - slowest) * t <= NEGLIGIBLE_DECAY)
}

pub(crate) fn check(basis: EigenbasisView<'_>) -> Result<(), DescriptorError> {
    let (vertices, eigenpairs) = (basis.len(), basis.eigenvalues().len());
    if vertices == 0 || eigenpairs == 0 {
        return Err(DescriptorError::EmptyBasis { vertices, eigenpairs });
    }
    Ok(())
}

/// `sum_i w_i phi_(first + i)(v)^2` of every vertex.
pub(crate) fn weighted_squares(basis: EigenbasisView<'_>, first: usize, weights: &[f64]) -> Vec<f64> {
    for_each_row(
        basis,
        VertexSubset::all(basis),
        first..first + weights.len(),
        1,
        #[inline(always)]
        |phi, value| value[0] = sum(weights, |i| phi[i] * phi[i]),
    )
}

/// A row of `width` numbers for each of some vertices, in parallel. `fill` makes it of the values of some eigenfunctions there; it
/// is compiled for vectors as wide as the processor has, if it is inlined. That changes no bit: multiplications and additions
/// are rounded each, and come in the order in which they are written.
pub(crate) fn for_each_row(
    basis: EigenbasisView<'_>,
    vertices: VertexSubset<'_>,
    modes: Range<usize>,
    width: usize,
    fill: impl Fn(&[f64], &mut [f64]) + Sync,
) -> Vec<f64> {
    const ROWS: usize = 256;
    let mut values = vec![0.0; vertices.len() * width];
    let (arch, width) = (Arch::new(), width.max(1));
    values.par_chunks_mut(ROWS * width).enumerate().for_each(|(block, values)| {
        let rows = values.chunks_exact_mut(width).enumerate();
        let mut scratch = Vec::new();
        arch.dispatch(
            #[inline(always)]
            || {
                for (row, values) in rows {
                    let vertex = vertices.vertex(block * ROWS + row);
                    fill(basis.row(vertex, modes.clone(), &mut scratch), values);
                }
            },
        );
    });
    values
}

/// `sums += factor * values`, number by number. To be called where code is compiled for wide vectors.
#[inline(always)]
pub(crate) fn add_multiple(sums: &mut [f64], factor: f64, values: &[f64]) {
    sums.iter_mut().zip(values).for_each(|(sum, x)| *sum += factor * x);
}

/// `sum_i weights[i] term(i)` in four interleaved partial sums: always the same order, and no long chain of
/// dependent additions.
#[inline(always)]
pub(crate) fn sum(weights: &[f64], term: impl Fn(usize) -> f64) -> f64 {
    let mut partial = [0.0; 4];
    let (blocks, rest) = weights.as_chunks::<4>();
    for (block, weights) in blocks.iter().enumerate() {
        for lane in 0..4 {
            partial[lane] += weights[lane] * term(4 * block + lane);
        }
    }
    for (lane, weight) in rest.iter().enumerate() {
        partial[lane] += weight * term(4 * blocks.len() + lane);
    }
    (partial[0] + partial[1]) + (partial[2] + partial[3])
}

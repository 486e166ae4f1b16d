//! The dense kernels under both solvers: products of 8 x 8 entries from blocks of eight columns.
//!
//! A row of a block is one cache line and, with AVX-512, one register. Filters, factors and stencils work on
//! blocks in place, and so do these kernels: nothing is packed first.

use std::ops::Range;

use faer::{Mat, MatRef};
use pulp::{Simd, WithSimd};

use crate::row::{Block, LANES, Lanes};

/// Products of a row of one block with a row of another: entry (i, j) is row i, lane j.
pub(crate) type Square = [Lanes; LANES];

/// The sum of partial sums, m by n squares each, in their order.
pub(crate) fn total(partials: Vec<Vec<Square>>, m: usize, n: usize) -> Mat<f64> {
    let mut total = Mat::zeros(m * LANES, n * LANES);
    for sums in partials {
        for (at, square) in sums.iter().enumerate() {
            for i in 0..LANES {
                for j in 0..LANES {
                    total[(at / n * LANES + i, at % n * LANES + j)] += square[i].0[j];
                }
            }
        }
    }
    total
}

/// Asks for a row that will be read soon: by itself the processor fetches too late for kernels as fast as these.
#[inline(always)]
fn prefetch<R>(row: &R) {
    #[cfg(target_arch = "x86_64")]
    if let Some(sse) = pulp::core_arch::x86::Sse::try_new() {
        sse._mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(std::ptr::from_ref(row).cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = row;
}

/// Rows of each block, each time with those of the block that follows; nothing follows the last.
pub(crate) fn with_next<'a, R: 'a, B: AsRef<[R]>>(
    blocks: &'a [B],
    rows: Range<usize>,
) -> impl Iterator<Item = [&'a [R]; 2]> {
    (0..blocks.len()).map(move |at| {
        [at, at + 1].map(|at| blocks.get(at).map_or(&[][..], |block| &block.as_ref()[rows.clone()]))
    })
}

/// `targets += left[rows] coefficients`.
pub(crate) fn combine(left: &[Block], rows: Range<usize>, squares: &[Square], targets: &mut [&mut [Lanes]]) {
    for ([a, next], squares) in with_next(left, rows).zip(squares.chunks_exact(targets.len())) {
        add_combinations(a, next, squares, targets);
    }
}

/// `blocks = blocks coefficients`.
pub(crate) fn rotate(coefficients: MatRef<'_, f64>, squares: &[Square], blocks: &mut [&mut [Lanes]]) {
    let (m, n) = (coefficients.nrows().div_ceil(LANES), coefficients.ncols().div_ceil(LANES));
    let length = blocks[0].len();
    let mut product = vec![Lanes::ZERO; n * length];
    let mut targets: Vec<&mut [Lanes]> = product.chunks_exact_mut(length).collect();
    for ([a, next], squares) in with_next(&blocks[..m], 0..length).zip(squares.chunks_exact(n)) {
        add_combinations(a, next, squares, &mut targets);
    }
    for (block, values) in blocks.iter_mut().zip(product.chunks_exact(length)) {
        block.copy_from_slice(values);
    }
}

/// `sums += blocks^T blocks`.
pub(crate) fn add_own_products(blocks: &[&mut [Lanes]], sums: &mut [Square]) {
    let rows = 0..blocks.first().map_or(0, |block| block.len());
    for ([a, next], sums) in with_next(blocks, rows).zip(sums.chunks_exact_mut(blocks.len())) {
        add_products(a, next, blocks, sums);
    }
}

/// Coefficients as 8 x 8 squares, row by row of squares, filled up with zeros.
pub(crate) fn squares(coefficients: MatRef<'_, f64>, factor: f64) -> Vec<Square> {
    let (m, n) = (coefficients.nrows().div_ceil(LANES), coefficients.ncols().div_ceil(LANES));
    let entry = |i: usize, j: usize| {
        let inside = i < coefficients.nrows() && j < coefficients.ncols();
        if inside { factor * coefficients[(i, j)] } else { 0.0 }
    };
    let square = |at: usize| -> Square {
        std::array::from_fn(|i| Lanes(std::array::from_fn(|j| entry(at / n * LANES + i, at % n * LANES + j))))
    };
    (0..m * n).map(square).collect()
}

/// `sums[j] += a^T b[j]`; `next` is what a is followed by.
pub(crate) fn add_products<R>(a: &[Lanes], mut next: &[R], b: &[impl AsRef<[Lanes]>], sums: &mut [Square]) {
    let arch = pulp::Arch::new();
    let at_once = arch.dispatch(AtOnce);
    for (b, sums) in b.chunks(at_once).zip(sums.chunks_mut(at_once)) {
        match (b, sums) {
            ([b, c], [sum, other]) => {
                arch.dispatch(Products { a, next, b: [b.as_ref(), c.as_ref()], sums: [sum, other] })
            }
            (b, sums) => b.iter().zip(sums).for_each(|(b, sum)| {
                arch.dispatch(Products { a, next, b: [b.as_ref()], sums: [sum] });
            }),
        }
        next = &[];
    }
}

/// `targets[j] += a coefficients[j]`; `next` is what a is followed by.
fn add_combinations<R>(a: &[Lanes], mut next: &[R], coefficients: &[Square], targets: &mut [&mut [Lanes]]) {
    let arch = pulp::Arch::new();
    let at_once = arch.dispatch(AtOnce);
    for (coefficients, targets) in coefficients.chunks(at_once).zip(targets.chunks_mut(at_once)) {
        match (coefficients, targets) {
            ([c, d], [target, other]) => {
                arch.dispatch(Combinations { a, next, coefficients: [c, d], targets: [target, other] })
            }
            (coefficients, targets) => coefficients.iter().zip(targets).for_each(|(c, target)| {
                arch.dispatch(Combinations { a, next, coefficients: [c], targets: [target] });
            }),
        }
        next = &[];
    }
}

/// How many blocks share what is read of another one. The sums of two fit in the registers of AVX-512, where reading then takes no
/// longer than computing; shorter ones hold the sums of one.
struct AtOnce;

impl WithSimd for AtOnce {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        if S::F64_LANES == LANES { 2 } else { 1 }
    }
}

struct Products<'a, R, const N: usize> {
    a: &'a [Lanes],
    next: &'a [R],
    b: [&'a [Lanes]; N],
    sums: [&'a mut Square; N],
}

impl<R, const N: usize> WithSimd for Products<'_, R, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let rows = self.b.iter().map(|b| b.len()).fold(self.a.len(), usize::min);
        let (a, b) = (&self.a[..rows], self.b.map(|b| &b[..rows]));
        for part in 0..LANES / S::F64_LANES {
            let load = |lanes: &Lanes| S::as_simd_f64s(&lanes.0).0[part];
            let mut sums: [[S::f64s; LANES]; N] =
                std::array::from_fn(|j| std::array::from_fn(|i| load(&self.sums[j][i])));
            for row in 0..rows {
                if let Some(next) = self.next.get(row) {
                    prefetch(next);
                }
                let b: [S::f64s; N] = std::array::from_fn(|j| load(&b[j][row]));
                for i in 0..LANES {
                    let a = simd.splat_f64s(a[row].0[i]);
                    for j in 0..N {
                        sums[j][i] = simd.mul_add_f64s(a, b[j], sums[j][i]);
                    }
                }
            }
            for (square, sums) in self.sums.iter_mut().zip(sums) {
                for (lanes, sum) in square.iter_mut().zip(sums) {
                    S::as_mut_simd_f64s(&mut lanes.0).0[part] = sum;
                }
            }
        }
    }
}

struct Combinations<'a, R, const N: usize> {
    a: &'a [Lanes],
    next: &'a [R],
    coefficients: [&'a Square; N],
    targets: [&'a mut [Lanes]; N],
}

impl<R, const N: usize> WithSimd for Combinations<'_, R, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let rows = self.targets.iter().map(|target| target.len()).fold(self.a.len(), usize::min);
        let a = &self.a[..rows];
        let mut targets = self.targets.map(|target| &mut target[..rows]);
        for part in 0..LANES / S::F64_LANES {
            let coefficients: [[S::f64s; LANES]; N] = std::array::from_fn(|j| {
                std::array::from_fn(|i| S::as_simd_f64s(&self.coefficients[j][i].0).0[part])
            });
            for row in 0..rows {
                if let Some(next) = self.next.get(row) {
                    prefetch(next);
                }
                let a: [S::f64s; LANES] = std::array::from_fn(|i| simd.splat_f64s(a[row].0[i]));
                for (target, coefficients) in targets.iter_mut().zip(&coefficients) {
                    let target = &mut S::as_mut_simd_f64s(&mut target[row].0).0[part];
                    // Two sums, so that one addition need not wait for the other.
                    let mut even = simd.mul_add_f64s(a[0], coefficients[0], *target);
                    let mut odd = simd.mul_f64s(a[1], coefficients[1]);
                    for i in (2..LANES).step_by(2) {
                        even = simd.mul_add_f64s(a[i], coefficients[i], even);
                        odd = simd.mul_add_f64s(a[i + 1], coefficients[i + 1], odd);
                    }
                    *target = simd.add_f64s(even, odd);
                }
            }
        }
    }
}

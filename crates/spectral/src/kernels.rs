//! The dense kernels under both solvers: products of 8 x 8 entries from blocks of eight columns.
//!
//! A row of a block is one cache line and, with AVX-512, one register. Filters, factors and stencils work on
//! blocks in place, and so do these kernels: nothing is packed first.

use std::ops::Range;

use faer::{Mat, MatRef};
use pulp::{Simd, WithSimd};

use crate::row::{Block, LANES, Lanes, Vectors, store, vectors};

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
pub(crate) fn add_products<R>(a: &[Lanes], next: &[R], b: &[impl AsRef<[Lanes]>], sums: &mut [Square]) {
    pulp::Arch::new().dispatch(Products { a, next, b, sums });
}

/// `targets[j] += a coefficients[j]`; `next` is what a is followed by.
fn add_combinations<R>(a: &[Lanes], next: &[R], coefficients: &[Square], targets: &mut [&mut [Lanes]]) {
    pulp::Arch::new().dispatch(Combinations { a, next, coefficients, targets });
}

struct Products<'a, R, B> {
    a: &'a [Lanes],
    next: &'a [R],
    b: &'a [B],
    sums: &'a mut [Square],
}

impl<R, B: AsRef<[Lanes]>> WithSimd for Products<'_, R, B> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { a, mut next, b, sums } = self;
        let at_once = blocks_at_once::<S>();
        for (b, sums) in b.chunks(at_once).zip(sums.chunks_mut(at_once)) {
            match (b, sums) {
                ([b, c], [sum, other]) => {
                    products::<S, R, 8, 2>(simd, a, next, [b.as_ref(), c.as_ref()], [sum, other]);
                }
                ([b], [sum]) if at_once > 1 => products::<S, R, 8, 1>(simd, a, next, [b.as_ref()], [sum]),
                ([b], [sum]) => products::<S, R, 4, 1>(simd, a, next, [b.as_ref()], [sum]),
                _ => {}
            }
            next = &[];
        }
    }
}

struct Combinations<'a, 'b, R> {
    a: &'a [Lanes],
    next: &'a [R],
    coefficients: &'a [Square],
    targets: &'a mut [&'b mut [Lanes]],
}

impl<R> WithSimd for Combinations<'_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { a, mut next, coefficients, targets } = self;
        let at_once = blocks_at_once::<S>();
        for (coefficients, targets) in coefficients.chunks(at_once).zip(targets.chunks_mut(at_once)) {
            match (coefficients, targets) {
                ([c, d], [target, other]) => {
                    combinations::<S, R, 8, 2>(simd, a, next, [c, d], [target, other]);
                }
                ([c], [target]) if at_once > 1 => combinations::<S, R, 8, 1>(simd, a, next, [c], [target]),
                ([c], [target]) => combinations::<S, R, 4, 1>(simd, a, next, [c], [target]),
                _ => {}
            }
            next = &[];
        }
    }
}

/// How many blocks share what is read of another one. The sums of two fit in the registers of AVX-512, where reading then takes no
/// longer than computing. Shorter registers hold the sums of half a block.
#[inline(always)]
fn blocks_at_once<S: Simd>() -> usize {
    if S::F64_LANES == LANES { 2 } else { 1 }
}

/// `sums[j] += a^T b[j]`, with `COLUMNS` columns of a at a time.
#[inline(always)]
fn products<S: Simd, R, const COLUMNS: usize, const N: usize>(
    simd: S,
    a: &[Lanes],
    mut next: &[R],
    b: [&[Lanes]; N],
    mut squares: [&mut Square; N],
) {
    let rows = b.iter().map(|b| b.len()).fold(a.len(), usize::min);
    let (a, b) = (&a[..rows], b.map(|b| &b[..rows]));
    for first in (0..LANES).step_by(COLUMNS) {
        let mut sums: [[Vectors<S>; COLUMNS]; N] =
            std::array::from_fn(|j| std::array::from_fn(|i| vectors(simd, &squares[j][first + i])));
        for row in 0..rows {
            if let Some(next) = next.get(row) {
                prefetch(next);
            }
            let b: [Vectors<S>; N] = std::array::from_fn(|j| vectors(simd, &b[j][row]));
            for i in 0..COLUMNS {
                let a = simd.splat_f64s(a[row].0[first + i]);
                for j in 0..N {
                    for part in 0..LANES / S::F64_LANES {
                        sums[j][i][part] = simd.mul_add_f64s(a, b[j][part], sums[j][i][part]);
                    }
                }
            }
        }
        for (square, sums) in squares.iter_mut().zip(sums) {
            for (lanes, sum) in square[first..].iter_mut().zip(sums) {
                store::<S>(lanes, sum);
            }
        }
        next = &[];
    }
}

/// `targets[j] += a coefficients[j]`, with `COLUMNS` columns of a at a time.
#[inline(always)]
fn combinations<S: Simd, R, const COLUMNS: usize, const N: usize>(
    simd: S,
    a: &[Lanes],
    mut next: &[R],
    coefficients: [&Square; N],
    targets: [&mut [Lanes]; N],
) {
    let rows = targets.iter().map(|target| target.len()).fold(a.len(), usize::min);
    let a = &a[..rows];
    let mut targets = targets.map(|target| &mut target[..rows]);
    for first in (0..LANES).step_by(COLUMNS) {
        let coefficients: [[Vectors<S>; COLUMNS]; N] =
            std::array::from_fn(|j| std::array::from_fn(|i| vectors(simd, &coefficients[j][first + i])));
        for row in 0..rows {
            if let Some(next) = next.get(row) {
                prefetch(next);
            }
            let a: [S::f64s; COLUMNS] = std::array::from_fn(|i| simd.splat_f64s(a[row].0[first + i]));
            for (target, coefficients) in targets.iter_mut().zip(&coefficients) {
                let mut sum = vectors(simd, &target[row]);
                for part in 0..LANES / S::F64_LANES {
                    // Two sums, so that one addition need not wait for the other.
                    let mut even = simd.mul_add_f64s(a[0], coefficients[0][part], sum[part]);
                    let mut odd = simd.mul_f64s(a[1], coefficients[1][part]);
                    for i in (2..COLUMNS).step_by(2) {
                        even = simd.mul_add_f64s(a[i], coefficients[i][part], even);
                        odd = simd.mul_add_f64s(a[i + 1], coefficients[i + 1][part], odd);
                    }
                    sum[part] = simd.add_f64s(even, odd);
                }
                store::<S>(&mut target[row], sum);
            }
        }
        next = &[];
    }
}

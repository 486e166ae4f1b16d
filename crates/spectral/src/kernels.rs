//! The dense kernels under both solvers: products of 8 x 8 entries from blocks of eight columns.
//!
//! A row of a block is one cache line and, with AVX-512, one register. Filters, factors and stencils work on
//! blocks in place, and so do these kernels: nothing is packed first.

use std::ops::Range;

use faer::{Mat, MatRef};
use pulp::{Simd, WithSimd};

/// Columns of a block.
pub(crate) const LANES: usize = 8;

/// A row of a block, aligned so that a vector register reads it at once.
#[repr(align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lanes(pub [f64; LANES]);

impl Lanes {
    pub const ZERO: Self = Self([0.0; LANES]);
}

/// A block of columns.
pub(crate) type Block = Vec<Lanes>;

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

/// `targets += left[rows] coefficients`.
pub(crate) fn combine(left: &[Block], rows: Range<usize>, squares: &[Square], targets: &mut [&mut [Lanes]]) {
    for (a, squares) in left.iter().zip(squares.chunks_exact(targets.len())) {
        for (target, square) in targets.iter_mut().zip(squares) {
            add_combination(&a[rows.clone()], square, target);
        }
    }
}

/// `blocks = blocks coefficients`.
pub(crate) fn rotate(coefficients: MatRef<'_, f64>, squares: &[Square], blocks: &mut [&mut [Lanes]]) {
    let (m, n) = (coefficients.nrows().div_ceil(LANES), coefficients.ncols().div_ceil(LANES));
    let length = blocks[0].len();
    let mut product = vec![Lanes::ZERO; n * length];
    for (j, target) in product.chunks_exact_mut(length).enumerate() {
        for (i, a) in blocks[..m].iter().enumerate() {
            add_combination(a, &squares[i * n + j], target);
        }
    }
    for (block, values) in blocks.iter_mut().zip(product.chunks_exact(length)) {
        block.copy_from_slice(values);
    }
}

/// `sums += blocks^T blocks`.
pub(crate) fn add_own_products(blocks: &[&mut [Lanes]], sums: &mut [Square]) {
    let pairs = blocks.iter().flat_map(|a| blocks.iter().map(move |b| (a, b)));
    pairs.zip(sums).for_each(|((a, b), sum)| add_products(a, b, sum));
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

/// `sum += a^T b`.
pub(crate) fn add_products(a: &[Lanes], b: &[Lanes], sum: &mut Square) {
    pulp::Arch::new().dispatch(Products { a, b, sum });
}

/// `target += a coefficients`.
fn add_combination(a: &[Lanes], coefficients: &Square, target: &mut [Lanes]) {
    pulp::Arch::new().dispatch(Combination { a, coefficients, target });
}

struct Products<'a> {
    a: &'a [Lanes],
    b: &'a [Lanes],
    sum: &'a mut Square,
}

impl WithSimd for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for part in 0..LANES / S::F64_LANES {
            let load = |lanes: &Lanes| S::as_simd_f64s(&lanes.0).0[part];
            let mut sums: [S::f64s; LANES] = std::array::from_fn(|i| load(&self.sum[i]));
            for (a, b) in self.a.iter().zip(self.b) {
                let b = load(b);
                for i in 0..LANES {
                    sums[i] = simd.mul_add_f64s(simd.splat_f64s(a.0[i]), b, sums[i]);
                }
            }
            for (lanes, sum) in self.sum.iter_mut().zip(sums) {
                S::as_mut_simd_f64s(&mut lanes.0).0[part] = sum;
            }
        }
    }
}

struct Combination<'a> {
    a: &'a [Lanes],
    coefficients: &'a Square,
    target: &'a mut [Lanes],
}

impl WithSimd for Combination<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for part in 0..LANES / S::F64_LANES {
            let coefficients: [S::f64s; LANES] =
                std::array::from_fn(|i| S::as_simd_f64s(&self.coefficients[i].0).0[part]);
            for (a, target) in self.a.iter().zip(self.target.iter_mut()) {
                let target = &mut S::as_mut_simd_f64s(&mut target.0).0[part];
                // Two sums, so that one addition need not wait for the other.
                let mut even = *target;
                let mut odd = simd.mul_f64s(simd.splat_f64s(a.0[1]), coefficients[1]);
                even = simd.mul_add_f64s(simd.splat_f64s(a.0[0]), coefficients[0], even);
                for i in (2..LANES).step_by(2) {
                    even = simd.mul_add_f64s(simd.splat_f64s(a.0[i]), coefficients[i], even);
                    odd = simd.mul_add_f64s(simd.splat_f64s(a.0[i + 1]), coefficients[i + 1], odd);
                }
                *target = simd.add_f64s(even, odd);
            }
        }
    }
}

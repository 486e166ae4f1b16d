//! The factor `L D L^T` of a shifted matrix: solves on blocks of eight columns, and the inertia.
//!
//! The solves are our own: a row of a block is one vector register, so a supernode's columns become
//! fused multiply-adds without gathering rows into a dense matrix first.

use faer::sparse::linalg::cholesky::supernodal::SupernodalLdltRef;
use faer::sparse::linalg::cholesky::{SymbolicCholesky, SymbolicCholeskyRaw};
use pulp::{Simd, WithSimd};

use crate::row::{LANES, Lanes};

/// `P^T L D L^T P = A - sigma I`; L has a unit diagonal, D is stored in its place.
pub(crate) struct Factor<'a> {
    symbolic: &'a SymbolicCholesky<usize>,
    values: Vec<f64>,
}

impl<'a> Factor<'a> {
    /// From the pattern and what faer computed on it, which has to be supernodal.
    pub fn new(symbolic: &'a SymbolicCholesky<usize>, values: Vec<f64>) -> Self {
        Self { symbolic, values }
    }

    /// Eigenvalues below the shift: by Sylvester's law of inertia, as many as D has negative entries.
    /// Numbers in it.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    pub fn negative_pivots(&self) -> usize {
        let count = |node: Supernode<'_>| (0..node.width).filter(|&j| node.entry(j, j) < 0.0).count();
        self.supernodes().map(count).sum()
    }

    /// The largest diagonal entry of `|L| |D| |L^T|`; not finite if the factorization broke down.
    pub fn largest_term(&self) -> f64 {
        let mut terms = vec![0.0; self.symbolic.nrows()];
        for node in self.supernodes() {
            for j in 0..node.width {
                let (pivot, column) = (node.entry(j, j).abs(), node.column(j));
                terms[node.start + j] += pivot;
                for i in j + 1..node.width {
                    terms[node.start + i] += pivot * column[i] * column[i];
                }
                for (&row, l) in node.below.iter().zip(&column[node.width..]) {
                    terms[row] += pivot * l * l;
                }
            }
        }
        terms.iter().fold(0.0, |most: f64, &term| if term <= most { most } else { term })
    }

    /// `x = (A - sigma I)^(-1) x`; `work` is of the size of x.
    pub fn solve(&self, x: &mut [Lanes], work: &mut [Lanes]) {
        pulp::Arch::new().dispatch(Solve { factor: self, x, work });
    }

    fn supernodes(&self) -> impl DoubleEndedIterator<Item = Supernode<'_>> {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            unreachable!("supernodal was asked for")
        };
        let factor = SupernodalLdltRef::new(symbolic, &self.values);
        (0..symbolic.n_supernodes()).map(move |s| {
            let node = factor.supernode(s);
            let (rows, width) = (node.val().nrows(), node.val().ncols());
            let first = symbolic.col_ptr_for_val()[s];
            let values = &self.values[first..first + rows * width];
            Supernode { start: node.start(), width, below: node.pattern(), values }
        })
    }
}

/// Neighbouring columns of L that share their rows below.
struct Supernode<'a> {
    start: usize,
    width: usize,
    below: &'a [usize],
    /// Column by column, `width + below.len()` rows each.
    values: &'a [f64],
}

/// Columns that are worked on at once, in registers.
const TILE: usize = 8;

impl Supernode<'_> {
    #[inline(always)]
    fn entry(&self, row: usize, column: usize) -> f64 {
        self.values[column * (self.width + self.below.len()) + row]
    }

    /// Column `j` of L, from its diagonal on.
    #[inline(always)]
    fn column(&self, j: usize) -> &[f64] {
        let rows = self.width + self.below.len();
        &self.values[j * rows..(j + 1) * rows]
    }
}

struct Solve<'a> {
    factor: &'a Factor<'a>,
    x: &'a mut [Lanes],
    work: &'a mut [Lanes],
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { factor, x, work } = self;
        let order = factor.symbolic.perm().map(|p| p.arrays().0);
        match order {
            Some(order) => work.iter_mut().zip(order).for_each(|(to, &from)| *to = x[from]),
            None => work.copy_from_slice(x),
        }
        for node in factor.supernodes() {
            for first in (0..node.width).step_by(TILE) {
                forward(simd, &node, first, work);
            }
        }
        for node in factor.supernodes().rev() {
            for first in (0..node.width).step_by(TILE).rev() {
                backward(simd, &node, first, work);
            }
        }
        match order {
            Some(order) => work.iter().zip(order).for_each(|(from, &to)| x[to] = *from),
            None => x.copy_from_slice(work),
        }
    }
}

#[inline(always)]
fn forward<S: Simd>(simd: S, node: &Supernode<'_>, first: usize, x: &mut [Lanes]) {
    match node.width - first {
        1 => forward_tile::<S, 1>(simd, node, first, x),
        2 => forward_tile::<S, 2>(simd, node, first, x),
        3 => forward_tile::<S, 3>(simd, node, first, x),
        4 => forward_tile::<S, 4>(simd, node, first, x),
        5 => forward_tile::<S, 5>(simd, node, first, x),
        6 => forward_tile::<S, 6>(simd, node, first, x),
        7 => forward_tile::<S, 7>(simd, node, first, x),
        _ => forward_tile::<S, 8>(simd, node, first, x),
    }
}

#[inline(always)]
fn backward<S: Simd>(simd: S, node: &Supernode<'_>, first: usize, x: &mut [Lanes]) {
    match node.width - first {
        1 => backward_tile::<S, 1>(simd, node, first, x),
        2 => backward_tile::<S, 2>(simd, node, first, x),
        3 => backward_tile::<S, 3>(simd, node, first, x),
        4 => backward_tile::<S, 4>(simd, node, first, x),
        5 => backward_tile::<S, 5>(simd, node, first, x),
        6 => backward_tile::<S, 6>(simd, node, first, x),
        7 => backward_tile::<S, 7>(simd, node, first, x),
        _ => backward_tile::<S, 8>(simd, node, first, x),
    }
}

/// `L^(-1)` of W columns.
#[inline(always)]
fn forward_tile<S: Simd, const W: usize>(simd: S, node: &Supernode<'_>, first: usize, x: &mut [Lanes]) {
    let columns: [&[f64]; W] = std::array::from_fn(|j| node.column(first + j));
    let top = node.start + first;
    for part in 0..LANES / S::F64_LANES {
        let mut known = [simd.splat_f64s(0.0); W];
        for i in 0..W {
            let target = &mut S::as_mut_simd_f64s(&mut x[top + i].0).0[part];
            let mut sum = *target;
            for j in 0..i {
                sum = simd.mul_add_f64s(simd.splat_f64s(-columns[j][first + i]), known[j], sum);
            }
            *target = sum;
            known[i] = sum;
        }
        let known = known.map(|v| simd.neg_f64s(v));
        let rest = &mut x[node.start..node.start + node.width][first + W..];
        for (i, row) in rest.iter_mut().enumerate() {
            let target = &mut S::as_mut_simd_f64s(&mut row.0).0[part];
            let mut sum = *target;
            for j in 0..W {
                sum = simd.mul_add_f64s(simd.splat_f64s(columns[j][first + W + i]), known[j], sum);
            }
            *target = sum;
        }
        let columns: [&[f64]; W] = std::array::from_fn(|j| &columns[j][node.width..][..node.below.len()]);
        for (i, &row) in node.below.iter().enumerate() {
            let target = &mut S::as_mut_simd_f64s(&mut x[row].0).0[part];
            let mut sum = *target;
            for j in 0..W {
                sum = simd.mul_add_f64s(simd.splat_f64s(columns[j][i]), known[j], sum);
            }
            *target = sum;
        }
    }
}

/// `L^(-T) D^(-1)` of W columns.
#[inline(always)]
fn backward_tile<S: Simd, const W: usize>(simd: S, node: &Supernode<'_>, first: usize, x: &mut [Lanes]) {
    let columns: [&[f64]; W] = std::array::from_fn(|j| node.column(first + j));
    let top = node.start + first;
    for part in 0..LANES / S::F64_LANES {
        let mut sums = [simd.splat_f64s(0.0); W];
        let below: [&[f64]; W] = std::array::from_fn(|j| &columns[j][node.width..][..node.below.len()]);
        for (i, &row) in node.below.iter().enumerate() {
            let source = S::as_simd_f64s(&x[row].0).0[part];
            for j in 0..W {
                sums[j] = simd.mul_add_f64s(simd.splat_f64s(below[j][i]), source, sums[j]);
            }
        }
        for i in first + W..node.width {
            let source = S::as_simd_f64s(&x[node.start + i].0).0[part];
            for j in 0..W {
                sums[j] = simd.mul_add_f64s(simd.splat_f64s(columns[j][i]), source, sums[j]);
            }
        }
        for i in (0..W).rev() {
            let pivot = simd.splat_f64s(1.0 / columns[i][first + i]);
            let target = &mut S::as_mut_simd_f64s(&mut x[top + i].0).0[part];
            let value = simd.sub_f64s(simd.mul_f64s(*target, pivot), sums[i]);
            *target = value;
            for j in 0..i {
                sums[j] = simd.mul_add_f64s(simd.splat_f64s(columns[j][first + i]), value, sums[j]);
            }
        }
    }
}

//! A coarse level: a sparse Laplacian W and masses M, and what a cycle does with blocks of vectors there, in single precision:
//! corrections are no more exact than a tenth.

use mser3d_laplace::Operator;
use mser3d_laplace::sprs::TriMat;
use mser3d_shape::Domain;
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use crate::SpectralError;
use crate::row::{LANES, Lanes, Short};

/// Rows that a thread treats at a time.
pub(super) const ROWS: usize = 1024;

/// One number for each column of a block.
pub(super) type Columns = [f32; LANES];

/// `W phi = lambda M phi` over aggregates of voxels, in units in which the largest link of the grid is 1 and so is the mass of a voxel.
pub(super) struct Level {
    /// Where the links of each row begin, and their number.
    starts: Vec<u32>,
    /// A neighbour, and how much of a difference flows to it.
    links: Vec<(u32, f32)>,
    /// The sum over the links of a row.
    diagonal: Vec<f32>,
    /// Voxels of a row.
    mass: Vec<f32>,
    /// The mass of all rows over the sum of the diagonal: how much less a smooth function's eigenvalue of `D^-1 W` is than that
    /// of `M^-1 W`.
    pub mass_over_diagonal: f64,
}

/// A link along an axis: a row, the one after it, and how much of a difference flows.
pub(super) type Link = (u32, u32, f32);

/// A step of Chebyshev's iteration: the next direction is `along` times the last one and `residual` times the residual over the
/// diagonal.
#[derive(Clone, Copy)]
pub(super) struct ChebyshevStep {
    pub along: Columns,
    pub residual: Columns,
}

impl Level {
    /// From masses and the links along each axis.
    pub fn new(mass: Vec<f32>, links: &[Vec<Link>; 3]) -> Self {
        let n = mass.len();
        let mut starts = vec![0u32; n + 1];
        for &(a, b, _) in links.iter().flatten() {
            starts[a as usize + 1] += 1;
            starts[b as usize + 1] += 1;
        }
        for row in 0..n {
            starts[row + 1] += starts[row];
        }
        let mut next = starts.clone();
        let mut all = vec![(0, 0.0); starts[n] as usize];
        let mut diagonal = vec![0.0; n];
        for &(a, b, flow) in links.iter().flatten() {
            for (a, b) in [(a, b), (b, a)] {
                all[next[a as usize] as usize] = (b, flow);
                next[a as usize] += 1;
                diagonal[a as usize] += flow;
            }
        }
        let sum = |of: &[f32]| of.iter().map(|&x| f64::from(x)).sum::<f64>();
        let mass_over_diagonal = sum(&mass) / sum(&diagonal);
        Self { starts, links: all, diagonal, mass, mass_over_diagonal }
    }

    pub fn len(&self) -> usize {
        self.mass.len()
    }

    pub fn mass(&self) -> &[f32] {
        &self.mass
    }

    /// As a matrix.
    pub fn operator(&self) -> Result<Operator, SpectralError> {
        let n = self.len();
        let mut entries = TriMat::with_capacity((n, n), self.links.len() + n);
        for row in 0..n {
            let links = self.links(row).iter().map(|&(u, flow)| (u as usize, f64::from(flow)));
            entries.add_triplet(row, row, links.clone().map(|(_, flow)| flow).sum());
            links.for_each(|(u, flow)| entries.add_triplet(row, u, -flow));
        }
        let mass = self.mass.iter().map(|&m| f64::from(m)).collect();
        Operator::new(Domain::Volume, entries.to_csc(), mass).map_err(|_| SpectralError::Overflow)
    }

    fn links(&self, row: usize) -> &[(u32, f32)] {
        &self.links[self.starts[row] as usize..self.starts[row + 1] as usize]
    }

    /// `y = W x`.
    pub fn apply(&self, x: &[Lanes], y: &mut [Lanes]) {
        rows(
            y,
            #[inline(always)]
            |row, y| {
                let mut sum = [0.0; LANES];
                for &(u, flow) in self.links(row) {
                    let (flow, own, other) = (f64::from(flow), &x[row].0, &x[u as usize].0);
                    (0..LANES).for_each(|l| sum[l] += flow * (own[l] - other[l]));
                }
                *y = Lanes(sum);
            },
        );
    }

    /// `(W - shift M) x` at a row.
    #[inline(always)]
    fn image(&self, x: &[Short], shift: &Columns, row: usize) -> Columns {
        let (diagonal, mass, own) = (self.diagonal[row], self.mass[row], &x[row].0);
        let mut sum: Columns = std::array::from_fn(|l| (diagonal - mass * shift[l]) * own[l]);
        for &(u, flow) in self.links(row) {
            let other = &x[u as usize].0;
            (0..LANES).for_each(|l| sum[l] -= flow * other[l]);
        }
        sum
    }

    /// `residual -= (W - shift M) x`.
    pub fn subtract_image(&self, x: &[Short], shift: &Columns, residual: &mut [Short]) {
        rows(
            residual,
            #[inline(always)]
            |row, r| {
                let image = self.image(x, shift, row);
                *r = Short(std::array::from_fn(|l| r.0[l] - image[l]));
            },
        );
    }

    /// Begins Chebyshev's iteration: `along = factor D^-1 residual`, by which d goes on.
    pub fn first_direction(
        &self,
        factor: &Columns,
        residual: &[Short],
        along: &mut [Short],
        d: &mut [Short],
    ) {
        let chunks = (along.par_chunks_mut(ROWS), d.par_chunks_mut(ROWS), residual.par_chunks(ROWS));
        chunks.into_par_iter().enumerate().for_each(|(chunk, (along, d, residual))| {
            pulp::Arch::new().dispatch(
                #[inline(always)]
                || {
                    for (i, ((p, d), r)) in along.iter_mut().zip(d).zip(residual).enumerate() {
                        let inverse = self.inverse(chunk * ROWS + i);
                        *p = Short(std::array::from_fn(|l| factor[l] * inverse * r.0[l]));
                        *d = Short(std::array::from_fn(|l| d.0[l] + p.0[l]));
                    }
                },
            );
        });
    }

    /// A step of Chebyshev's iteration: `residual -= (W - shift M) along`, the next direction, and d goes on by it.
    pub fn next_direction(
        &self,
        shift: &Columns,
        step: &ChebyshevStep,
        along: &[Short],
        next: &mut [Short],
        residual: &mut [Short],
        d: &mut [Short],
    ) {
        let chunks = (next.par_chunks_mut(ROWS), residual.par_chunks_mut(ROWS), d.par_chunks_mut(ROWS));
        chunks.into_par_iter().enumerate().for_each(|(chunk, (next, residual, d))| {
            pulp::Arch::new().dispatch(
                #[inline(always)]
                || {
                    for (i, ((q, r), d)) in next.iter_mut().zip(residual).zip(d).enumerate() {
                        let row = chunk * ROWS + i;
                        let (image, inverse) = (self.image(along, shift, row), self.inverse(row));
                        *r = Short(std::array::from_fn(|l| r.0[l] - image[l]));
                        let last = along[row].0;
                        *q = Short(std::array::from_fn(|l| {
                            step.along[l] * last[l] + step.residual[l] * inverse * r.0[l]
                        }));
                        *d = Short(std::array::from_fn(|l| d.0[l] + q.0[l]));
                    }
                },
            );
        });
    }

    /// 1 over the diagonal; 0 in a row without links.
    #[inline(always)]
    fn inverse(&self, row: usize) -> f32 {
        let diagonal = self.diagonal[row];
        if diagonal > 0.0 { 1.0 / diagonal } else { 0.0 }
    }
}

/// Does something with each row, chunk by chunk in parallel.
pub(super) fn rows<T: Send>(block: &mut [T], work: impl Fn(usize, &mut T) + Sync) {
    block.par_chunks_mut(ROWS).enumerate().for_each(|(chunk, rows)| {
        pulp::Arch::new().dispatch(EachRow { first: chunk * ROWS, rows, work: &work });
    });
}

/// Some rows from the first on, as pulp wants it: a closure that is called by another one would not be compiled for each
/// instruction set.
struct EachRow<'a, T, F> {
    first: usize,
    rows: &'a mut [T],
    work: &'a F,
}

impl<T, F: Fn(usize, &mut T)> WithSimd for EachRow<'_, T, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for (i, row) in self.rows.iter_mut().enumerate() {
            (self.work)(self.first + i, row);
        }
    }
}

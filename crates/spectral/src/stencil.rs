//! The seven-point stencil of a grid, laid out so that it runs through memory in order.

use std::cmp::Reverse;
use std::ops::Range;

use mser3d_laplace::GridStencil;
use mser3d_shape::VoxelGrid;
use pulp::Simd;

use crate::row::{Row, Vectors, vectors};

/// The grid Laplacian with its voxels reordered: slices across the solid's longest axis, in them lines along
/// the second longest.
///
/// Slices across the longest axis are the smallest, so that many fit in a cache. Long lines make long runs of
/// rows that are treated alike: no index is read for each row, and no row is loaded twice as a neighbour
/// along the line. That is what the time goes into, not the arithmetic.
pub(crate) struct SlicedStencil {
    runs: Vec<Run>,
    /// First run of each line, line by line of slice by slice, and the number of runs.
    line_starts: Vec<u32>,
    /// Lines of a slice.
    lines: usize,
    /// 1/h^2 along the line, across slices, and across lines of a slice.
    weights: [f64; 3],
    /// The voxel of each row.
    pub order: Vec<u32>,
    bound: f64,
}

/// Rows that are linked along their line, and whose neighbours across it follow each other as they do. A
/// missing neighbour is the row itself, as in [`GridStencil`].
#[derive(Clone, Copy)]
struct Run {
    start: u32,
    len: u32,
    /// The neighbour along the line of the first row, and of the last.
    ends: [u32; 2],
    /// The neighbours across the line of the first row.
    across: [u32; 4],
}

/// `y <- step.a A x + step.x x + step.previous y`: a step of a three-term recurrence.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub a: f64,
    pub x: f64,
    pub previous: f64,
}

impl SlicedStencil {
    pub fn new(grid: &VoxelGrid) -> Self {
        let stencil = GridStencil::new(grid);
        let dims = grid.frame().dims();
        let mut axes = [2, 1, 0];
        axes.sort_by_key(|&axis| Reverse(dims[axis]));
        let [across_slices, along, across] = axes;
        // Within a line the voxels come in their own order.
        let line = |v: [u32; 3]| v[across_slices] as usize * dims[across] + v[across] as usize;
        let mut next = vec![0u32; dims[across_slices] * dims[across] + 1];
        grid.voxels().for_each(|v| next[line(v) + 1] += 1);
        for i in 1..next.len() {
            next[i] += next[i - 1];
        }
        let (mut order, mut position) = (vec![0u32; grid.len()], vec![0u32; grid.len()]);
        for (v, voxel) in grid.voxels().enumerate() {
            let row = &mut next[line(voxel)];
            order[*row as usize] = v as u32;
            position[v] = *row;
            *row += 1;
        }
        // By now they are the ends of the lines.
        let line_ends = &next[..next.len() - 1];
        let (mut runs, mut line_starts): (Vec<Run>, Vec<u32>) = (Vec::new(), vec![0]);
        let mut row = 0;
        for &end in line_ends {
            while row < end {
                let around = stencil.neighbours()[order[row as usize] as usize].map(|u| position[u as usize]);
                let both = |axis: usize| [around[2 - axis], around[3 + axis]];
                let ([before, after], [a, b], [c, d]) = (both(along), both(across_slices), both(across));
                match runs.last_mut() {
                    Some(run) if before + 1 == row && run.across.map(|u| u + run.len) == [a, b, c, d] => {
                        run.len += 1;
                        run.ends[1] = after;
                    }
                    _ => runs.push(Run { start: row, len: 1, ends: [before, after], across: [a, b, c, d] }),
                }
                row += 1;
            }
            line_starts.push(runs.len() as u32);
        }
        let weights = [along, across_slices, across].map(|axis| stencil.weights()[axis]);
        Self { runs, line_starts, lines: dims[across], weights, order, bound: stencil.spectral_bound() }
    }

    /// Number of rows, n.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Upper bound of the spectrum.
    pub fn bound(&self) -> f64 {
        self.bound
    }

    /// Slices across the longest axis; neighbours lie in the same or the next one.
    pub fn slices(&self) -> usize {
        (self.line_starts.len() - 1) / self.lines
    }

    /// Lines of each slice; neighbours lie in the same or the next one. Some may be empty.
    pub fn lines(&self) -> usize {
        self.lines
    }

    /// First row of a slice, or the number of rows.
    pub fn first_row(&self, slice: usize) -> usize {
        let run = self.line_starts[slice * self.lines] as usize;
        self.runs.get(run).map_or(self.len(), |run| run.start as usize)
    }

    /// The runs of some lines of a slice.
    pub fn runs(&self, slice: usize, lines: Range<usize>) -> Range<usize> {
        let [start, end] = [lines.start, lines.end].map(|line| self.line_starts[slice * self.lines + line]);
        start as usize..end as usize
    }

    /// A step on the rows of some runs; x and y begin with row `base`.
    #[inline(always)]
    pub fn step<S: Simd, R: Row>(
        &self,
        simd: S,
        step: Step,
        x: &[R],
        y: &mut [R],
        runs: Range<usize>,
        base: usize,
    ) {
        let update = Update::new(simd, step, self.weights);
        for run in &self.runs[runs] {
            let len = run.len as usize;
            let rows = |first: u32| first as usize - base..first as usize - base + len;
            let (centres, targets) = (&x[rows(run.start)], &mut y[rows(run.start)]);
            let [a, b, c, d] = run.across.map(|first| &x[rows(first)]);
            let [first, last] = run.ends.map(|row| update.load(&x[row as usize - base]));
            let (mut before, mut centre) = (first, update.load(&centres[0]));
            for i in 0..len - 1 {
                let after = update.load(&centres[i + 1]);
                update.row([before, centre, after], [&a[i], &b[i], &c[i], &d[i]], &mut targets[i]);
                (before, centre) = (centre, after);
            }
            let i = len - 1;
            update.row([before, centre, last], [&a[i], &b[i], &c[i], &d[i]], &mut targets[i]);
        }
    }
}

/// A step as vectors.
struct Update<S: Simd> {
    simd: S,
    along: S::f64s,
    slices: S::f64s,
    across: S::f64s,
    diagonal: S::f64s,
    previous: S::f64s,
}

impl<S: Simd> Update<S> {
    #[inline(always)]
    fn new(simd: S, step: Step, weights: [f64; 3]) -> Self {
        let [along, slices, across] = weights.map(|w| simd.splat_f64s(-step.a * w));
        let diagonal = simd.splat_f64s(step.x + 2.0 * step.a * weights.iter().sum::<f64>());
        Self { simd, along, slices, across, diagonal, previous: simd.splat_f64s(step.previous) }
    }

    #[inline(always)]
    fn load<R: Row>(&self, row: &R) -> Vectors<S> {
        vectors(self.simd, &row.wide())
    }

    /// At a row with its neighbours along the line, and across it.
    #[inline(always)]
    fn row<R: Row>(&self, along: [Vectors<S>; 3], across: [&R; 4], target: &mut R) {
        let Self { simd, .. } = *self;
        let [before, centre, after] = along;
        let [a, b, c, d] = across.map(|row| self.load(row));
        let old = self.load(target);
        let mut row = target.wide();
        for (part, new) in S::as_mut_simd_f64s(&mut row.0).0.iter_mut().enumerate() {
            let sum = simd.mul_add_f64s(self.previous, old[part], simd.mul_f64s(self.diagonal, centre[part]));
            let sum = simd.mul_add_f64s(self.along, simd.add_f64s(before[part], after[part]), sum);
            let other = simd.mul_f64s(self.slices, simd.add_f64s(a[part], b[part]));
            let other = simd.mul_add_f64s(self.across, simd.add_f64s(c[part], d[part]), other);
            *new = simd.add_f64s(sum, other);
        }
        *target = R::narrow(row);
    }
}

//! Where grid lines cross triangles: rays along grid lines need no tree.
//!
//! A sweep along an axis scan-converts each triangle, seen along that axis, over the lattice of
//! grid lines with half-open intervals: a line belongs to a triangle when it lies at or beyond the
//! triangle's one edge and before the other. Columns and depths are computed in floating point with
//! an error bound; where the bound cannot decide, exact predicates do. The result is that of exact
//! arithmetic on the perturbed grid lines of [`crate::predicates`].

use crate::lattice::Lattice;
use crate::predicates::{orient2d, side};
use rayon::prelude::*;
use std::ops::Range;

/// A grid line passing through a triangle, in 8 bytes that sort by cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Crossing(u64);

impl Crossing {
    #[inline]
    fn new(cell: u32, triangle: u32, entering: bool) -> Self {
        Self(u64::from(cell) << 32 | u64::from(triangle) << 1 | u64::from(entering))
    }

    /// The first voxel centre beyond the crossing.
    #[inline]
    pub fn cell(self) -> usize {
        (self.0 >> 32) as usize
    }

    #[inline]
    pub fn triangle(self) -> usize {
        (self.0 as u32 >> 1) as usize
    }

    /// Whether the line goes in by the triangle's front: the winding number grows by one.
    #[inline]
    pub fn entering(self) -> bool {
        self.0 & 1 == 1
    }

    /// The change of the winding number: 1 or -1.
    #[inline]
    pub fn step(self) -> i32 {
        (self.0 & 1) as i32 * 2 - 1
    }
}

/// More triangles than this do not fit a [`Crossing`].
pub(crate) const MAX_TRIANGLES: usize = 1 << 31;

/// The axes of a sweep: columns along `u`, rows along `v`, depth along `d`. Always `u < v`, so that
/// the perturbation along u dominates the one along v.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axes {
    pub u: usize,
    pub v: usize,
    pub d: usize,
}

impl Axes {
    pub fn along(d: usize) -> Self {
        let (u, v) = [(1, 2), (0, 2), (0, 1)][d];
        Self { u, v, d }
    }
}

/// The triangles of a mesh sorted into slabs of rows, ready to be swept along one axis.
pub(crate) struct Sweep<'a> {
    lattice: &'a Lattice,
    vertices: &'a [[f64; 3]],
    triangles: &'a [[u32; 3]],
    axes: Axes,
    slab_rows: usize,
    /// Triangles that touch each slab, in one list for each chunk of the mesh.
    buckets: Vec<Vec<Vec<u32>>>,
}

/// The crossings of a slab, line by line; reused from slab to slab.
#[derive(Default)]
pub(crate) struct SlabLines {
    unsorted: Vec<(u32, Crossing)>,
    starts: Vec<u32>,
    crossings: Vec<Crossing>,
}

const CHUNK: usize = 1 << 14;

impl<'a> Sweep<'a> {
    pub fn new(
        lattice: &'a Lattice,
        vertices: &'a [[f64; 3]],
        triangles: &'a [[u32; 3]],
        axis: usize,
    ) -> Self {
        let axes = Axes::along(axis);
        let rows = lattice.dims[axes.v];
        // About 8192 lines a slab: their crossings stay in the cache, and there are slabs enough
        // for all threads.
        let slab_rows = (8192 / lattice.dims[axes.u].max(1)).clamp(1, rows.div_ceil(8).max(1));
        let slabs = rows.div_ceil(slab_rows);
        let mut sweep = Self { lattice, vertices, triangles, axes, slab_rows, buckets: Vec::new() };
        sweep.buckets = (0..triangles.len().div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let mut lists = vec![Vec::new(); slabs];
                for t in chunk * CHUNK..((chunk + 1) * CHUNK).min(triangles.len()) {
                    if let Some(rows) = sweep.rows(t) {
                        for slab in rows.start as usize / slab_rows..=(rows.end as usize - 1) / slab_rows {
                            lists[slab].push(t as u32);
                        }
                    }
                }
                lists
            })
            .collect();
        sweep
    }

    pub fn axes(&self) -> Axes {
        self.axes
    }

    /// Number of slabs.
    pub fn slabs(&self) -> usize {
        self.lattice.dims[self.axes.v].div_ceil(self.slab_rows)
    }

    /// The rows of a slab.
    pub fn slab_rows(&self, slab: usize) -> Range<usize> {
        let first = slab * self.slab_rows;
        first..(first + self.slab_rows).min(self.lattice.dims[self.axes.v])
    }

    /// Rows in each slab but perhaps the last.
    pub fn rows_per_slab(&self) -> usize {
        self.slab_rows
    }

    #[inline]
    fn corners(&self, triangle: usize) -> [[f64; 3]; 3] {
        self.triangles[triangle].map(|v| self.vertices[v as usize])
    }

    /// The rows in which a triangle may have crossings, if any.
    #[inline]
    fn rows(&self, triangle: usize) -> Option<Range<u32>> {
        let corners = self.corners(triangle);
        let range = |axis: usize| {
            let (low, high) = extremes([corners[0][axis], corners[1][axis], corners[2][axis]]);
            self.lattice.first_at_or_beyond(axis, low)..self.lattice.first_at_or_beyond(axis, high)
        };
        let rows = range(self.axes.v);
        (!rows.is_empty() && !range(self.axes.u).is_empty()).then_some(rows)
    }

    /// Calls `visit(u, v, crossings)` for each line of the slab that crosses the surface (or for `all`
    /// lines), the crossings in order of their cells.
    pub fn for_each_line(
        &self,
        slab: usize,
        lines: &mut SlabLines,
        all: bool,
        mut visit: impl FnMut(usize, usize, &[Crossing]),
    ) {
        let rows = self.slab_rows(slab);
        let columns = self.lattice.dims[self.axes.u];
        lines.unsorted.clear();
        for list in &self.buckets {
            for &t in &list[slab] {
                self.scan(t, rows.start as u32..rows.end as u32, &mut |u, v, crossing| {
                    let line = (v as usize - rows.start) * columns + u as usize;
                    lines.unsorted.push((line as u32, crossing));
                });
            }
        }
        lines.sort(rows.len() * columns);
        for line in 0..rows.len() * columns {
            let (start, end) = (lines.starts[line] as usize, lines.starts[line + 1] as usize);
            if all || start < end {
                visit(line % columns, rows.start + line / columns, &lines.crossings[start..end]);
            }
        }
    }

    /// The depth at which a line passes through a triangle, in grid units, up to rounding.
    pub fn depth(&self, triangle: usize, column: usize, row: usize) -> f64 {
        let plane = Depth::new(self.lattice, self.axes, &self.corners(triangle));
        plane.at(column as u32, row as u32)
    }

    /// Calls `emit(u, v, crossing)` for each grid line of these rows that passes through a triangle.
    #[inline]
    fn scan(&self, triangle: u32, rows: Range<u32>, emit: &mut impl FnMut(u32, u32, Crossing)) {
        let Axes { v, d, .. } = self.axes;
        let lattice = self.lattice;
        let corners = self.corners(triangle as usize);
        let first = corners.map(|p| lattice.first_at_or_beyond(v, p[v]));
        // Corners from the first row to the last; an odd permutation turns the triangle over.
        let (mut order, mut odd) = ([0, 1, 2], false);
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            if first[order[i]] > first[order[j]] {
                order.swap(i, j);
                odd = !odd;
            }
        }
        let [a, b, c] = order;
        let start = first[a].max(rows.start);
        let end = first[c].min(rows.end);
        if start >= end {
            return;
        }
        let middle = first[b].clamp(start, end);
        let depth = Depth::new(lattice, self.axes, &corners);
        let long = Edge::new(lattice, self.axes, &corners[a], &corners[c]);
        let mut half = |rows: Range<u32>, short: Edge| {
            for row in rows {
                let (x, y) = (long.column(lattice, self.axes, row), short.column(lattice, self.axes, row));
                if x == y {
                    continue;
                }
                // Counter-clockwise seen from +d when b lies beyond the long edge, once for each of:
                // an odd permutation, and the left-handed axes (x, z, y).
                let front_up = (x < y) ^ odd ^ (d == 1);
                for column in x.min(y)..x.max(y) {
                    let cell = depth.cell(lattice, self.axes, &corners, column, row, front_up);
                    emit(column, row, Crossing::new(cell, triangle, !front_up));
                }
            }
        };
        if start < middle {
            half(start..middle, Edge::new(lattice, self.axes, &corners[a], &corners[b]));
        }
        if middle < end {
            half(middle..end, Edge::new(lattice, self.axes, &corners[b], &corners[c]));
        }
    }
}

impl SlabLines {
    /// Counting sort by line, then each line's few crossings by cell.
    fn sort(&mut self, lines: usize) {
        self.starts.clear();
        self.starts.resize(lines + 1, 0);
        for &(line, _) in &self.unsorted {
            self.starts[line as usize] += 1;
        }
        let mut total = 0;
        for start in &mut self.starts {
            total += *start;
            *start = total;
        }
        self.crossings.resize(self.unsorted.len(), Crossing(0));
        for &(line, crossing) in self.unsorted.iter().rev() {
            let slot = &mut self.starts[line as usize];
            *slot -= 1;
            self.crossings[*slot as usize] = crossing;
        }
        for line in 0..lines {
            let (start, end) = (self.starts[line] as usize, self.starts[line + 1] as usize);
            if end - start > 1 {
                self.crossings[start..end].sort_unstable();
            }
        }
    }
}

/// An edge of a triangle seen along the sweep, from its lower to its upper end.
struct Edge {
    low: [f64; 2],
    high: [f64; 2],
    /// The lower end in grid units, the slope du/dv, and a bound on the error of a column.
    start: [f64; 2],
    slope: f64,
    error: f64,
    /// The column lies in this range, ends included.
    columns: [u32; 2],
}

impl Edge {
    #[inline]
    fn new(lattice: &Lattice, axes: Axes, low: &[f64; 3], high: &[f64; 3]) -> Self {
        let (low, high) = ([low[axes.u], low[axes.v]], [high[axes.u], high[axes.v]]);
        let start = [lattice.grid_units(axes.u, low[0]), lattice.grid_units(axes.v, low[1])];
        let end = [lattice.grid_units(axes.u, high[0]), lattice.grid_units(axes.v, high[1])];
        let slope = (end[0] - start[0]) / (end[1] - start[1]);
        let error = 32.0 * lattice.tolerance * (1.0 + slope.abs());
        let columns =
            [low[0].min(high[0]), low[0].max(high[0])].map(|x| lattice.first_at_or_beyond(axes.u, x));
        Self { low, high, start, slope, error, columns }
    }

    /// The first column at or beyond the edge in a row that the edge spans: exact.
    #[inline]
    fn column(&self, lattice: &Lattice, axes: Axes, row: u32) -> u32 {
        let x = self.start[0] + (f64::from(row) - self.start[1]) * self.slope;
        if let Some(column) = certain_ceiling(x, self.error) {
            return column.clamp(self.columns[0], self.columns[1]);
        }
        let height = lattice.centres[axes.v][row as usize];
        partition_point(self.columns[0]..self.columns[1], |column| {
            let point = [lattice.centres[axes.u][column as usize], height];
            orient2d(self.low, self.high, point) <= 0.0
        })
    }
}

/// The depth at which a triangle is crossed, as a plane in grid units.
struct Depth {
    anchor: [f64; 3],
    slope: [f64; 2],
    error: f64,
}

impl Depth {
    #[inline]
    fn new(lattice: &Lattice, axes: Axes, corners: &[[f64; 3]; 3]) -> Self {
        let [a, b, c] =
            corners.map(|p| [axes.u, axes.v, axes.d].map(|axis| lattice.grid_units(axis, p[axis])));
        let (p, q): ([f64; 3], [f64; 3]) =
            (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
        let normal = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
        let size = p.iter().chain(&q).fold(0.0f64, |m, x| m.max(x.abs()));
        let inverse = 1.0 / normal[2];
        // Rounded corners move the plane by at most this inside the triangle.
        let error = 128.0 * lattice.tolerance * size * size * inverse.abs();
        Self { anchor: a, slope: [-normal[0] * inverse, -normal[1] * inverse], error }
    }

    #[inline]
    fn at(&self, column: u32, row: u32) -> f64 {
        self.anchor[2]
            + (f64::from(column) - self.anchor[0]) * self.slope[0]
            + (f64::from(row) - self.anchor[1]) * self.slope[1]
    }

    /// The first centre beyond the triangle on a line that passes through it: exact.
    #[inline]
    fn cell(
        &self,
        lattice: &Lattice,
        axes: Axes,
        corners: &[[f64; 3]; 3],
        column: u32,
        row: u32,
        front_up: bool,
    ) -> u32 {
        let last = lattice.dims[axes.d] as u32;
        match certain_ceiling(self.at(column, row), self.error) {
            Some(cell) => cell.min(last),
            None => exact_cell(lattice, axes, corners, column, row, front_up),
        }
    }
}

#[cold]
fn exact_cell(
    lattice: &Lattice,
    axes: Axes,
    corners: &[[f64; 3]; 3],
    column: u32,
    row: u32,
    front_up: bool,
) -> u32 {
    let (low, high) = extremes(corners.map(|p| p[axes.d]));
    let first = lattice.first_at_or_beyond(axes.d, low);
    // A centre at the very top of the triangle may still count as below it.
    let last = (lattice.first_at_or_beyond(axes.d, high) + 1).min(lattice.dims[axes.d] as u32);
    let beyond = if front_up { 1 } else { -1 };
    partition_point(first..last, |cell| {
        let mut voxel = [0; 3];
        (voxel[axes.u], voxel[axes.v], voxel[axes.d]) = (column as usize, row as usize, cell as usize);
        side(corners, lattice.centre(voxel)) == beyond
    })
}

/// The smallest integer beyond x, clamped to u32, if x is further than `error` from any integer.
#[inline]
fn certain_ceiling(x: f64, error: f64) -> Option<u32> {
    if x < -1.0 {
        return (x + error < -1.0).then_some(0);
    }
    let above = x + 1.0;
    let ceiling = above as u32;
    let fraction = above - f64::from(ceiling);
    (fraction > error && 1.0 - fraction > error).then_some(ceiling)
}

/// The first number of the range for which a monotone condition holds, its end if none.
fn partition_point(range: Range<u32>, holds: impl Fn(u32) -> bool) -> u32 {
    let (mut low, mut high) = (range.start, range.end);
    while low < high {
        let middle = low + (high - low) / 2;
        if holds(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}

#[inline]
fn extremes(x: [f64; 3]) -> (f64, f64) {
    (x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]))
}

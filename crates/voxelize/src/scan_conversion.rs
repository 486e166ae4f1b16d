//! Where grid lines cross triangles: rays along grid lines need no tree.
//!
//! A sweep along an axis scan-converts each triangle, seen along that axis, over the lattice of
//! grid lines with half-open intervals: a line belongs to a triangle when it lies at or beyond the
//! triangle's one edge and before the other. Columns and depths are computed in floating point with
//! an error bound; where the bound cannot decide, exact predicates do. The result is that of exact
//! arithmetic on the perturbed grid lines of [`crate::predicates`].

use crate::centre_lattice::{CentreLattice, PlacedVertex, certain_ceiling};
use crate::predicates::{orient2d, side};
use std::ops::Range;

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

/// A grid line and a triangle that it passes through.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passage {
    pub column: u32,
    pub row: u32,
    /// The first centre beyond the triangle; the number of centres if there is none.
    pub cell: u32,
    /// Whether the line goes in by the triangle's front.
    pub entering: bool,
}

/// What scan conversion looks at: a lattice, and the vertices on it.
#[derive(Clone, Copy)]
pub(crate) struct ScanConverter<'a> {
    pub lattice: &'a CentreLattice,
    pub vertices: &'a [[f64; 3]],
    pub placed: &'a [PlacedVertex],
    pub axes: Axes,
}

impl ScanConverter<'_> {
    /// Calls `emit` for each grid line that passes through a triangle.
    #[inline]
    pub fn scan(&self, triangle: [u32; 3], mut emit: impl FnMut(Passage)) {
        let Axes { u, v, d } = self.axes;
        let placed = triangle.map(|i| &self.placed[i as usize]);
        let first = placed.map(|p| p.first[v]);
        let columns = placed.map(|p| p.first[u]);
        if first[0] == first[1] && first[1] == first[2]
            || columns[0] == columns[1] && columns[1] == columns[2]
        {
            return;
        }
        let ([a, b, c], odd) = ascending(first);
        let edge = |low: usize, high: usize| {
            Edge::new(self, [triangle[low], triangle[high]], [placed[low], placed[high]])
        };
        let (long, short) = (edge(a, c), [edge(a, b), edge(b, c)]);
        // Counter-clockwise seen from +d when b lies beyond the long edge, once for each of: an odd
        // permutation, and the left-handed axes (x, z, y).
        let turned = odd ^ (d == 1);
        let mut depth = None;
        for row in first[a]..first[c] {
            let (x, y) = (long.column(self, row), short[usize::from(row >= first[b])].column(self, row));
            let entering = (x < y) == turned;
            for column in x.min(y)..x.max(y) {
                let depth = depth.get_or_insert_with(|| Depth::new(self, placed));
                let cell = match certain_ceiling(depth.at(column, row), depth.error) {
                    Some(cell) => cell.min(self.lattice.dims[d] as u32),
                    None => self.exact_cell(triangle, column, row, entering),
                };
                emit(Passage { column, row, cell, entering });
            }
        }
    }

    /// The depth at which a line passes through a triangle, in grid units, up to rounding.
    pub fn depth(&self, triangle: [u32; 3], column: u32, row: u32) -> f64 {
        Depth::new(self, triangle.map(|i| &self.placed[i as usize])).at(column, row)
    }

    #[cold]
    fn exact_cell(&self, triangle: [u32; 3], column: u32, row: u32, entering: bool) -> u32 {
        let Axes { u, v, d } = self.axes;
        let corners = triangle.map(|i| self.vertices[i as usize]);
        let first = triangle.map(|i| self.placed[i as usize].first[d]);
        let low = first[0].min(first[1]).min(first[2]);
        // A centre at the very top of the triangle may still count as below it.
        let high = (first[0].max(first[1]).max(first[2]) + 1).min(self.lattice.dims[d] as u32);
        let beyond = if entering { -1 } else { 1 };
        partition_point(low..high, |cell| {
            let mut voxel = [0; 3];
            (voxel[u], voxel[v], voxel[d]) = (column as usize, row as usize, cell as usize);
            side(&corners, self.lattice.centre(voxel)) == beyond
        })
    }
}

/// The order of three rows from the first to the last, and whether it is an odd permutation; without
/// branches, which no processor would foresee.
#[inline]
fn ascending(rows: [u32; 3]) -> ([usize; 3], bool) {
    let [p, q, r]: [u64; 3] = std::array::from_fn(|i| u64::from(rows[i]) << 2 | i as u64);
    let (low, high) = (p.min(q), p.max(q));
    let order = [low.min(r), low.max(r).min(high), high.max(r)].map(|key| (key & 3) as usize);
    (order, order[1] != (order[0] + 1) % 3)
}

/// An edge of a triangle seen along the sweep, from its lower to its upper end.
struct Edge {
    ends: [u32; 2],
    /// The lower end in grid units, the slope du/dv, and a bound on the error of a column.
    start: [f64; 2],
    slope: f64,
    error: f64,
    /// The column lies in this range, ends included.
    columns: [u32; 2],
}

impl Edge {
    #[inline]
    fn new(space: &ScanConverter, ends: [u32; 2], placed: [&PlacedVertex; 2]) -> Self {
        let Axes { u, v, .. } = space.axes;
        let [low, high] = placed;
        let slope = (high.units[u] - low.units[u]) / (high.units[v] - low.units[v]);
        Self {
            ends,
            start: [low.units[u], low.units[v]],
            slope,
            error: 32.0 * space.lattice.tolerance * (1.0 + slope.abs()),
            columns: [low.first[u].min(high.first[u]), low.first[u].max(high.first[u])],
        }
    }

    /// The first column at or beyond the edge in a row that the edge spans: exact.
    #[inline]
    fn column(&self, space: &ScanConverter, row: u32) -> u32 {
        let x = self.start[0] + (f64::from(row) - self.start[1]) * self.slope;
        match certain_ceiling(x, self.error) {
            Some(column) => column.clamp(self.columns[0], self.columns[1]),
            None => self.exact_column(space, row),
        }
    }

    #[cold]
    fn exact_column(&self, space: &ScanConverter, row: u32) -> u32 {
        let Axes { u, v, .. } = space.axes;
        let [low, high] = self.ends.map(|i| space.vertices[i as usize]).map(|p| [p[u], p[v]]);
        let height = space.lattice.centres[v][row as usize];
        partition_point(self.columns[0]..self.columns[1], |column| {
            orient2d(low, high, [space.lattice.centres[u][column as usize], height]) <= 0.0
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
    fn new(space: &ScanConverter, placed: [&PlacedVertex; 3]) -> Self {
        let Axes { u, v, d } = space.axes;
        let [a, b, c] = placed.map(|p| [p.units[u], p.units[v], p.units[d]]);
        let (p, q): ([f64; 3], [f64; 3]) =
            (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
        let normal = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
        let size = p.iter().chain(&q).fold(0.0f64, |m, x| m.max(x.abs()));
        let inverse = 1.0 / normal[2];
        // Corners that are off by the tolerance move the plane by at most this inside the triangle.
        let error = 128.0 * space.lattice.tolerance * size * size * inverse.abs();
        Self { anchor: a, slope: [-normal[0] * inverse, -normal[1] * inverse], error }
    }

    #[inline]
    fn at(&self, column: u32, row: u32) -> f64 {
        self.anchor[2]
            + (f64::from(column) - self.anchor[0]) * self.slope[0]
            + (f64::from(row) - self.anchor[1]) * self.slope[1]
    }
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

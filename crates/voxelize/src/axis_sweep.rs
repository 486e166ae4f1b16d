//! All crossings of a surface with the grid lines along one axis, line by line.

use crate::cancel::Stop;
use crate::centre_lattice::{CentreLattice, PlacedVertex};
use crate::scan_conversion::{Axes, ScanConverter};
use rayon::prelude::*;
use std::ops::Range;

/// A grid line passing through a triangle, in 8 bytes that sort by cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Crossing(u64);

impl Crossing {
    #[inline]
    pub fn new(cell: u32, triangle: u32, entering: bool) -> Self {
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

/// The crossings along one axis, in slabs of rows.
pub(crate) struct AxisSweep<'a> {
    converter: ScanConverter<'a>,
    triangles: &'a [[u32; 3]],
    slab_rows: usize,
    /// For each chunk of the mesh and each slab: line within the slab, and crossing.
    lists: Vec<Vec<Vec<(u32, Crossing)>>>,
    stop: &'a Stop<'a>,
}

/// The crossings of a slab in the order of their lines; reused from slab to slab.
#[derive(Default)]
pub(crate) struct SlabLines {
    starts: Vec<u32>,
    crossings: Vec<Crossing>,
}

/// Triangles that one task scans.
const CHUNK: usize = 1 << 13;
/// Lines in a slab: their crossings stay in the cache, and there are slabs enough for all threads.
const SLAB_LINES: usize = 1 << 13;

impl<'a> AxisSweep<'a> {
    /// Finds all crossings. Cost: O(triangles + crossings); 12 bytes a crossing.
    pub fn new(
        lattice: &'a CentreLattice,
        vertices: &'a [[f64; 3]],
        placed: &'a [PlacedVertex],
        triangles: &'a [[u32; 3]],
        axis: usize,
        stop: &'a Stop<'a>,
    ) -> Self {
        let axes = Axes::along(axis);
        let converter = ScanConverter { lattice, vertices, placed, axes };
        let (width, rows) = (lattice.dims[axes.u], lattice.dims[axes.v]);
        let slab_rows = (SLAB_LINES / width.max(1)).clamp(1, rows.div_ceil(8).max(1));
        // A power of two spares a division for each crossing.
        let shift = slab_rows.ilog2();
        let slab_rows = 1 << shift;
        let slabs = rows.div_ceil(slab_rows);
        let lists = triangles
            .par_chunks(CHUNK)
            .enumerate()
            .map(|(chunk, triangles)| {
                let mut lists = vec![Vec::new(); slabs];
                if stop.now() {
                    return lists;
                }
                for (number, &triangle) in triangles.iter().enumerate() {
                    let number = (chunk * CHUNK + number) as u32;
                    converter.scan(triangle, |p| {
                        let (slab, row) = (p.row as usize >> shift, p.row as usize & (slab_rows - 1));
                        let line = row * width + p.column as usize;
                        lists[slab].push((line as u32, Crossing::new(p.cell, number, p.entering)));
                    });
                }
                lists
            })
            .collect();
        Self { converter, triangles, slab_rows, lists, stop }
    }

    pub fn axes(&self) -> Axes {
        self.converter.axes
    }

    /// Number of slabs.
    pub fn slabs(&self) -> usize {
        self.converter.lattice.dims[self.axes().v].div_ceil(self.slab_rows)
    }

    /// The rows of a slab.
    pub fn slab_rows(&self, slab: usize) -> Range<usize> {
        let first = slab * self.slab_rows;
        first..(first + self.slab_rows).min(self.converter.lattice.dims[self.axes().v])
    }

    /// Rows in each slab but perhaps the last.
    pub fn rows_per_slab(&self) -> usize {
        self.slab_rows
    }

    /// The depth at which a line passes through a triangle, in grid units, up to rounding.
    pub fn depth(&self, triangle: usize, column: usize, row: usize) -> f64 {
        self.converter.depth(self.triangles[triangle], column as u32, row as u32)
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
        if self.stop.now() {
            return;
        }
        let rows = self.slab_rows(slab);
        let width = self.converter.lattice.dims[self.axes().u];
        lines.sort(rows.len() * width, &self.lists, slab);
        for v in rows.clone() {
            for u in 0..width {
                let line = (v - rows.start) * width + u;
                let (start, end) = (lines.starts[line] as usize, lines.starts[line + 1] as usize);
                if all || start < end {
                    let crossings = &mut lines.crossings[start..end];
                    crossings.sort_unstable();
                    visit(u, v, crossings);
                }
            }
        }
    }
}

impl SlabLines {
    /// Counting sort by line.
    fn sort(&mut self, lines: usize, lists: &[Vec<Vec<(u32, Crossing)>>], slab: usize) {
        self.starts.clear();
        self.starts.resize(lines + 1, 0);
        for &(line, _) in lists.iter().flat_map(|chunk| &chunk[slab]) {
            self.starts[line as usize] += 1;
        }
        let mut total = 0;
        for start in &mut self.starts {
            total += *start;
            *start = total;
        }
        self.crossings.resize(total as usize, Crossing(0));
        for &(line, crossing) in lists.iter().flat_map(|chunk| &chunk[slab]) {
            let slot = &mut self.starts[line as usize];
            *slot -= 1;
            self.crossings[*slot as usize] = crossing;
        }
    }
}

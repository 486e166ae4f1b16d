//! The winding number of open shells: an integer that columns give, less that of the caps.

use crate::bvh::{COARSE_ERROR, NEGLIGIBLE, ROUGHLY_NEGLIGIBLE, WindingTree};
use crate::cancel::Stop;
use crate::centre_lattice::CentreLattice;
use crate::surface::Surface;
use mser3d_shape::BoundingBox;
use mser3d_shape::vector::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Where the caps of open shells matter, and what they add there.
///
/// A shell and its caps form a closed chain of integer winding number n, so the shell alone has
/// `w = n - w(caps)`, exactly. The caps are few, and only near holes can they move w across 1/2: all
/// over a block of voxels where a bound certifies |w(caps)| < 1/2 - `UNCLEAR`, n decides; cubes of blocks are tried first. In the
/// other blocks w(caps) is evaluated roughly for each voxel, with a bound of its error, and precisely where that leaves a doubt.
pub(crate) struct HoleCorrections {
    /// The open shells.
    shells: Vec<u32>,
    /// Rows of blocks along x in a layer.
    rows: usize,
    /// First marked block of each row, and the number of them.
    starts: Vec<u32>,
    /// The place of each marked block in its row.
    columns: Vec<u32>,
    /// What to add to n, in steps of `STEP`: by marked block, then shell, then voxel.
    values: Vec<i16>,
}

/// A winding number this close to 1/2 or 3/2 is ambiguous.
pub(crate) const UNCLEAR: f64 = 0.2;
/// Voxels along the edge of a block.
pub(crate) const BLOCK: usize = 4;
/// Blocks along the edge of a cube, a power of two.
const CUBE: usize = 16;
/// Voxels in a block.
const VOLUME: usize = BLOCK * BLOCK * BLOCK;
/// More winding numbers of a block than this close to a half are no boundary that passes through.
const PLATEAU: usize = VOLUME / 4;
/// Blocks that are looked at to foretell the work.
const SAMPLE: usize = 3000;
/// Far finer than the error of the evaluation. Values reach +-8; beyond that they only need to be large.
const STEP: f64 = 1.0 / 4096.0;

/// What an open shell adds to its integer winding number: less its caps, or all of a scattered shell's
/// triangles.
struct Part {
    shell: u32,
    sign: f64,
    tree: WindingTree,
}

impl HoleCorrections {
    /// `None` when every shell is closed.
    pub fn new(surface: &Surface, lattice: &CentreLattice, stop: &Stop) -> Option<Self> {
        let parts = parts(surface);
        if parts.is_empty() {
            return None;
        }
        let blocks = lattice.dims.map(|n| n.div_ceil(BLOCK));
        let marked = marked_blocks(&parts, lattice, blocks, stop);
        // What the bound could not tell, the values do.
        let bound = (0.5 - UNCLEAR) / parts.len() as f64 - COARSE_ERROR;
        let matters = |value: &i16| f64::from(*value).abs() * STEP >= bound;
        let evaluate = |&[row, column]: &[u32; 2]| {
            let block = [column as usize, row as usize % blocks[1], row as usize / blocks[1]];
            let mut values = vec![0; parts.len() * VOLUME];
            let points = centres(lattice, block);
            let target = bounds(lattice, block, block);
            // Roughly first: most matter nowhere.
            let small = |part: &Part| {
                let (found, error) = part.tree.winding_numbers(&target, &points, ROUGHLY_NEGLIGIBLE);
                found.into_iter().all(|w| w.abs() + error < bound)
            };
            if stop.now() || parts.iter().all(small) {
                return None;
            }
            for (values, part) in values.chunks_mut(VOLUME).zip(&parts) {
                part.evaluate(&target, &points, values);
            }
            values.iter().any(matters).then_some(([row, column], values))
        };
        let found: Vec<_> = marked.par_iter().filter_map(evaluate).collect();
        let mut starts = vec![0; blocks[1] * blocks[2] + 1];
        found.iter().for_each(|([row, _], _)| starts[*row as usize + 1] += 1);
        (1..starts.len()).for_each(|row| starts[row] += starts[row - 1]);
        Some(Self {
            shells: parts.iter().map(|p| p.shell).collect(),
            rows: blocks[1],
            starts,
            columns: found.iter().map(|([_, column], _)| *column).collect(),
            values: found.into_iter().flat_map(|(_, values)| values).collect(),
        })
    }

    /// The marked blocks of the row through these voxels of a line, by their columns; the first one's place.
    #[inline]
    fn row(&self, [j, k]: [usize; 2]) -> (usize, &[u32]) {
        let row = k / BLOCK * self.rows + j / BLOCK;
        let (start, end) = (self.starts[row] as usize, self.starts[row + 1] as usize);
        (start, &self.columns[start..end])
    }

    /// The marked blocks that a run of voxels along x passes through: their places, and the voxels in them.
    #[inline]
    pub fn along(&self, run: Range<usize>, line: [usize; 2]) -> impl Iterator<Item = (usize, Range<usize>)> {
        let (start, columns) = self.row(line);
        let first = columns.partition_point(|&column| (column as usize + 1) * BLOCK <= run.start);
        let voxels = move |column: u32| {
            let from = column as usize * BLOCK;
            from.max(run.start)..(from + BLOCK).min(run.end)
        };
        let blocks = columns[first..].iter().map(move |&column| voxels(column));
        (start + first..).zip(blocks).take_while(|(_, voxels)| !voxels.is_empty())
    }

    /// The place of a voxel's block, if the caps may matter there.
    pub fn place(&self, [i, j, k]: [usize; 3]) -> Option<usize> {
        let (start, columns) = self.row([j, k]);
        Some(start + columns.binary_search(&((i / BLOCK) as u32)).ok()?)
    }

    /// What to add to the integer winding number of each open shell at a voxel of the marked block at this place.
    pub fn corrections(&self, place: usize, voxel: [usize; 3]) -> impl Iterator<Item = (u32, f64)> + '_ {
        let [i, j, k] = voxel.map(|x| x % BLOCK);
        let first = place * self.shells.len() * VOLUME + (k * BLOCK + j) * BLOCK + i;
        let value = move |b: usize| f64::from(self.values[first + b * VOLUME]) * STEP;
        self.shells.iter().enumerate().map(move |(b, &shell)| (shell, value(b)))
    }
}

impl Part {
    /// The values at a block's voxels.
    fn evaluate(&self, target: &BoundingBox, points: &[Vec3; VOLUME], values: &mut [i16]) {
        let (found, _) = self.tree.winding_numbers(target, points, NEGLIGIBLE);
        // Where they are a half all over, as in a soup, no precision makes a surface of them.
        let plateau = found.iter().filter(|w| WindingTree::is_close(**w)).count() > PLATEAU;
        for ((value, &winding), &point) in values.iter_mut().zip(&found).zip(points) {
            let winding = if plateau { winding } else { self.tree.decided(point, winding) };
            // Rounded upwards: what is more than a half stays more than a half.
            *value = (self.sign * winding / STEP).ceil() as i16;
        }
    }
}

/// About how many solid angles the winding numbers of a whole grid take, counted for some of its blocks.
pub(crate) fn winding_work(surface: &Surface, lattice: &CentreLattice) -> f64 {
    let parts = parts(surface);
    let blocks = lattice.dims.map(|n| n.div_ceil(BLOCK));
    let count: usize = blocks.iter().product();
    if parts.is_empty() || count == 0 {
        return 0.0;
    }
    // Steps that share no factor with the blocks in a row, so that the sample is spread over the box.
    let step = (count / SAMPLE).max(1) | 1;
    let sample: Vec<usize> = (0..count).step_by(step).collect();
    let work = |&i: &usize| {
        let block = [i % blocks[0], i / blocks[0] % blocks[1], i / blocks[0] / blocks[1]];
        let target = bounds(lattice, block, block);
        let bound = (0.5 - UNCLEAR) / parts.len() as f64;
        if parts.iter().all(|part| part.tree.is_below(bound, &target)) {
            return 0.0;
        }
        parts.iter().map(|part| part.tree.work(&target)).sum::<f64>() * VOLUME as f64
    };
    // To find out whether a block matters costs something too.
    let each = sample.iter().map(work).sum::<f64>() / sample.len() as f64;
    (each + 5.0 * parts.len() as f64) * count as f64
}

/// Row and column of the blocks where the caps may matter, ascending. Whole cubes of blocks where they don't are left out at once.
fn marked_blocks(parts: &[Part], lattice: &CentreLattice, blocks: [usize; 3], stop: &Stop) -> Vec<[u32; 2]> {
    let bound = (0.5 - UNCLEAR) / parts.len() as f64;
    let cubes = blocks.map(|n| n.div_ceil(CUBE));
    let in_cube = |i: usize| {
        let cube = [i % cubes[0], i / cubes[0] % cubes[1], i / cubes[0] / cubes[1]];
        let mut marked = Vec::new();
        let mut waiting = vec![(cube.map(|x| x * CUBE), CUBE)];
        while let Some((first, size)) = waiting.pop().filter(|_| !stop.now()) {
            let last: [usize; 3] = std::array::from_fn(|a| (first[a] + size).min(blocks[a]) - 1);
            let target = bounds(lattice, first, last);
            if parts.iter().all(|part| part.tree.is_below(bound, &target)) {
                continue;
            }
            if size == 1 {
                marked.push([(first[2] * blocks[1] + first[1]) as u32, first[0] as u32]);
                continue;
            }
            let half = size / 2;
            let corner =
                |c: usize| std::array::from_fn(|a| first[a] + if c >> a & 1 == 1 { half } else { 0 });
            let inside = |corner: &[usize; 3]| (0..3).all(|a| corner[a] < blocks[a]);
            waiting.extend((0..8).map(corner).filter(inside).map(|corner| (corner, half)));
        }
        marked
    };
    let mut marked: Vec<[u32; 2]> =
        (0..cubes.iter().product()).into_par_iter().flat_map_iter(in_cube).collect();
    marked.sort_unstable();
    marked
}

/// The centres of a block's voxels; those beyond the grid's end are never looked at.
fn centres(lattice: &CentreLattice, block: [usize; 3]) -> [Vec3; VOLUME] {
    let place = |v: usize| {
        let offset = [v % BLOCK, v / BLOCK % BLOCK, v / BLOCK / BLOCK];
        lattice.centre(std::array::from_fn(|a| (block[a] * BLOCK + offset[a]).min(lattice.dims[a] - 1)))
    };
    std::array::from_fn(place)
}

/// The box around the centres of the voxels from one block to another.
fn bounds(lattice: &CentreLattice, first: [usize; 3], last: [usize; 3]) -> BoundingBox {
    let end = |a: usize| (last[a] * BLOCK + BLOCK - 1).min(lattice.dims[a] - 1);
    BoundingBox {
        min: std::array::from_fn(|a| lattice.centres[a][first[a] * BLOCK]),
        max: std::array::from_fn(|a| lattice.centres[a][end(a)]),
    }
}

fn parts(surface: &Surface) -> Vec<Part> {
    if surface.closed() {
        return Vec::new();
    }
    let mut corners = vec![Vec::new(); surface.shells.len()];
    for t in 0..surface.triangles.len() {
        let shell = surface.shell_of(t);
        let info = &surface.shells[shell];
        if !info.closed && info.scattered == (t < surface.caps) {
            corners[shell].push(surface.corners(t));
        }
    }
    let part = |(shell, corners): (usize, Vec<[Vec3; 3]>)| Part {
        shell: shell as u32,
        sign: if surface.shells[shell].scattered { 1.0 } else { -1.0 },
        tree: WindingTree::over(corners),
    };
    corners.into_iter().enumerate().filter(|c| !c.1.is_empty()).map(part).collect()
}

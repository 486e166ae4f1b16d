//! The winding number of open shells: an integer that columns give, less that of the caps.

use crate::bvh::WindingTree;
use crate::cancel::Stop;
use crate::centre_lattice::CentreLattice;
use crate::surface::Surface;
use mser3d_shape::BoundingBox;
use mser3d_shape::vector::Vec3;
use rayon::prelude::*;

/// Where the caps of open shells matter, and what they add there.
///
/// A shell and its caps form a closed chain of integer winding number n, so the shell alone has
/// `w = n - w(caps)`, exactly. The caps are few, and only near holes can they move w across 1/2: all
/// over a block of voxels where a bound certifies |w(caps)| < 1/2 - `UNCLEAR`, n decides. In the other blocks
/// w(caps) is evaluated once for each voxel.
pub(crate) struct HoleCorrections {
    /// The open shells.
    shells: Vec<u32>,
    blocks: [usize; 3],
    /// The place of each block's values, or `UNMARKED`.
    places: Vec<u32>,
    /// What to add to n, in steps of `STEP`: by block, then shell, then voxel.
    values: Vec<i16>,
}

/// A winding number this close to 1/2 or 3/2 is ambiguous.
pub(crate) const UNCLEAR: f64 = 0.2;
/// Voxels along the edge of a block.
pub(crate) const BLOCK: usize = 4;
/// Voxels in a block.
const VOLUME: usize = BLOCK * BLOCK * BLOCK;
/// More winding numbers of a block than this close to a half are no boundary that passes through.
const PLATEAU: usize = VOLUME / 4;
/// Blocks that are looked at to foretell the work.
const SAMPLE: usize = 3000;
const UNMARKED: u32 = u32::MAX;
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
        let block = |i: usize| [i % blocks[0], i / blocks[0] % blocks[1], i / blocks[0] / blocks[1]];
        let matters = |i: usize| {
            let target = bounds(lattice, block(i));
            let bound = (0.5 - UNCLEAR) / parts.len() as f64;
            !parts.iter().all(|part| part.tree.is_below(bound, &target))
        };
        let marked: Vec<usize> =
            (0..blocks.iter().product()).into_par_iter().filter(|&i| !stop.now() && matters(i)).collect();
        let mut values = vec![0; marked.len() * parts.len() * VOLUME];
        values.par_chunks_mut(parts.len() * VOLUME).zip(&marked).for_each(|(values, &i)| {
            for (values, part) in values.chunks_mut(VOLUME).zip(&parts).filter(|_| !stop.now()) {
                part.evaluate(lattice, block(i), values);
            }
        });
        let mut places = vec![UNMARKED; blocks.iter().product()];
        for (place, &i) in marked.iter().enumerate() {
            places[i] = place as u32;
        }
        Some(Self { shells: parts.iter().map(|p| p.shell).collect(), blocks, places, values })
    }

    fn place(&self, voxel: [usize; 3]) -> u32 {
        let [i, j, k] = voxel.map(|x| x / BLOCK);
        self.places[(k * self.blocks[1] + j) * self.blocks[0] + i]
    }

    /// Whether the caps may matter at a voxel.
    #[inline]
    pub fn is_marked(&self, voxel: [usize; 3]) -> bool {
        self.place(voxel) != UNMARKED
    }

    /// What to add to the integer winding number of each open shell at a marked voxel.
    pub fn corrections(&self, voxel: [usize; 3]) -> impl Iterator<Item = (u32, f64)> + '_ {
        let [i, j, k] = voxel.map(|x| x % BLOCK);
        let first = self.place(voxel) as usize * self.shells.len() * VOLUME + (k * BLOCK + j) * BLOCK + i;
        let value = move |b: usize| f64::from(self.values[first + b * VOLUME]) * STEP;
        self.shells.iter().enumerate().map(move |(b, &shell)| (shell, value(b)))
    }
}

impl Part {
    /// The values of a block's voxels; those beyond the grid's end are never read.
    fn evaluate(&self, lattice: &CentreLattice, block: [usize; 3], values: &mut [i16]) {
        let target = bounds(lattice, block);
        let place = |v: usize| {
            let offset = [v % BLOCK, v / BLOCK % BLOCK, v / BLOCK / BLOCK];
            lattice.centre(std::array::from_fn(|a| (block[a] * BLOCK + offset[a]).min(lattice.dims[a] - 1)))
        };
        let points: [Vec3; VOLUME] = std::array::from_fn(place);
        let found = self.tree.winding_numbers(&target, &points);
        // Where they are a half all over, as in a soup, no precision makes a surface of them.
        let plateau = found.iter().filter(|w| WindingTree::is_close(**w)).count() > PLATEAU;
        for ((value, &winding), &point) in values.iter_mut().zip(&found).zip(&points) {
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
        let target = bounds(lattice, block);
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

/// The box around the centres of a block's voxels.
fn bounds(lattice: &CentreLattice, block: [usize; 3]) -> BoundingBox {
    let end = |a: usize| (block[a] * BLOCK + BLOCK - 1).min(lattice.dims[a] - 1);
    BoundingBox {
        min: std::array::from_fn(|a| lattice.centres[a][block[a] * BLOCK]),
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

//! All pixels of an image or voxels of a volume, with neighbours by offsets: no graph is made.
use std::ops::Range;

use mser3d_shape::{Bits, Connectivity};

use super::{Topology, lower, split_evenly};
use crate::{GreyValue, TreeError};

/// All steps to neighbours, by ascending vertex number.
fn steps(connectivity: Connectivity) -> impl Iterator<Item = [i32; 3]> {
    let allowed = move |[x, y, z]: [i32; 3]| match (connectivity, x.abs() + y.abs() + z.abs()) {
        (_, distance @ 0..=1) => distance == 1,
        (Connectivity::Six, _) => false,
        (Connectivity::TwentySix, _) => true,
    };
    let slice = |z| (-1..=1).flat_map(move |y| (-1..=1).map(move |x| [x, y, z]));
    (-1..=1).flat_map(slice).filter(move |&step| allowed(step))
}

/// All voxels of a box, x fastest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DenseGrid {
    dims: [usize; 3],
    connectivity: Connectivity,
}

impl DenseGrid {
    /// # Errors
    /// [`TreeError::TooMany`] beyond 2^31 - 1 voxels.
    pub fn new(dims: [usize; 3], connectivity: Connectivity) -> Result<Self, TreeError> {
        let count = dims.iter().fold(1u128, |a, &d| a.saturating_mul(d as u128));
        crate::build::check_limit("voxels in the grid", count)?;
        Ok(Self { dims, connectivity })
    }

    /// The steps possible from a row, as offsets of vertex numbers and as steps along x.
    fn row_steps(&self, row: usize) -> Vec<(isize, i32)> {
        let [nx, ny, nz] = self.dims;
        let (j, k) = (row % ny, row / ny);
        let fits = |at: usize, step: i32, n: usize| (0..n as i64).contains(&(at as i64 + i64::from(step)));
        let inside = |s: &[i32; 3]| fits(j, s[1], ny) && fits(k, s[2], nz);
        let offset =
            |s: [i32; 3]| ((s[2] as isize * ny as isize + s[1] as isize) * nx as isize + s[0] as isize, s[0]);
        steps(self.connectivity).filter(inside).map(offset).collect()
    }

    /// Calls `f` with each row of the range and its steps, which are the same along a row.
    fn rows(&self, range: Range<usize>, mut f: impl FnMut(Range<usize>, &[(isize, i32)])) {
        let [nx, ny, _] = self.dims;
        let border = |row: usize| {
            let (j, k) = (row % ny, row / ny);
            [j == 0, j + 1 == ny, k == 0, k + 1 == self.dims[2]]
        };
        let mut known: Option<([bool; 4], Vec<(isize, i32)>)> = None;
        for row in range.start / nx..range.end.div_ceil(nx) {
            if known.as_ref().is_none_or(|(at, _)| *at != border(row)) {
                known = Some((border(row), self.row_steps(row)));
            }
            if let Some((_, steps)) = &known {
                f(row * nx..(row + 1) * nx, steps);
            }
        }
    }
}

/// The least of a vertex and its neighbours at both ends of a row.
fn least_at_border<V: GreyValue, const DOWN: bool>(
    values: &[V],
    v: usize,
    steps: impl Iterator<Item = isize>,
) -> u32 {
    let mut best = v;
    for w in steps.map(|o| v.wrapping_add_signed(o)) {
        if lower::<V, DOWN>(values[w], values[best]) || values[w] == values[best] && w < best {
            best = w;
        }
    }
    best as u32
}

/// The same for all of `range`, from which all `K` offsets lead inside; the first half of them lead back,
/// from near to far, the others forward, from near to far. So ties go to the smaller number without
/// comparing numbers.
#[inline(always)]
fn least_inside<V: GreyValue, const DOWN: bool, const K: usize>(
    values: &[V],
    range: Range<usize>,
    offsets: [isize; K],
    f: &mut impl FnMut(u32, u32),
) {
    const BLOCK: usize = 64;
    let mut steps = [0; 32];
    steps[1..=K].copy_from_slice(&offsets);
    for start in range.clone().step_by(BLOCK) {
        let len = BLOCK.min(range.end - start);
        let shifted = |o: isize| &values[start.wrapping_add_signed(o)..][..len];
        let (centre, around) = (shifted(0), offsets.map(shifted));
        let mut best = [V::Step::from(0); BLOCK];
        // A loop without calls and branches: it is done in vector registers.
        for i in 0..len {
            let (mut step, mut least) = (V::Step::from(0), centre[i]);
            for k in 0..K {
                let x = around[k][i];
                let takes = if k < K / 2 { !lower::<V, DOWN>(least, x) } else { lower::<V, DOWN>(x, least) };
                step = if takes { V::Step::from(k as u8 + 1) } else { step };
                least = if takes { x } else { least };
            }
            best[i] = step;
        }
        for (v, &step) in (start..).zip(&best[..len]) {
            f(v as u32, v.wrapping_add_signed(steps[V::index(step) & 31]) as u32);
        }
    }
}

impl Topology for DenseGrid {
    fn len(&self) -> usize {
        self.dims.iter().product()
    }

    fn split(&self, parts: usize) -> Vec<Range<usize>> {
        split_evenly(self.len(), self.dims[0], parts)
    }

    fn visit(&self, range: Range<usize>, mut f: impl FnMut(u32, &[u32])) {
        let nx = self.dims[0];
        let mut neighbours = Vec::with_capacity(26);
        self.rows(range, |row, steps| {
            let six: Option<[isize; 6]> = (steps.len() == 6).then(|| std::array::from_fn(|k| steps[k].0));
            for (i, v) in row.enumerate() {
                // Inside, most vertices of most grids, nothing is to be checked.
                if let Some(offsets) = six
                    && i > 0
                    && i + 1 < nx
                {
                    f(v as u32, &offsets.map(|o| v.wrapping_add_signed(o) as u32));
                    continue;
                }
                neighbours.clear();
                let inside = |step: &&(isize, i32)| (0..nx as i64).contains(&(i as i64 + i64::from(step.1)));
                neighbours.extend(steps.iter().filter(inside).map(|s| v.wrapping_add_signed(s.0) as u32));
                f(v as u32, &neighbours);
            }
        });
    }

    fn descend<V: GreyValue, const DOWN: bool>(
        &self,
        range: Range<usize>,
        values: &[V],
        mut f: impl FnMut(u32, u32),
    ) {
        let nx = self.dims[0];
        self.rows(range, |row, steps| {
            let first = steps.iter().filter(|s| s.1 >= 0 && (nx > 1 || s.1 == 0)).map(|s| s.0);
            f(row.start as u32, least_at_border::<V, DOWN>(values, row.start, first));
            if nx > 2 {
                let inner = row.start + 1..row.end - 1;
                let back = steps.iter().filter(|s| s.0 < 0).count();
                // Back steps from near to far, then forward ones.
                let at = |k: usize| if k < back { steps[back - 1 - k].0 } else { steps[k].0 };
                match (steps.len(), back) {
                    (6, 3) => least_inside::<V, DOWN, 6>(values, inner, std::array::from_fn(at), &mut f),
                    (26, 13) => least_inside::<V, DOWN, 26>(values, inner, std::array::from_fn(at), &mut f),
                    (4, 2) => least_inside::<V, DOWN, 4>(values, inner, std::array::from_fn(at), &mut f),
                    (8, 4) => least_inside::<V, DOWN, 8>(values, inner, std::array::from_fn(at), &mut f),
                    _ => {
                        for v in inner {
                            let all = steps.iter().map(|s| s.0);
                            f(v as u32, least_at_border::<V, DOWN>(values, v, all));
                        }
                    }
                }
            }
            if nx > 1 {
                let last = steps.iter().filter(|s| s.1 <= 0).map(|s| s.0);
                f(row.end as u32 - 1, least_at_border::<V, DOWN>(values, row.end - 1, last));
            }
        });
    }

    fn boundary(&self, range: Range<usize>, labels: &[u32], mut f: impl FnMut(u32, u32)) {
        self.rows(range, |row, steps| {
            for &(offset, x) in steps.iter().filter(|s| s.0 > 0) {
                let start = row.start + usize::from(x < 0);
                let len = row.end - usize::from(x > 0) - start;
                let to = start.wrapping_add_signed(offset);
                let (here, there) = (&labels[start..start + len], &labels[to..to + len]);
                for (block, (a, b)) in here.chunks(64).zip(there.chunks(64)).enumerate() {
                    // Inside of large basins nothing differs, which is seen at once.
                    if a == b {
                        continue;
                    }
                    for bit in Bits(differing(a, b)) {
                        let i = block * 64 + bit as usize;
                        f((start + i) as u32, (to + i) as u32);
                    }
                }
            }
        });
    }
}

/// One bit for each of up to 64 pairs: whether they differ.
#[inline(always)]
fn differing(a: &[u32], b: &[u32]) -> u64 {
    let mut bytes = [0u8; 64];
    for (byte, (a, b)) in bytes.iter_mut().zip(a.iter().zip(b)) {
        *byte = u8::from(a != b);
    }
    // Eight bytes of 0 or 1 become the eight highest bits of the product.
    let pack = |eight: &[u8; 8]| u64::from_le_bytes(*eight).wrapping_mul(0x0102_0408_1020_4080) >> 56;
    let (eights, _) = bytes.as_chunks::<8>();
    eights.iter().rev().fold(0, |bits, eight| bits << 8 | pack(eight))
}

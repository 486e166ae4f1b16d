//! Voxels and the links that the surface cuts (section 3.2 of the paper), a word of 64 voxels at a time.
use std::ops::Range;

use mser3d_shape::{BitGrid, Bits, Connectivity, DIAGONALS, VoxelGrid};

use super::Topology;
use crate::TreeError;

/// The linked voxels of a grid, numbered as [`VoxelGrid`] does.
pub(crate) struct LinkedVoxels<'a> {
    grid: &'a VoxelGrid,
    /// Occupied voxels before each word.
    rank: Vec<u32>,
    /// Pairs of diagonal neighbours that are not linked, both ways round, ascending; `None` for face
    /// neighbours only.
    cut: Option<Vec<[u32; 2]>>,
}

impl<'a> LinkedVoxels<'a> {
    /// # Errors
    /// [`TreeError::DiagonalsUnknown`] when 26 neighbours are asked of a grid without diagonal links.
    pub fn new(grid: &'a VoxelGrid, connectivity: Connectivity) -> Result<Self, TreeError> {
        crate::build::check_limit("voxels", grid.len() as u128)?;
        let cut = match connectivity {
            Connectivity::Six => None,
            Connectivity::TwentySix => {
                let cut = grid.cut_diagonals().ok_or(TreeError::DiagonalsUnknown)?;
                let mut both: Vec<[u32; 2]> = cut.iter().flat_map(|&[u, v]| [[u, v], [v, u]]).collect();
                both.sort_unstable();
                Some(both)
            }
        };
        let mut before = 0;
        let rank = grid.occupancy().words().iter().map(|word| {
            let here = before;
            before += word.count_ones();
            here
        });
        let rank = rank.collect();
        Ok(Self { grid, rank, cut })
    }

    /// The number of the voxel at a bit of a word.
    #[inline]
    fn number(&self, word: usize, bit: u32) -> u32 {
        self.rank[word] + (self.grid.occupancy().words()[word] & ((1 << bit) - 1)).count_ones()
    }
}

/// The bits that have a set bit of `links` before them, along x.
#[inline]
fn linked_back(links: &BitGrid, word: usize) -> u64 {
    let carried = if word.is_multiple_of(links.row_words()) { 0 } else { links.words()[word - 1] >> 63 };
    links.words()[word] << 1 | carried
}

impl Topology for LinkedVoxels<'_> {
    fn len(&self) -> usize {
        self.grid.len()
    }

    fn split(&self, parts: usize) -> Vec<Range<usize>> {
        // Ranges end where words end.
        let n = self.grid.len();
        let mut bounds: Vec<usize> = (0..=parts.max(1))
            .map(|part| {
                let word = self.rank.partition_point(|&r| (r as usize) < n * part / parts.max(1));
                self.rank.get(word).map_or(n, |&r| r as usize)
            })
            .collect();
        bounds.dedup();
        bounds.windows(2).map(|w| w[0]..w[1]).collect()
    }

    fn visit(&self, range: Range<usize>, mut f: impl FnMut(u32, &[u32])) {
        let inside = self.grid.occupancy();
        let (row, slab) = (inside.row_words(), inside.row_words() * inside.dims()[1]);
        let [x, y, z] = self.grid.links();
        let mut neighbours = Vec::with_capacity(26);
        // Of words that start with the same number all but the last are empty.
        let first = self.rank.partition_point(|&r| (r as usize) <= range.start).saturating_sub(1);
        for word in first..self.rank.len() {
            if self.rank[word] as usize >= range.end {
                break;
            }
            let (forward_x, back_x) = (x.words()[word], linked_back(x, word));
            let back =
                |links: &BitGrid, stride: usize| if word < stride { 0 } else { links.words()[word - stride] };
            let (back_y, back_z) = (back(y, row), back(z, slab));
            let (forward_y, forward_z) = (y.words()[word], z.words()[word]);
            for (v, bit) in (self.rank[word]..).zip(Bits(inside.words()[word])) {
                let has = |links: u64| links >> bit & 1 == 1;
                neighbours.clear();
                if has(back_z) {
                    neighbours.push(self.number(word - slab, bit));
                }
                if has(back_y) {
                    neighbours.push(self.number(word - row, bit));
                }
                if has(back_x) {
                    neighbours.push(v - 1);
                }
                if has(forward_x) {
                    neighbours.push(v + 1);
                }
                if has(forward_y) {
                    neighbours.push(self.number(word + row, bit));
                }
                if has(forward_z) {
                    neighbours.push(self.number(word + slab, bit));
                }
                if let Some(cut) = &self.cut {
                    let at = inside.voxel(word, bit);
                    let cut = &cut[cut.partition_point(|pair| pair[0] < v)..];
                    let cut = &cut[..cut.partition_point(|pair| pair[0] == v)];
                    for step in DIAGONALS.iter().flat_map(|s| [*s, s.map(|c| -c)]) {
                        // A step below zero wraps to a coordinate outside any box.
                        let to = std::array::from_fn(|a| at[a].wrapping_add_signed(step[a]));
                        if inside.get(to) {
                            let (word, bit) = inside.position(to);
                            let w = self.number(word, bit);
                            if !cut.contains(&[v, w]) {
                                neighbours.push(w);
                            }
                        }
                    }
                }
                f(v, &neighbours);
            }
        }
    }
}

use crate::ShapeError;
use std::ops::Range;

/// One bit per voxel of a box, x fastest; each row along x starts at a new 64-bit word.
///
/// Bits beyond the end of a row are always zero, so that words can be counted and scanned whole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BitGrid {
    dims: [usize; 3],
    row_words: usize,
    words: Vec<u64>,
}

/// 2^40 voxels, 128 GiB as bits: beyond it a size is a mistake.
const MAX_VOXELS: u128 = 1 << 40;

impl BitGrid {
    /// An empty grid of the given size.
    ///
    /// # Errors
    /// [`ShapeError::TooMany`] beyond 2^40 voxels.
    pub fn empty(dims: [usize; 3]) -> Result<Self, ShapeError> {
        let count = dims.iter().try_fold(1u128, |a, &d| a.checked_mul(d as u128)).unwrap_or(u128::MAX);
        let too_long = dims.iter().any(|&d| d > u32::MAX as usize >> 1);
        if count > MAX_VOXELS || too_long {
            return Err(ShapeError::TooMany { what: "voxels in the grid's box", count, limit: MAX_VOXELS });
        }
        let row_words = dims[0].div_ceil(64);
        Ok(Self { dims, row_words, words: vec![0; row_words * dims[1] * dims[2]] })
    }

    /// A grid with every bit set.
    ///
    /// # Errors
    /// [`ShapeError::TooMany`] beyond 2^40 voxels.
    pub fn full(dims: [usize; 3]) -> Result<Self, ShapeError> {
        let mut grid = Self::empty(dims)?;
        for row in grid.words.chunks_mut(grid.row_words.max(1)) {
            row.fill(u64::MAX);
            if !dims[0].is_multiple_of(64) {
                row[dims[0] / 64] = (1 << (dims[0] % 64)) - 1;
            }
        }
        Ok(grid)
    }

    /// Voxels along x, y and z.
    pub fn dims(&self) -> [usize; 3] {
        self.dims
    }

    /// Words in a row along x.
    pub fn row_words(&self) -> usize {
        self.row_words
    }

    /// All words: row (j, k) is `words[(k * dims[1] + j) * row_words..][..row_words]`.
    pub fn words(&self) -> &[u64] {
        &self.words
    }

    /// All words, to change. Bits beyond the end of a row must stay zero.
    pub fn words_mut(&mut self) -> &mut [u64] {
        &mut self.words
    }

    /// The word and the bit in it that hold a voxel.
    #[inline]
    pub fn position(&self, [i, j, k]: [u32; 3]) -> (usize, u32) {
        let row = k as usize * self.dims[1] + j as usize;
        (row * self.row_words + i as usize / 64, i % 64)
    }

    /// The bit of a voxel; false outside the box.
    #[inline]
    pub fn get(&self, voxel: [u32; 3]) -> bool {
        let inside = (0..3).all(|a| (voxel[a] as usize) < self.dims[a]);
        inside && {
            let (word, bit) = self.position(voxel);
            self.words[word] >> bit & 1 == 1
        }
    }

    /// Sets the bit of a voxel.
    ///
    /// # Panics
    /// When the voxel lies outside the box.
    #[inline]
    pub fn set(&mut self, voxel: [u32; 3], value: bool) {
        assert!(
            (0..3).all(|a| (voxel[a] as usize) < self.dims[a]),
            "voxel {voxel:?} outside {:?}",
            self.dims
        );
        let (word, bit) = self.position(voxel);
        self.words[word] = self.words[word] & !(1 << bit) | u64::from(value) << bit;
    }

    /// How many bits are set.
    pub fn count_ones(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }

    /// The set voxels, x fastest.
    pub fn ones(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        (0..self.words.len())
            .flat_map(move |word| Bits(self.words[word]).map(move |bit| self.voxel(word, bit)))
    }

    /// The voxel that a bit of a word stands for.
    #[inline]
    pub fn voxel(&self, word: usize, bit: u32) -> [u32; 3] {
        let (row, column) = (word / self.row_words, word % self.row_words);
        [(column * 64) as u32 + bit, (row % self.dims[1]) as u32, (row / self.dims[1]) as u32]
    }
}

/// The positions of the set bits of a word, lowest first.
#[derive(Clone, Debug)]
pub struct Bits(pub u64);

impl Iterator for Bits {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        if self.0 == 0 {
            return None;
        }
        let bit = self.0.trailing_zeros();
        self.0 &= self.0 - 1;
        Some(bit)
    }
}

/// Whether any bit of a range is set in a row.
#[inline]
pub(crate) fn any(row: &[u64], range: Range<u32>) -> bool {
    masks(range).any(|(word, mask)| row[word] & mask != 0)
}

/// Clears the bits of a range in a row.
#[inline]
pub(crate) fn clear(row: &mut [u64], range: Range<u32>) {
    masks(range).for_each(|(word, mask)| row[word] &= !mask);
}

/// The words that a range of bits touches, with the mask of its bits in each. The range must not be empty.
#[inline]
fn masks(range: Range<u32>) -> impl Iterator<Item = (usize, u64)> {
    let (first, last) = (range.start / 64, (range.end - 1) / 64);
    (first..=last).map(move |word| {
        let low = if word == first { u64::MAX << (range.start % 64) } else { u64::MAX };
        let high = if word == last { u64::MAX >> (63 - (range.end - 1) % 64) } else { u64::MAX };
        (word as usize, low & high)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_round_trip_over_word_boundaries() {
        let mut grid = BitGrid::empty([130, 3, 2]).unwrap();
        let voxels = [[0, 0, 0], [63, 0, 0], [64, 1, 0], [129, 2, 1]];
        for v in voxels {
            grid.set(v, true);
        }
        assert_eq!(grid.ones().collect::<Vec<_>>(), voxels);
        grid.set([64, 1, 0], false);
        assert_eq!(grid.count_ones(), 3);
        assert!(!grid.get([130, 0, 0]) && !grid.get([0, 3, 0]));
    }

    #[test]
    fn a_full_grid_has_no_bits_beyond_its_rows() {
        for nx in [1, 63, 64, 65, 128] {
            assert_eq!(BitGrid::full([nx, 2, 3]).unwrap().count_ones(), nx * 6);
        }
    }

    #[test]
    fn an_absurd_size_is_an_error() {
        assert!(matches!(BitGrid::empty([usize::MAX, usize::MAX, 2]), Err(ShapeError::TooMany { .. })));
        assert!(matches!(BitGrid::empty([1 << 20; 3]), Err(ShapeError::TooMany { .. })));
    }
}

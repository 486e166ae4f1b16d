//! The numbers of occupied voxels, from the bits that say which are occupied.

use crate::BitGrid;

/// Of so many voxels one tells where it is, and where to look for the others.
const HINT: usize = 256;

/// Which number each occupied voxel has, and where the voxel with a number is. It belongs to the bits it was made from.
#[derive(Debug, PartialEq)]
pub(crate) struct Numbering {
    /// Occupied voxels before each word of bits.
    before: Vec<u32>,
    /// The word of each voxel whose number is a multiple of [`HINT`].
    hints: Vec<usize>,
}

impl Numbering {
    /// Of less than 2^32 voxels.
    pub fn new(occupancy: &BitGrid) -> Self {
        let (mut before, mut hints) = (Vec::with_capacity(occupancy.words().len()), Vec::new());
        hints.reserve_exact(occupancy.count_ones().div_ceil(HINT));
        let mut sum = 0;
        for (word, bits) in occupancy.words().iter().enumerate() {
            before.push(sum);
            sum += bits.count_ones();
            while hints.len() * HINT < sum as usize {
                hints.push(word);
            }
        }
        Self { before, hints }
    }

    /// The number of the first voxel of a word.
    #[inline]
    pub fn first(&self, word: usize) -> u32 {
        self.before[word]
    }

    /// The number of an occupied voxel.
    #[inline]
    pub fn number(&self, occupancy: &BitGrid, word: usize, bit: u32) -> u32 {
        self.before[word] + (occupancy.words()[word] & ((1 << bit) - 1)).count_ones()
    }

    /// The word that holds the voxel with a number: of words that begin with the same number all but the last are empty.
    #[inline]
    pub fn word(&self, number: u32) -> usize {
        let hint = number as usize / HINT;
        let (first, last) =
            (self.hints[hint], self.hints.get(hint + 1).map_or(self.before.len(), |last| last + 1));
        first + self.before[first..last].partition_point(|&before| before <= number) - 1
    }

    /// The word and the bit in it that hold the voxel with a number.
    #[inline]
    pub fn position(&self, occupancy: &BitGrid, number: u32) -> (usize, u32) {
        let word = self.word(number);
        (word, nth_bit(occupancy.words()[word], number - self.before[word]))
    }
}

/// Which bit of a word is the one with so many set bits before it.
#[inline]
fn nth_bit(mut bits: u64, mut before: u32) -> u32 {
    let mut at = 0;
    for width in [32, 16, 8, 4, 2, 1] {
        let low = (bits & ((1 << width) - 1)).count_ones();
        if before >= low {
            before -= low;
            bits >>= width;
            at += width;
        }
    }
    at
}

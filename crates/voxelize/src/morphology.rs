//! Opening and closing of a solid by one voxel.

use mser3d_shape::BitGrid;

mser3d_shape::choice! {
    /// A change of the solid by one voxel, against artefacts of the mesh such as hair or cracks.
    pub enum Morphology("morphological operation") {
        /// Erosion, then dilation: drops what is thinner than three voxels
        ///
        /// By the 6-neighbourhood.
        #[default]
        Open = "open",
        /// Dilation, then erosion: fills slits and pits a voxel wide
        ///
        /// By the 6-neighbourhood.
        Close = "close",
    }
}

pub(crate) fn apply(bits: &mut BitGrid, morphology: Morphology) {
    let order = match morphology {
        Morphology::Open => [erode, dilate],
        Morphology::Close => [dilate, erode],
    };
    for step in order {
        *bits = step(bits);
    }
}

/// Voxels that are set, or one of whose six neighbours is.
fn dilate(bits: &BitGrid) -> BitGrid {
    combine(bits, |own, neighbours| neighbours.iter().fold(own, |a, b| a | b))
}

/// Voxels that are set with all six neighbours; beyond the box everything counts as set, so that the
/// box's sides do not wear down what a dilation could not extend beyond them.
fn erode(bits: &BitGrid) -> BitGrid {
    combine(&complement(bits), |own, neighbours| !neighbours.iter().fold(own, |a, b| a | b))
}

fn complement(bits: &BitGrid) -> BitGrid {
    let mut result = bits.clone();
    result.words_mut().iter_mut().for_each(|w| *w = !*w);
    mask_rows(&mut result);
    result
}

/// Clears the bits beyond the end of each row.
fn mask_rows(bits: &mut BitGrid) {
    let (nx, row) = (bits.dims()[0], bits.row_words());
    if nx % 64 != 0 {
        bits.words_mut().chunks_mut(row).for_each(|r| r[row - 1] &= (1 << (nx % 64)) - 1);
    }
}

/// A word from each word and those shifted by one voxel along -x, +x, -y, +y, -z, +z.
fn combine(bits: &BitGrid, merge: impl Fn(u64, [u64; 6]) -> u64) -> BitGrid {
    let mut result = bits.clone();
    let ([_, ny, nz], row, words) = (bits.dims(), bits.row_words(), bits.words());
    for (at, word) in result.words_mut().iter_mut().enumerate() {
        let (i, j, k) = (at % row, at / row % ny, at / row / ny);
        let own = words[at];
        let at_or_zero = |ok: bool, place: usize| if ok { words[place] } else { 0 };
        *word = merge(
            own,
            [
                own << 1 | at_or_zero(i > 0, at.wrapping_sub(1)) >> 63,
                own >> 1 | at_or_zero(i + 1 < row, at + 1) << 63,
                at_or_zero(j > 0, at.wrapping_sub(row)),
                at_or_zero(j + 1 < ny, at + row),
                at_or_zero(k > 0, at.wrapping_sub(row * ny)),
                at_or_zero(k + 1 < nz, at + row * ny),
            ],
        );
    }
    mask_rows(&mut result);
    result
}

use crate::{Bits, ShapeError};

/// A set of vertices or voxels, one bit each: a region. Regions may overlap and nest.
///
/// ```
/// use mser3d_shape::IndexSet;
/// let [arm, hand] = [IndexSet::from_members(8, [2, 3, 4, 5])?, IndexSet::from_members(8, [4, 5])?];
/// assert!(arm.contains(4) && !arm.contains(6));
/// // |A and B| / |A or B|, with a weight for each vertex.
/// assert_eq!(arm.overlap(&hand, &[1.0; 8]), 0.5);
/// # Ok::<(), mser3d_shape::ShapeError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IndexSet {
    words: Vec<u64>,
    universe: usize,
}

impl IndexSet {
    /// The set of the indices below `universe` for which `contains` holds.
    pub fn from_fn(universe: usize, mut contains: impl FnMut(usize) -> bool) -> Self {
        let mut words = vec![0; universe.div_ceil(64)];
        for v in (0..universe).filter(|&v| contains(v)) {
            words[v / 64] |= 1 << (v % 64);
        }
        Self { words, universe }
    }

    /// The set of the given indices, which are all below `universe`.
    ///
    /// # Errors
    /// [`ShapeError::IndexOutOfRange`] for an index that is not.
    pub fn from_members(universe: usize, members: impl IntoIterator<Item = u32>) -> Result<Self, ShapeError> {
        let mut words = vec![0; universe.div_ceil(64)];
        for (number, index) in members.into_iter().enumerate() {
            let v = index as usize;
            if v >= universe {
                let element = "entry of a region";
                return Err(ShapeError::IndexOutOfRange { element, number, index, vertices: universe });
            }
            words[v / 64] |= 1 << (v % 64);
        }
        Ok(Self { words, universe })
    }

    /// How many indices there are in all: the vertices of the surface, the voxels of the grid.
    pub fn universe(&self) -> usize {
        self.universe
    }

    /// How many are in the set.
    pub fn len(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }

    /// Whether none is in the set.
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|w| *w == 0)
    }

    /// Whether an index is in the set; false for one beyond the universe.
    #[inline]
    pub fn contains(&self, index: usize) -> bool {
        self.words.get(index / 64).is_some_and(|w| w >> (index % 64) & 1 == 1)
    }

    /// The indices in the set, ascending.
    pub fn members(&self) -> impl Iterator<Item = usize> + '_ {
        let members = |(word, bits): (usize, &u64)| Bits(*bits).map(move |bit| 64 * word + bit as usize);
        self.words.iter().enumerate().flat_map(members)
    }

    /// The indices in both sets.
    ///
    /// # Panics
    /// When the universes differ.
    pub fn intersection(&self, other: &Self) -> Self {
        assert_eq!(self.universe, other.universe);
        let words = self.words.iter().zip(&other.words).map(|(a, b)| a & b).collect();
        Self { words, universe: self.universe }
    }

    /// How many indices are in both sets.
    ///
    /// # Panics
    /// When the universes differ.
    pub fn common(&self, other: &Self) -> usize {
        assert_eq!(self.universe, other.universe);
        self.words.iter().zip(&other.words).map(|(a, b)| (a & b).count_ones() as usize).sum()
    }

    /// |A and B| / |A or B| with a weight for each index; 0 when neither weighs anything.
    ///
    /// # Panics
    /// When the universes differ, or the weights are not as many.
    pub fn overlap(&self, other: &Self, weight: &[f64]) -> f64 {
        assert_eq!((self.universe, weight.len()), (other.universe, other.universe));
        let (mut both, mut either) = (0.0, 0.0);
        for (word, (a, b)) in self.words.iter().zip(&other.words).enumerate() {
            let mut left = a | b;
            while left != 0 {
                let bit = left.trailing_zeros();
                left &= left - 1;
                let w = weight[word * 64 + bit as usize];
                either += w;
                if a & b & (1 << bit) != 0 {
                    both += w;
                }
            }
        }
        if either > 0.0 { both / either } else { 0.0 }
    }
}

/// The innermost region of each of `count` vertices or voxels, for regions in descending order of size: the last,
/// and so the smallest, that contains it.
///
/// # Panics
/// When a member is not below `count`.
///
/// ```
/// let (arm, hand) = (vec![2, 3, 4], vec![4]);
/// let innermost = mser3d_shape::innermost_regions(5, [&arm, &hand]);
/// assert_eq!(innermost, [None, None, Some(0), Some(0), Some(1)]);
/// ```
pub fn innermost_regions<R: AsRef<[u32]>>(
    count: usize,
    regions: impl IntoIterator<Item = R>,
) -> Vec<Option<u32>> {
    let mut innermost = vec![None; count];
    for (number, members) in (0..).zip(regions) {
        members.as_ref().iter().for_each(|&m| innermost[m as usize] = Some(number));
    }
    innermost
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_come_back_over_word_boundaries() {
        let members = [0, 63, 64, 129];
        let set = IndexSet::from_members(130, members).unwrap();
        assert_eq!(set.members().map(|v| v as u32).collect::<Vec<_>>(), members);
        assert_eq!((set.len(), set.universe()), (4, 130));
        assert!(!set.contains(130));
        assert_eq!(set, IndexSet::from_fn(130, |v| members.contains(&(v as u32))));
        let error = IndexSet::from_members(130, [1, 130]).unwrap_err().to_string();
        assert!(error.contains("entry of a region 1 names vertex 130"), "{error}");
    }

    #[test]
    fn overlap_is_the_weighted_ratio() {
        let set = |members: &[u32]| IndexSet::from_members(4, members.iter().copied()).unwrap();
        let weight = [1.0, 2.0, 4.0, 8.0];
        assert_eq!(set(&[0, 1]).overlap(&set(&[1, 2]), &weight), 2.0 / 7.0);
        assert_eq!(set(&[3]).overlap(&set(&[3]), &weight), 1.0);
        assert_eq!(set(&[3]).overlap(&set(&[0]), &weight), 0.0);
        assert_eq!(set(&[0, 1]).intersection(&set(&[1, 2])), set(&[1]));
        assert_eq!(set(&[0, 1, 3]).common(&set(&[1, 2, 3])), 2);
        assert_eq!(set(&[]).overlap(&set(&[]), &weight), 0.0);
    }
}

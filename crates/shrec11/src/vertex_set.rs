use crate::ShrecError;

/// A region on a surface: a set of its vertices, one bit each. Regions may overlap and nest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VertexSet {
    words: Vec<u64>,
    vertices: usize,
}

impl VertexSet {
    /// The set of the vertices, of `vertices` in all, for which `contains` holds.
    pub fn from_fn(vertices: usize, mut contains: impl FnMut(usize) -> bool) -> Self {
        let mut words = vec![0; vertices.div_ceil(64)];
        for v in (0..vertices).filter(|&v| contains(v)) {
            words[v / 64] |= 1 << (v % 64);
        }
        Self { words, vertices }
    }

    /// The set of the given vertices, of `vertices` in all.
    ///
    /// # Errors
    /// [`ShrecError::OutOfRange`] for a vertex that is not there.
    pub fn from_members(
        vertices: usize,
        members: impl IntoIterator<Item = usize>,
    ) -> Result<Self, ShrecError> {
        let mut words = vec![0; vertices.div_ceil(64)];
        for (number, v) in members.into_iter().enumerate() {
            if v >= vertices {
                let what = "member of a region, entry";
                return Err(ShrecError::OutOfRange { what, number, index: v as u64, count: vertices });
            }
            words[v / 64] |= 1 << (v % 64);
        }
        Ok(Self { words, vertices })
    }

    /// How many vertices the surface has.
    pub fn vertices(&self) -> usize {
        self.vertices
    }

    /// How many vertices are in the set.
    pub fn len(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }

    /// Whether no vertex is in the set.
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|w| *w == 0)
    }

    /// Whether a vertex is in the set; false for one that is not on the surface.
    #[inline]
    pub fn contains(&self, vertex: usize) -> bool {
        self.words.get(vertex / 64).is_some_and(|w| w >> (vertex % 64) & 1 == 1)
    }

    /// The vertices in the set, ascending.
    pub fn members(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.vertices).filter(|&v| self.contains(v))
    }

    /// The vertices in both sets.
    ///
    /// # Panics
    /// When the sizes differ.
    pub fn intersection(&self, other: &Self) -> Self {
        assert_eq!(self.vertices, other.vertices);
        let words = self.words.iter().zip(&other.words).map(|(a, b)| a & b).collect();
        Self { words, vertices: self.vertices }
    }

    /// |A and B| / |A or B| with a weight per vertex; 0 when neither weighs anything.
    ///
    /// # Panics
    /// When the sizes differ.
    pub fn overlap(&self, other: &Self, weight: &[f64]) -> f64 {
        assert_eq!((self.vertices, weight.len()), (other.vertices, other.vertices));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_come_back_over_word_boundaries() {
        let members = [0, 63, 64, 129];
        let set = VertexSet::from_members(130, members).unwrap();
        assert_eq!(set.members().collect::<Vec<_>>(), members);
        assert_eq!(set.len(), 4);
        assert!(!set.contains(130));
        assert_eq!(set, VertexSet::from_fn(130, |v| members.contains(&v)));
        assert!(VertexSet::from_members(130, [130]).is_err());
    }

    #[test]
    fn overlap_is_the_weighted_ratio() {
        let set = |members: &[usize]| VertexSet::from_members(4, members.iter().copied()).unwrap();
        let weight = [1.0, 2.0, 4.0, 8.0];
        assert_eq!(set(&[0, 1]).overlap(&set(&[1, 2]), &weight), 2.0 / 7.0);
        assert_eq!(set(&[3]).overlap(&set(&[3]), &weight), 1.0);
        assert_eq!(set(&[3]).overlap(&set(&[0]), &weight), 0.0);
        assert_eq!(set(&[0, 1]).intersection(&set(&[1, 2])), set(&[1]));
        assert_eq!(set(&[]).overlap(&set(&[]), &weight), 0.0);
    }
}

/// Union-find over `0..n` (Tarjan 1975): union by size, paths halved.
///
/// ```
/// let mut sets = mser3d_shape::DisjointSets::new(4);
/// sets.union(0, 3);
/// assert_eq!(sets.find(0), sets.find(3));
/// assert_ne!(sets.find(1), sets.find(3));
/// ```
#[derive(Clone, Debug)]
pub struct DisjointSets {
    parent: Vec<u32>,
    size: Vec<u32>,
}

impl DisjointSets {
    /// `n` sets of one element.
    pub fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect(), size: vec![1; n] }
    }

    /// The representative of the set of `x`.
    #[inline]
    pub fn find(&mut self, mut x: u32) -> u32 {
        while self.parent[x as usize] != x {
            let above = self.parent[self.parent[x as usize] as usize];
            self.parent[x as usize] = above;
            x = above;
        }
        x
    }

    /// Joins the sets of `a` and `b`. Returns the representative that stays and the one that goes,
    /// or `None` if they were one set before.
    #[inline]
    pub fn union(&mut self, a: u32, b: u32) -> Option<(u32, u32)> {
        let (mut a, mut b) = (self.find(a), self.find(b));
        if a == b {
            return None;
        }
        if self.size[a as usize] < self.size[b as usize] {
            std::mem::swap(&mut a, &mut b);
        }
        self.parent[b as usize] = a;
        self.size[a as usize] += self.size[b as usize];
        Some((a, b))
    }
}

//! A bounding volume hierarchy over the words of a grid that have voxels in them.

use crate::VoxelGrid;

/// Most words in a leaf.
const LEAF: usize = 4;

/// The nearest voxel found so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Best {
    /// Square of the distance.
    pub square: f64,
    /// The smallest number at that distance.
    pub voxel: u32,
}

impl Default for Best {
    fn default() -> Self {
        Self { square: f64::INFINITY, voxel: u32::MAX }
    }
}

impl Best {
    /// Takes a voxel if it is nearer, or as near with a smaller number. Point and voxel in units of voxels.
    #[inline]
    pub fn take(&mut self, at: [f64; 3], spacing: [f64; 3], voxel: [f64; 3], number: impl FnOnce() -> u32) {
        let square: f64 = (0..3).map(|a| ((voxel[a] + 0.5 - at[a]) * spacing[a]).powi(2)).sum();
        if square <= self.square {
            let number = number();
            if square < self.square || number < self.voxel {
                *self = Self { square, voxel: number };
            }
        }
    }
}

/// Splits the words at the median of the longest side of their box, down to a few words.
#[derive(Debug)]
pub(crate) struct WordTree {
    nodes: Vec<Node>,
    words: Vec<Word>,
}

/// A word of the grid: up to 64 voxels along x.
#[derive(Clone, Copy, Debug)]
struct Word {
    bits: u64,
    /// The voxel of its lowest bit.
    first: [u32; 3],
}

#[derive(Clone, Copy, Debug)]
struct Node {
    /// The lowest and highest voxels.
    low: [u32; 3],
    high: [u32; 3],
    /// Its words; of an inner node, those of both children.
    start: u32,
    end: u32,
    /// The second child; the first follows the node. 0 for a leaf.
    second: u32,
}

impl WordTree {
    /// Over the voxels of a grid. Cost: O(w log w) for w words with voxels.
    pub fn new(grid: &VoxelGrid) -> Self {
        let inside = grid.occupancy();
        let filled = inside.words().iter().enumerate().filter(|(_, bits)| **bits != 0);
        let words = filled.map(|(at, &bits)| Word { bits, first: inside.voxel(at, 0) }).collect();
        let mut tree = Self { nodes: Vec::new(), words };
        tree.build(0, tree.words.len(), grid.frame().spacing());
        tree
    }

    fn build(&mut self, start: usize, end: usize, spacing: [f64; 3]) {
        let words = &mut self.words[start..end];
        let (mut low, mut high) = ([u32::MAX; 3], [0; 3]);
        for word in &*words {
            let ends =
                [word.bits.trailing_zeros(), 63 - word.bits.leading_zeros()].map(|b| word.first[0] + b);
            (low[0], high[0]) = (low[0].min(ends[0]), high[0].max(ends[1]));
            for a in 1..3 {
                (low[a], high[a]) = (low[a].min(word.first[a]), high[a].max(word.first[a]));
            }
        }
        let node = self.nodes.len();
        // At most 2^32 - 2 voxels have a number, so words and nodes can have one too.
        self.nodes.push(Node { low, high, start: start as u32, end: end as u32, second: 0 });
        if end - start <= LEAF {
            return;
        }
        let length = |a: usize| f64::from(high[a].saturating_sub(low[a])) * spacing[a];
        let axis = (0..3).max_by(|&a, &b| length(a).total_cmp(&length(b))).unwrap_or(0);
        let middle = words.len() / 2;
        words.select_nth_unstable_by_key(middle, |w| (w.first[axis], w.first));
        self.build(start, start + middle, spacing);
        self.nodes[node].second = self.nodes.len() as u32;
        self.build(start + middle, end, spacing);
    }

    /// Looks for voxels nearer to a point (in units of voxels) than the best so far.
    pub fn search(&self, grid: &VoxelGrid, at: [f64; 3], best: &mut Best) {
        let spacing = grid.frame().spacing();
        // Rounded like the distance of a voxel, so that it is never larger than that of a voxel in the box.
        let bound = |node: u32| -> f64 {
            let Node { low, high, .. } = self.nodes[node as usize];
            let axis = |a: usize| {
                let nearest = at[a].clamp(f64::from(low[a]) + 0.5, f64::from(high[a]) + 0.5);
                ((nearest - at[a]) * spacing[a]).powi(2)
            };
            (0..3).map(axis).sum()
        };
        let mut open = vec![(bound(0), 0u32)];
        while let Some((least, number)) = open.pop() {
            if least > best.square {
                continue;
            }
            let node = &self.nodes[number as usize];
            if node.second == 0 {
                for word in &self.words[node.start as usize..node.end as usize] {
                    word.search(grid, at, spacing, best);
                }
                continue;
            }
            let children = [number + 1, node.second].map(|child| (bound(child), child));
            let nearer = usize::from(children[1].0 < children[0].0);
            open.extend([children[1 - nearer], children[nearer]]);
        }
    }
}

impl Word {
    /// In a row only the next voxel to either side can be nearest.
    #[inline]
    fn search(&self, grid: &VoxelGrid, at: [f64; 3], spacing: [f64; 3], best: &mut Best) {
        // How many of the 64 centres do not lie beyond the point.
        let before = (at[0] - f64::from(self.first[0]) + 0.5).clamp(0.0, 64.0) as u32;
        let low = u64::MAX.checked_shr(64 - before).unwrap_or(0);
        let sides = [self.bits & low, self.bits & !low];
        let places = [63u32.wrapping_sub(sides[0].leading_zeros()), sides[1].trailing_zeros()];
        for (side, place) in sides.into_iter().zip(places) {
            if side != 0 {
                let voxel = [self.first[0] + place, self.first[1], self.first[2]];
                best.take(at, spacing, voxel.map(f64::from), || grid.index(voxel).unwrap_or(u32::MAX));
            }
        }
    }
}

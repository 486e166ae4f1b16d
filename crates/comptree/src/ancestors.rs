//! Lowest common ancestors in constant time (Schieber and Vishkin 1988).
use crate::ComponentTree;
use crate::tree::NONE;

/// Answers queries for lowest common ancestors in constant time (Schieber and Vishkin 1988), from three
/// numbers a node.
///
/// ```
/// use mser3d_comptree::{CommonAncestors, ComponentTree, Polarity};
///
/// let heights = [2.0, 9.0, 1.0, 4.0, 3.0];
/// let path = [[0, 1], [1, 2], [2, 3], [3, 4]];
/// let tree = ComponentTree::from_vertex_weights(&path, &heights, 1.0, Polarity::Sublevel)?;
/// let ancestors = CommonAncestors::new(&tree);
/// // Between two vertices one has to climb to the altitude of the smallest component with both.
/// let pass = |u, v| ancestors.of(tree.node_of(u), tree.node_of(v)).map(|node| tree.altitude(node));
/// assert_eq!((pass(2, 4), pass(0, 4)), (Some(4.0), Some(9.0)));
/// # Ok::<(), mser3d_comptree::TreeError>(())
/// ```
#[derive(Clone, Debug)]
pub struct CommonAncestors<'a> {
    tree: &'a ComponentTree,
    /// The number with most trailing zeros among the descendants' preorder numbers: one for each path.
    path: Vec<u32>,
    /// The trailing zeros of the paths of all ancestors, one bit each.
    ascent: Vec<u32>,
    /// The highest node of each path.
    head: Vec<u32>,
}

impl<'a> CommonAncestors<'a> {
    /// Prepares a tree, in one pass down and one up.
    pub fn new(tree: &'a ComponentTree) -> Self {
        let n = tree.len();
        // Counted from the last node down, postorder is a preorder: n - node, from 1 on. The
        // descendants of a node are an interval from its own number on.
        let path = (0..n as u32).map(|node| {
            let (first, last) = (n as u32 - node, n as u32 - tree.descendants(node).start);
            // The number in the interval with most trailing zeros.
            let spread = 31 - ((first - 1) ^ last).leading_zeros();
            last >> spread << spread
        });
        let path: Vec<u32> = path.collect();
        let mut ascent = vec![0u32; n];
        let mut head = vec![NONE; n + 1];
        for node in (0..n).rev() {
            let parent = tree.parents[node];
            let above = if parent == NONE { 0 } else { ascent[parent as usize] };
            ascent[node] = above | 1 << path[node].trailing_zeros();
            if parent == NONE || path[parent as usize] != path[node] {
                head[path[node] as usize] = node as u32;
            }
        }
        Self { tree, path, ascent, head }
    }

    /// The smallest node that contains both; `None` in different trees of a forest.
    #[inline]
    pub fn of(&self, a: u32, b: u32) -> Option<u32> {
        let [p, q] = [a, b].map(|node| self.path[node as usize]);
        // The level of the lowest path that both have above them.
        let apart = if p == q { 0 } else { 31 - (p ^ q).leading_zeros() };
        let shared = self.ascent[a as usize] & self.ascent[b as usize] & (u32::MAX << apart);
        if shared == 0 {
            return None;
        }
        let level = shared.trailing_zeros();
        let [x, y] = [a, b].map(|node| self.entry(node, level));
        let (low, high) = (x?.min(y?), x?.max(y?));
        // Trees side by side have paths of their own, though perhaps of one level.
        self.tree.contains(high, low).then_some(high)
    }

    /// Where the way up from a node comes to the path of a level.
    #[inline]
    fn entry(&self, node: u32, level: u32) -> Option<u32> {
        let path = self.path[node as usize];
        if path.trailing_zeros() == level {
            return Some(node);
        }
        let below = 31 - (self.ascent[node as usize] & ((1 << level) - 1)).leading_zeros();
        let path = (path >> below | 1) << below;
        self.tree.parent(self.head[path as usize])
    }
}

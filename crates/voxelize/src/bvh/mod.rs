//! A hierarchy of boxes over triangles: rays in any direction, nearest points, and the fast winding number.

mod build;
mod columns;
mod far_field;
mod nearest;
mod rays;
mod stack;
mod winding;

pub use nearest::NearestPoint;
pub use rays::Hit;
pub use winding::WindingTree;
pub(crate) use winding::{COARSE_ERROR, NEGLIGIBLE, ROUGHLY_NEGLIGIBLE};

use mser3d_shape::BoundingBox;
use mser3d_shape::vector::Vec3;

/// A bounding volume hierarchy over the triangles of a mesh (binned surface-area heuristic, Wald 2007).
///
/// The hierarchy depends on the triangles alone, not on the number of threads. Triangles keep their
/// numbers; those without area are kept too.
///
/// Cost: O(n log n) time; about 140 bytes a triangle.
#[derive(Clone, Debug)]
pub struct Bvh {
    /// Depth first: the left child of node i is i + 1.
    nodes: Vec<Node>,
    /// The number of each triangle, in leaf order.
    numbers: Vec<u32>,
    /// The corners of each triangle, in leaf order.
    corners: Vec<[Vec3; 3]>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: BoundingBox,
    /// First triangle of a leaf, or the right child.
    first: u32,
    /// Triangles of a leaf; 0 in an inner node.
    count: u32,
}

impl Bvh {
    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.numbers.len()
    }

    /// Whether there are no triangles.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// The box around all triangles; `None` without triangles.
    pub fn bounding_box(&self) -> Option<BoundingBox> {
        self.nodes.first().map(|n| n.bounds)
    }
}

/// The squared distance from a point to a box; 0 inside.
#[inline]
fn distance_squared(bounds: &BoundingBox, p: Vec3) -> f64 {
    (0..3).map(|a| (bounds.min[a] - p[a]).max(p[a] - bounds.max[a]).max(0.0).powi(2)).sum()
}

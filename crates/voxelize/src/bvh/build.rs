//! Building by binned surface-area heuristic: I. Wald, *On fast construction of SAH-based bounding
//! volume hierarchies*, 2007.

use super::{Bvh, Node};
use mser3d_shape::vector::Vec3;
use mser3d_shape::{BoundingBox, TriangleMesh};

const BINS: usize = 16;
/// Triangles that a leaf may hold when splitting it does not pay.
const MAX_LEAF: usize = 8;
/// Fewer triangles are not worth another thread.
const PARALLEL: usize = 8192;
/// Cost of visiting a node, in triangle tests.
const VISIT: f64 = 1.0;

#[derive(Clone, Copy)]
struct Item {
    bounds: BoundingBox,
    number: u32,
}

impl Item {
    /// Twice the middle of the box.
    #[inline]
    fn middle(&self, axis: usize) -> f64 {
        self.bounds.min[axis] + self.bounds.max[axis]
    }
}

const NOTHING: BoundingBox = BoundingBox { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };

#[inline]
fn joined(a: BoundingBox, b: &BoundingBox) -> BoundingBox {
    BoundingBox {
        min: std::array::from_fn(|i| a.min[i].min(b.min[i])),
        max: std::array::from_fn(|i| a.max[i].max(b.max[i])),
    }
}

#[inline]
fn half_area(bounds: &BoundingBox) -> f64 {
    let [x, y, z] = bounds.extent();
    if x < 0.0 { 0.0 } else { x * y + y * z + z * x }
}

impl Bvh {
    /// A hierarchy over all triangles of a mesh.
    pub fn new(mesh: &TriangleMesh) -> Self {
        Self::over(mesh.triangles().len(), |triangle| mesh.corners(triangle))
    }

    /// A hierarchy over so many loose triangles with these corners.
    pub(crate) fn over(count: usize, corners: impl Fn(usize) -> [Vec3; 3]) -> Self {
        let item = |number: usize| {
            let ends = corners(number).into_iter().map(|p| BoundingBox { min: p, max: p });
            Item { bounds: ends.fold(NOTHING, |all, end| joined(all, &end)), number: number as u32 }
        };
        let mut items: Vec<Item> = (0..count).map(item).collect();
        let nodes = if items.is_empty() { Vec::new() } else { subtree(&mut items, 0) };
        let numbers: Vec<u32> = items.iter().map(|i| i.number).collect();
        drop(items);
        let corners = numbers.iter().map(|&t| corners(t as usize)).collect();
        Self { nodes, numbers, corners }
    }
}

/// The nodes over some items, depth first, `first` being the place of items[0] in leaf order.
/// The place of a right child counts from the first of these nodes.
fn subtree(items: &mut [Item], first: u32) -> Vec<Node> {
    let bounds = items.iter().fold(NOTHING, |b, item| joined(b, &item.bounds));
    let middle = split(items, &bounds);
    let Some(middle) = middle else {
        return vec![Node { bounds, first, count: items.len() as u32 }];
    };
    let parallel = items.len() > PARALLEL;
    let (low, high) = items.split_at_mut(middle);
    let second = first + middle as u32;
    let (left, right) = if parallel {
        rayon::join(|| subtree(low, first), || subtree(high, second))
    } else {
        (subtree(low, first), subtree(high, second))
    };
    let mut nodes = Vec::with_capacity(1 + left.len() + right.len());
    nodes.push(Node { bounds, first: 1 + left.len() as u32, count: 0 });
    for (children, shift) in [(&left, 1), (&right, 1 + left.len() as u32)] {
        nodes.extend(children.iter().map(|&node| {
            let shift = if node.count == 0 { shift } else { 0 };
            Node { first: node.first + shift, ..node }
        }));
    }
    nodes
}

/// Reorders the items so that the cheapest split of three axes times `BINS` lies at the returned place;
/// `None` for a leaf.
fn split(items: &mut [Item], bounds: &BoundingBox) -> Option<usize> {
    if items.len() <= 2 {
        return None;
    }
    // The axis along which the middles are spread widest, as is usual: all three cost three times as much, and
    // gain next to nothing.
    let spread = |axis: usize| {
        let ends = items.iter().map(|i| i.middle(axis));
        ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    let spreads = [spread(0), spread(1), spread(2)];
    let width = |axis: &usize| spreads[*axis].1 - spreads[*axis].0;
    let axis = (1..3).fold(0, |widest, axis| if width(&axis) > width(&widest) { axis } else { widest });
    let (mut best, mut cheapest) = (None, f64::INFINITY);
    let (low, high) = spreads[axis];
    let scale = BINS as f64 / (high - low);
    let bin = move |item: &Item| (((item.middle(axis) - low) * scale) as usize).min(BINS - 1);
    if high > low && scale.is_finite() {
        let mut bins = [(NOTHING, 0usize); BINS];
        for item in items.iter() {
            let slot = &mut bins[bin(item)];
            *slot = (joined(slot.0, &item.bounds), slot.1 + 1);
        }
        let mut above = [(0.0, 0); BINS];
        let mut sweep = (NOTHING, 0);
        for i in (1..BINS).rev() {
            sweep = (joined(sweep.0, &bins[i].0), sweep.1 + bins[i].1);
            above[i] = (half_area(&sweep.0), sweep.1);
        }
        sweep = (NOTHING, 0);
        for i in 1..BINS {
            sweep = (joined(sweep.0, &bins[i - 1].0), sweep.1 + bins[i - 1].1);
            if sweep.1 > 0 && above[i].1 > 0 {
                let cost = half_area(&sweep.0) * sweep.1 as f64 + above[i].0 * above[i].1 as f64;
                if cost < cheapest {
                    (best, cheapest) = (Some(i), cost);
                }
            }
        }
    }
    let leaf_cost = half_area(bounds) * (items.len() as f64 - VISIT);
    match best {
        Some(_) if items.len() <= MAX_LEAF && cheapest >= leaf_cost => None,
        Some(i) => {
            let mut middle = 0;
            for at in 0..items.len() {
                if bin(&items[at]) < i {
                    items.swap(at, middle);
                    middle += 1;
                }
            }
            Some(middle)
        }
        // All middles coincide: halve, or the recursion would not end.
        None => (items.len() > MAX_LEAF).then_some(items.len() / 2),
    }
}

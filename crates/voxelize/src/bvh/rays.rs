//! Rays and segments in any direction: S. Woop, C. Benthin and I. Wald, *Watertight ray/triangle
//! intersection*, 2013.

use super::stack::Stack;
use super::{Bvh, Node};
use crate::predicates::{orient3d, side};
use mser3d_shape::BoundingBox;
use mser3d_shape::vector::{Vec3, add, cross, scale, sub};

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance from the origin in lengths of the direction.
    pub t: f64,
    /// The triangle's number in the mesh.
    pub triangle: u32,
    /// Whether the ray comes from the side that the triangle's normal points to.
    pub front: bool,
}

/// A ray sheared so that it runs along +z from the origin.
struct Sheared {
    origin: Vec3,
    inverse: Vec3,
    axes: [usize; 3],
    shear: [f64; 3],
}

impl Sheared {
    fn new(origin: Vec3, direction: Vec3) -> Self {
        // The dominant axis becomes z; the others keep the handedness.
        let z = (0..3).fold(0, |m, a| if direction[a].abs() > direction[m].abs() { a } else { m });
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if direction[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        let shear = [direction[x] / direction[z], direction[y] / direction[z], 1.0 / direction[z]];
        Self { origin, inverse: direction.map(|d| 1.0 / d), axes: [x, y, z], shear }
    }

    /// Whether the ray meets a box before `limit`. Rounding never loses a box.
    #[inline]
    fn meets(&self, node: &Node, limit: f64) -> bool {
        let (mut near, mut far) = (0.0f64, limit);
        for a in 0..3 {
            let low = (node.bounds.min[a] - self.origin[a]) * self.inverse[a];
            let high = (node.bounds.max[a] - self.origin[a]) * self.inverse[a];
            // Within a plane of the box 0 * infinity is no number, and the plane no bound.
            if low.is_nan() || high.is_nan() {
                continue;
            }
            near = near.max(low.min(high));
            far = far.min(low.max(high) * (1.0 + 4.0 * f64::EPSILON));
        }
        near <= far
    }

    /// The hit with a triangle in 0..=limit.
    #[inline]
    fn hit(&self, corners: &[Vec3; 3], triangle: u32, limit: f64) -> Option<Hit> {
        let [x, y, z] = self.axes;
        let [a, b, c] = corners.map(|p| {
            let p = sub(p, self.origin);
            [p[x] - self.shear[0] * p[z], p[y] - self.shear[1] * p[z], self.shear[2] * p[z]]
        });
        let u = c[0] * b[1] - c[1] * b[0];
        let v = a[0] * c[1] - a[1] * c[0];
        let w = b[0] * a[1] - b[1] * a[0];
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        if det == 0.0 {
            return None;
        }
        let t = (u * a[2] + v * b[2] + w * c[2]) / det;
        (t >= 0.0 && t <= limit).then_some(Hit { t, triangle, front: det > 0.0 })
    }
}

impl Bvh {
    /// The first triangle that a ray meets at `origin + t direction`, 0 <= t <= `limit`; of several at one t
    /// the one with the smallest number. Watertight: no ray slips between triangles that share an edge.
    ///
    /// ```
    /// # use mser3d_shape::TriangleMesh;
    /// # use mser3d_voxelize::Bvh;
    /// let mesh = TriangleMesh::new(vec![[0., 0., 1.], [1., 0., 1.], [0., 1., 1.]], vec![[0, 1, 2]])?;
    /// let hit = Bvh::new(&mesh).first_hit([0.2, 0.2, 3.0], [0.0, 0.0, -1.0], f64::INFINITY).unwrap();
    /// assert_eq!((hit.t, hit.triangle, hit.front), (2.0, 0, true));
    /// # Ok::<(), mser3d_shape::ShapeError>(())
    /// ```
    pub fn first_hit(&self, origin: Vec3, direction: Vec3, limit: f64) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.visit_hits(origin, direction, limit, |hit| {
            if best.is_none_or(|b| (hit.t, hit.triangle) < (b.t, b.triangle)) {
                best = Some(hit);
            }
            best.map_or(limit, |b| b.t)
        });
        best
    }

    /// All triangles that a ray meets up to `limit`, by distance, then by number. A ray through a shared
    /// edge meets both triangles.
    pub fn all_hits(&self, origin: Vec3, direction: Vec3, limit: f64) -> Vec<Hit> {
        let mut hits = Vec::new();
        self.visit_hits(origin, direction, limit, |hit| {
            hits.push(hit);
            limit
        });
        hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        hits
    }

    /// Calls `visit` with the hits in any order; it returns the limit from there on.
    fn visit_hits(&self, origin: Vec3, direction: Vec3, mut limit: f64, mut visit: impl FnMut(Hit) -> f64) {
        if self.is_empty() || direction == [0.0; 3] || limit.is_nan() {
            return;
        }
        let ray = Sheared::new(origin, direction);
        let mut stack = Stack::new();
        while let Some(i) = stack.pop() {
            let node = &self.nodes[i];
            if !ray.meets(node, limit) {
                continue;
            }
            if node.count == 0 {
                stack.push(node.first as usize);
                stack.push(i + 1);
                continue;
            }
            for place in node.first as usize..(node.first + node.count) as usize {
                if let Some(hit) = ray.hit(&self.corners[place], self.numbers[place], limit) {
                    limit = visit(hit);
                }
            }
        }
    }

    /// How many triangles the segment from p to q passes through: exact, both ends displaced by one
    /// infinitesimal along +x (then +y, then +z), so that a shared edge counts once.
    pub fn crossings(&self, p: Vec3, q: Vec3) -> usize {
        let mut count = 0;
        self.visit_crossings(p, q, |_, _| count += 1);
        count
    }

    /// Calls `visit` with the number of each triangle that the segment passes through, and whether it goes
    /// in by the triangle's front.
    pub(crate) fn visit_crossings(&self, p: Vec3, q: Vec3, mut visit: impl FnMut(u32, bool)) {
        if self.is_empty() {
            return;
        }
        let segment = Segment::new(p, q, &self.nodes[0].bounds);
        let mut stack = Stack::new();
        while let Some(i) = stack.pop() {
            let node = &self.nodes[i];
            if segment.is_apart(&node.bounds) {
                continue;
            }
            if node.count == 0 {
                stack.push(node.first as usize);
                stack.push(i + 1);
                continue;
            }
            for place in node.first as usize..(node.first + node.count) as usize {
                let corners = &self.corners[place];
                let (from, to) = (side(corners, p), side(corners, q));
                if from * to < 0 && passes_within(corners, p, q) {
                    visit(self.numbers[place], from > 0);
                }
            }
        }
    }
}

/// Whether the perturbed line through p and q passes within a triangle: the same side of all three edges.
fn passes_within(corners: &[Vec3; 3], p: Vec3, q: Vec3) -> bool {
    let direction = sub(q, p);
    let turn = |a: Vec3, b: Vec3| {
        let volume = orient3d(p, q, a, b);
        if volume != 0.0 {
            return volume > 0.0;
        }
        // Displacing p and q by e changes the volume by a multiple of e . ((b - a) x (q - p)).
        let change = cross(sub(b, a), direction);
        change.into_iter().find(|c| *c != 0.0).is_some_and(|c| c > 0.0)
    };
    let [a, b, c] = *corners;
    let first = turn(a, b);
    first == turn(b, c) && first == turn(c, a)
}

/// A segment that is compared with boxes by separating axes: those of the box, and their cross products with the segment.
struct Segment {
    middle: Vec3,
    /// Half of the way from one end to the other, and its absolute values.
    half: Vec3,
    size: Vec3,
    /// What rounding may have moved.
    slack: f64,
}

impl Segment {
    fn new(p: Vec3, q: Vec3, all: &BoundingBox) -> Self {
        let half = scale(sub(q, p), 0.5);
        let reach = [p, q, all.min, all.max].iter().flatten().fold(0.0f64, |most, x| most.max(x.abs()));
        let (middle, size) = (scale(add(p, q), 0.5), half.map(f64::abs));
        Self { middle, half, size, slack: 16.0 * f64::EPSILON * reach }
    }

    /// Whether it certainly does not touch a box.
    #[inline]
    fn is_apart(&self, bounds: &BoundingBox) -> bool {
        let away: Vec3 = std::array::from_fn(|a| 0.5 * (bounds.min[a] + bounds.max[a]) - self.middle[a]);
        let extent: Vec3 = std::array::from_fn(|a| 0.5 * (bounds.max[a] - bounds.min[a]) + self.slack);
        (0..3).any(|a| {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            let across = (self.half[b] * away[c] - self.half[c] * away[b]).abs();
            away[a].abs() > extent[a] + self.size[a]
                || across > extent[b] * self.size[c] + extent[c] * self.size[b]
        })
    }
}

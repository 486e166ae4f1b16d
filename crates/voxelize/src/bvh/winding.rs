//! The generalized winding number of any set of triangles in O(log n) a point: G. Barill, N. Dickson,
//! R. Schmidt, D. Levin and A. Jacobson, *Fast winding numbers for soups and clouds*, 2018.

use super::columns::Columns;
use super::far_field::{ACCURACY, Expansion, Moments};
use super::nearest::nearest_on_triangle;
use super::stack::Stack;
use super::{Bvh, distance_squared};
use crate::predicates::side;
use crate::triangle_geometry::{area_vector, solid_angle};
use mser3d_shape::vector::{Vec3, cross, dot, norm, sub};
use mser3d_shape::{BoundingBox, TriangleMesh};
use std::f64::consts::PI;

/// A hierarchy that sums the winding number of triangles around a point: exact dipole sums nearby, an
/// expansion to second order of all triangles of a node far away.
///
/// `w(q) = sum_t Omega_t(q) / 4 pi`, Omega_t the signed solid angle of triangle t seen from q: 1 inside a
/// closed outward surface, 0 outside, a fraction near holes.
///
/// ```
/// # use mser3d_shape::TriangleMesh;
/// # use mser3d_voxelize::WindingTree;
/// let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
/// let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])?;
/// let tree = WindingTree::new(&mesh);
/// assert!((tree.winding_number([0.2, 0.2, 0.2]) - 1.0).abs() < 1e-12);
/// assert!(tree.winding_number([2.0, 0.0, 0.0]).abs() < 1e-3);
/// # Ok::<(), mser3d_shape::ShapeError>(())
/// ```
#[derive(Clone, Debug)]
pub struct WindingTree {
    bvh: Bvh,
    expansions: Vec<Expansion>,
    areas: Vec<f64>,
}

/// A node whose part of the winding number changes by less over a block is taken as constant there.
pub(crate) const NEGLIGIBLE: f64 = 5e-5;
/// The same to find out roughly where values matter at all.
pub(crate) const ROUGHLY_NEGLIGIBLE: f64 = 8e-3;

/// The most that winding numbers of a whole block are off by.
pub(crate) const COARSE_ERROR: f64 = 5e-3;
/// How much farther away expansions begin where more precision is needed; their error falls with the cube.
const FINER: f64 = 4.0;
/// The most that those are off by.
const FINE_ERROR: f64 = 2e-4;
/// The same of sums of all solid angles.
const ROUNDING: f64 = 1e-10;

impl WindingTree {
    /// A tree over all triangles of a mesh, as they are oriented. Cost: O(n log n).
    pub fn new(mesh: &TriangleMesh) -> Self {
        Self::over((0..mesh.triangles().len()).map(|t| mesh.corners(t)).collect())
    }

    pub(crate) fn over(corners: Vec<[Vec3; 3]>) -> Self {
        let bvh = Bvh::over(corners.len(), |triangle| corners[triangle]);
        let (mut expansions, mut areas) = (Vec::new(), Vec::new());
        // Children come after their parents; going back, those whose parent is still to come wait here.
        let mut waiting: Vec<Moments> = Vec::new();
        for node in bvh.nodes.iter().rev() {
            let children = if node.count == 0 { waiting.pop().zip(waiting.pop()) } else { None };
            let here = children.map_or_else(
                || {
                    let start = node.first as usize;
                    Moments::of(&bvh.corners[start..start + node.count as usize])
                },
                |(first, second)| first.join(&second),
            );
            areas.push(here.area);
            expansions.push(here.expansion());
            waiting.push(here);
        }
        areas.reverse();
        expansions.reverse();
        Self { bvh, expansions, areas }
    }

    /// The winding number around a point, to a few 1e-3 and better near the surface. A point on a
    /// triangle counts as displaced by an infinitesimal along +x (then +y, +z).
    /// Cost: O(log n) for the meshes of practice.
    pub fn winding_number(&self, point: Vec3) -> f64 {
        self.winding_number_from(point, 1.0)
    }

    /// The same, with expansions only from so many times farther away; with infinity, of no node.
    fn winding_number_from(&self, point: Vec3, times: f64) -> f64 {
        if self.bvh.is_empty() {
            return 0.0;
        }
        let mut sum = 0.0;
        let mut stack = Stack::new();
        while let Some(i) = stack.pop() {
            let expansion = &self.expansions[i];
            let x = sub(expansion.centre, point);
            let node = &self.bvh.nodes[i];
            if dot(x, x) > expansion.far * (times * times) {
                sum += expansion.evaluate(x);
            } else if node.count > 0 {
                sum += self.of_leaf(i, point);
            } else {
                stack.push(node.first as usize);
                stack.push(i + 1);
            }
        }
        sum
    }

    /// Whether an approximation is too close to a half to be trusted.
    #[inline]
    pub(crate) fn is_close(value: f64) -> bool {
        (value - half(value)).abs() < COARSE_ERROR
    }

    /// The winding number at a point where an approximation came out as `value`. It is made more precise
    /// where it lies so close to a half that the approximation cannot tell on which side: then it does not
    /// depend on how the tree happens to be divided, and a turned mesh has the same inside.
    pub(crate) fn decided(&self, point: Vec3, value: f64) -> f64 {
        if !Self::is_close(value) {
            return value;
        }
        let finer = self.winding_number_from(point, FINER);
        if (finer - half(finer)).abs() > FINE_ERROR {
            return finer;
        }
        let exact = self.winding_number_from(point, f64::INFINITY);
        if (exact - half(exact)).abs() > ROUNDING { exact } else { half(exact) }
    }

    /// The winding number at points of a box, as [`Self::winding_number`] but for an error, and a bound of that: what changes by less
    /// than `negligible` over the box is summed once, and what is so nearly linear is interpolated between its corners.
    pub(crate) fn winding_numbers<const N: usize>(
        &self,
        target: &BoundingBox,
        points: &[Vec3; N],
        negligible: f64,
    ) -> ([f64; N], f64) {
        if self.bvh.is_empty() {
            return ([0.0; N], 0.0);
        }
        let extent = target.extent();
        let centre: Vec3 = std::array::from_fn(|a| target.min[a] + 0.5 * extent[a]);
        let radius = 0.5 * norm(extent);
        let longest = extent.into_iter().fold(0.0, f64::max);
        let corners: [Vec3; 8] = std::array::from_fn(|c| {
            std::array::from_fn(|a| if c >> a & 1 == 1 { target.max[a] } else { target.min[a] })
        });
        let (mut common, mut at_corners, mut error) = (0.0, [0.0; 8], 0.0);
        // What is summed at each point.
        let (mut expansions, mut leaves): (Vec<&Expansion>, Vec<&[[Vec3; 3]]>) = (Vec::new(), Vec::new());
        let mut stack = Stack::new();
        while let Some(i) = stack.pop() {
            let expansion = &self.expansions[i];
            let x = sub(expansion.centre, centre);
            let gap = norm(x) - radius;
            let size = expansion.far.sqrt() / ACCURACY;
            if gap > ACCURACY * size {
                // The gradient of a solid angle is at most twice the area over the distance cubed, and the
                // second derivatives along three axes are together at most 12 times that over its fourth
                // power.
                let (distance, angle) = (gap - size, self.areas[i] / (4.0 * PI));
                let constant = 2.0 * angle * radius / distance.powi(3);
                let linear = 12.0 / 8.0 * angle * longest * longest / distance.powi(4);
                if constant < negligible {
                    error += constant;
                    common += expansion.evaluate(x);
                } else if linear < negligible {
                    error += linear;
                    for (value, corner) in at_corners.iter_mut().zip(&corners) {
                        *value += expansion.evaluate(sub(expansion.centre, *corner));
                    }
                } else {
                    expansions.push(expansion);
                }
            } else if self.bvh.nodes[i].count > 0 {
                leaves.push(self.leaf(i));
            } else {
                stack.push(self.bvh.nodes[i].first as usize);
                stack.push(i + 1);
            }
        }
        let mut columns = Columns::of(points);
        columns.add(&expansions, &leaves);
        let linear = at_corners != [0.0; 8];
        for (sum, point) in columns.sums.iter_mut().zip(points) {
            *sum += common + if linear { trilinear(target, &at_corners, *point) } else { 0.0 };
        }
        (columns.sums, error)
    }

    /// The triangles of a leaf.
    fn leaf(&self, i: usize) -> &[[Vec3; 3]] {
        let (start, count) = (self.bvh.nodes[i].first as usize, self.bvh.nodes[i].count as usize);
        &self.bvh.corners[start..start + count]
    }

    /// About how many solid angles a point of a box takes in [`Self::winding_numbers`].
    pub(crate) fn work(&self, target: &BoundingBox) -> f64 {
        if self.bvh.is_empty() {
            return 0.0;
        }
        let (mut work, mut stack) = (1.5, Stack::new());
        let centre: Vec3 = std::array::from_fn(|a| 0.5 * (target.min[a] + target.max[a]));
        let radius = 0.5 * target.diagonal();
        while let Some(i) = stack.pop() {
            let expansion = &self.expansions[i];
            let gap = norm(sub(expansion.centre, centre)) - radius;
            let size = expansion.far.sqrt() / ACCURACY;
            let node = &self.bvh.nodes[i];
            if gap > ACCURACY * size {
                let (distance, angle) = (gap - size, self.areas[i] / (4.0 * PI));
                // Interpolated from the corners of the block, an eighth of its points, or evaluated at each.
                work += if angle * 2.0 * radius * radius < NEGLIGIBLE * distance.powi(4) { 0.1 } else { 1.0 };
            } else if node.count > 0 {
                let near = dot(sub(expansion.centre, centre), sub(expansion.centre, centre)) < expansion.far;
                work += if near { f64::from(node.count) } else { 1.0 };
            } else {
                stack.push(node.first as usize);
                stack.push(i + 1);
            }
        }
        work
    }

    /// What the triangles of a leaf add, one by one.
    fn of_leaf(&self, i: usize, point: Vec3) -> f64 {
        sum_of_solid_angles(self.leaf(i), point)
    }

    /// Whether the winding number stays below `bound` in absolute value all over a box: `true` is certain.
    pub(crate) fn is_below(&self, bound: f64, target: &BoundingBox) -> bool {
        if self.bvh.is_empty() {
            return true;
        }
        let middle: Vec3 = std::array::from_fn(|a| 0.5 * (target.min[a] + target.max[a]));
        let reach = 0.5 * target.diagonal();
        let (mut certain, mut stack) = (0.0, Stack::new());
        while let Some(i) = stack.pop() {
            let node = &self.bvh.nodes[i];
            let gap = (distance_squared(&node.bounds, middle).sqrt() - reach).max(0.0);
            // A triangle's solid angle is at most its area over the squared distance.
            let angle = self.areas[i] / (4.0 * PI * gap * gap);
            if angle < 0.05 * bound {
                certain += angle;
            } else if node.count == 0 {
                stack.push(node.first as usize);
                stack.push(i + 1);
            } else {
                // Each by its own distance. None takes up more than half of all directions.
                certain += angle.min(
                    self.leaf(i)
                        .iter()
                        .map(|triangle| {
                            let gap =
                                (norm(sub(nearest_on_triangle(triangle, middle), middle)) - reach).max(0.0);
                            (norm(area_vector(triangle)) / (4.0 * PI * gap * gap)).min(0.5)
                        })
                        .sum(),
                );
            }
            if certain >= bound {
                return false;
            }
        }
        true
    }
}

/// What is linear along each axis of a box, from its values at the corners.
fn trilinear(target: &BoundingBox, at_corners: &[f64; 8], p: Vec3) -> f64 {
    let place: Vec3 = std::array::from_fn(|a| {
        let extent = target.max[a] - target.min[a];
        if extent > 0.0 { (p[a] - target.min[a]) / extent } else { 0.0 }
    });
    // Along x, then y, then z.
    let between = |low: f64, high: f64, a: usize| low + place[a] * (high - low);
    let along_x: [f64; 4] = std::array::from_fn(|c| between(at_corners[2 * c], at_corners[2 * c + 1], 0));
    between(between(along_x[0], along_x[1], 1), between(along_x[2], along_x[3], 1), 2)
}

/// The half nearest to a number: an integer and a half.
#[inline]
fn half(x: f64) -> f64 {
    x.floor() + 0.5
}

/// The solid angles of some triangles over 4 pi. The half angles are the arguments of complex numbers: these are
/// multiplied, and the turns counted, so that one arc tangent serves all.
#[inline]
pub(super) fn sum_of_solid_angles(triangles: &[[Vec3; 3]], point: Vec3) -> f64 {
    let (mut re, mut im, mut turns, mut on_planes) = (1.0, 0.0, 0i32, 0.0);
    for triangle in triangles {
        let [a, b, c] = triangle.map(|p| sub(p, point));
        let (la, lb, lc) = (norm(a), norm(b), norm(c));
        let det = dot(a, cross(b, c));
        let rest = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
        let size = rest.abs() + det.abs();
        if size == 0.0 || rest < 0.0 && det.abs() <= 1e-8 * size {
            on_planes += perturbed_solid_angle(triangle, point);
            continue;
        }
        let (x, y) = (rest / size, det / size);
        let before = im;
        (re, im) = (re * x - im * y, re * y + im * x);
        // Two angles of one sign whose sum has the other one passed half a turn.
        turns +=
            i32::from(before > 0.0 && y > 0.0 && im < 0.0) - i32::from(before < 0.0 && y < 0.0 && im > 0.0);
        // Not smaller than a half, so that no product vanishes.
        let scale = 1.0 / (re.abs() + im.abs());
        (re, im) = (re * scale, im * scale);
    }
    on_planes + im.atan2(re) / (2.0 * PI) + f64::from(turns)
}

/// The solid angle of a triangle over 4 pi, on its plane as seen from the perturbed point.
#[inline]
fn perturbed_solid_angle(corners: &[Vec3; 3], point: Vec3) -> f64 {
    let angle = solid_angle(corners, point);
    // Far from a half and from zero the sign is beyond doubt.
    if angle.abs() > 1e-9 && angle.abs() < 0.5 - 1e-9 {
        return angle;
    }
    let [a, b, c] = corners.map(|p| sub(p, point));
    let (la, lb, lc) = (norm(a), norm(b), norm(c));
    let rest = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    if rest >= 0.0 {
        return angle;
    }
    // Within the triangle and next to it: half of all directions, on the side that is exact.
    -f64::from(side(corners, point)) * angle.abs().max(0.5 - 1e-9)
}

//! The generalized winding number of any set of triangles in O(log n) a point: G. Barill, N. Dickson,
//! R. Schmidt, D. Levin and A. Jacobson, *Fast winding numbers for soups and clouds*, 2018.

use super::stack::Stack;
use super::{Bvh, distance_squared};
use crate::predicates::side;
use crate::vector::{Vec3, area_vector, dot, norm, scaled, solid_angle, sub};
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

/// A node is far away beyond this many of its radii; 2 in Barill et al.
const ACCURACY: f64 = 2.0;

/// A node whose part of the winding number changes by less is taken as constant.
const NEGLIGIBLE: f64 = 5e-5;

/// The far field of a node's triangles around their centre, contracted to what the evaluation reads.
#[derive(Clone, Copy, Debug)]
struct Expansion {
    centre: Vec3,
    /// Square of the distance from which the expansion holds.
    far: f64,
    /// sum A n
    dipole: Vec3,
    /// The symmetric part of sum A n_i d_j: xx, yy, zz, xy, yz, zx.
    linear: [f64; 6],
    /// 2 sum_i M_iik + sum_i M_kii of M_ijk = sum A n_i d_j d_k
    trace: Vec3,
    /// The coefficients of sum_ijk M_ijk x_i x_j x_k: xxx, yyy, zzz, xxy, xxz, yyx, yyz, zzx, zzy, xyz.
    cubic: [f64; 10],
}

/// The moments of a set of triangles around a point.
#[derive(Clone, Copy)]
struct Moments {
    centre: Vec3,
    area: f64,
    radius: f64,
    /// sum A n_i
    zeroth: Vec3,
    /// sum A n_i d_j
    first: [[f64; 3]; 3],
    /// sum A n_i d_j d_k
    second: [[[f64; 3]; 3]; 3],
}

impl WindingTree {
    /// A tree over all triangles of a mesh, as they are oriented. Cost: O(n log n).
    pub fn new(mesh: &TriangleMesh) -> Self {
        Self::over((0..mesh.triangles().len()).map(|t| mesh.corners(t)).collect())
    }

    pub(crate) fn over(corners: Vec<[Vec3; 3]>) -> Self {
        let bvh = Bvh::over(corners);
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
        if self.bvh.is_empty() {
            return 0.0;
        }
        let mut sum = 0.0;
        let mut stack = Stack::new();
        while let Some(i) = stack.pop() {
            let x = sub(self.expansions[i].centre, point);
            let node = &self.bvh.nodes[i];
            if node.count > 0 || dot(x, x) > self.expansions[i].far {
                sum += self.of_node(i, point);
            } else {
                stack.push(node.first as usize);
                stack.push(i + 1);
            }
        }
        sum
    }

    /// The winding number at points of a box, as [`Self::winding_number`] but for 1e-3: what hardly changes
    /// over the box is summed once, and what changes almost linearly is interpolated between its corners.
    pub(crate) fn winding_numbers(&self, target: &BoundingBox, points: &[Vec3]) -> Vec<f64> {
        if self.bvh.is_empty() {
            return vec![0.0; points.len()];
        }
        let extent = target.extent();
        let centre: Vec3 = std::array::from_fn(|a| target.min[a] + 0.5 * extent[a]);
        let radius = 0.5 * norm(extent);
        let longest = extent.into_iter().fold(0.0, f64::max);
        let corners: [Vec3; 8] = std::array::from_fn(|c| {
            std::array::from_fn(|a| if c >> a & 1 == 1 { target.max[a] } else { target.min[a] })
        });
        let (mut common, mut at_corners) = (0.0, [0.0; 8]);
        let (mut own, mut stack) = (Vec::new(), Stack::new());
        while let Some(i) = stack.pop() {
            let expansion = &self.expansions[i];
            let x = sub(expansion.centre, centre);
            let gap = norm(x) - radius;
            let size = expansion.far.sqrt() / ACCURACY;
            if gap > ACCURACY * size {
                // The gradient of a solid angle is at most twice the area over the distance cubed, and the
                // second derivatives along three axes are together at most 12 times that over its fourth power.
                let (distance, angle) = (gap - size, self.areas[i] / (4.0 * PI));
                if 2.0 * angle * radius < NEGLIGIBLE * distance.powi(3) {
                    common += expansion.evaluate(x);
                } else if 12.0 / 8.0 * angle * longest * longest < NEGLIGIBLE * distance.powi(4) {
                    for (value, corner) in at_corners.iter_mut().zip(&corners) {
                        *value += expansion.evaluate(sub(expansion.centre, *corner));
                    }
                } else {
                    own.push(i);
                }
            } else if self.bvh.nodes[i].count > 0 {
                own.push(i);
            } else {
                stack.push(self.bvh.nodes[i].first as usize);
                stack.push(i + 1);
            }
        }
        let at =
            |p: &Vec3| {
                let place: Vec3 = std::array::from_fn(|a| {
                    if extent[a] > 0.0 { (p[a] - target.min[a]) / extent[a] } else { 0.0 }
                });
                let weight = |c: usize| -> f64 {
                    (0..3).map(|a| if c >> a & 1 == 1 { place[a] } else { 1.0 - place[a] }).product()
                };
                let linear: f64 = (0..8).map(|c| weight(c) * at_corners[c]).sum();
                common + linear + own.iter().map(|&i| self.of_node(i, *p)).sum::<f64>()
            };
        points.iter().map(at).collect()
    }

    /// What a leaf, or a node far away, adds to the winding number.
    #[inline]
    fn of_node(&self, i: usize, point: Vec3) -> f64 {
        let x = sub(self.expansions[i].centre, point);
        if dot(x, x) > self.expansions[i].far {
            return self.expansions[i].evaluate(x);
        }
        let (start, count) = (self.bvh.nodes[i].first as usize, self.bvh.nodes[i].count as usize);
        self.bvh.corners[start..start + count].iter().map(|t| perturbed_solid_angle(t, point)).sum()
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
                // No triangle takes up more than half of all directions.
                certain += angle.min(0.5 * f64::from(node.count));
            }
            if certain >= bound {
                return false;
            }
        }
        true
    }
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

impl Moments {
    fn of(triangles: &[[Vec3; 3]]) -> Self {
        let (mut area, mut weighted) = (0.0, [0.0; 3]);
        for t in triangles {
            let a = norm(area_vector(t));
            let middle: Vec3 = std::array::from_fn(|i| (t[0][i] + t[1][i] + t[2][i]) / 3.0);
            area += a;
            weighted = std::array::from_fn(|i| weighted[i] + a * middle[i]);
        }
        let centre = if area > 0.0 { scaled(weighted, 1.0 / area) } else { triangles[0][0] };
        let mut moments = Self {
            centre,
            area,
            radius: 0.0,
            zeroth: [0.0; 3],
            first: [[0.0; 3]; 3],
            second: [[[0.0; 3]; 3]; 3],
        };
        for t in triangles {
            let n = area_vector(t);
            let d = t.map(|p| sub(p, centre));
            moments.radius = d.iter().map(|d| norm(*d)).fold(moments.radius, f64::max);
            let sum: Vec3 = std::array::from_fn(|i| d[0][i] + d[1][i] + d[2][i]);
            for i in 0..3 {
                moments.zeroth[i] += n[i];
                for j in 0..3 {
                    moments.first[i][j] += n[i] * sum[j] / 3.0;
                    for k in 0..3 {
                        // The mean of d_j d_k over the triangle.
                        let mean = (d.iter().map(|d| d[j] * d[k]).sum::<f64>() + sum[j] * sum[k]) / 12.0;
                        moments.second[i][j][k] += n[i] * mean;
                    }
                }
            }
        }
        moments
    }

    fn join(&self, other: &Self) -> Self {
        let area = self.area + other.area;
        let share = if area > 0.0 { other.area / area } else { 0.5 };
        let centre: Vec3 =
            std::array::from_fn(|i| self.centre[i] + share * (other.centre[i] - self.centre[i]));
        let (mut a, b) = (self.moved_to(centre), other.moved_to(centre));
        a.area = area;
        a.radius = a.radius.max(b.radius);
        for i in 0..3 {
            a.zeroth[i] += b.zeroth[i];
            for j in 0..3 {
                a.first[i][j] += b.first[i][j];
                for k in 0..3 {
                    a.second[i][j][k] += b.second[i][j][k];
                }
            }
        }
        a
    }

    fn moved_to(&self, centre: Vec3) -> Self {
        let s = sub(self.centre, centre);
        let mut moved = Self { centre, radius: self.radius + norm(s), ..*self };
        for i in 0..3 {
            for j in 0..3 {
                moved.first[i][j] += self.zeroth[i] * s[j];
                for k in 0..3 {
                    moved.second[i][j][k] +=
                        self.first[i][j] * s[k] + self.first[i][k] * s[j] + self.zeroth[i] * s[j] * s[k];
                }
            }
        }
        moved
    }

    fn expansion(&self) -> Expansion {
        let (f, m) = (&self.first, &self.second);
        let linear = [f[0][0], f[1][1], f[2][2], f[0][1] + f[1][0], f[1][2] + f[2][1], f[2][0] + f[0][2]];
        let trace = std::array::from_fn(|k| (0..3).map(|i| 2.0 * m[i][i][k] + m[k][i][i]).sum());
        let square = |a: usize, b: usize| m[b][a][a] + m[a][a][b] + m[a][b][a];
        let cubic = [
            m[0][0][0],
            m[1][1][1],
            m[2][2][2],
            square(0, 1),
            square(0, 2),
            square(1, 0),
            square(1, 2),
            square(2, 0),
            square(2, 1),
            m[0][1][2] + m[0][2][1] + m[1][0][2] + m[1][2][0] + m[2][0][1] + m[2][1][0],
        ];
        let far = (ACCURACY * self.radius).powi(2);
        Expansion { centre: self.centre, far, dipole: self.zeroth, linear, trace, cubic }
    }
}

impl Expansion {
    /// The terms of order 0, 1 and 2 of w in x = centre - q: with g = x / (4 pi |x|^3),
    /// `sum A n_i (g_i + d_j dg_i/dx_j + d_j d_k d2g_i/dx_j dx_k / 2)`.
    #[inline]
    fn evaluate(&self, x: Vec3) -> f64 {
        let [px, py, pz] = x;
        let r2 = 1.0 / dot(x, x);
        let r3 = r2 * r2.sqrt();
        let r5 = r3 * r2;
        let l = &self.linear;
        let quadratic =
            px * (l[0] * px + l[3] * py) + py * (l[1] * py + l[4] * pz) + pz * (l[2] * pz + l[5] * px);
        let c = &self.cubic;
        let cubic = px * px * (c[0] * px + c[3] * py + c[4] * pz)
            + py * py * (c[1] * py + c[5] * px + c[6] * pz)
            + pz * pz * (c[2] * pz + c[7] * px + c[8] * py)
            + px * py * pz * c[9];
        let value = r3 * (dot(self.dipole, x) + l[0] + l[1] + l[2])
            - r5 * (3.0 * quadratic + 1.5 * dot(self.trace, x))
            + 7.5 * r5 * r2 * cubic;
        value / (4.0 * PI)
    }
}

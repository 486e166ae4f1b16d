//! The far field of a set of triangles: their moments, and the expansion of the winding number to second
//! order.

use crate::triangle_geometry::area_vector;
use mser3d_shape::vector::{Vec3, dot, norm, scale, sub};
use std::f64::consts::PI;

/// A node is far away beyond this many of its radii; 2 in Barill et al.
pub(super) const ACCURACY: f64 = 2.0;

/// The far field of a node's triangles around their centre, contracted to what the evaluation reads.
#[derive(Clone, Copy, Debug)]
pub(super) struct Expansion {
    pub centre: Vec3,
    /// Square of the distance from which the expansion holds.
    pub far: f64,
    /// sum A n
    pub dipole: Vec3,
    /// The symmetric part of sum A n_i d_j: xx, yy, zz, xy, yz, zx.
    pub linear: [f64; 6],
    /// 2 sum_i M_iik + sum_i M_kii of M_ijk = sum A n_i d_j d_k
    pub trace: Vec3,
    /// The coefficients of sum_ijk M_ijk x_i x_j x_k: xxx, yyy, zzz, xxy, xxz, yyx, yyz, zzx, zzy, xyz.
    pub cubic: [f64; 10],
}

/// The moments of a set of triangles around a point.
#[derive(Clone, Copy)]
pub(super) struct Moments {
    centre: Vec3,
    pub area: f64,
    radius: f64,
    /// sum A n_i
    zeroth: Vec3,
    /// sum A n_i d_j
    first: [[f64; 3]; 3],
    /// sum A n_i d_j d_k
    second: [[[f64; 3]; 3]; 3],
}

impl Moments {
    pub fn of(triangles: &[[Vec3; 3]]) -> Self {
        let (mut area, mut weighted) = (0.0, [0.0; 3]);
        for t in triangles {
            let a = norm(area_vector(t));
            let middle: Vec3 = std::array::from_fn(|i| (t[0][i] + t[1][i] + t[2][i]) / 3.0);
            area += a;
            weighted = std::array::from_fn(|i| weighted[i] + a * middle[i]);
        }
        let centre = if area > 0.0 { scale(weighted, 1.0 / area) } else { triangles[0][0] };
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

    pub fn join(&self, other: &Self) -> Self {
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

    pub fn expansion(&self) -> Expansion {
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
    pub fn evaluate(&self, x: Vec3) -> f64 {
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

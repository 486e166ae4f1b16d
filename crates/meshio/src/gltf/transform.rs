//! Affine maps and rotations.

/// An affine map: three rows of a 3 x 4 matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Affine(pub [[f64; 4]; 3]);

impl Affine {
    pub(super) const IDENTITY: Self = Self([[1., 0., 0., 0.], [0., 1., 0., 0.], [0., 0., 1., 0.]]);

    /// From a 4 x 4 matrix, column by column, whose last row is taken to be (0, 0, 0, 1).
    pub(super) fn from_columns(m: &[f64]) -> Self {
        Self(std::array::from_fn(|row| std::array::from_fn(|column| m[4 * column + row])))
    }

    /// Scale, then rotate by a quaternion (x, y, z, w), then translate.
    pub(super) fn from_parts(t: [f64; 3], q: [f64; 4], s: [f64; 3]) -> Self {
        let [x, y, z, w] = unit(q);
        let rotation = [
            [1. - 2. * (y * y + z * z), 2. * (x * y - w * z), 2. * (x * z + w * y)],
            [2. * (x * y + w * z), 1. - 2. * (x * x + z * z), 2. * (y * z - w * x)],
            [2. * (x * z - w * y), 2. * (y * z + w * x), 1. - 2. * (x * x + y * y)],
        ];
        Self(std::array::from_fn(|i| {
            let r = rotation[i];
            [r[0] * s[0], r[1] * s[1], r[2] * s[2], t[i]]
        }))
    }

    /// `self` after `first`.
    pub(super) fn after(&self, first: &Self) -> Self {
        Self(std::array::from_fn(|i| {
            let row = self.0[i];
            std::array::from_fn(|j| {
                let product: f64 = (0..3).map(|k| row[k] * first.0[k][j]).sum();
                product + if j == 3 { row[3] } else { 0.0 }
            })
        }))
    }

    pub(super) fn apply(&self, p: [f64; 3]) -> [f64; 3] {
        self.0.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3])
    }

    /// `self + weight * other`, for blending.
    pub(super) fn add(&mut self, weight: f64, other: &Self) {
        for i in 0..3 {
            for j in 0..4 {
                self.0[i][j] += weight * other.0[i][j];
            }
        }
    }

    /// Negative when the map turns the inside out.
    pub(super) fn determinant(&self) -> f64 {
        let [a, b, c] = self.0;
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    }
}

/// The quaternion scaled to length 1; no rotation for length 0.
pub(super) fn unit(q: [f64; 4]) -> [f64; 4] {
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 { q.map(|x| x / length) } else { [0., 0., 0., 1.] }
}

/// Spherical linear interpolation of rotations, the short way round (Shoemake 1985).
pub(super) fn slerp(a: [f64; 4], b: [f64; 4], u: f64) -> [f64; 4] {
    let (a, mut b) = (unit(a), unit(b));
    let mut cosine: f64 = (0..4).map(|i| a[i] * b[i]).sum();
    if cosine < 0.0 {
        b = b.map(|x| -x);
        cosine = -cosine;
    }
    let angle = cosine.min(1.0).acos();
    // Below this angle the sines cancel; the chord is then exact to rounding.
    let (from, to) = if angle < 1e-6 {
        (1.0 - u, u)
    } else {
        (((1.0 - u) * angle).sin() / angle.sin(), (u * angle).sin() / angle.sin())
    };
    unit(std::array::from_fn(|i| from * a[i] + to * b[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_1_SQRT_2;

    #[test]
    fn parts_act_in_the_order_scale_rotate_translate() {
        // A quarter turn about z takes x to y.
        let map = Affine::from_parts([10., 0., 0.], [0., 0., FRAC_1_SQRT_2, FRAC_1_SQRT_2], [2., 3., 4.]);
        let moved = map.apply([1., 0., 1.]);
        let expected = [10., 2., 4.];
        assert!((0..3).all(|a| (moved[a] - expected[a]).abs() < 1e-14), "{moved:?}");
        assert!((map.determinant() - 24.0).abs() < 1e-12);
        let twice = map.after(&map).apply([1., 0., 1.]);
        let step = map.apply(moved);
        assert!((0..3).all(|a| (twice[a] - step[a]).abs() < 1e-12));
    }

    #[test]
    fn slerp_halves_the_angle_the_short_way() {
        let quarter = [0., 0., FRAC_1_SQRT_2, FRAC_1_SQRT_2];
        for end in [quarter, quarter.map(|x| -x)] {
            let half = slerp([0., 0., 0., 1.], end, 0.5);
            let eighth = std::f64::consts::PI / 8.0;
            assert!((half[2] - eighth.sin()).abs() < 1e-15 && (half[3] - eighth.cos()).abs() < 1e-15);
        }
        assert_eq!(slerp(quarter, quarter, 0.3), unit(quarter));
    }
}

//! Winding numbers at many points at once: a lane of a vector register for each.

use super::far_field::Expansion;
use super::winding::sum_of_solid_angles;
use mser3d_shape::vector::Vec3;
use pulp::{Simd, WithSimd};
use std::f64::consts::PI;

/// Points, coordinate by coordinate, and the winding number around each. As many as fill the widest registers, or a multiple.
pub(super) struct Columns<const N: usize> {
    places: [[f64; N]; 3],
    pub sums: [f64; N],
}

impl<const N: usize> Columns<N> {
    pub fn of(points: &[Vec3; N]) -> Self {
        Self { places: [0, 1, 2].map(|a| points.map(|p| p[a])), sums: [0.0; N] }
    }

    /// Adds what these expansions and triangles make of the winding numbers.
    pub fn add(&mut self, expansions: &[&Expansion], leaves: &[&[[Vec3; 3]]]) {
        let [x, y, z] = &self.places;
        let (arch, sums) = (pulp::Arch::new(), &mut self.sums);
        if !expansions.is_empty() {
            arch.dispatch(Expansions { expansions, x, y, z, sums });
        }
        if leaves.is_empty() {
            return;
        }
        let [mut angles, mut doubts] = [[0.0; N]; 2];
        arch.dispatch(SolidAngles { leaves, x, y, z, angles: &mut angles, doubts: &mut doubts });
        for i in 0..N {
            self.sums[i] += if doubts[i] == 0.0 {
                angles[i]
            } else {
                let point = [x[i], y[i], z[i]];
                leaves.iter().map(|triangles| sum_of_solid_angles(triangles, point)).sum()
            };
        }
    }
}

/// As [`Expansion::evaluate`].
struct Expansions<'a> {
    expansions: &'a [&'a Expansion],
    x: &'a [f64],
    y: &'a [f64],
    z: &'a [f64],
    sums: &'a mut [f64],
}

impl WithSimd for Expansions<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let [x, y, z] = [self.x, self.y, self.z].map(|column| S::as_simd_f64s(column).0);
        let sums = S::as_mut_simd_f64s(self.sums).0;
        let (mul, add, sub) =
            (|a, b| simd.mul_f64s(a, b), |a, b| simd.add_f64s(a, b), |a, b| simd.sub_f64s(a, b));
        let (fma, splat) = (|a, b, c| simd.mul_add_f64s(a, b, c), |a: f64| simd.splat_f64s(a));
        for expansion in self.expansions {
            let Expansion { centre, dipole: d, linear: l, trace: t, cubic: c, .. } = expansion;
            for (((&x, &y), &z), sum) in x.iter().zip(y).zip(z).zip(sums.iter_mut()) {
                let px = sub(splat(centre[0]), x);
                let py = sub(splat(centre[1]), y);
                let pz = sub(splat(centre[2]), z);
                let (xx, yy, zz) = (mul(px, px), mul(py, py), mul(pz, pz));
                let r2 = simd.div_f64s(splat(1.0), add(xx, add(yy, zz)));
                let r3 = mul(r2, simd.sqrt_f64s(r2));
                let r5 = mul(r3, r2);
                let along = |v: &Vec3, s| fma(splat(v[0]), px, fma(splat(v[1]), py, fma(splat(v[2]), pz, s)));
                let first = along(d, splat(l[0] + l[1] + l[2]));
                let pair = |a, b, p, q| fma(splat(a), p, mul(splat(b), q));
                let quadratic = fma(
                    px,
                    pair(l[0], l[3], px, py),
                    fma(py, pair(l[1], l[4], py, pz), mul(pz, pair(l[2], l[5], pz, px))),
                );
                let triple = |a, b, c, p, q, r| fma(splat(a), p, fma(splat(b), q, mul(splat(c), r)));
                let cubic = fma(
                    xx,
                    triple(c[0], c[3], c[4], px, py, pz),
                    fma(
                        yy,
                        triple(c[1], c[5], c[6], py, px, pz),
                        fma(zz, triple(c[2], c[7], c[8], pz, px, py), mul(mul(px, py), mul(pz, splat(c[9])))),
                    ),
                );
                let zero = splat(0.0);
                let second = fma(splat(3.0), quadratic, mul(splat(1.5), along(t, zero)));
                let value = fma(mul(mul(splat(7.5), r5), r2), cubic, sub(mul(r3, first), mul(r5, second)));
                *sum = fma(splat(1.0 / (4.0 * PI)), value, *sum);
            }
        }
    }
}

/// As [`sum_of_solid_angles`], to 3e-6; and whether a point lies on the plane of some triangle, where it is not to be trusted.
struct SolidAngles<'a> {
    leaves: &'a [&'a [[Vec3; 3]]],
    x: &'a [f64],
    y: &'a [f64],
    z: &'a [f64],
    angles: &'a mut [f64],
    doubts: &'a mut [f64],
}

impl WithSimd for SolidAngles<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let [xs, ys, zs] = [self.x, self.y, self.z].map(|column| S::as_simd_f64s(column).0);
        let [angles, all_doubts] = [self.angles, self.doubts].map(|column| S::as_mut_simd_f64s(column).0);
        let splat = |a: f64| simd.splat_f64s(a);
        let (zero, one) = (splat(0.0), splat(1.0));
        for at in 0..xs.len() {
            let (mut re, mut im, mut turns, mut doubts) = (one, zero, zero, zero);
            for triangle in self.leaves.iter().copied().flatten() {
                let from = |p: &Vec3| {
                    [
                        simd.sub_f64s(splat(p[0]), xs[at]),
                        simd.sub_f64s(splat(p[1]), ys[at]),
                        simd.sub_f64s(splat(p[2]), zs[at]),
                    ]
                };
                let dot = |a: [S::f64s; 3], b: [S::f64s; 3]| {
                    simd.mul_add_f64s(a[0], b[0], simd.mul_add_f64s(a[1], b[1], simd.mul_f64s(a[2], b[2])))
                };
                let minor = |a: S::f64s, b: S::f64s, c: S::f64s, d: S::f64s| {
                    simd.sub_f64s(simd.mul_f64s(a, b), simd.mul_f64s(c, d))
                };
                let [a, b, c] = triangle.each_ref().map(from);
                let [la, lb, lc] = [a, b, c].map(|v| simd.sqrt_f64s(dot(v, v)));
                let cross = [
                    minor(b[1], c[2], b[2], c[1]),
                    minor(b[2], c[0], b[0], c[2]),
                    minor(b[0], c[1], b[1], c[0]),
                ];
                let det = dot(a, cross);
                let rest = simd.mul_add_f64s(
                    simd.mul_add_f64s(la, lb, dot(a, b)),
                    lc,
                    simd.mul_add_f64s(dot(b, c), la, simd.mul_f64s(dot(c, a), lb)),
                );
                let (size_of_det, size) =
                    (simd.abs_f64s(det), simd.add_f64s(simd.abs_f64s(rest), simd.abs_f64s(det)));
                // On the plane, within the triangle or next to it.
                let flat = simd.less_than_or_equal_f64s(size_of_det, simd.mul_f64s(splat(1e-8), size));
                let behind = simd.less_than_or_equal_f64s(rest, zero);
                doubts = simd.select_f64s(behind, simd.select_f64s(flat, one, doubts), doubts);
                let before = im;
                let next = simd.sub_f64s(simd.mul_f64s(re, rest), simd.mul_f64s(im, det));
                im = simd.mul_add_f64s(re, det, simd.mul_f64s(im, rest));
                re = next;
                let same = simd.greater_than_f64s(simd.mul_f64s(before, det), zero);
                let turned = simd.less_than_f64s(simd.mul_f64s(before, im), zero);
                let turn = simd.select_f64s(simd.greater_than_f64s(before, zero), one, splat(-1.0));
                let turn = simd.select_f64s(same, simd.select_f64s(turned, turn, zero), zero);
                turns = simd.add_f64s(turns, turn);
                let scale = simd.div_f64s(one, simd.add_f64s(simd.abs_f64s(re), simd.abs_f64s(im)));
                (re, im) = (simd.mul_f64s(re, scale), simd.mul_f64s(im, scale));
            }
            (angles[at], all_doubts[at]) = (simd.add_f64s(turns, turn_of(simd, re, im)), doubts);
        }
    }
}

/// The argument of complex numbers in turns, to 2e-6.
#[inline(always)]
fn turn_of<S: Simd>(simd: S, re: S::f64s, im: S::f64s) -> S::f64s {
    /// The arc tangent over its argument, by even powers (minimax on [0, 1]).
    const ODD: [f64; 6] = [0.99997726, -0.33262347, 0.19354346, -0.11643287, 0.05265332, -0.01172120];
    let splat = |a: f64| simd.splat_f64s(a);
    let (x, y) = (simd.abs_f64s(re), simd.abs_f64s(im));
    let steep = simd.greater_than_f64s(y, x);
    let (low, high) = (simd.select_f64s(steep, x, y), simd.select_f64s(steep, y, x));
    let q = simd.div_f64s(low, high);
    let square = simd.mul_f64s(q, q);
    let series = ODD.iter().rev().fold(splat(0.0), |sum, &c| simd.mul_add_f64s(sum, square, splat(c)));
    let angle = simd.mul_f64s(simd.mul_f64s(series, q), splat(1.0 / (2.0 * PI)));
    let angle = simd.select_f64s(steep, simd.sub_f64s(splat(0.25), angle), angle);
    let left = simd.less_than_f64s(re, splat(0.0));
    let angle = simd.select_f64s(left, simd.sub_f64s(splat(0.5), angle), angle);
    simd.select_f64s(simd.less_than_f64s(im, splat(0.0)), simd.neg_f64s(angle), angle)
}

#[cfg(test)]
mod tests {
    use super::super::far_field::Moments;
    use super::*;
    use mser3d_shape::SplitMix64;

    #[test]
    fn lanes_agree_with_points_one_by_one() {
        let mut random = SplitMix64::new(5);
        let mut point =
            |reach: f64| -> Vec3 { std::array::from_fn(|_| reach * (2.0 * random.uniform() - 1.0)) };
        let triangles: Vec<[Vec3; 3]> = (0..11).map(|_| [0, 1, 2].map(|_| point(1.0))).collect();
        let mut points: [Vec3; 64] = std::array::from_fn(|_| point(1.5));
        // On a triangle, and on the corner of one.
        let [a, b, c] = triangles[3];
        points[20] = std::array::from_fn(|i| (a[i] + b[i] + c[i]) / 3.0);
        points[63] = a;
        let expansion = Moments::of(&triangles).expansion();
        let far = points.map(|p| [p[0] + 9.0, p[1], p[2]]);
        let mut columns = Columns::of(&far);
        columns.add(&[&expansion, &expansion], &[]);
        for (p, sum) in far.iter().zip(&columns.sums) {
            let x = std::array::from_fn(|i| expansion.centre[i] - p[i]);
            assert!((sum - 2.0 * expansion.evaluate(x)).abs() < 1e-14);
        }
        let mut columns = Columns::of(&points);
        columns.add(&[], &[&triangles[..4], &triangles[4..]]);
        for (p, sum) in points.iter().zip(&columns.sums) {
            let plain = sum_of_solid_angles(&triangles, *p);
            assert!((sum - plain).abs() < 3e-6, "{p:?}: {sum} {plain}");
        }
    }
}

//! Areas of triangles, and the solid angles that they take up.

use mser3d_shape::vector::{Vec3, cross, dot, norm, scale, sub};

/// The area of a triangle times its unit normal.
#[inline]
pub(crate) fn area_vector([a, b, c]: &[Vec3; 3]) -> Vec3 {
    scale(cross(sub(*b, *a), sub(*c, *a)), 0.5)
}

/// The solid angle of a triangle seen from p over 4 pi: its part of the winding number
/// (Van Oosterom and Strackee 1983). Positive from behind the triangle.
#[inline]
pub(crate) fn solid_angle([a, b, c]: &[Vec3; 3], p: Vec3) -> f64 {
    let (a, b, c) = (sub(*a, p), sub(*b, p), sub(*c, p));
    let (la, lb, lc) = (norm(a), norm(b), norm(c));
    let det = dot(a, cross(b, c));
    let rest = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    // On the triangle's plane det is zero, and so is the angle, inside the triangle too: the caller
    // that needs the limit from one side breaks the tie.
    if det == 0.0 { 0.0 } else { det.atan2(rest) / (2.0 * std::f64::consts::PI) }
}

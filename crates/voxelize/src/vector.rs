//! Three-vectors as arrays.

pub(crate) type Vec3 = [f64; 3];

#[inline]
pub(crate) fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
pub(crate) fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline]
pub(crate) fn scaled(a: Vec3, s: f64) -> Vec3 {
    a.map(|x| x * s)
}

#[inline]
pub(crate) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline]
pub(crate) fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// The area of a triangle times its unit normal.
#[inline]
pub(crate) fn area_vector([a, b, c]: &[Vec3; 3]) -> Vec3 {
    scaled(cross(sub(*b, *a), sub(*c, *a)), 0.5)
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

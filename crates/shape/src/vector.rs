//! Three-vectors as plain arrays, as meshes store them.
//!
//! Only operations that IEEE 754 rounds correctly, so that results are the same bits everywhere.
//!
//! ```
//! use mser3d_shape::vector::{cross, dot, unit};
//! let normal = unit(cross([2.0, 0.0, 0.0], [0.0, 3.0, 0.0]));
//! assert_eq!(normal, [0.0, 0.0, 1.0]);
//! assert_eq!(dot(normal, [5.0, 6.0, 7.0]), 7.0);
//! ```

/// A point or a direction.
pub type Vec3 = [f64; 3];

/// `a + b`.
#[inline]
pub fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a - b`.
#[inline]
pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `s a`.
#[inline]
pub fn scale(a: Vec3, s: f64) -> Vec3 {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// The scalar product.
#[inline]
pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product, right-handed.
#[inline]
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Euclidean length.
#[inline]
pub fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// Scaled to length 1; the zero vector stays zero.
#[inline]
pub fn unit(a: Vec3) -> Vec3 {
    let length = norm(a);
    if length > 0.0 { scale(a, 1.0 / length) } else { a }
}

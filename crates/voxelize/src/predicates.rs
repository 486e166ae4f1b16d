//! Exact signs, with ties broken by one symbolic perturbation.
//!
//! A voxel centre that lies exactly on the surface is neither inside nor outside. Every query point
//! P is therefore read as `P + (e_x, e_y, e_z)` with infinitesimals `e_x >> e_y >> e_z > 0` (Edelsbrunner
//! and Mücke's simulation of simplicity, applied to the query points only). The perturbed point lies
//! on no triangle, and a perturbed grid line meets no edge and no vertex, so a closed surface is
//! crossed consistently, and the columns along x, y and z agree about every voxel.

use robust::{Coord, Coord3D};

/// Twice the signed area of the triangle a, b, c in the plane: its sign is exact.
#[inline]
pub(crate) fn orient2d(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let coord = |p: [f64; 2]| Coord { x: p[0], y: p[1] };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// Six times the signed volume of the tetrahedron a, b, c, d: its sign is exact.
#[inline]
pub(crate) fn orient3d(a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3]) -> f64 {
    let coord = |p: [f64; 3]| Coord3D { x: p[0], y: p[1], z: p[2] };
    // Shewchuk's sign is positive when d lies below the plane of a, b, c.
    -robust::orient3d(coord(a), coord(b), coord(c), coord(d))
}

/// The sign of `n . (p - a)` for the triangle's normal `n = (b - a) x (c - a)` and the perturbed
/// point p: 1 in front, -1 behind, 0 only for a triangle without area.
pub(crate) fn side([a, b, c]: &[[f64; 3]; 3], p: [f64; 3]) -> i32 {
    let height = orient3d(*a, *b, *c, p);
    if height != 0.0 {
        return sign(height);
    }
    for (u, v) in [(1, 2), (2, 0), (0, 1)] {
        let component = orient2d([a[u], a[v]], [b[u], b[v]], [c[u], c[v]]);
        if component != 0.0 {
            return sign(component);
        }
    }
    0
}

#[inline]
pub(crate) fn sign(x: f64) -> i32 {
    i32::from(x > 0.0) - i32::from(x < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_of_a_triangle_is_where_its_normal_points() {
        let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(side(&triangle, [0.2, 0.2, 1e-300]), 1);
        assert_eq!(side(&triangle, [5.0, 5.0, -1e-300]), -1);
    }

    #[test]
    fn ties_are_broken_along_x_then_y_then_z() {
        let facing = |normal: [f64; 3]| {
            // A triangle through the origin with this normal.
            let [x, y, z] = normal;
            let corners = if z != 0.0 {
                [[0.0; 3], [1.0, 0.0, -x / z], [0.0, 1.0, -y / z]]
            } else if y != 0.0 {
                [[0.0; 3], [0.0, 0.0, 1.0], [1.0, -x / y, 0.0]]
            } else {
                [[0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            };
            side(&corners, [0.0; 3])
        };
        assert_eq!(facing([1.0, 0.0, 0.0]), 1);
        assert_eq!(facing([-1.0, 4.0, 1.0]), -1);
        assert_eq!(facing([0.0, -1.0, 2.0]), -1);
        assert_eq!(facing([0.0, 0.0, 1.0]), 1);
    }

    #[test]
    fn a_triangle_without_area_has_no_sides() {
        assert_eq!(side(&[[0.0; 3], [1.0; 3], [2.0; 3]], [0.0, 1.0, 0.0]), 0);
    }
}

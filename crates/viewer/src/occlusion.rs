//! Ambient occlusion by depth maps from many directions.

use mser3d_shape::vector::{Vec3, add, cross, dot, scale, sub, unit};
use rayon::prelude::*;

use crate::raster::{Gradient, ScreenPoint, scan};

/// Light directions, spread evenly over the sphere.
const DIRECTIONS: u32 = 128;
/// Samples across the depth map of a direction.
const MAP: i64 = 192;

/// The share of the sky that each vertex sees (ambient occlusion), weighted by the cosine to its
/// normal: 1 in the open, near 0 in a deep fold.
///
/// A depth map per direction, and a look into its four nearest samples per vertex. The sums are
/// integers, so their order does not matter. Cost: O(directions (triangles + vertices)).
pub(crate) fn openness(points: &[Vec3], triangles: &[[u32; 3]], normals: &[Vec3]) -> Vec<f32> {
    let used = || triangles.iter().flatten().map(|&v| points[v as usize]);
    let Some(bounds) = mser3d_shape::BoundingBox::around(used()) else { return vec![1.0; points.len()] };
    let centre = scale(add(bounds.min, bounds.max), 0.5);
    let radius = 0.5 * bounds.diagonal();
    if radius == 0.0 {
        return vec![1.0; points.len()];
    }
    let scaled: Vec<Vec3> = points.iter().map(|&p| scale(sub(p, centre), 1.0 / radius)).collect();
    let none = || (vec![0u32; points.len()], vec![0u32; points.len()]);
    let (seen, all) = (0..DIRECTIONS)
        .into_par_iter()
        .fold(none, |mut sums, i| {
            let light = fibonacci_direction(i);
            let map = DepthMap::new(light, &scaled, triangles);
            for (v, (&p, &n)) in scaled.iter().zip(normals).enumerate() {
                let cosine = dot(n, light);
                if cosine > 0.05 {
                    // 64 x 256 per direction: the sum over all stays far below 2^32.
                    let weight = (cosine * 64.0) as u32;
                    sums.0[v] += weight * map.lit(p, cosine);
                    sums.1[v] += weight * 256;
                }
            }
            sums
        })
        .reduce(none, |mut a, b| {
            a.0.iter_mut().zip(b.0).for_each(|(x, y)| *x += y);
            a.1.iter_mut().zip(b.1).for_each(|(x, y)| *x += y);
            a
        });
    let share = |(&seen, &all): (&u32, &u32)| if all == 0 { 1.0 } else { seen as f32 / all as f32 };
    seen.iter().zip(&all).map(share).collect()
}

/// Point i of a Fibonacci lattice on the unit sphere.
fn fibonacci_direction(i: u32) -> Vec3 {
    let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(DIRECTIONS);
    let turn = std::f64::consts::TAU * (f64::from(i) * 0.618_033_988_749_895).fract();
    let r = (1.0 - y * y).sqrt();
    [r * turn.cos(), y, r * turn.sin()]
}

/// Depth of what a parallel light reaches first, over the unit ball.
struct DepthMap {
    right: Vec3,
    up: Vec3,
    light: Vec3,
    depth: Vec<f32>,
}

impl DepthMap {
    fn new(light: Vec3, points: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let right = unit(cross(if light[1].abs() < 0.9 { [0., 1., 0.] } else { [1., 0., 0.] }, light));
        let up = cross(light, right);
        let mut map = Self { right, up, light, depth: vec![f32::NEG_INFINITY; (MAP * MAP) as usize] };
        let screen: Vec<ScreenPoint> = points
            .iter()
            .map(|&p| {
                let [x, y] = map.place(p);
                ScreenPoint::new(x, y, dot(light, p))
            })
            .collect();
        for triangle in triangles {
            let corners = triangle.map(|v| screen[v as usize]);
            let Some(depth) = Gradient::new(&corners, corners.map(|p| p.z)) else { continue };
            scan(&corners, MAP, (0, MAP), |x, y| {
                let cell = &mut map.depth[(y * MAP + x) as usize];
                *cell = cell.max(depth.at(x, y) as f32);
            });
        }
        map
    }

    /// Where a point lies in the map, in samples.
    fn place(&self, p: Vec3) -> [f64; 2] {
        let size = MAP as f64;
        [dot(self.right, p), dot(self.up, p)].map(|x| (0.5 + 0.49 * x) * size)
    }

    /// How much of the light reaches a point, in 256ths: the four samples around it, weighted.
    fn lit(&self, p: Vec3, cosine: f64) -> u32 {
        let [x, y] = self.place(p).map(|x| (x - 0.5).clamp(0.0, (MAP - 2) as f64));
        let (i, j) = (x as i64, y as i64);
        let (fx, fy) = (((x - i as f64) * 16.0) as u32, ((y - j as f64) * 16.0) as u32);
        // A surface that slants away from the light changes its depth by the tangent per sample.
        let tangent = (1.0 - cosine * cosine).max(0.0).sqrt() / cosine;
        let sample = 2.0 / (0.98 * MAP as f64);
        let own = (dot(self.light, p) + sample * (1.0 + 1.5 * tangent)) as f32;
        let open = |di: i64, dj: i64| u32::from(self.depth[((j + dj) * MAP + i + di) as usize] <= own);
        (16 - fy) * ((16 - fx) * open(0, 0) + fx * open(1, 0))
            + fy * ((16 - fx) * open(0, 1) + fx * open(1, 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{normals, test_shapes};

    #[test]
    fn a_convex_body_sees_the_whole_sky() {
        let sphere = test_shapes::sphere(24, 48);
        let normals = normals::smooth(&sphere).vertices;
        let open = openness(sphere.vertices(), sphere.triangles(), &normals);
        assert!(open.iter().all(|&o| o > 0.97), "{open:?}");
    }

    #[test]
    fn the_inside_of_a_sphere_sees_nothing() {
        let sphere = test_shapes::sphere(24, 48);
        let inward: Vec<Vec3> = normals::smooth(&sphere).vertices.iter().map(|n| scale(*n, -1.0)).collect();
        let open = openness(sphere.vertices(), sphere.triangles(), &inward);
        assert!(open.iter().all(|&o| o < 0.1), "{open:?}");
    }

    #[test]
    fn the_number_of_threads_changes_nothing() {
        let sphere = test_shapes::sphere(10, 20);
        let normals = normals::smooth(&sphere).vertices;
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| openness(sphere.vertices(), sphere.triangles(), &normals))
        };
        assert_eq!(with(1), with(3));
    }
}

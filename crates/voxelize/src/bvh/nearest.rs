//! The point of a surface nearest to another.

use super::{Bvh, distance_squared};
use mser3d_shape::vector::{Vec3, add, dot, scale, sub};

/// A point on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestPoint {
    /// The point.
    pub point: Vec3,
    /// The number of the triangle it lies on.
    pub triangle: u32,
    /// Its distance from the point asked about.
    pub distance: f64,
}

impl Bvh {
    /// The nearest point of all triangles; of several the one on the triangle of smallest number.
    /// `None` without triangles. Cost: O(log n) for points near the surface.
    ///
    /// ```
    /// # use mser3d_shape::TriangleMesh;
    /// # use mser3d_voxelize::Bvh;
    /// let mesh = TriangleMesh::new(vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]], vec![[0, 1, 2]])?;
    /// let nearest = Bvh::new(&mesh).nearest([1.0, 1.0, 2.0]).unwrap();
    /// assert_eq!(nearest.point, [0.5, 0.5, 0.0]);
    /// # Ok::<(), mser3d_shape::ShapeError>(())
    /// ```
    pub fn nearest(&self, query: Vec3) -> Option<NearestPoint> {
        let root = self.nodes.first()?;
        let mut best: Option<(f64, u32, Vec3)> = None;
        let mut stack = vec![(distance_squared(&root.bounds, query), 0usize)];
        while let Some((gap, i)) = stack.pop() {
            if best.is_some_and(|b| gap > b.0) {
                continue;
            }
            let node = &self.nodes[i];
            if node.count == 0 {
                let children = [i + 1, node.first as usize];
                let gaps = children.map(|c| distance_squared(&self.nodes[c].bounds, query));
                let near = usize::from(gaps[1] < gaps[0]);
                stack.push((gaps[1 - near], children[1 - near]));
                stack.push((gaps[near], children[near]));
                continue;
            }
            for place in node.first as usize..(node.first + node.count) as usize {
                let point = nearest_on_triangle(&self.corners[place], query);
                let offset = sub(point, query);
                let candidate = (dot(offset, offset), self.numbers[place]);
                if best.is_none_or(|b| candidate < (b.0, b.1)) {
                    best = Some((candidate.0, candidate.1, point));
                }
            }
        }
        best.map(|(square, triangle, point)| NearestPoint { point, triangle, distance: square.sqrt() })
    }
}

/// The nearest point of a triangle, by the region of the plane that the query projects to
/// (Ericson, *Real-Time Collision Detection*, 5.1.5).
pub(super) fn nearest_on_triangle(&[a, b, c]: &[Vec3; 3], p: Vec3) -> Vec3 {
    let (ab, ac, ap) = (sub(b, a), sub(c, a), sub(p, a));
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = sub(p, b);
    let (d3, d4) = (dot(ab, bp), dot(ac, bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let cp = sub(p, c);
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return add(a, scale(ab, d1 / (d1 - d3)));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return add(a, scale(ac, d2 / (d2 - d6)));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return add(b, scale(sub(c, b), (d4 - d3) / ((d4 - d3) + (d5 - d6))));
    }
    let sum = va + vb + vc;
    if sum == 0.0 {
        return a;
    }
    add(a, add(scale(ab, vb / sum), scale(ac, vc / sum)))
}

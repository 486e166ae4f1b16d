//! The point of a surface nearest to a point in space, by a grid of triangles.

use mser3d_shape::TriangleMesh;

use crate::SurfacePoint;
use crate::vector::{Vec3, add, cross, dot, norm, scale, sub};

/// Triangles by the cells of a grid that their bounding boxes touch.
pub(super) struct TriangleGrid<'m> {
    mesh: &'m TriangleMesh,
    low: Vec3,
    cell: f64,
    dims: [usize; 3],
    cells: Vec<Vec<u32>>,
}

impl<'m> TriangleGrid<'m> {
    /// With about as many cells as triangles; `None` without triangles.
    pub fn new(mesh: &'m TriangleMesh) -> Option<Self> {
        let bounds = mesh.bounding_box()?;
        let longest = bounds.extent().into_iter().fold(0.0, f64::max);
        let cell = (longest / (mesh.triangles().len() as f64).cbrt().max(1.0)).max(f64::MIN_POSITIVE);
        let dims = bounds.extent().map(|x| (x / cell) as usize + 1);
        let mut grid =
            Self { mesh, low: bounds.min, cell, dims, cells: vec![Vec::new(); dims.iter().product()] };
        for t in 0..mesh.triangles().len() {
            let corners = mesh.corners(t);
            let bound = |pick: fn(f64, f64) -> f64| {
                grid.place([0, 1, 2].map(|a| pick(pick(corners[0][a], corners[1][a]), corners[2][a])))
            };
            let (low, high) = (bound(f64::min), bound(f64::max));
            for k in low[2]..=high[2] {
                for j in low[1]..=high[1] {
                    for i in low[0]..=high[0] {
                        grid.cells[(k * dims[1] + j) * dims[0] + i].push(t as u32);
                    }
                }
            }
        }
        Some(grid)
    }

    /// The cell of a point, or the nearest one.
    fn place(&self, p: Vec3) -> [usize; 3] {
        std::array::from_fn(|a| (((p[a] - self.low[a]) / self.cell).max(0.0) as usize).min(self.dims[a] - 1))
    }

    /// The nearest point; of several, the one on the triangle with the smallest number.
    pub fn nearest(&self, p: Vec3) -> SurfacePoint {
        let home = self.place(p);
        let mut best = (f64::INFINITY, SurfacePoint::corner(0, 0));
        for shell in 0..=self.dims.into_iter().max().unwrap_or(1) {
            // Triangles first met in this shell lie beyond the cells before it.
            if best.0 <= self.depth(p, home, shell) {
                break;
            }
            self.visit_shell(home, shell, |t| {
                let (point, place) = nearest_on_triangle(p, self.mesh.corners(t as usize));
                let away = norm(sub(p, place));
                if away < best.0 || away == best.0 && t < best.1.triangle {
                    best = (away, SurfacePoint { triangle: t, weights: point });
                }
            });
        }
        best.1
    }

    /// How far `p` is, at least, from what lies outside the cube of cells before this shell.
    fn depth(&self, p: Vec3, home: [usize; 3], shell: usize) -> f64 {
        let along = |a: usize| {
            let low = self.low[a] + (home[a] as f64 - shell as f64 + 1.0) * self.cell;
            let high = self.low[a] + (home[a] + shell) as f64 * self.cell;
            (p[a] - low).min(high - p[a])
        };
        along(0).min(along(1)).min(along(2)).max(0.0)
    }

    fn visit_shell(&self, home: [usize; 3], shell: usize, mut visit: impl FnMut(u32)) {
        let range = |a: usize| home[a].saturating_sub(shell)..=(home[a] + shell).min(self.dims[a] - 1);
        for k in range(2) {
            for j in range(1) {
                let face = home[2].abs_diff(k) == shell || home[1].abs_diff(j) == shell;
                for i in range(0).filter(|&i| face || home[0].abs_diff(i) == shell) {
                    self.cells[(k * self.dims[1] + j) * self.dims[0] + i].iter().for_each(|&t| visit(t));
                }
            }
        }
    }
}

/// Barycentric weights and place of the point of a triangle nearest to `p`: its foot in the plane
/// when that lies inside, or the nearest point of a side.
fn nearest_on_triangle(p: Vec3, corners: [Vec3; 3]) -> (Vec3, Vec3) {
    let [a, b, c] = corners;
    let n = cross(sub(b, a), sub(c, a));
    let square = dot(n, n);
    if square > 0.0 {
        let weights = [
            dot(cross(sub(c, b), sub(p, b)), n) / square,
            dot(cross(sub(a, c), sub(p, c)), n) / square,
            dot(cross(sub(b, a), sub(p, a)), n) / square,
        ];
        if weights.iter().all(|w| *w >= 0.0) {
            let place = (0..3).fold([0.0; 3], |s, i| add(s, scale(corners[i], weights[i])));
            return (weights, place);
        }
    }
    let on_side = |i: usize| {
        let (s, e) = (corners[i], corners[(i + 1) % 3]);
        let along = sub(e, s);
        let t = if dot(along, along) > 0.0 {
            (dot(sub(p, s), along) / dot(along, along)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let mut weights = [0.0; 3];
        (weights[i], weights[(i + 1) % 3]) = (1.0 - t, t);
        (weights, add(s, scale(along, t)))
    };
    let sides = [on_side(0), on_side(1), on_side(2)];
    let away = |side: &(Vec3, Vec3)| norm(sub(p, side.1));
    sides.into_iter().reduce(|x, y| if away(&y) < away(&x) { y } else { x }).unwrap_or(([1.0, 0.0, 0.0], a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn agrees_with_a_search_of_all_triangles() {
        let mut random = Random::new(&[7]);
        let mut point = |size: f64| {
            [random.between(-size, size), random.between(-size, size), random.between(-size, size)]
        };
        let vertices: Vec<Vec3> = (0..60).map(|_| point(1.0)).collect();
        let triangles = (0..20).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let mesh = TriangleMesh::new(vertices, triangles).unwrap();
        let grid = TriangleGrid::new(&mesh).unwrap();
        for _ in 0..300 {
            let p = point(2.0);
            let all = (0..20).map(|t| norm(sub(p, nearest_on_triangle(p, mesh.corners(t)).1)));
            let found = norm(sub(p, grid.nearest(p).position(&mesh)));
            assert!((found - all.fold(f64::INFINITY, f64::min)).abs() < 1e-12);
        }
    }
}

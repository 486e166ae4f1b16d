//! Parts of a surface: one side of a plane, and what a camera sees.

use mser3d_shape::TriangleMesh;
use mser3d_shape::vector::{Vec3, cross, dot, unit};

use super::random::Random;
use super::transformed::Transformed;
use crate::EvaluationError;
use crate::surface_point::normal;

/// One side of a plane of random direction, placed so that this share of the area stays.
pub(super) fn partial(
    null: &TriangleMesh,
    share: f64,
    random: &mut Random,
) -> Result<Transformed, EvaluationError> {
    let direction = random.direction();
    let height = |t: usize| null.corners(t).iter().map(|&p| dot(p, direction)).fold(f64::INFINITY, f64::min);
    let mut triangles: Vec<(f64, usize)> = (0..null.triangles().len()).map(|t| (height(t), t)).collect();
    triangles.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut left = share * null.area();
    let mut keep = vec![false; triangles.len()];
    for (_, t) in triangles {
        left -= null.triangle_area(t);
        if left < 0.0 {
            break;
        }
        keep[t] = true;
    }
    Transformed::kept(null, |t| keep[t])
}

/// The triangles that face a far camera and are not hidden. Five cameras stand evenly around an
/// axis near the horizon of the null shape's y axis; the seed turns them.
pub(super) fn view(null: &TriangleMesh, camera: u32, seed: u64) -> Result<Transformed, EvaluationError> {
    let mut random = Random::new(&[seed, super::class::Class::View as u64]);
    let (start, tilt) = (random.uniform(), random.between(-0.3, 0.3));
    let (x, z) = on_circle(start + f64::from(camera) / 5.0);
    let towards = unit([x, tilt, z]);
    let right = unit(cross([0.0, 1.0, 0.0], towards));
    let up = cross(towards, right);
    let project = |p: Vec3| [dot(p, right), dot(p, up), dot(p, towards)];
    let places: Vec<Vec3> = null.vertices().iter().map(|&p| project(p)).collect();
    let buffer = DepthBuffer::of(&places, null.triangles());
    let seen = |t: usize| {
        let towards_camera = dot(normal(null.corners(t)), towards) > 0.0;
        towards_camera && null.triangles()[t].iter().all(|&v| buffer.sees(places[v as usize]))
    };
    Transformed::kept(null, seen)
}

/// A point of the unit circle for a share of a turn, by the rational parametrization within each
/// quarter: correctly rounded arithmetic only. (Not quite even within a quarter, which is no matter.)
fn on_circle(turn: f64) -> (f64, f64) {
    let quarters = (turn - turn.floor()) * 4.0;
    let t = quarters - quarters.floor();
    let (c, s) = ((1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t));
    match quarters.floor() as u32 {
        0 => (c, s),
        1 => (-s, c),
        2 => (-c, -s),
        _ => (s, -c),
    }
}

/// The depth nearest to the camera in each pixel of an orthographic picture.
struct DepthBuffer {
    origin: [f64; 2],
    pixel: f64,
    width: usize,
    depth: Vec<f64>,
}

impl DepthBuffer {
    /// 600 pixels on the longer side.
    fn of(places: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let used = || triangles.iter().flatten().map(|&v| places[v as usize]);
        let bound = |a: usize| {
            let (low, high) = (
                used().map(|p| p[a]).fold(f64::INFINITY, f64::min),
                used().map(|p| p[a]).fold(f64::NEG_INFINITY, f64::max),
            );
            (low, high - low)
        };
        let ((left, wide), (bottom, tall)) = (bound(0), bound(1));
        let pixel = wide.max(tall) / 600.0;
        let (width, height) = ((wide / pixel) as usize + 1, (tall / pixel) as usize + 1);
        let mut buffer =
            Self { origin: [left, bottom], pixel, width, depth: vec![f64::NEG_INFINITY; width * height] };
        for t in triangles {
            buffer.draw(t.map(|v| places[v as usize]), height);
        }
        buffer
    }

    fn draw(&mut self, corners: [Vec3; 3], height: usize) {
        let [a, b, c] =
            corners.map(|p| [(p[0] - self.origin[0]) / self.pixel, (p[1] - self.origin[1]) / self.pixel]);
        let turn = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        };
        let area = turn(a, b, c);
        if area == 0.0 {
            return;
        }
        let range = |axis: usize, end: usize| {
            let (low, high) = (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
            (low - 0.5).ceil().max(0.0) as usize..((high + 0.5).floor().max(0.0) as usize).min(end)
        };
        for row in range(1, height) {
            for column in range(0, self.width) {
                let p = [column as f64 + 0.5, row as f64 + 0.5];
                let weights = [turn(b, c, p) / area, turn(c, a, p) / area, turn(a, b, p) / area];
                if weights.iter().all(|w| *w >= 0.0) {
                    let depth = (0..3).map(|i| weights[i] * corners[i][2]).sum::<f64>();
                    let cell = &mut self.depth[row * self.width + column];
                    *cell = cell.max(depth);
                }
            }
        }
    }

    /// Whether nothing lies more than four pixels before the point. (A slanted surface is deeper at
    /// a pixel's edge than at its centre; limbs that hide each other are farther apart.)
    fn sees(&self, p: Vec3) -> bool {
        let column = ((p[0] - self.origin[0]) / self.pixel) as usize;
        let row = ((p[1] - self.origin[1]) / self.pixel) as usize;
        let cell = row * self.width + column.min(self.width - 1);
        self.depth.get(cell).is_none_or(|d| p[2] >= d - 4.0 * self.pixel)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mser3d_shape::vector::norm;

    #[test]
    fn the_circle_is_a_circle() {
        for n in 0..40 {
            let (x, y) = on_circle(f64::from(n) / 40.0);
            assert!((norm([x, y, 0.0]) - 1.0).abs() < 1e-15);
            let (u, v) = on_circle(f64::from(n) / 40.0 + 0.5);
            assert!((x + u).abs() + (y + v).abs() < 1e-12);
        }
    }
}

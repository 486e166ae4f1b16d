//! Scan conversion: which samples of a picture a triangle covers.

/// A corner on the screen: x and y in 1/256 of a sample (so that the inside test is exact and
/// neighbouring triangles leave no gap), y down, and a depth that grows towards the viewer.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ScreenPoint {
    pub x: i64,
    pub y: i64,
    pub z: f64,
}

/// Fixed-point units in a sample.
pub(crate) const UNIT: i64 = 256;

impl ScreenPoint {
    pub fn new(x: f64, y: f64, z: f64) -> Self {
        // Positions come from a fitted camera: far below the range where a product would overflow.
        Self { x: (x * UNIT as f64).round() as i64, y: (y * UNIT as f64).round() as i64, z }
    }
}

/// A function that is linear over the screen, given by its values at a triangle's corners.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gradient {
    at_origin: f64,
    pub dx: f64,
    pub dy: f64,
}

impl Gradient {
    /// `None` when the triangle has no area on the screen.
    pub fn new(t: &[ScreenPoint; 3], values: [f64; 3]) -> Option<Self> {
        let area = doubled_area(t);
        if area == 0 {
            return None;
        }
        let inverse = UNIT as f64 / area as f64;
        let (ux, uy) = ((t[1].x - t[0].x) as f64, (t[1].y - t[0].y) as f64);
        let (vx, vy) = ((t[2].x - t[0].x) as f64, (t[2].y - t[0].y) as f64);
        let (du, dv) = (values[1] - values[0], values[2] - values[0]);
        let (dx, dy) = ((du * vy - dv * uy) * inverse, (dv * ux - du * vx) * inverse);
        let (x, y) = (t[0].x as f64 / UNIT as f64, t[0].y as f64 / UNIT as f64);
        Some(Self { at_origin: values[0] - dx * x - dy * y, dx, dy })
    }

    /// The value at the centre of a sample.
    #[inline]
    pub fn at(&self, x: i64, y: i64) -> f64 {
        self.at_origin + self.dx * (x as f64 + 0.5) + self.dy * (y as f64 + 0.5)
    }
}

/// Twice the signed area, in units of 1/256 sample squared; positive when clockwise on a y-down screen.
pub(crate) fn doubled_area(t: &[ScreenPoint; 3]) -> i64 {
    (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x)
}

/// Calls `f(x, y)` for each sample inside `width` x (`rows.0` to `rows.1`) whose centre the triangle
/// covers, row by row. A sample on the border of two triangles belongs to exactly one of them (the
/// top-left rule), so that crossings of a closed surface can be counted.
pub(crate) fn scan(t: &[ScreenPoint; 3], width: i64, rows: (i64, i64), mut f: impl FnMut(i64, i64)) {
    let area = doubled_area(t);
    if area == 0 {
        return;
    }
    let [a, b, c] = if area > 0 { [t[0], t[1], t[2]] } else { [t[0], t[2], t[1]] };
    let low = |p: i64, q: i64, r: i64| (p.min(q).min(r) - UNIT / 2 + UNIT - 1).div_euclid(UNIT);
    let high = |p: i64, q: i64, r: i64| (p.max(q).max(r) - UNIT / 2).div_euclid(UNIT) + 1;
    let (x0, x1) = (low(a.x, b.x, c.x).max(0), high(a.x, b.x, c.x).min(width));
    let (y0, y1) = (low(a.y, b.y, c.y).max(rows.0), high(a.y, b.y, c.y).min(rows.1));
    if x0 >= x1 {
        return;
    }
    // Twice the area of the triangle that the sample makes with each edge.
    let edge = |p: ScreenPoint, q: ScreenPoint| {
        let (dx, dy) = (q.x - p.x, q.y - p.y);
        let (sx, sy) = (x0 * UNIT + UNIT / 2 - p.x, y0 * UNIT + UNIT / 2 - p.y);
        // Left and top edges own the samples on them; the others lose them by the smallest step.
        let owns = dy < 0 || (dy == 0 && dx > 0);
        (dx * sy - dy * sx - i64::from(!owns), -dy * UNIT, dx * UNIT)
    };
    let edges = [edge(a, b), edge(b, c), edge(c, a)];
    let mut row = edges.map(|e| e.0);
    for y in y0..y1 {
        let mut w = row;
        let mut entered = false;
        for x in x0..x1 {
            if w[0] | w[1] | w[2] >= 0 {
                entered = true;
                f(x, y);
            } else if entered {
                break;
            }
            for i in 0..3 {
                w[i] += edges[i].1;
            }
        }
        for i in 0..3 {
            row[i] += edges[i].2;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, y: f64) -> ScreenPoint {
        ScreenPoint::new(x, y, x + 2.0 * y)
    }

    #[test]
    fn a_fan_of_triangles_covers_every_sample_of_a_square() {
        let centre = point(7.3, 4.1);
        let ring: Vec<_> = (0..9)
            .map(|i| f64::from(i) * 0.7)
            .map(|a| point(8.0 + 40.0 * a.cos(), 8.0 + 40.0 * a.sin()))
            .collect();
        let mut hits = [0u32; 256];
        for i in 0..9 {
            scan(&[centre, ring[i], ring[(i + 1) % 9]], 16, (0, 16), |x, y| hits[(y * 16 + x) as usize] += 1);
        }
        assert!(hits.iter().all(|&h| h == 1));
    }

    #[test]
    fn samples_on_a_shared_edge_belong_to_one_triangle() {
        // All edges run through centres of samples.
        let corners = [(0.5, 0.5), (8.5, 0.5), (8.5, 8.5), (0.5, 8.5)].map(|(x, y)| point(x, y));
        let middle = point(4.5, 4.5);
        let mut hits = [0u32; 100];
        for i in 0..4 {
            let t = [corners[i], corners[(i + 1) % 4], middle];
            scan(&t, 10, (0, 10), |x, y| hits[(y * 10 + x) as usize] += 1);
        }
        assert!(hits.iter().all(|&h| h <= 1));
        assert_eq!(hits.iter().sum::<u32>(), 64);
    }

    #[test]
    fn winding_does_not_matter_and_flat_triangles_cover_nothing() {
        let [a, b, c] = [point(1.2, 0.4), point(9.9, 3.0), point(2.0, 8.5)];
        let covered = |t: [ScreenPoint; 3]| {
            let mut list = Vec::new();
            scan(&t, 10, (2, 7), |x, y| list.push((x, y)));
            list
        };
        assert!(!covered([a, b, c]).is_empty());
        assert_eq!(covered([a, b, c]), covered([a, c, b]));
        assert!(covered([a, b, b]).is_empty());
    }

    #[test]
    fn a_gradient_is_the_linear_function() {
        let t = [point(1.25, 0.5), point(9.75, 3.0), point(2.0, 8.5)];
        let g = Gradient::new(&t, t.map(|p| p.z)).unwrap();
        assert!((g.at(4, 5) - (4.5 + 2.0 * 5.5)).abs() < 1e-9);
        assert!((g.dx - 1.0).abs() < 1e-9 && (g.dy - 2.0).abs() < 1e-9);
    }
}

//! Which surface each sample of a picture sees: the z-buffer.

use mser3d_shape::vector::{Vec3, add, dot, scale, sub};

use crate::Model;
use crate::borders;
use crate::camera::Camera;
use crate::model::Section;
use crate::raster::{Gradient, ScreenPoint, UNIT, doubled_area, scan};

/// No surface.
pub(crate) const NOTHING: u32 = u32::MAX;
/// The filling of a cut.
pub(crate) const FILLING: u32 = u32::MAX - 1;

/// The samples of some rows.
pub(crate) struct Samples {
    pub width: i64,
    /// First row.
    pub top: i64,
    /// Row after the last.
    pub bottom: i64,
    /// Depth of each sample, growing towards the viewer.
    pub depth: Vec<f32>,
    /// Triangle that each sample sees, [`FILLING`] or [`NOTHING`].
    pub triangle: Vec<u32>,
    /// Index into the model's colours; left at 0 for blended ones.
    pub paint: Vec<u32>,
}

impl Samples {
    pub fn index(&self, x: i64, y: i64) -> usize {
        ((y - self.top) * self.width + x) as usize
    }
}

/// A model projected to samples.
pub(crate) struct Projection<'a> {
    pub model: &'a Model,
    pub camera: Camera,
    /// The point of the shape from which `origin` is measured.
    centre: Vec3,
    /// Where the centre falls, in samples from the left and the top.
    origin: [f64; 2],
    /// Samples per unit of length.
    per_length: f64,
    screen: Vec<ScreenPoint>,
    /// Per vertex, how far it lies beyond the cut; empty without one.
    beyond: Vec<f64>,
    width: i64,
}

impl<'a> Projection<'a> {
    pub fn new(
        model: &'a Model,
        camera: Camera,
        centre: Vec3,
        origin: [f64; 2],
        per_length: f64,
        width: i64,
    ) -> Self {
        let place = |&p: &Vec3| {
            let [x, y, z] = camera.turn(sub(p, centre));
            ScreenPoint::new(origin[0] + x * per_length, origin[1] - y * per_length, z)
        };
        let screen = model.points.iter().map(place).collect();
        let beyond = match &model.section {
            Some(section) => model.points.iter().map(|&p| section.cut.beyond(p)).collect(),
            None => Vec::new(),
        };
        Self { model, camera, centre, origin, per_length, screen, beyond, width }
    }

    /// Samples in a row.
    pub fn width(&self) -> i64 {
        self.width
    }

    pub fn corners(&self, triangle: u32) -> [ScreenPoint; 3] {
        self.model.triangles[triangle as usize].map(|v| self.screen[v as usize])
    }

    /// How depth changes from sample to sample on what a sample sees.
    pub fn slope(&self, triangle: u32) -> [f64; 2] {
        if triangle == FILLING {
            let normal = self.model.section.as_ref().map_or([0., 0., 1.], |s| s.cut.normal);
            let [x, y, z] = self.camera.turn(normal);
            return [-x / z / self.per_length, y / z / self.per_length];
        }
        let corners = self.corners(triangle);
        Gradient::new(&corners, corners.map(|p| p.z)).map_or([0.0; 2], |g| [g.dx, g.dy])
    }

    /// For each of `count` bands of sample rows, the triangles that come within `reach` rows of it.
    pub fn triangles_by_band(&self, count: usize, rows: i64, reach: i64) -> Vec<Vec<u32>> {
        let mut bands = vec![Vec::new(); count];
        for t in 0..self.model.triangles.len() as u32 {
            let y = self.corners(t).map(|p| p.y);
            let (low, high) = (y[0].min(y[1]).min(y[2]) / UNIT, y[0].max(y[1]).max(y[2]) / UNIT);
            let first = ((low - reach - 1) / rows).max(0) as usize;
            let last = ((high + reach + 1).max(0) / rows) as usize;
            for band in bands.iter_mut().take(last + 1).skip(first) {
                band.push(t);
            }
        }
        bands
    }

    /// What the samples of some rows see, given all triangles that reach them: the nearest triangle,
    /// of equally near ones the first.
    pub fn find(&self, triangles: &[u32], top: i64, bottom: i64) -> Samples {
        let size = (self.width * (bottom - top)) as usize;
        let mut samples = Samples {
            width: self.width,
            top,
            bottom,
            depth: vec![f32::NEG_INFINITY; size],
            triangle: vec![NOTHING; size],
            paint: vec![0; size],
        };
        let section = self.model.section.as_ref();
        // How often the part that was cut away wraps around the place of the cut behind each sample.
        let filled = section.is_some_and(|s| s.filling.is_some());
        let mut winding = if filled { vec![0i16; size] } else { Vec::new() };
        for &t in triangles {
            let corners = self.corners(t);
            let Some(z) = Gradient::new(&corners, corners.map(|p| p.z)) else { continue };
            let clipped = section.is_some_and(|s| (t as usize) < s.clipped);
            let beyond = if clipped {
                Gradient::new(&corners, self.model.triangles[t as usize].map(|v| self.beyond[v as usize]))
            } else {
                None
            };
            let turn = if doubled_area(&corners) > 0 { 1 } else { -1 };
            scan(&corners, self.width, (top, bottom), |x, y| {
                let at = samples.index(x, y);
                if beyond.is_some_and(|b| b.at(x, y) > 0.0) {
                    if filled {
                        winding[at] += turn;
                    }
                    return;
                }
                let here = z.at(x, y) as f32;
                if here > samples.depth[at] {
                    samples.depth[at] = here;
                    samples.triangle[at] = t;
                }
            });
        }
        if let Some(section) = section.filter(|_| filled) {
            self.fill(&mut samples, section, &winding);
        }
        if !self.model.blend {
            for y in top..bottom {
                for x in 0..self.width {
                    let at = samples.index(x, y);
                    if samples.triangle[at] < FILLING {
                        samples.paint[at] = self.prevailing_paint(samples.triangle[at], x, y);
                    }
                }
            }
        }
        samples
    }

    /// Fills the cut. A line of sight from the viewer to the cut runs through the part that was taken
    /// away only, so it ends inside the solid just when it met that part's surface an unequal number
    /// of times from outside and inside.
    fn fill(&self, samples: &mut Samples, section: &Section, winding: &[i16]) {
        let Some(filling) = &section.filling else { return };
        let facing = dot(section.cut.normal, self.camera.toward);
        if facing <= 0.0 {
            return;
        }
        for y in samples.top..samples.bottom {
            for x in 0..self.width {
                let at = samples.index(x, y);
                if winding[at] == 0 {
                    continue;
                }
                let right = (x as f64 + 0.5 - self.origin[0]) / self.per_length;
                let up = (self.origin[1] - y as f64 - 0.5) / self.per_length;
                let level = add(self.centre, add(scale(self.camera.right, right), scale(self.camera.up, up)));
                let depth = -section.cut.beyond(level) / facing;
                samples.depth[at] = depth as f32;
                samples.triangle[at] = FILLING;
                samples.paint[at] = filling.paint_at(add(level, scale(self.camera.toward, depth)));
            }
        }
    }

    /// Shares of a triangle's corners at a sample; they sum to one.
    pub fn weights(&self, corners: &[ScreenPoint; 3], x: i64, y: i64) -> [f64; 3] {
        let p = ScreenPoint { x: x * UNIT + UNIT / 2, y: y * UNIT + UNIT / 2, z: 0.0 };
        let area = doubled_area(corners) as f64;
        let [a, b, c] = *corners;
        [[p, b, c], [a, p, c], [a, b, p]].map(|t| doubled_area(&t) as f64 / area)
    }

    /// The colour that weighs most: borders become straight lines across triangles.
    fn prevailing_paint(&self, triangle: u32, x: i64, y: i64) -> u32 {
        let model = self.model;
        let vertices = model.triangles[triangle as usize].map(|v| v as usize);
        let paint = vertices.map(|v| model.paint[v]);
        let smooth = !model.shares.is_empty();
        if !smooth && paint[0] == paint[1] && paint[1] == paint[2] {
            return paint[0];
        }
        let weights = self.weights(&self.corners(triangle), x, y);
        let whole = paint.map(borders::whole);
        let shares = [0, 1, 2].map(|i| if smooth { &model.shares[vertices[i]] } else { &whole[i] });
        borders::prevailing(shares, weights)
    }
}

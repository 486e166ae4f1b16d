//! One panel: samples are found by a z-buffer, then lit, then averaged to pixels.

use rayon::prelude::*;

use crate::camera::Camera;
use crate::raster::{Gradient, ScreenPoint, doubled_area, scan};
use crate::shade::{Surface, light};
use crate::vector::{Vec3, sub};
use crate::{Image, Model, RenderOptions, Rgb, ViewerError};

/// How a model is placed in its panel.
pub(crate) struct Placement {
    pub camera: Camera,
    pub centre: Vec3,
    /// Pixels per unit of length.
    pub scale: f64,
    /// Where the centre goes, in pixels from the left and the top.
    pub shift: [f64; 2],
    /// Pixels in width and height.
    pub size: [usize; 2],
    /// Length against which jumps in depth are measured.
    pub depth_unit: f64,
}

/// Rows of pixels drawn at a time: a band's samples fit the cache.
const BAND: usize = 16;
const NOTHING: u32 = u32::MAX;

/// Draws the model on the background.
pub(crate) fn draw(model: &Model, place: &Placement, options: &RenderOptions) -> Result<Image, ViewerError> {
    let [width, height] = place.size;
    let mut image = Image::new(width, height, options.background)?;
    let samples = options.supersampling;
    let per_length = place.scale * samples as f64;
    let screen: Vec<ScreenPoint> = model
        .points
        .iter()
        .map(|&p| {
            let [x, y, z] = place.camera.turn(sub(p, place.centre));
            let [left, top] = place.shift.map(|s| s * samples as f64);
            ScreenPoint::new(left + x * per_length, top - y * per_length, z)
        })
        .collect();
    let beyond: Vec<f64> =
        model.clip.map_or(Vec::new(), |(cut, _)| model.points.iter().map(|&p| cut.beyond(p)).collect());
    let scene = Scene {
        model,
        camera: place.camera,
        screen,
        beyond,
        width: (width * samples) as i64,
        // A line is about a pixel wide at the default size and grows slowly with the picture.
        reach: (samples as f64 * (height as f64 / 800.0).sqrt().clamp(0.5, 3.0) * 0.6).round().max(1.0)
            as i64,
        jump: 0.012 * place.depth_unit,
        options,
    };
    let bands = scene.triangles_by_band(height.div_ceil(BAND), (BAND * samples) as i64);
    image
        .pixels_mut()
        .par_chunks_mut(BAND * width)
        .enumerate()
        .for_each(|(band, rows)| scene.draw_band(band, &bands[band], rows));
    Ok(image)
}

struct Scene<'a> {
    model: &'a Model,
    camera: Camera,
    screen: Vec<ScreenPoint>,
    /// Per vertex, how far it lies beyond the cut; empty without one.
    beyond: Vec<f64>,
    width: i64,
    /// Distance in samples at which lines look for another surface.
    reach: i64,
    jump: f64,
    options: &'a RenderOptions,
}

/// The samples of a band and of a few rows around it.
struct Samples {
    top: i64,
    bottom: i64,
    depth: Vec<f32>,
    triangle: Vec<u32>,
    /// Index into the model's colours.
    paint: Vec<u32>,
}

impl Scene<'_> {
    fn corners(&self, triangle: u32) -> [ScreenPoint; 3] {
        self.model.triangles[triangle as usize].map(|v| self.screen[v as usize])
    }

    /// For each band of sample rows, the triangles that reach into it, in their order.
    fn triangles_by_band(&self, count: usize, rows: i64) -> Vec<Vec<u32>> {
        let mut bands = vec![Vec::new(); count];
        let unit = crate::raster::UNIT;
        for t in 0..self.model.triangles.len() as u32 {
            let y = self.corners(t).map(|p| p.y);
            let (low, high) = (y[0].min(y[1]).min(y[2]) / unit, y[0].max(y[1]).max(y[2]) / unit);
            let first = ((low - self.reach - 1) / rows).max(0) as usize;
            let last = ((high + self.reach + 1).max(0) / rows) as usize;
            for band in bands.iter_mut().take(last + 1).skip(first) {
                band.push(t);
            }
        }
        bands
    }

    fn draw_band(&self, band: usize, triangles: &[u32], pixels: &mut [Rgb]) {
        if triangles.is_empty() {
            return;
        }
        let n = self.options.supersampling;
        let width = self.width as usize / n;
        let top = (band * BAND * n) as i64;
        let bottom = top + (pixels.len() / width * n) as i64;
        let samples = self.find_samples(triangles, top - self.reach, bottom + self.reach);
        let background = self.options.background.linear();
        for (row, line) in pixels.chunks_mut(width).enumerate() {
            for (column, pixel) in line.iter_mut().enumerate() {
                let mut sum = [0.0f32; 3];
                let mut covered = 0;
                for sy in 0..n {
                    for sx in 0..n {
                        let (x, y) = ((column * n + sx) as i64, top + (row * n + sy) as i64);
                        if let Some(colour) = self.shade(&samples, x, y) {
                            covered += 1;
                            (0..3).for_each(|i| sum[i] += colour[i]);
                        }
                    }
                }
                if covered > 0 {
                    let rest = (n * n - covered) as f32;
                    let share = 1.0 / (n * n) as f32;
                    *pixel =
                        Rgb::from_linear(std::array::from_fn(|i| (sum[i] + rest * background[i]) * share));
                }
            }
        }
    }

    /// The z-buffer: nearest triangle of each sample; of equally near ones, the first.
    fn find_samples(&self, triangles: &[u32], top: i64, bottom: i64) -> Samples {
        let size = (self.width * (bottom - top)) as usize;
        let mut depth = vec![f32::NEG_INFINITY; size];
        let mut nearest = vec![NOTHING; size];
        for &t in triangles {
            let corners = self.corners(t);
            let Some(z) = Gradient::new(&corners, corners.map(|p| p.z)) else { continue };
            let clipped = self.model.clip.is_some_and(|(_, end)| (t as usize) < end);
            let beyond = if clipped {
                Gradient::new(&corners, self.model.triangles[t as usize].map(|v| self.beyond[v as usize]))
            } else {
                None
            };
            scan(&corners, self.width, (top, bottom), |x, y| {
                if beyond.is_some_and(|b| b.at(x, y) > 0.0) {
                    return;
                }
                let at = ((y - top) * self.width + x) as usize;
                let here = z.at(x, y) as f32;
                if here > depth[at] {
                    depth[at] = here;
                    nearest[at] = t;
                }
            });
        }
        let mut samples = Samples { top, bottom, depth, triangle: nearest, paint: vec![0; size] };
        if !self.model.blend {
            for y in top..bottom {
                for x in 0..self.width {
                    let at = ((y - top) * self.width + x) as usize;
                    if samples.triangle[at] != NOTHING {
                        samples.paint[at] = self.prevailing_paint(samples.triangle[at], x, y);
                    }
                }
            }
        }
        samples
    }

    /// Shares of a triangle's corners at a sample; they sum to one.
    fn weights(&self, corners: &[ScreenPoint; 3], x: i64, y: i64) -> [f64; 3] {
        let unit = crate::raster::UNIT;
        let p = ScreenPoint { x: x * unit + unit / 2, y: y * unit + unit / 2, z: 0.0 };
        let area = doubled_area(corners) as f64;
        let [a, b, c] = *corners;
        [[p, b, c], [a, p, c], [a, b, p]].map(|t| doubled_area(&t) as f64 / area)
    }

    /// The colour whose vertices weigh most: region borders become straight lines across triangles.
    fn prevailing_paint(&self, triangle: u32, x: i64, y: i64) -> u32 {
        let [p, q, r] = self.model.triangles[triangle as usize].map(|v| self.model.paint[v as usize]);
        if p == q || p == r {
            if q == r {
                return p;
            }
        } else if q != r {
            let w = self.weights(&self.corners(triangle), x, y);
            return if w[0] >= w[1] && w[0] >= w[2] {
                p
            } else if w[1] >= w[2] {
                q
            } else {
                r
            };
        }
        let w = self.weights(&self.corners(triangle), x, y);
        let (odd, share, pair) = if p == q {
            (r, w[2], p)
        } else if p == r {
            (q, w[1], p)
        } else {
            (p, w[0], q)
        };
        if share > 0.5 { odd } else { pair }
    }

    fn shade(&self, samples: &Samples, x: i64, y: i64) -> Option<[f32; 3]> {
        let at = ((y - samples.top) * self.width + x) as usize;
        let t = samples.triangle[at];
        if t == NOTHING {
            return None;
        }
        let model = self.model;
        let corners = self.corners(t);
        let w = self.weights(&corners, x, y).map(|w| w as f32);
        let vertices = model.triangles[t as usize];
        let mut normal = [0.0f32; 3];
        let mut open = 0.0;
        for i in 0..3 {
            (0..3).for_each(|a| normal[a] += w[i] * model.normals[t as usize][i][a]);
            open += w[i] * model.openness[vertices[i] as usize];
        }
        let colour = if model.blend {
            let mut mixed = [0.0f32; 3];
            for i in 0..3 {
                let c = model.colours[model.paint[vertices[i] as usize] as usize];
                (0..3).for_each(|a| mixed[a] += w[i] * c[a]);
            }
            mixed
        } else {
            model.colours[samples.paint[at] as usize]
        };
        let normal = self.camera.turn(normal.map(f64::from));
        let surface = Surface { colour, normal, openness: open.clamp(0.0, 1.0) };
        let lit = light(&surface, self.options.occlusion as f32);
        let line = self.line(samples, x, y, at, &corners);
        Some(lit.map(|c| c * (1.0 - line)))
    }

    /// How dark a line is drawn here: where a nearer surface ends, or two colours meet.
    fn line(&self, samples: &Samples, x: i64, y: i64, at: usize, corners: &[ScreenPoint; 3]) -> f32 {
        if self.options.lines == 0.0 {
            return 0.0;
        }
        let z = Gradient::new(corners, corners.map(|p| p.z));
        let here = f64::from(samples.depth[at]);
        let (mut silhouette, mut border) = (0, 0);
        for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
            let (nx, ny) = (x + dx * self.reach, y + dy * self.reach);
            if nx < 0 || nx >= self.width || ny < samples.top || ny >= samples.bottom {
                continue;
            }
            let there = ((ny - samples.top) * self.width + nx) as usize;
            // Where the surface would be if it went on flat: a slanted one is no edge.
            let slope = z.map_or(0.0, |g| g.dx * dx as f64 + g.dy * dy as f64) * self.reach as f64;
            let drop = here + slope.min(0.0) - f64::from(samples.depth[there]);
            if samples.triangle[there] == NOTHING || drop > self.jump {
                silhouette += 1;
            } else if samples.paint[there] != samples.paint[at] && drop > -self.jump {
                border += 1;
            }
        }
        let strength = self.options.lines as f32;
        if silhouette > 0 {
            strength * 0.9
        } else if border > 0 {
            strength * 0.55
        } else {
            0.0
        }
    }
}

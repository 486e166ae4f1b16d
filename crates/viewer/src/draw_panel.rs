//! One panel: what each sample sees is lit, then samples are averaged to pixels.

use mser3d_shape::vector::Vec3;
use rayon::prelude::*;

use crate::axes::draw_axes;
use crate::camera::Camera;
use crate::labels::draw_labels;
use crate::lighting::{Surface, light};
use crate::render_options::RenderOptions;
use crate::z_buffer::{FILLING, NOTHING, Projection, Samples};
use crate::{Image, Model, Rgb, ViewerError};

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

/// Draws the model on the background.
pub(crate) fn draw_panel(
    model: &Model,
    place: &Placement,
    options: &RenderOptions,
) -> Result<Image, ViewerError> {
    let [width, height] = place.size;
    let mut image = Image::new(width, height, options.background.colour())?;
    let n = options.supersampling;
    let origin = place.shift.map(|s| s * n as f64);
    let per_length = place.scale * n as f64;
    let artist = Artist {
        projection: Projection::new(
            model,
            place.camera,
            place.centre,
            origin,
            per_length,
            (width * n) as i64,
        ),
        // A line is about a pixel wide at the default size and grows slowly with the picture.
        reach: (n as f64 * (height as f64 / 800.0).sqrt().clamp(0.5, 3.0) * 0.6).round().max(1.0) as i64,
        jump: 0.012 * place.depth_unit,
        options,
    };
    let rows = (BAND * n) as i64;
    let bands = artist.projection.triangles_by_band(height.div_ceil(BAND), rows, artist.reach);
    let chunks = image.pixels_mut().par_chunks_mut(BAND * width).enumerate();
    chunks.for_each(|(band, pixels)| artist.draw_band(band as i64 * rows, &bands[band], pixels));
    draw_labels(&mut image, model, place, options);
    if options.axes {
        draw_axes(&mut image, &place.camera, options.letters(), options.background.ink());
    }
    Ok(image)
}

struct Artist<'a> {
    projection: Projection<'a>,
    /// Distance in samples at which lines look for another surface.
    reach: i64,
    /// A change of depth that makes a line.
    jump: f64,
    options: &'a RenderOptions,
}

impl Artist<'_> {
    /// Draws the pixels from a row of samples on.
    fn draw_band(&self, top: i64, triangles: &[u32], pixels: &mut [Rgb]) {
        if triangles.is_empty() {
            return;
        }
        let n = self.options.supersampling;
        let share = 1.0 / (n * n) as f32;
        let background = self.options.background.colour().linear();
        // Lines look at the rows around the band too.
        let rows = (pixels.len() * n * n) as i64;
        let samples =
            self.projection.find(triangles, top - self.reach, top + self.reach + rows / self.width());
        let width = self.width() as usize / n;
        for (row, line) in pixels.chunks_mut(width).enumerate() {
            for (column, pixel) in line.iter_mut().enumerate() {
                let mut sum = [0.0f32; 3];
                let mut covered = 0;
                for s in 0..n * n {
                    let (x, y) = ((column * n + s % n) as i64, top + (row * n + s / n) as i64);
                    if let Some(colour) = self.shade(&samples, x, y) {
                        covered += 1;
                        (0..3).for_each(|i| sum[i] += colour[i]);
                    }
                }
                if covered > 0 {
                    let rest = (n * n - covered) as f32;
                    let light = std::array::from_fn(|i| (sum[i] + rest * background[i]) * share);
                    *pixel = Rgb::from_linear(light);
                }
            }
        }
    }

    fn width(&self) -> i64 {
        self.projection.width()
    }

    /// Linear light of a sample; `None` where nothing is.
    fn shade(&self, samples: &Samples, x: i64, y: i64) -> Option<[f32; 3]> {
        let at = samples.index(x, y);
        let surface = match samples.triangle[at] {
            NOTHING => return None,
            FILLING => self.filling(samples.paint[at])?,
            triangle => self.surface(triangle, samples.paint[at], x, y),
        };
        let lit = light(&surface, self.options.occlusion as f32);
        let line = self.line(samples, x, y);
        Some(lit.map(|c| c * (1.0 - line)))
    }

    fn filling(&self, paint: u32) -> Option<Surface> {
        let model = self.projection.model;
        let normal = self.projection.camera.turn(model.section.as_ref()?.cut.normal);
        Some(Surface { colour: model.colours[paint as usize], normal, openness: 1.0 })
    }

    fn surface(&self, triangle: u32, paint: u32, x: i64, y: i64) -> Surface {
        let model = self.projection.model;
        let corners = self.projection.corners(triangle);
        let w = self.projection.weights(&corners, x, y).map(|w| w as f32);
        let vertices = model.triangles[triangle as usize].map(|v| v as usize);
        let normals = &model.normals[triangle as usize];
        let normal: [f32; 3] = std::array::from_fn(|a| (0..3).map(|i| w[i] * normals[i][a]).sum());
        let openness: f32 = (0..3).map(|i| w[i] * model.openness[vertices[i]]).sum();
        let colour = if model.blend {
            let colours = vertices.map(|v| model.colours[model.paint[v] as usize]);
            std::array::from_fn(|a| (0..3).map(|i| w[i] * colours[i][a]).sum())
        } else {
            model.colours[paint as usize]
        };
        let normal = self.projection.camera.turn(normal.map(f64::from));
        Surface { colour, normal, openness: openness.clamp(0.0, 1.0) }
    }

    /// How dark a line is drawn here: where a nearer surface ends, or two colours meet.
    fn line(&self, samples: &Samples, x: i64, y: i64) -> f32 {
        if self.options.lines == 0.0 {
            return 0.0;
        }
        let at = samples.index(x, y);
        let slope = self.projection.slope(samples.triangle[at]);
        let here = f64::from(samples.depth[at]);
        let mut border = false;
        for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
            let (nx, ny) = (x + dx * self.reach, y + dy * self.reach);
            if nx < 0 || nx >= self.width() || ny < samples.top || ny >= samples.bottom {
                continue;
            }
            let there = samples.index(nx, ny);
            // Where the surface would be if it went on flat: a slanted one is no edge.
            let ahead = (slope[0] * dx as f64 + slope[1] * dy as f64) * self.reach as f64;
            let drop = here + ahead.min(0.0) - f64::from(samples.depth[there]);
            if samples.triangle[there] == NOTHING || drop > self.jump {
                return 0.9 * self.options.lines as f32;
            }
            let same = samples.paint[there] == samples.paint[at]
                && (samples.triangle[there] == FILLING) == (samples.triangle[at] == FILLING);
            border |= !same && drop > -self.jump;
        }
        if border { 0.55 * self.options.lines as f32 } else { 0.0 }
    }
}

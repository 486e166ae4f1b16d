//! Sheets of panels: sizes, a common scale, captions.

use mser3d_shape::vector::{dot, sub};

use crate::axes::corner;
use crate::camera::{NamedView, Up, View};
use crate::draw_panel::{Placement, draw_panel};
use crate::legend::{Legend, LegendEntry, draw_bar, round_length};
use crate::render_options::RenderOptions;
use crate::text::{text_width, write_text};
use crate::{Image, Model, ViewerError};

/// One picture of a sheet: a model, where it is seen from, and what is written below.
#[derive(Clone, Debug)]
pub struct Panel<'a> {
    /// What is drawn.
    pub model: &'a Model,
    /// From where.
    pub view: View,
    /// Written below; empty for nothing. As for [`write_text`], letters that the font lacks are boxes.
    pub caption: String,
}

impl<'a> Panel<'a> {
    /// A model from the front, a three-quarter view, the side and the back.
    pub fn around(model: &'a Model) -> Vec<Self> {
        [NamedView::Front, NamedView::ThreeQuarter, NamedView::Side, NamedView::Back]
            .map(|view| Self { model, view: view.into(), caption: view.to_string() })
            .into()
    }
}

/// Draws panels into one sheet, all at the same scale, by an orthographic camera.
///
/// No display or GPU is needed. The picture is the same, byte for byte, for any number of threads.
/// Memory does not grow with the number of samples: the rows of the picture are drawn in bands.
///
/// # Errors
/// [`ViewerError::InvalidParameter`], [`ViewerError::Empty`] without panels, [`ViewerError::NotFinite`] for a
/// view that is not, [`ViewerError::TooLarge`] beyond 2^28 pixels.
pub fn render(panels: &[Panel<'_>], options: &RenderOptions) -> Result<Image, ViewerError> {
    render_with_legend(panels, &[], options)
}

/// The same, and what the colours mean below.
///
/// # Errors
/// As [`render`].
pub fn render_with_legend(
    panels: &[Panel<'_>],
    legend: &[LegendEntry],
    options: &RenderOptions,
) -> Result<Image, ViewerError> {
    options.validate()?;
    if panels.is_empty() {
        return Err(ViewerError::Empty { reason: "no panels" });
    }
    let mut extents = Vec::with_capacity(panels.len());
    for (number, panel) in panels.iter().enumerate() {
        if !(panel.view.azimuth.is_finite() && panel.view.elevation.is_finite()) {
            return Err(ViewerError::NotFinite { what: "the view of panel", number });
        }
        extents.push(Extent::of(panel, options.up));
    }
    let tallest = extents.iter().map(|e| e.high[1] - e.low[1]).fold(0.0, f64::max);
    let widest = extents.iter().map(|e| e.high[0] - e.low[0]).fold(0.0, f64::max);
    // A very wide shape gets a panel of at most 3 : 1, a single point any scale.
    let unit = Some(tallest.max(widest / 3.0)).filter(|unit| *unit > 0.0).unwrap_or(1.0);
    let inner = options.height as f64 * (1.0 - 2.0 * options.margin);
    let scale = inner / unit;
    let border = options.height as f64 * options.margin;

    let (letters, ink) = (options.letters(), options.background.ink());
    // Axes stand to the left of the shape.
    let gutter = if options.axes { corner(letters).ceil() } else { 0.0 };
    let captioned = panels.iter().any(|p| !p.caption.is_empty());
    let footer = if captioned { letters * 5 / 2 } else { 0 };
    let columns = if options.columns == 0 { panels.len() } else { options.columns.min(panels.len()) };
    let rows = panels.len().div_ceil(columns);
    let width_of = |i: usize| {
        let shape = (extents[i].high[0] - extents[i].low[0]) * scale + 2.0 * border + gutter;
        (shape.ceil() as usize).max(text_width(&panels[i].caption, letters as f64).ceil() as usize + letters)
    };
    let widths: Vec<usize> =
        (0..columns).map(|c| (c..panels.len()).step_by(columns).map(width_of).max().unwrap_or(0)).collect();
    // No taller than the shapes need, so that wide shapes leave no empty bands.
    let height = ((tallest * scale + 2.0 * border).ceil() as usize).max(16);

    let width: usize = widths.iter().sum();
    let bar = round_length(widths[0] as f64 / 4.0, scale).filter(|_| options.scale_bar);
    let bar = bar.map(|(length, name)| ((length * scale).round().max(1.0) as usize, name));
    let taken = bar.as_ref().map_or(0, |(bar, _)| bar + 2 * letters);
    let legend = Legend::new(legend, width.saturating_sub(taken), letters);
    let below = legend.height().max(if bar.is_some() { 3 * letters } else { 0 });
    let bottom = rows * (height + footer);
    let mut sheet = Image::new(width, bottom + below, options.background.colour())?;
    for (i, panel) in panels.iter().enumerate() {
        let (row, column) = (i / columns, i % columns);
        let width = widths[column];
        let middle = [0, 1].map(|a| 0.5 * (extents[i].low[a] + extents[i].high[a]));
        let placement = Placement {
            camera: panel.view.camera(options.up),
            centre: extents[i].centre,
            scale,
            shift: [
                (width as f64 + gutter) / 2.0 - middle[0] * scale,
                height as f64 / 2.0 + middle[1] * scale,
            ],
            size: [width, height],
            // Depth jumps are judged against the shape, not the sheet.
            depth_unit: unit,
        };
        let picture = draw_panel(panel.model, &placement, options)?;
        let (left, top) = (widths[..column].iter().sum::<usize>(), row * (height + footer));
        sheet.paste(&picture, left, top);
        let text_left =
            left as f64 + (width as f64 + gutter - text_width(&panel.caption, letters as f64)) / 2.0;
        let baseline = (top + height) as f64 + 1.2 * letters as f64;
        write_text(&mut sheet, &panel.caption, [text_left, baseline], letters as f64, ink);
    }
    legend.draw(&mut sheet, bottom, ink);
    if let Some((bar, name)) = bar {
        draw_bar(
            &mut sheet,
            [width.saturating_sub(bar + letters), bottom + 2 * letters],
            bar,
            &name,
            letters,
            ink,
        );
    }
    Ok(sheet)
}

/// The rectangle a model fills in the camera's frame, around its centre.
struct Extent {
    centre: [f64; 3],
    low: [f64; 2],
    high: [f64; 2],
}

impl Extent {
    fn of(panel: &Panel<'_>, up: Up) -> Self {
        let camera = panel.view.camera(up);
        let model = panel.model;
        let centre = model.centre();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for &v in model.triangles.iter().flatten() {
            let p = sub(model.points[v as usize], centre);
            for (a, axis) in [camera.right, camera.up].into_iter().enumerate() {
                let x = dot(axis, p);
                low[a] = low[a].min(x);
                high[a] = high[a].max(x);
            }
        }
        Self { centre, low, high }
    }
}

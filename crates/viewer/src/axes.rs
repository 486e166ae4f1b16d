//! The axes of the coordinates, in a corner of a panel.

use mser3d_shape::vector::Vec3;

use crate::camera::Camera;
use crate::text::{text_width, write_text};
use crate::{Image, Rgb};

/// Length of an axis across the view, in heights of a capital.
const LENGTH: f64 = 3.0;

/// How wide and high the corner is that they need, in pixels.
pub(crate) fn corner(letters: usize) -> f64 {
    2.0 * (LENGTH + 1.6) * letters as f64
}

/// Draws where x, y and z point as seen by a camera, at the lower left: a line and a letter for each. Of an axis that points to the viewer or
/// away there is a dot only.
pub(crate) fn draw_axes(image: &mut Image, camera: &Camera, letters: usize, ink: Rgb) {
    let size = letters as f64;
    let reach = 0.5 * corner(letters);
    let origin = [reach, image.height() as f64 - reach];
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let mut direction: Vec3 = [0.0; 3];
        direction[axis] = 1.0;
        let [right, up, _] = camera.turn(direction);
        let end = [origin[0] + LENGTH * size * right, origin[1] - LENGTH * size * up];
        draw_line(image, origin, end, (0.09 * size).max(0.6), ink);
        let beyond = [end[0] + size * right, end[1] - size * up];
        let half = [0.5 * text_width(name, size), 0.4 * size];
        write_text(image, name, [beyond[0] - half[0], beyond[1] + half[1]], size, ink);
    }
}

/// Draws a line with round ends; `radius` is half of its width, in pixels.
fn draw_line(image: &mut Image, from: [f64; 2], to: [f64; 2], radius: f64, ink: Rgb) {
    let along = [to[0] - from[0], to[1] - from[1]];
    let squared = along[0] * along[0] + along[1] * along[1];
    let (width, height) = (image.width(), image.height());
    let range = |a: f64, b: f64, most: usize| {
        let low = (a.min(b) - radius - 1.0).max(0.0) as usize;
        low..((a.max(b) + radius + 2.0).max(0.0) as usize).min(most)
    };
    for y in range(from[1], to[1], height) {
        for x in range(from[0], to[0], width) {
            let p = [x as f64 + 0.5 - from[0], y as f64 + 0.5 - from[1]];
            let share = (p[0] * along[0] + p[1] * along[1]) / squared.max(1e-12);
            let t = share.clamp(0.0, 1.0);
            let distance = (p[0] - t * along[0]).hypot(p[1] - t * along[1]);
            let cover = (radius + 0.5 - distance).clamp(0.0, 1.0) as f32;
            if cover > 0.0 {
                let pixel = &mut image.pixels_mut()[y * width + x];
                let (under, over) = (pixel.linear(), ink.linear());
                *pixel = Rgb::from_linear(std::array::from_fn(|i| under[i] + cover * (over[i] - under[i])));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{NamedView, Up, View};

    /// How dark the picture is in the direction of a panel's right and up, as seen from the corner's origin.
    fn drawn(view: NamedView) -> [bool; 4] {
        let mut image = Image::new(120, 120, Rgb::WHITE).unwrap();
        draw_axes(&mut image, &View::from(view).camera(Up::Y), 10, Rgb([0; 3]));
        let [x, y] = [46i32, 120 - 46];
        [(15, 0), (0, -15), (-15, 0), (0, 15)].map(|(dx, dy)| {
            let around = (-1..=1).flat_map(|a| (-1..=1).map(move |b| (x + dx + a, y + dy + b)));
            around.into_iter().any(|(x, y)| image.pixels()[(y * 120 + x) as usize] != Rgb::WHITE)
        })
    }

    #[test]
    fn axes_point_where_the_camera_sees_them() {
        // x to the right, y up, z to the viewer.
        assert_eq!(drawn(NamedView::Front), [true, true, false, false]);
        // x to the left.
        assert_eq!(drawn(NamedView::Back), [false, true, true, false]);
        // From above z points down.
        assert_eq!(drawn(NamedView::Top), [true, false, false, true]);
    }
}

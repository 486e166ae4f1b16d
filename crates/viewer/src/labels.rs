//! Numbers on regions, where there is most room for them.

use crate::draw_panel::Placement;
use crate::render_options::RenderOptions;
use crate::text::{text_width, write_text_with_halo};
use crate::z_buffer::{FILLING, NOTHING, Projection};
use crate::{Image, Model, Rgb};

const INK: Rgb = Rgb::hex(0x111111);

/// Writes the model's labels on its picture: each once, at the place of its regions that is farthest from their border. What has too little
/// room is left out.
pub(crate) fn draw_labels(image: &mut Image, model: &Model, place: &Placement, options: &RenderOptions) {
    if model.labels.iter().all(String::is_empty) {
        return;
    }
    let [width, height] = place.size;
    let projection =
        Projection::new(model, place.camera, place.centre, place.shift, place.scale, width as i64);
    let bands = projection.triangles_by_band(1, height as i64, 0);
    let samples = projection.find(&bands[0], 0, height as i64);
    // The label that each pixel shows, as a place in `texts`; regions with the same text count as one.
    let mut texts: Vec<&str> = Vec::new();
    let number: Vec<Option<usize>> = model
        .labels
        .iter()
        .map(|text| {
            let known = texts.iter().position(|known| known == text);
            (!text.is_empty()).then(|| {
                known.unwrap_or_else(|| {
                    texts.push(text);
                    texts.len() - 1
                })
            })
        })
        .collect();
    let shown = |pixel: usize| match samples.triangle[pixel] {
        NOTHING | FILLING => None,
        _ => number.get((samples.paint[pixel] as usize).checked_sub(1)?).copied().flatten(),
    };
    let shown: Vec<Option<usize>> = (0..width * height).map(shown).collect();
    let room = room(&shown, width);
    let size = options.letters() as f64;
    for (label, text) in texts.iter().enumerate() {
        let of_label = (0..shown.len()).filter(|&pixel| shown[pixel] == Some(label));
        // Of equally good places the first.
        let best = of_label.fold(None, |best: Option<usize>, pixel| match best {
            Some(best) if room[best] >= room[pixel] => Some(best),
            _ => Some(pixel),
        });
        let half = 0.5 * text_width(text, size);
        if let Some(pixel) = best.filter(|&pixel| room[pixel] >= 0.5 * size.max(half)) {
            let [x, y] = [pixel % width, pixel / width].map(|at| at as f64);
            write_text_with_halo(image, text, [x - half, y + 0.5 * size], size, INK, Rgb::WHITE);
        }
    }
}

/// For each pixel about how far it is from one that shows something else, in pixels (a chamfer distance).
fn room(shown: &[Option<usize>], width: usize) -> Vec<f64> {
    let height = shown.len() / width;
    let mut room = vec![0.0f64; shown.len()];
    let diagonal = std::f64::consts::SQRT_2;
    let steps = [(-1, 0, 1.0), (0, -1, 1.0), (-1, -1, diagonal), (1, -1, diagonal)];
    for back in [false, true] {
        for step in 0..shown.len() {
            let pixel = if back { shown.len() - 1 - step } else { step };
            let (x, y) = ((pixel % width) as i64, (pixel / width) as i64);
            let mut least = if back { room[pixel] } else { f64::INFINITY };
            for (dx, dy, length) in steps {
                let (dx, dy) = if back { (-dx, -dy) } else { (dx, dy) };
                let (nx, ny) = (x + dx, y + dy);
                let inside = (0..width as i64).contains(&nx) && (0..height as i64).contains(&ny);
                let there = inside.then(|| (ny * width as i64 + nx) as usize);
                least = least.min(match there {
                    Some(there) if shown[there] == shown[pixel] => room[there] + length,
                    _ => length,
                });
            }
            room[pixel] = least;
        }
    }
    room
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_a_square_has_most_room() {
        // A square of 5 x 5 in a picture of 9 x 7.
        let inside = |pixel: usize| (2..7).contains(&(pixel % 9)) && (1..6).contains(&(pixel / 9));
        let shown: Vec<Option<usize>> = (0..63).map(|pixel| inside(pixel).then_some(0)).collect();
        let found = room(&shown, 9);
        let best = (0..63).filter(|&p| inside(p)).max_by(|&a, &b| found[a].total_cmp(&found[b])).unwrap();
        assert_eq!(([best % 9, best / 9], found[best]), ([4, 3], 3.0));
        assert_eq!(found[9 + 2], 1.0);
    }
}

//! Text in pictures: captions, numbers and legends, in DejaVu Sans.
//!
//! The font has Latin with all its accents, Greek, Cyrillic, Armenian, Georgian, mathematical signs and arrows.
//! Those that it lacks (Chinese, say) are boxes. Letters stand one after the other, from left to right:
//! Arabic is not joined and Hebrew not turned around.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, GlyphId, OutlinedGlyph, PxScale, point};
use unicode_normalization::UnicodeNormalization;

use crate::{Image, Rgb};

/// Capitals larger than this many pixels are drawn at this size: no picture needs them, and each letter takes memory for
/// its whole area.
const LARGEST: f64 = 2048.0;
/// How far a halo reaches around the letters, in heights of a capital.
const HALO: f64 = 0.2;
/// A box in place of a letter, in heights of a capital: its width, the pen, and the gap to either side.
const BOX: [f64; 3] = [0.6, 0.1, 0.1];

static LETTERS: LazyLock<Option<Letters>> = LazyLock::new(Letters::load);

/// The font, and the height of its capitals.
struct Letters {
    font: FontRef<'static>,
    /// Of a capital over that of a line, which is what the font is scaled by.
    capital: f64,
    /// Units of the font in a line.
    line: f64,
}

impl Letters {
    fn load() -> Option<Self> {
        let font = FontRef::try_from_slice(dejavu::sans::regular()).ok()?;
        let line = f64::from(font.height_unscaled());
        let capital = f64::from(font.outline(font.glyph_id('H'))?.bounds.height().abs()) / line;
        Some(Self { font, capital, line })
    }
}

/// A letter of a line of text.
enum Glyph {
    Known(GlyphId),
    /// One that the font lacks.
    Box,
}

/// Puts letters beside each other, capitals `size` pixels high. Gives each its left end, and the end of all.
fn layout(text: &str, size: f64) -> (Vec<(Glyph, f64)>, f64) {
    let mut placed = Vec::new();
    let mut x = 0.0;
    let mut last: Option<GlyphId> = None;
    // Some systems write an accent in a file's name as a character after its letter; the font's letters have theirs.
    for letter in text.nfc() {
        let known = LETTERS.as_ref().map(|letters| (letters, letters.font.glyph_id(letter)));
        // Glyph 0 is the font's own "missing".
        let Some((letters, id)) = known.filter(|(_, id)| id.0 != 0) else {
            placed.push((Glyph::Box, x));
            x += (BOX[0] + 2.0 * BOX[2]) * size;
            last = None;
            continue;
        };
        let unit = size / letters.capital / letters.line;
        let kern = last.map_or(0.0, |last| f64::from(letters.font.kern_unscaled(last, id)));
        x += kern * unit;
        placed.push((Glyph::Known(id), x));
        x += f64::from(letters.font.h_advance_unscaled(id)) * unit;
        last = Some(id);
    }
    (placed, x)
}

/// A size that can be drawn, or none.
fn drawable(size: f64) -> Option<f64> {
    (size > 0.0).then(|| size.min(LARGEST))
}

/// Width in pixels of a text whose capitals are `size` pixels high: where the next letter would begin.
///
/// ```
/// use mser3d_viewer::text_width;
/// assert!(text_width("Äpfel", 20.0) > text_width("Apfe", 20.0));
/// assert_eq!(text_width("Äpfel", 20.0), text_width("A\u{308}pfel", 20.0));
/// ```
pub fn text_width(text: &str, size: f64) -> f64 {
    drawable(size).map_or(0.0, |size| layout(text, size).1)
}

/// Writes a text with the left end of its baseline at a place (x to the right, y down, in pixels), its capitals `size`
/// pixels high. What is outside the picture is left out. Letters that the font lacks, and line ends, are boxes.
///
/// The font is DejaVu Sans: Latin with accents, Greek, Cyrillic, Armenian, Georgian, mathematical signs and arrows. Sizes
/// above 2048 are drawn as 2048; without a positive size, or at a place that is not finite, nothing is drawn. The pixels
/// depend on the arguments alone.
///
/// ```
/// use mser3d_viewer::{Image, Rgb, write_text};
/// let mut image = Image::new(120, 30, Rgb::WHITE)?;
/// write_text(&mut image, "Δφ = 0, été", [5.0, 20.0], 12.0, Rgb([0; 3]));
/// assert!(image.pixels().iter().any(|p| *p != Rgb::WHITE));
/// # Ok::<(), mser3d_viewer::ViewerError>(())
/// ```
pub fn write_text(image: &mut Image, text: &str, at: [f64; 2], size: f64, ink: Rgb) {
    if let Some(cover) = Cover::of(image, text, at, size, 0.0) {
        cover.paint(image, ink);
    }
}

/// The same as [`write_text`], with a rim of another colour around the letters, so that they can be read on any ground: a
/// number inside a picture. The rim is a fifth of `size` wide, at least a pixel.
pub fn write_text_with_halo(image: &mut Image, text: &str, at: [f64; 2], size: f64, ink: Rgb, halo: Rgb) {
    let radius = (HALO * size.min(LARGEST)).max(1.0);
    if let Some(cover) = Cover::of(image, text, at, size, radius) {
        cover.widened(radius).paint(image, halo);
        cover.paint(image, ink);
    }
}

/// How much of each pixel letters cover, in a rectangle of a picture.
struct Cover {
    left: usize,
    top: usize,
    width: usize,
    /// 0 to 1, row by row.
    shares: Vec<f32>,
}

impl Cover {
    /// What a text covers in a picture, with room around it; `None` if nothing.
    fn of(image: &Image, text: &str, [left, baseline]: [f64; 2], size: f64, room: f64) -> Option<Self> {
        let size = drawable(size)?;
        if !(left.is_finite() && baseline.is_finite()) {
            return None;
        }
        let (placed, width) = layout(text, size);
        // Letters reach beyond their advances, accents above capitals and tails below the baseline.
        let clip = |from: f64, to: f64, limit: usize| {
            let (from, to) = (from.floor().max(0.0) as usize, (to.ceil().max(0.0) as usize).min(limit));
            (from < to).then_some((from, to))
        };
        let (x0, x1) = clip(left - size - room, left + width + size + room, image.width())?;
        let (y0, y1) = clip(baseline - 2.0 * size - room, baseline + size + room, image.height())?;
        let shares = vec![0.0; (x1 - x0) * (y1 - y0)];
        let mut cover = Self { left: x0, top: y0, width: x1 - x0, shares };
        for (glyph, x) in placed {
            let x = left + x;
            // Far from the picture: not worth its outline.
            if x + 3.0 * size < x0 as f64 || x - 2.0 * size > x1 as f64 {
                continue;
            }
            match glyph {
                Glyph::Known(id) => cover.add_glyph(id, [x, baseline], size),
                Glyph::Box => cover.add_box([x, baseline], size),
            }
        }
        Some(cover)
    }

    fn add_glyph(&mut self, id: GlyphId, [x, y]: [f64; 2], size: f64) {
        let Some(letters) = LETTERS.as_ref() else { return };
        let scale = PxScale::from((size / letters.capital) as f32);
        // Whole pixels are added afterwards, so that a letter looks the same anywhere in a large picture.
        let (column, row) = (x.floor(), y.floor());
        let place = point((x - column) as f32, (y - row) as f32);
        let outlined: Option<OutlinedGlyph> =
            letters.font.outline_glyph(id.with_scale_and_position(scale, place));
        let Some(outlined) = outlined else { return };
        let corner = outlined.px_bounds().min;
        let (column, row) = (column as i64 + corner.x as i64, row as i64 + corner.y as i64);
        outlined.draw(|x, y, share| self.add(column + i64::from(x), row + i64::from(y), share));
    }

    fn add_box(&mut self, [x, baseline]: [f64; 2], size: f64) {
        let [width, pen, gap] = BOX.map(|part| part * size);
        let (left, right) = (x + gap, x + gap + width);
        let (top, bottom) = (baseline - size, baseline);
        // The share of a pixel's edge between two places.
        let within = |pixel: i64, from: f64, to: f64| {
            ((pixel as f64 + 1.0).min(to) - (pixel as f64).max(from)).clamp(0.0, 1.0)
        };
        for row in top.floor() as i64..bottom.ceil() as i64 {
            for column in left.floor() as i64..right.ceil() as i64 {
                let outer = within(column, left, right) * within(row, top, bottom);
                let inner = within(column, left + pen, right - pen) * within(row, top + pen, bottom - pen);
                self.add(column, row, (outer - inner) as f32);
            }
        }
    }

    /// Letters that overlap cover a pixel together, at most all of it.
    fn add(&mut self, column: i64, row: i64, share: f32) {
        let place = |at: i64, from: usize| usize::try_from(at - from as i64).ok();
        if let (Some(column), Some(row)) = (place(column, self.left), place(row, self.top))
            && column < self.width
            && let Some(at) = self.shares.get_mut(row * self.width + column)
        {
            *at = (*at + share).clamp(0.0, 1.0);
        }
    }

    /// The same, and all within a distance of it.
    fn widened(&self, radius: f64) -> Self {
        let reach = (radius + 0.5).floor() as i64;
        let (width, height) = (self.width as i64, (self.shares.len() / self.width) as i64);
        let mut shares = self.shares.clone();
        for row in 0..height {
            for column in 0..width {
                let share = self.shares[(row * width + column) as usize];
                if share == 0.0 {
                    continue;
                }
                for dy in (-reach).max(-row)..=reach.min(height - 1 - row) {
                    for dx in (-reach).max(-column)..=reach.min(width - 1 - column) {
                        let fade = (radius + 0.5 - (dx as f64).hypot(dy as f64)).clamp(0.0, 1.0) as f32;
                        let at = &mut shares[((row + dy) * width + column + dx) as usize];
                        *at = at.max(share * fade);
                    }
                }
            }
        }
        Self { shares, ..*self }
    }

    fn paint(&self, image: &mut Image, colour: Rgb) {
        let width = image.width();
        for (i, &share) in self.shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            let (row, column) = (self.top + i / self.width, self.left + i % self.width);
            let pixel = &mut image.pixels_mut()[row * width + column];
            *pixel = pixel.mix(colour, share);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INK: Rgb = Rgb([0; 3]);

    /// A text with the left end of its baseline at (20, 40), capitals 20 pixels high.
    fn drawn(text: &str) -> Image {
        let mut image = Image::new(200, 60, Rgb::WHITE).unwrap();
        write_text(&mut image, text, [20.0, 40.0], 20.0, INK);
        image
    }

    /// The places (x, y) of pixels that are at least half dark.
    fn dark(image: &Image) -> Vec<[usize; 2]> {
        let grey = Rgb::WHITE.mix(INK, 0.5);
        let places = (0..image.pixels().len()).filter(|&i| image.pixels()[i] <= grey);
        places.map(|i| [i % image.width(), i / image.width()]).collect()
    }

    fn rows(places: &[[usize; 2]]) -> (usize, usize) {
        let rows = || places.iter().map(|p| p[1]);
        (rows().min().unwrap(), rows().max().unwrap())
    }

    #[test]
    fn a_capital_is_as_high_as_asked_and_stands_on_the_baseline() {
        assert_eq!(rows(&dark(&drawn("H"))), (20, 39));
        // A tail hangs below.
        assert!(rows(&dark(&drawn("g"))).1 > 42);
    }

    #[test]
    fn an_accent_is_drawn_above_its_letter_and_changes_nothing_else() {
        for (plain, accented) in [("e", "é"), ("A", "Á"), ("α", "ά"), ("и", "й"), ("u", "ü")] {
            let (plain, accented) = (dark(&drawn(plain)), dark(&drawn(accented)));
            let top = rows(&plain).0;
            let (above, rest): (Vec<[usize; 2]>, Vec<_>) = accented.into_iter().partition(|p| p[1] < top);
            assert!(!above.is_empty());
            assert_eq!(rest, plain);
        }
        // A cedilla hangs below.
        assert!(rows(&dark(&drawn("ç"))).1 > rows(&dark(&drawn("c"))).1);
    }

    #[test]
    fn an_accent_after_its_letter_is_the_letter_with_the_accent() {
        assert_eq!(drawn("e\u{301}te\u{301}"), drawn("été"));
        assert_ne!(drawn("e\u{301}te\u{301}"), drawn("ete"));
    }

    #[test]
    fn letters_of_three_alphabets_differ_and_unknown_ones_are_the_same_box() {
        let mut seen: Vec<Image> = Vec::new();
        for letter in "ABÇÉŁßąőệΓΔλψЖЯцюі0189%±→∞½Ω≤".chars() {
            let image = drawn(&letter.to_string());
            assert!(!dark(&image).is_empty() && !seen.contains(&image), "{letter}");
            seen.push(image);
        }
        assert_eq!(drawn("漢"), drawn("\n"));
        // A rectangle of 12 by 20 pixels, its pen 2 pixels wide, 2 pixels from where it begins.
        let places = dark(&drawn("漢"));
        assert_eq!(places.len(), 12 * 20 - 8 * 16);
        assert!(places.iter().all(|&[x, y]| (22..34).contains(&x) && (20..40).contains(&y)));
        assert!(places.iter().all(|&[x, y]| !((24..32).contains(&x) && (22..38).contains(&y))));
        assert_eq!(text_width("漢字", 20.0), 32.0);
    }

    #[test]
    fn every_letter_makes_a_text_wider_and_all_ink_is_within() {
        let text = "Wolf: été, Ωμέγα, Ёж 漢 #12";
        let ends: Vec<f64> =
            text.char_indices().map(|(i, c)| text_width(&text[..i + c.len_utf8()], 14.0)).collect();
        assert!(ends.windows(2).all(|w| w[0] < w[1]), "{ends:?}");
        // In proportion to the size.
        assert!((text_width(text, 28.0) - 2.0 * text_width(text, 14.0)).abs() < 1e-9);
        let mut image = Image::new(400, 40, Rgb::WHITE).unwrap();
        write_text(&mut image, text, [10.3, 25.6], 14.0, INK);
        let end = 10.3 + text_width(text, 14.0);
        assert!(dark(&image).iter().all(|p| p[0] >= 10 && (p[0] as f64) < end));
        assert!(dark(&image).iter().any(|p| p[0] as f64 > end - 4.0));
    }

    #[test]
    fn a_halo_lies_around_the_letters_and_not_on_them() {
        let ground = Rgb([90, 40, 40]);
        let (mut on_white, mut rimmed) =
            (Image::new(60, 60, Rgb::WHITE).unwrap(), Image::new(60, 60, ground).unwrap());
        write_text(&mut on_white, "8", [20.0, 40.0], 20.0, INK);
        write_text_with_halo(&mut rimmed, "8", [20.0, 40.0], 20.0, INK, Rgb::WHITE);
        let of = |image: &Image, is: &dyn Fn(Rgb) -> bool| -> Vec<[usize; 2]> {
            (0..3600).filter(|&i| is(image.pixels()[i])).map(|i| [i % 60, i / 60]).collect()
        };
        // The letter is the same as on paper.
        let inked = of(&on_white, &|p| p != Rgb::WHITE);
        assert!(inked.iter().all(|[x, y]| rimmed.pixels()[60 * y + x] == on_white.pixels()[60 * y + x]));
        // The rim is a fifth of the height, 4 pixels, and half of one that fades.
        let near = |p: &[usize; 2], q: &[usize; 2]| {
            let apart = |a: usize| p[a].abs_diff(q[a]) as f64;
            apart(0).hypot(apart(1)) < 4.5
        };
        let touched = of(&rimmed, &|p| p != ground);
        assert!(touched.iter().all(|p| inked.iter().any(|q| near(p, q))));
        let around = dark(&on_white);
        let white = of(&rimmed, &|p| p == Rgb::WHITE);
        for x in [19, 20] {
            assert!(white.contains(&[x, 34]) && !around.contains(&[x, 34]), "{x}");
        }
    }

    #[test]
    fn text_is_clipped_and_moves_by_whole_pixels_unchanged() {
        let (whole, mut part) = (drawn("Ünder"), Image::new(50, 30, Rgb::WHITE).unwrap());
        write_text(&mut part, "Ünder", [-5.0, 20.0], 20.0, INK);
        for (i, pixel) in part.pixels().iter().enumerate() {
            assert_eq!(*pixel, whole.pixels()[(i / 50 + 20) * 200 + i % 50 + 25]);
        }
    }

    #[test]
    fn sizes_and_places_without_sense_draw_nothing_and_huge_ones_cost_little() {
        let mut image = Image::new(8, 8, Rgb::WHITE).unwrap();
        for (at, size) in [
            ([0.0, 4.0], 0.0),
            ([0.0, 4.0], -3.0),
            ([0.0, 4.0], f64::NAN),
            ([f64::NAN, 4.0], 5.0),
            ([f64::INFINITY, 4.0], 5.0),
            ([1e300, -1e300], 5.0),
        ] {
            write_text(&mut image, "x漢", at, size, INK);
            write_text_with_halo(&mut image, "x漢", at, size, INK, Rgb([9; 3]));
        }
        assert!(image.pixels().iter().all(|p| *p == Rgb::WHITE));
        assert_eq!(text_width("x", f64::NAN), 0.0);
        assert_eq!(text_width("x", 1e300), text_width("x", LARGEST));
        write_text_with_halo(&mut image, "漢H", [-100.0, 100.0], 1e300, INK, Rgb([9; 3]));
    }
}

//! Captions in a small stroke font: round pens along lines and curves, smooth at every size.

use crate::{Image, Rgb};

/// Units of the font's grid in a capital's height; the baseline lies at y = 4.
const CAPITAL: f64 = 12.0;
const BASELINE: f64 = 4.0;
/// Empty units after each letter.
const GAP: f64 = 4.5;
const SPACE: f64 = 4.0;
/// Half the width of the pen.
const PEN: f64 = 0.85;

/// The printable ASCII characters from '!' on. A stroke is a row of points, each two digits of base
/// 36 (x and y, y up); `~` before it bends it into a quadratic B-spline, `o` closes that into a ring.
const GLYPHS: [&str; 94] = [
    "04 04|08 0g",
    "0d 0g|3d 3g",
    "24 4g|64 8g|08 98|0c 9c",
    "~9d 8g 0g 0a 9a 94 14 07|4i 42",
    "24 ag|o0g 4g 4b 0b|o89 c9 c4 84",
    "~a4 2c 2g 7g 7c 09 04 84 a9",
    "0d 0g",
    "~3h 0d 05 31",
    "~0h 3d 35 01",
    "38 3e|09 6d|0d 69",
    "09 89|45 4d",
    "15 02",
    "09 59",
    "04 04",
    "02 6g",
    "o0g 8g 84 04",
    "0d 4g 44",
    "~0d 0g 8g 8a 04|04 84",
    "~0e 1g 8g 8a 3a|~3a 8a 84 04 06",
    "74 7g 08 98",
    "7g 1g 0a|~0a 2c 8c 84 04 06",
    "o0c 8c 84 04|~08 0d 4g 7g",
    "0g 8g 34",
    "o1g 7g 7a 1a|o0a 8a 84 04",
    "o0g 8g 88 08|~8c 87 44 14",
    "04 04|0a 0a",
    "15 02|1a 1a",
    "7d 09 75",
    "07 87|0b 8b",
    "0d 79 05",
    "~0d 0g 7g 7b 3a 38|34 34",
    "o0g cg c4 04|o4c 8c 88 48",
    "04 5g a4|28 88",
    "04 0g|~0g 3g 8g 8a 3a 0a|~0a 3a 9a 94 34 04",
    "~ad 9g 0g 04 94 a7",
    "04 0g|~0g 3g ag a4 34 04",
    "8g 0g 04 84|0a 7a",
    "8g 0g 04|0a 7a",
    "~ad 9g 0g 04 94 a6 aa|aa 6a",
    "04 0g|a4 ag|0a aa",
    "04 0g",
    "~6g 69 64 04 07",
    "04 0g|9g 08|3b 94",
    "0g 04 84",
    "04 0g 66 cg c4",
    "04 0g a4 ag",
    "o0g bg b4 04",
    "04 0g|~0g 3g 9g 99 39 09",
    "o0g bg b4 04|77 b3",
    "04 0g|~0g 3g 9g 99 39 09|59 94",
    "~9d 8g 0g 0a 9a 94 14 07",
    "0g ag|54 5g",
    "~0g 09 04 a4 a9 ag",
    "0g 54 ag",
    "0g 44 7e a4 eg",
    "04 ag|0g a4",
    "0g 5a ag|5a 54",
    "0g 9g 04 94",
    "3h 0h 01 31",
    "0g 62",
    "0h 3h 31 01",
    "0c 3g 6c",
    "02 82",
    "0g 2e",
    "7c 74|o0c 7c 74 04",
    "0g 04|o0c 8c 84 04",
    "~7a 6c 0c 04 64 76",
    "8g 84|o0c 8c 84 04",
    "08 88|~88 8c 0c 04 74 86",
    "~5g 2g 2b 24|0c 5c",
    "o0c 8c 84 04|~8c 84 80 00 02",
    "0g 04|~09 0c 7c 79 74",
    "04 0c|0g 0g",
    "~2c 22 20 00|2g 2g",
    "0g 04|6c 08|29 74",
    "0g 04",
    "0c 04|~09 0c 6c 69 64|~69 6c cc c9 c4",
    "0c 04|~09 0c 7c 79 74",
    "o0c 8c 84 04",
    "0c 00|o0c 8c 84 04",
    "8c 80|o0c 8c 84 04",
    "0c 04|~08 0c 4c 5b",
    "~6a 5c 0c 08 68 64 14 06",
    "~2g 27 24 54|0c 5c",
    "7c 74|~0c 07 04 74 77",
    "0c 44 8c",
    "0c 34 6b 94 cc",
    "04 7c|0c 74",
    "0c 44|8c 20",
    "0c 7c 04 74",
    "~3h 1h 1c 09|~09 16 11 31",
    "0h 01",
    "~0h 2h 2c 39|~39 26 21 01",
    "~08 2c 68 8c",
];
/// Stands for characters that the font lacks.
const UNKNOWN: &str = "04 0g 8g 84 04";

/// Width of a text in pixels, its capitals `size` pixels high.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    let units: f64 = text.chars().map(advance).sum();
    ((units - GAP).max(0.0) + 2.0 * PEN) * size / CAPITAL
}

/// Writes a text with its baseline's left end at a place, its capitals `size` pixels high.
pub(crate) fn write_text(image: &mut Image, text: &str, [left, baseline]: [f64; 2], size: f64, ink: Rgb) {
    let unit = size / CAPITAL;
    let mut x = left + PEN * unit;
    for letter in text.chars() {
        let lines: Vec<[[f64; 2]; 2]> = strokes(letter)
            .flat_map(|stroke| {
                let point = |p: &[f64; 2]| [x + p[0] * unit, baseline - (p[1] - BASELINE) * unit];
                let points: Vec<[f64; 2]> = stroke.iter().map(point).collect();
                points.windows(2).map(|w| [w[0], w[1]]).collect::<Vec<_>>()
            })
            .collect();
        ink_lines(image, &lines, PEN * unit, ink);
        x += advance(letter) * unit;
    }
}

fn glyph(letter: char) -> &'static str {
    (letter as usize).checked_sub(33).and_then(|i| GLYPHS.get(i)).copied().unwrap_or(UNKNOWN)
}

fn advance(letter: char) -> f64 {
    if letter == ' ' {
        return SPACE + GAP / 2.0;
    }
    let right = strokes(letter).flatten().map(|p| p[0]).fold(0.0, f64::max);
    right + GAP
}

/// The strokes of a letter as polylines on the font's grid.
fn strokes(letter: char) -> impl Iterator<Item = Vec<[f64; 2]>> {
    let code = if letter == ' ' { "" } else { glyph(letter) };
    code.split('|').filter(|s| !s.is_empty()).map(|stroke| {
        let ring = stroke.starts_with('o');
        let curve = ring || stroke.starts_with('~');
        let digits = stroke.trim_start_matches(['~', 'o']);
        let mut points: Vec<[f64; 2]> = digits
            .split(' ')
            .map(|pair| {
                let mut digits = pair.chars().map(|c| f64::from(c.to_digit(36).unwrap_or(0)));
                [digits.next().unwrap_or(0.0), digits.next().unwrap_or(0.0)]
            })
            .collect();
        if curve {
            for _ in 0..4 {
                points = cut_corners(&points, ring);
            }
        }
        if ring {
            points.push(points[0]);
        }
        points
    })
}

/// One round of Chaikin's corner cutting, whose limit is the quadratic B-spline.
fn cut_corners(points: &[[f64; 2]], ring: bool) -> Vec<[f64; 2]> {
    let between = |p: [f64; 2], q: [f64; 2], t: f64| [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])];
    let n = points.len();
    let mut cut = Vec::with_capacity(2 * n);
    for i in 0..if ring { n } else { n - 1 } {
        let (p, q) = (points[i], points[(i + 1) % n]);
        cut.push(between(p, q, if !ring && i == 0 { 0.0 } else { 0.25 }));
        cut.push(between(p, q, if !ring && i == n - 2 { 1.0 } else { 0.75 }));
    }
    cut
}

/// Darkens the pixels that a round pen of this radius covers along some lines.
fn ink_lines(image: &mut Image, lines: &[[[f64; 2]; 2]], radius: f64, ink: Rgb) {
    let (width, height) = (image.width(), image.height());
    let bound = |axis: usize, limit: usize| {
        let all = || lines.iter().flatten().map(|p| p[axis]);
        let low = all().fold(f64::INFINITY, f64::min) - radius - 1.0;
        let high = all().fold(f64::NEG_INFINITY, f64::max) + radius + 1.0;
        (low.max(0.0) as usize, (high.max(0.0).ceil() as usize).min(limit))
    };
    let ((x0, x1), (y0, y1)) = (bound(0, width), bound(1, height));
    for y in y0..y1 {
        for x in x0..x1 {
            let p = [x as f64 + 0.5, y as f64 + 0.5];
            let nearest = lines.iter().map(|l| distance(p, *l)).fold(f64::INFINITY, f64::min);
            let cover = (radius + 0.5 - nearest).clamp(0.0, 1.0);
            if cover > 0.0 {
                let pixel = &mut image.pixels_mut()[y * width + x];
                *pixel = pixel.mix(ink, cover as f32);
            }
        }
    }
}

fn distance(p: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length = dx * dx + dy * dy;
    let along = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / length.max(1e-30);
    let t = along.clamp(0.0, 1.0);
    (p[0] - a[0] - t * dx).hypot(p[1] - a[1] - t * dy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_printable_character_leaves_ink_within_its_width() {
        for letter in '!'..='~' {
            let text = letter.to_string();
            let mut image = Image::new(40, 40, Rgb::WHITE).unwrap();
            write_text(&mut image, &text, [10.0, 25.0], 18.0, Rgb([0; 3]));
            let inked = |i: usize| image.pixels()[i] != Rgb::WHITE;
            assert!((0..1600).any(inked), "{letter}");
            let right = 10.0 + text_width(&text, 18.0) + 1.0;
            assert!(
                (0..1600).filter(|i| inked(*i)).all(|i| (9.0..=right).contains(&((i % 40) as f64))),
                "{letter}"
            );
        }
    }

    #[test]
    fn letters_differ() {
        let mut seen = std::collections::HashSet::new();
        assert!(('0'..='9').chain('A'..='Z').chain('a'..='z').all(|c| c == 'l' || seen.insert(glyph(c))));
    }
}

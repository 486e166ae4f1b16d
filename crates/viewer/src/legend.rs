//! What stands below the panels of a sheet: which colour means what, and how long things are.

use crate::text::{text_width, write_text};
use crate::{Image, Rgb};

/// The colours of one thing, and what it is.
#[derive(Clone, Debug, PartialEq)]
pub struct LegendEntry {
    /// One of each square before the text.
    pub colours: Vec<Rgb>,
    /// What they mean.
    pub text: String,
}

/// Entries in rows that are no wider than the sheet.
pub(crate) struct Legend<'a> {
    /// Of each row the entries, with their left ends.
    rows: Vec<Vec<(usize, &'a LegendEntry)>>,
    letters: usize,
}

impl<'a> Legend<'a> {
    pub fn new(entries: &'a [LegendEntry], width: usize, letters: usize) -> Self {
        let mut rows: Vec<Vec<(usize, &LegendEntry)>> = Vec::new();
        let mut right = usize::MAX;
        for entry in entries {
            let text = text_width(&entry.text, letters as f64).ceil() as usize;
            let own = entry.colours.len() * step(letters) + letters / 2 + text;
            if right.saturating_add(own + 2 * letters) > width {
                rows.push(Vec::new());
                right = letters;
            }
            if let Some(row) = rows.last_mut() {
                row.push((right, entry));
            }
            right += own + 2 * letters;
        }
        Self { rows, letters }
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        if self.rows.is_empty() { 0 } else { (2 * self.rows.len() + 1) * self.letters }
    }

    /// Draws it from a row of pixels on.
    pub fn draw(&self, sheet: &mut Image, top: usize, ink: Rgb) {
        let letters = self.letters;
        for (row, entries) in self.rows.iter().enumerate() {
            let baseline = top + (2 * row + 1) * letters + letters / 2;
            for (left, entry) in entries {
                for (place, colour) in entry.colours.iter().enumerate() {
                    let square = Image::new(letters, letters, *colour);
                    // As high as a capital.
                    if let Ok(square) = square {
                        sheet.paste(&square, left + place * step(letters), baseline - letters);
                    }
                }
                let text = left + entry.colours.len() * step(letters) + letters / 2;
                write_text(sheet, &entry.text, [text as f64, baseline as f64], letters as f64, ink);
            }
        }
    }
}

/// From one square to the next.
fn step(letters: usize) -> usize {
    letters + letters / 4
}

/// A length of 1, 2 or 5 times a power of ten that fills at most `pixels` at this scale, and its name.
pub(crate) fn round_length(pixels: f64, scale: f64) -> Option<(f64, String)> {
    let most = pixels / scale;
    if !(most > 0.0 && most.is_finite()) {
        return None;
    }
    let power = most.log10().floor();
    let length = [5.0, 2.0, 1.0].map(|digit| digit * 10f64.powf(power)).into_iter().find(|l| *l <= most)?;
    let name = if (-4.0..6.0).contains(&power) {
        format!("{length:.*}", (-power).max(0.0) as usize)
    } else {
        format!("{length:e}")
    };
    Some((length, name))
}

/// Draws a bar with its length written over it; `[left, baseline]` is where it begins.
pub(crate) fn draw_bar(
    sheet: &mut Image,
    place: [usize; 2],
    width: usize,
    name: &str,
    letters: usize,
    ink: Rgb,
) {
    let [left, bottom] = place;
    let pen = (letters / 8).max(1);
    let mut bar = |width: usize, height: usize, left: usize, top: usize| {
        if let Ok(bar) = Image::new(width, height, ink) {
            sheet.paste(&bar, left, top);
        }
    };
    bar(width, pen, left, bottom);
    for end in [left, left + width.saturating_sub(pen)] {
        bar(pen, letters / 2, end, (bottom + pen).saturating_sub(letters / 2));
    }
    let text = left as f64 + (width as f64 - text_width(name, letters as f64)) / 2.0;
    write_text(sheet, name, [text.max(0.0), bottom.saturating_sub(letters / 2) as f64], letters as f64, ink);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_round_and_fit() {
        let length = |pixels: f64, scale: f64| round_length(pixels, scale);
        assert_eq!(length(100.0, 100.0), Some((1.0, "1".into())));
        assert_eq!(length(99.0, 100.0), Some((0.5, "0.5".into())));
        assert_eq!(length(100.0, 0.45), Some((200.0, "200".into())));
        assert_eq!(length(100.0, 3e8).map(|(_, name)| name), Some("2e-7".into()));
        assert_eq!((length(100.0, 0.0), length(100.0, f64::NAN)), (None, None));
    }

    #[test]
    fn entries_flow_into_rows() {
        let entry = |text: &str| LegendEntry { colours: vec![Rgb::WHITE], text: text.into() };
        let entries = [entry("one"), entry("two"), entry("three")];
        let rows = |width| Legend::new(&entries, width, 10).rows.iter().map(Vec::len).collect::<Vec<_>>();
        assert_eq!(rows(1000), [3]);
        assert_eq!(rows(1), [1, 1, 1]);
        assert!(Legend::new(&[], 100, 10).height() == 0);
    }
}

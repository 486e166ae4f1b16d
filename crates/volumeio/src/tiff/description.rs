//! What a program wrote into the description of the first page.
use super::ome::Ome;
use super::page::Page;
use crate::error::Fault;
use std::collections::HashMap;

/// Whose description it is.
pub(super) enum Description {
    /// ImageJ's lines `key=value`.
    ImageJ(ImageJ),
    /// OME-XML.
    Ome(Ome),
    /// The shape of an array, as tifffile writes it.
    Shaped(Shaped),
    /// None that is known.
    None,
}

/// What ImageJ says (`ij.io.FileSaver`).
pub(super) struct ImageJ {
    fields: HashMap<String, String>,
}

impl ImageJ {
    pub fn count(&self, key: &str) -> Option<usize> {
        self.fields.get(key)?.parse().ok().filter(|&n| n > 0)
    }

    pub fn number(&self, key: &str) -> Option<f64> {
        self.fields.get(key)?.parse().ok()
    }

    pub fn text(&self, key: &str) -> Option<&str> {
        self.fields.get(key).map(String::as_str)
    }
}

/// What tifffile says.
pub(super) struct Shaped {
    /// The axes before those of a page, slowest first: letter and length.
    pub axes: Vec<(char, usize)>,
    pub spacing: Option<f64>,
    pub unit: Option<String>,
}

impl Description {
    pub fn of(text: Option<&str>, page: &Page) -> Result<Self, Fault> {
        let Some(text) = text else { return Ok(Self::None) };
        if text.starts_with("ImageJ=") {
            let pairs = text.lines().filter_map(|line| line.split_once('='));
            let fields = pairs.map(|(key, value)| (key.trim().to_owned(), value.trim().to_owned()));
            return Ok(Self::ImageJ(ImageJ { fields: fields.collect() }));
        }
        if text.trim_start().starts_with('<') && text.contains("OME") {
            return Ok(Ome::of(text)?.map_or(Self::None, Self::Ome));
        }
        Ok(shaped(text, page).map_or(Self::None, Self::Shaped))
    }
}

/// `{"shape": [24, 40, 30], "axes": "ZYX"}`, of which the last axes must be those of the page.
fn shaped(text: &str, page: &Page) -> Option<Shaped> {
    let text = text.trim();
    if !text.starts_with('{') {
        return None;
    }
    let after = |key: &str| {
        let (_, rest) = text.split_once(&format!("\"{key}\""))?;
        rest.trim_start().strip_prefix(':').map(str::trim_start)
    };
    let quoted =
        |key: &str| after(key)?.strip_prefix('"')?.split_once('"').map(|(value, _)| value.to_owned());
    let inside = after("shape")?.strip_prefix('[')?.split_once(']')?.0;
    let shape: Vec<usize> = inside.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>()?;
    let (w, h, s) = (page.width, page.height, page.samples);
    let last = [&[h, w][..], &[h, w, s], &[s, h, w]];
    let last = if s == 1 { &last[..1] } else { &last[1..] };
    let before = last.iter().find(|&&last| shape.ends_with(last)).map(|last| shape.len() - last.len())?;
    let names: Vec<char> = quoted("axes").unwrap_or_default().chars().collect();
    let named = names.len() == shape.len();
    let letter = |i: usize| match named {
        true => names[i],
        false if i + 1 == before => 'Z',
        false => '?',
    };
    let spacing = after("spacing").and_then(|text| {
        let end =
            text.find(|c: char| !matches!(c, '0'..='9' | '.' | 'e' | 'E' | '+' | '-')).unwrap_or(text.len());
        text[..end].parse::<f64>().ok()
    });
    Some(Shaped { axes: (0..before).map(|i| (letter(i), shape[i])).collect(), spacing, unit: quoted("unit") })
}

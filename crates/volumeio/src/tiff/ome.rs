//! OME-XML: axes, sizes of pixels, and which page is which plane
//! (<https://docs.openmicroscopy.org/ome-model/latest/ome-tiff/specification.html>).
use super::xml::{Element, elements};
use crate::error::Fault;

/// What the description says of its first image.
pub(super) struct Ome {
    /// The axes of its planes, fastest first: letter and length. Of C, planes and not samples.
    pub axes: Vec<(char, usize)>,
    /// The page of each plane by number in the file; none where pages follow in the order of planes.
    pub pages: Option<Vec<usize>>,
    /// Sizes of a pixel along X, Y and Z, each with its unit.
    pub sizes: [Option<(f64, String)>; 3],
    /// Images that follow.
    pub others: usize,
}

impl Ome {
    /// None for XML without an image.
    pub fn of(text: &str) -> Result<Option<Self>, Fault> {
        let elements = elements(text);
        let images = elements.iter().filter(|e| e.name == "Pixels").count();
        let Some(at) = elements.iter().position(|e| e.name == "Pixels") else {
            if let Some(file) = elements.iter().find_map(|e| e.attribute("MetadataFile")) {
                return Err(Fault::unsupported(format!(
                    "its description is in another file, {file}; export a single OME-TIFF"
                )));
            }
            return Ok(None);
        };
        let pixels = &elements[at];
        let end =
            elements[at + 1..].iter().position(|e| e.name == "Pixels").map_or(elements.len(), |n| at + 1 + n);
        let inside = &elements[at + 1..end];
        let size = |name: &str| {
            let size = pixels.attribute(name).and_then(|n| n.trim().parse::<usize>().ok()).filter(|&n| n > 0);
            size.ok_or_else(|| Fault::invalid(format!("the OME-XML of the file has no usable {name}")))
        };
        // The samples of a pixel are channels without planes of their own.
        let samples = inside.iter().filter(|e| e.name == "Channel");
        let samples = samples.filter_map(|e| e.attribute("SamplesPerPixel")?.trim().parse::<usize>().ok());
        let samples = samples.max().unwrap_or(1).max(1);
        let planes = |letter: char| -> Result<(char, usize), Fault> {
            Ok((
                letter,
                match letter {
                    'C' => size("SizeC")?.div_ceil(samples),
                    'T' => size("SizeT")?,
                    _ => size("SizeZ")?,
                },
            ))
        };
        let order = pixels.attribute("DimensionOrder").unwrap_or("XYZCT");
        let mut letters: Vec<char> = order.chars().filter(|c| matches!(c, 'Z' | 'C' | 'T')).collect();
        letters.sort_by_key(|&c| order.find(c));
        letters.dedup();
        if letters.len() != 3 {
            return Err(Fault::invalid(format!("the OME-XML of the file has the DimensionOrder {order:?}")));
        }
        let axes = letters.into_iter().map(planes).collect::<Result<Vec<_>, _>>()?;
        let unit = |name: &str| pixels.attribute(&format!("{name}Unit")).unwrap_or("µm").to_owned();
        let length = |axis: &str| {
            let name = format!("PhysicalSize{axis}");
            let length = pixels.attribute(&name)?.trim().parse::<f64>().ok()?;
            Some((length, unit(&name))).filter(|(length, _)| length.is_normal() && *length > 0.0)
        };
        let own = elements.iter().find(|e| e.name == "OME").and_then(|e| e.attribute("UUID"));
        Ok(Some(Self {
            pages: pages(inside, own, &axes)?,
            axes,
            sizes: ["X", "Y", "Z"].map(length),
            others: images - 1,
        }))
    }
}

/// The page of each plane by the elements `TiffData`.
fn pages(inside: &[Element], own: Option<&str>, axes: &[(char, usize)]) -> Result<Option<Vec<usize>>, Fault> {
    let planes = axes.iter().try_fold(1usize, |n, axis| n.checked_mul(axis.1)).filter(|&n| n <= 1 << 20);
    let planes = planes.ok_or_else(|| Fault::invalid("the OME-XML of the file promises too many planes"))?;
    let mut of_plane: Vec<Option<usize>> = vec![None; planes];
    let (mut said, mut assigned) = (false, 0);
    for (i, data) in inside.iter().enumerate().filter(|(_, e)| e.name == "TiffData") {
        let number = |name: &str| data.attribute(name).and_then(|n| n.trim().parse::<usize>().ok());
        if let Some(uuid) = inside.get(i + 1).filter(|e| e.name == "UUID")
            && own.is_some_and(|own| own.trim() != uuid.text.trim())
        {
            let file = uuid.attribute("FileName").unwrap_or("another file");
            return Err(Fault::unsupported(format!(
                "some of its planes are in {file}; export a single OME-TIFF"
            )));
        }
        let (page, count) = (number("IFD"), number("PlaneCount"));
        let firsts = axes.iter().map(|&(letter, _)| number(&format!("First{letter}")));
        let firsts: Vec<Option<usize>> = firsts.collect();
        if page.is_none() && count.is_none() && firsts.iter().all(Option::is_none) {
            // All planes, in order.
            continue;
        }
        said = true;
        let count = count.unwrap_or(if page.is_some() { 1 } else { planes });
        let (mut start, mut stride) = (0usize, 1usize);
        for (first, &(_, size)) in firsts.iter().zip(axes) {
            start = start.saturating_add(first.unwrap_or(0).saturating_mul(stride));
            stride *= size;
        }
        let page = page.unwrap_or(0);
        assigned += count.min(planes);
        if assigned > 2 * planes {
            return Err(Fault::invalid("the OME-XML of the file gives planes several pages each"));
        }
        for i in 0..count.min(planes) {
            if let Some(plane) = start.checked_add(i).and_then(|plane| of_plane.get_mut(plane)) {
                *plane = Some(page.saturating_add(i));
            }
        }
    }
    if !said {
        return Ok(None);
    }
    let missing = of_plane.iter().filter(|page| page.is_none()).count();
    if missing > 0 {
        return Err(Fault::invalid(format!(
            "the OME-XML of the file promises {planes} planes, but {missing} of them are in no page"
        )));
    }
    Ok(of_plane.into_iter().collect())
}

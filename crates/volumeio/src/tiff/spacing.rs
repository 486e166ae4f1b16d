//! The size of a voxel: resolution tags, ImageJ's, OME's and tifffile's descriptions.
use super::description::Description;
use super::directory::{Directory, Source};
use std::io::{Read, Seek};

/// Spacing, its unit, and what said it.
pub(super) fn of(
    source: &Source<impl Read + Seek>,
    directory: &Directory,
    description: &Description,
    layers: usize,
    notes: &mut Vec<String>,
) -> ([f64; 3], Option<String>, String) {
    let resolution = [source.fraction(directory, 282), source.fraction(directory, 283)];
    let kind = source.number(directory, 296).unwrap_or(2);
    match description {
        Description::ImageJ(ij) => {
            let [x, y] = resolution.map(|r| r.map(|r| 1.0 / r));
            let x = x.or(y).unwrap_or(1.0);
            let y = y.unwrap_or(x);
            let spacing = ij.number("spacing").map(f64::abs).filter(|z| z.is_normal());
            // ImageJ writes it unless it is 1.
            if spacing.is_none() && layers > 1 && (x, y) != (1.0, 1.0) {
                notes.push(
                    "ImageJ's description has no spacing; layers are 1 apart, as ImageJ takes it".to_owned(),
                );
            }
            if ["xorigin", "yorigin", "zorigin"].iter().any(|key| ij.number(key).is_some_and(|x| x != 0.0)) {
                notes.push("ImageJ's origin is left out: the first voxel is at 0".to_owned());
            }
            let by_tag = match kind {
                2 => Some("inch"),
                3 => Some("cm"),
                _ => None,
            };
            let by_tag = by_tag.filter(|_| resolution != [None, None]);
            let unit = ij.text("unit").or(by_tag).and_then(unit);
            if ["yunit", "zunit"].iter().any(|key| ij.text(key).is_some_and(|u| self::unit(u) != unit)) {
                notes.push(
                    "ImageJ's units of y or z are others than that of x; the numbers are as stored"
                        .to_owned(),
                );
            }
            let by = match spacing {
                Some(_) => "ImageJ's spacing and the resolution",
                None if (x, y) == (1.0, 1.0) => "nothing: voxels of size 1",
                None => "the resolution, as ImageJ reads it",
            };
            ([x, y, spacing.unwrap_or(1.0)], unit, by.to_owned())
        }
        Description::Ome(ome) => {
            let [x, y, z] = ome.sizes.clone();
            let Some((x_size, x_unit)) = x.clone().or(y.clone()) else {
                return by_tags(resolution, kind, layers, notes);
            };
            // In the unit of x.
            let mut as_x = |size: Option<(f64, String)>, axis: &str| {
                let (size, other) = size?;
                match (metres(&x_unit), metres(&other)) {
                    _ if x_unit == other => Some(size),
                    (Some(own), Some(other)) => Some(size * (other / own)),
                    _ => {
                        notes.push(format!(
                            "the unit {other} of {axis} is not that of x, {x_unit}; it was taken as that"
                        ));
                        Some(size)
                    }
                }
            };
            let (y, z) = (as_x(y, "y").unwrap_or(x_size), as_x(z, "z"));
            let z = z.unwrap_or_else(|| guessed(x_size, layers, notes));
            ([x_size, y, z], unit(&x_unit), "OME's PhysicalSize".to_owned())
        }
        Description::Shaped(shaped) if shaped.spacing.is_some() || shaped.unit.is_some() => {
            let [x, y] = resolution.map(|r| r.map(|r| 1.0 / r));
            let x = x.or(y).unwrap_or(1.0);
            let spacing = shaped.spacing.map(f64::abs).filter(|z| z.is_normal());
            let z = spacing.unwrap_or_else(|| guessed(x, layers, notes));
            let unit = shaped.unit.as_deref().and_then(unit);
            ([x, y.unwrap_or(x), z], unit, "the description's spacing and the resolution".to_owned())
        }
        _ => by_tags(resolution, kind, layers, notes),
    }
}

/// By the tags of the page alone, which know no distance of layers.
fn by_tags(
    resolution: [Option<f64>; 2],
    kind: u64,
    layers: usize,
    notes: &mut Vec<String>,
) -> ([f64; 3], Option<String>, String) {
    let nothing = ([1.0; 3], None, "nothing: voxels of size 1".to_owned());
    let [Some(x), Some(y)] = resolution else { return nothing };
    let unit_length = match kind {
        2 => 25.4,
        3 => 10.0,
        // Without a unit the resolution says no more than how high pixels are for their width.
        _ if x == y => return nothing,
        _ => {
            let z = guessed(1.0, layers, notes);
            return ([1.0, x / y, z], None, "the ratio of the resolutions".to_owned());
        }
    };
    let [x, y] = [unit_length / x, unit_length / y];
    let z = guessed(x, layers, notes);
    ([x, y, z], Some("mm".to_owned()), "the resolution".to_owned())
}

fn guessed(x: f64, layers: usize, notes: &mut Vec<String>) -> f64 {
    if layers > 1 {
        let about = (x * 1e6).round() / 1e6;
        notes.push(format!(
            "the file does not say how far apart the layers are; {about} was taken, the width of a pixel"
        ));
    }
    x
}

/// A unit's usual short name; none for one that is no length.
fn unit(name: &str) -> Option<String> {
    Some(match name.trim() {
        "" | "pixel" | "pixels" | "reference frame" | "null" | "none" | "None" => return None,
        "\\u00B5m" | "\\u00b5m" | "µm" | "μm" | "um" | "micron" | "microns" | "micrometer"
        | "micrometers" => "um".to_owned(),
        "millimeter" | "millimeters" => "mm".to_owned(),
        "in" | "inch" | "inches" => "inch".to_owned(),
        other => other.to_owned(),
    })
}

fn metres(name: &str) -> Option<f64> {
    Some(match unit(name)?.as_str() {
        "pm" => 1e-12,
        "Å" => 1e-10,
        "nm" => 1e-9,
        "um" => 1e-6,
        "mm" => 1e-3,
        "cm" => 1e-2,
        "dm" => 1e-1,
        "m" => 1.0,
        "inch" => 0.0254,
        _ => return None,
    })
}

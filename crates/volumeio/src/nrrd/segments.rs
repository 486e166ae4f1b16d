//! The names of labels, as 3D Slicer writes them
//! (<https://slicer.readthedocs.io/en/latest/user_guide/modules/segmentations.html>, `.seg.nrrd`).
use super::header::Header;
use crate::loaded::Segment;
use std::collections::BTreeMap;

/// What the remarks `Segment0_Name`, `Segment0_ID`, `Segment0_LabelValue` and `Segment0_Layer` say.
pub(super) fn of(header: &Header, layers: usize, notes: &mut Vec<String>) -> Vec<Segment> {
    let mut all: BTreeMap<usize, BTreeMap<&str, &str>> = BTreeMap::new();
    for (key, value) in &header.remarks {
        let parts = key.strip_prefix("Segment").and_then(|rest| rest.split_once('_'));
        if let Some((number, what)) = parts.and_then(|(n, what)| Some((n.parse().ok()?, what))) {
            all.entry(number).or_default().insert(what, value.trim());
        }
    }
    let segment = |(number, about): (usize, BTreeMap<&str, &str>)| {
        // Segmentations of before layers have one segment in each, all of value 1.
        let of_old = if layers > 1 { number } else { 0 };
        let layer = about.get("Layer").map_or(Some(of_old), |layer| layer.parse().ok());
        let value = about.get("LabelValue").map_or(Some(1), |value| value.parse().ok());
        let name = about.get("Name").or_else(|| about.get("ID")).copied().unwrap_or_default();
        let name = if name.is_empty() { format!("Segment {number}") } else { name.to_owned() };
        match (value, layer.filter(|&layer| layer < layers)) {
            (Some(value), Some(layer)) => Some(Segment { value, layer, name }),
            _ => {
                notes.push(format!(
                    "segment {number} ({name}) is left out: its label or layer is not in the file"
                ));
                None
            }
        }
    };
    all.into_iter().filter_map(segment).collect()
}

//! What was found as a short table.

use std::path::Path;

use mser3d::{Domain, Features, PartCount, Sidedness};
use mser3d_results::{left_and_right, side_text};

use crate::message::name;

/// The regions, the parts, and where they were written.
pub fn found(features: &Features, folder: &Path) -> String {
    let (count, size) = (features.regions.len(), features.shape.len());
    let elements = elements(features);
    let end =
        format!("{count} regions in {size} {elements}; written to {}\n", name(&folder.to_string_lossy()));
    regions(features) + &parts(features) + &left_and_right_of_bodies(features) + &end
}

fn elements(features: &Features) -> &'static str {
    match features.shape.domain() {
        Domain::Volume => "voxels",
        Domain::Surface => "vertices",
    }
}

fn regions(features: &Features) -> String {
    let elements = elements(features);
    // Columns that would have nothing to say are left out.
    let twins = features.regions.iter().any(|region| region.twin.is_some());
    let sides = features.regions.iter().any(|region| region.side.is_some());
    let own = |twin: String, side: String| {
        let twin = if twins { format!("  {twin:>4}") } else { String::new() };
        if sides { format!("{twin}  {side:>5}") } else { twin }
    };
    let heads = own("twin".into(), "side".into());
    let mut text = format!(
        " id  parent{heads}  measure %  {elements:>8}  stability  reliability  time scale  centroid\n"
    );
    let or_dash = |number: Option<f64>, digits: usize| {
        number.filter(|x| x.is_finite()).map_or("-".into(), |x| format!("{x:.digits$}"))
    };
    for id in features.ranked() {
        let region = &features.regions[id];
        let number = |other: Option<usize>| other.map_or("-".into(), |id| id.to_string());
        let parent = number(region.parent);
        let own = own(number(region.twin), region.side.map_or("-".into(), side_text));
        let scale = features.trees[region.tree].time_scale.map_or("-".into(), |scale| scale.to_string());
        let [x, y, z] = region.centroid;
        text += &format!(
            "{id:>3}  {parent:>6}{own}  {:>9.2}  {:>8}  {:>9}  {:>11}  {scale:>10}  ({x:.4}, {y:.4}, {z:.4})\n",
            100.0 * region.volume_fraction,
            region.elements.len(),
            or_dash(Some(region.stability), 3),
            or_dash(region.reliability, 2),
        );
    }
    if features.regions.is_empty() {
        text += "no stable regions: a shape without parts (a ball) has none; else try --min-volume 0.005, \
                 --window 0.1 or other --time-scale\n";
    }
    text
}

/// That left and right can't be told, where they can't.
fn left_and_right_of_bodies(features: &Features) -> String {
    let several = features.bodies.len() > 1;
    let mut text = String::new();
    for (number, body) in features.bodies.iter().enumerate() {
        if let (Sidedness::Alike { .. }, Some(told)) = (body.sidedness, left_and_right(body.sidedness)) {
            let of_body = if several { format!("body {number}: ") } else { String::new() };
            text += &format!("{of_body}left and right {told}\n");
        }
    }
    text
}

/// The parts; nothing where none were asked for.
fn parts(features: &Features) -> String {
    let (Some(found), Some(wanted)) = (&features.partition, &features.parameters.parts) else {
        return String::new();
    };
    let elements = elements(features);
    let mut text = format!("\npart  region  measure %  {elements:>8}  twins  centroid\n");
    for (id, part) in found.parts.iter().enumerate() {
        let region = match (part.trunk, part.region) {
            (true, _) => "trunk".to_owned(),
            (false, Some(region)) => region.to_string(),
            (false, None) => "-".to_owned(),
        };
        let twins: Vec<String> = part.twins.iter().map(ToString::to_string).collect();
        let twins = if twins.is_empty() { "-".to_owned() } else { twins.join(",") };
        let [x, y, z] = part.centroid;
        text += &format!(
            "{id:>4}  {region:>6}  {:>9.2}  {:>8}  {twins:>5}  ({x:.4}, {y:.4}, {z:.4})\n",
            100.0 * part.volume_fraction,
            part.elements.len(),
        );
    }
    for body in 0..features.bodies.len() {
        let count = found.parts.iter().filter(|part| part.body == body).count();
        let of_body = if features.bodies.len() > 1 { format!("body {body}: ") } else { String::new() };
        text += &match wanted.count {
            PartCount::Count(wanted) if count < wanted => format!(
                "{of_body}{count} of {wanted} parts: mirror images come together, and nothing else hangs by a narrow place\n"
            ),
            _ if count == 1 => format!("{of_body}1 part: no limbs\n"),
            _ => format!("{of_body}{count} parts\n"),
        };
    }
    text
}

//! Landmarks as 3D Slicer reads them: markups in JSON
//! (<https://slicer.readthedocs.io/en/latest/developer_guide/modules/markups.html>).

use std::path::Path;

use mser3d_fileio::write_text;
use mser3d_volumeio::WorldAxes;
use serde_json::{Value, json};

use crate::{Record, ResultsError};

const SCHEMA: &str = "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/\
                      markups-schema-v1.0.3.json#";

/// Writes two lists of points: the regions' centres of mass, and their tips.
///
/// In LPS, as Slicer has it: x to the left, y to the back, z up. Places of a world that is RAS+ are turned; others, such as those
/// of a mesh or a NumPy array, stay as they are, which is how Slicer reads meshes.
///
/// `records` are results, each with a prefix for the names of its points.
///
/// # Errors
/// [`ResultsError::File`], naming the file.
pub fn write_landmarks(path: &Path, records: &[(String, &Record)]) -> Result<(), ResultsError> {
    let lists = [("centres", "centre"), ("tips", "tip")];
    let lists = lists.map(|(name, what)| list(name, what, records));
    let unit = records.first().and_then(|r| r.1.input.volume.as_ref()?.world.unit.clone());
    let mut lists = lists.to_vec();
    if let Some(unit) = unit {
        lists.iter_mut().for_each(|list| list["coordinateUnits"] = json!(unit));
    }
    let text = serde_json::to_string_pretty(&json!({ "@schema": SCHEMA, "markups": lists }));
    let text = text.map_err(|error| ResultsError::Io { path: path.to_owned(), error: error.into() })?;
    Ok(write_text(path, &(text + "\n"))?)
}

fn list(name: &str, what: &str, records: &[(String, &Record)]) -> Value {
    let mut points = Vec::new();
    for (prefix, record) in records {
        let ras = record.input.volume.as_ref().is_some_and(|v| v.world.axes == WorldAxes::Ras);
        for region in &record.regions {
            let [x, y, z] = if what == "tip" { region.tip } else { region.centroid };
            let place = if ras { [-x, -y, z] } else { [x, y, z] };
            points.push(json!({
                "id": (points.len() + 1).to_string(),
                "label": format!("{prefix}{}", region.id),
                "description": format!("{what} of region {}", region.id),
                "associatedNodeID": "",
                "position": place,
                "orientation": [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
                "selected": true,
                "locked": false,
                "visibility": true,
                "positionStatus": "defined",
            }));
        }
    }
    json!({
        "type": "Fiducial",
        "coordinateSystem": "LPS",
        "coordinateUnits": "mm",
        "locked": false,
        "fixedNumberOfControlPoints": false,
        "labelFormat": format!("{name}-%d"),
        "lastUsedControlPointNumber": points.len(),
        "controlPoints": points,
        "measurements": [],
    })
}

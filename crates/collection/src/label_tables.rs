//! Tables of label maps: every label and every region with its place, size and box.

use std::path::Path;

use mser3d_fileio::write_text;
use mser3d_results::{
    BodyRecord, Checksums, Extra, LabelMap, OrientedBox, Record, Results, sidedness_certainty,
    sidedness_kind, write_landmarks,
};

use crate::folder::result_names;
use crate::job::SkippedLabel;
use crate::{CollectionError, Failure};

/// What the tables of a collection call `labels.csv` and `regions.csv`.
pub(crate) const LABELS: &str = "labels.csv";
pub(crate) const REGIONS: &str = "regions.csv";

/// Writes `labels.csv` and `regions.csv` of the results that are labels of label maps, if there are any.
pub(crate) fn write(
    folder: &Path,
    records: &[(String, Record)],
    failures: &[Failure],
    skipped: &[SkippedLabel],
) -> Result<(), CollectionError> {
    let labelled: Vec<(&str, &Record, &BodyRecord)> =
        records.iter().filter_map(|(name, record)| Some((name.as_str(), record, body(record)?))).collect();
    let failed: Vec<&Failure> = failures.iter().filter(|f| f.label.is_some()).collect();
    if labelled.is_empty() && failed.is_empty() && skipped.is_empty() {
        return Ok(());
    }
    let mut labels = Csv::new(
        "path,volume_number,label,name,status,shape,voxels,volume,x,y,z,components,searched_volume,regions,sidedness,\
         sidedness_certainty,problem",
    );
    for (name, record, body) in &labelled {
        let searched = record.measure().unwrap_or(body.volume);
        let sidedness = record.bodies.first().map(|body| body.sidedness);
        labels.row([
            text(&record.input.path),
            body.volume_number.to_string(),
            optional(body.label),
            text(body.name.as_deref().unwrap_or_default()),
            "searched".to_owned(),
            text(name),
            body.voxels.to_string(),
            body.volume.to_string(),
            triple(body.centroid),
            body.components.to_string(),
            searched.to_string(),
            record.regions.len().to_string(),
            sidedness.map_or(String::new(), |s| sidedness_kind(s).to_owned()),
            optional(sidedness.and_then(sidedness_certainty)),
            text(&record.warnings.join("; ")),
        ]);
    }
    for failure in failed {
        let label = optional(failure.label);
        let [path, shape, error] = [&failure.path, &failure.name, &failure.error].map(|t| text(t));
        labels.line(&format!("{path},,{label},,failed,{shape},,,,,,,,,,,{error}"));
    }
    for SkippedLabel { path, volume, label, name, voxels } in skipped {
        let (path, name) = (text(path), text(name.as_deref().unwrap_or_default()));
        labels.line(&format!("{path},{volume},{label},{name},too small,,{voxels},,,,,,,0,,,"));
    }
    write_text(&folder.join(LABELS), &labels.0)?;

    let mut regions = Csv::new(
        "map_value,path,volume_number,label,name,shape,region,parent,reliability,twin,side,voxels,volume,\
         volume_fraction,x,y,z,tip_x,tip_y,tip_z,box_x,box_y,box_z,box_size_1,box_size_2,box_size_3,axis_1_x,axis_1_y,axis_1_z,axis_2_x,axis_2_y,axis_2_z,\
         axis_3_x,axis_3_y,axis_3_z",
    );
    let mut map_value = 0;
    for (name, record, body) in &labelled {
        for region in &record.regions {
            map_value += 1;
            let OrientedBox { centre, size, axes } = region.oriented_box;
            regions.row([
                map_value.to_string(),
                text(&record.input.path),
                body.volume_number.to_string(),
                optional(body.label),
                text(body.name.as_deref().unwrap_or_default()),
                text(name),
                region.id.to_string(),
                optional(region.parent),
                optional(region.reliability),
                optional(region.twin),
                optional(region.side),
                optional(region.voxels),
                region.volume.to_string(),
                region.volume_fraction.to_string(),
                triple(region.centroid),
                triple(region.tip),
                triple(centre),
                triple(size),
                triple(axes[0]),
                triple(axes[1]),
                triple(axes[2]),
            ]);
        }
    }
    Ok(write_text(&folder.join(REGIONS), &regions.0)?)
}

/// Writes the regions of all labels of one label map to one: `regions.nii.gz`, numbered as `map_value` in `regions.csv`, and
/// `landmarks.mrk.json`. Returns how many voxels belong to regions of several labels, of which the last stays.
///
/// # Errors
/// [`CollectionError::Results`], also where the results are not on one grid.
pub fn write_label_map(folder: &Path, shapes: &[String]) -> Result<usize, CollectionError> {
    let mut results = Vec::new();
    let mut first = 0;
    // Numbered as in the table, which has all labels of the collection, those of earlier runs too.
    for name in result_names(folder)? {
        let record = match Record::load(&folder.join(&name)) {
            Ok(record) if body(&record).is_some() => record,
            _ => continue,
        };
        if shapes.contains(&name) {
            results.push((Results::load(&folder.join(&name))?, first, name));
        }
        first += record.regions.len() as u32;
    }
    let numbered: Vec<(&Results, u32)> = results.iter().map(|(r, first, _)| (r, *first)).collect();
    let map = LabelMap::new(&numbered)?;
    let files = [Extra::Nifti, Extra::Landmarks].map(Extra::file_name);
    map.write(&folder.join(files[0]))?;
    let records: Vec<(String, &Record)> =
        results.iter().map(|(r, _, name)| (format!("{name}-"), &r.record)).collect();
    write_landmarks(&folder.join(files[1]), &records)?;
    Checksums::add(folder, &files)?;
    Ok(map.contested)
}

/// The body of a result that is a label.
fn body(record: &Record) -> Option<&BodyRecord> {
    record.input.volume.as_ref()?.body.as_ref().filter(|body| body.label.is_some())
}

/// Comma-separated values, as RFC 4180 has them but for the line ends.
struct Csv(String);

impl Csv {
    fn new(header: &str) -> Self {
        Self(format!("{header}\n"))
    }

    fn line(&mut self, line: &str) {
        self.0.push_str(line);
        self.0.push('\n');
    }

    fn row<const N: usize>(&mut self, fields: [String; N]) {
        self.line(&fields.join(","));
    }
}

fn text(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

fn optional(value: Option<impl ToString>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

fn triple([x, y, z]: [f64; 3]) -> String {
    format!("{x},{y},{z}")
}

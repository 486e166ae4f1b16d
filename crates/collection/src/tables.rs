use std::path::Path;

use mser3d::spectral::EigenpairRange;
use mser3d_fileio::{InputFile, NpyValues, read_npz, write_text};
use mser3d_results::{Checksums, Record, ResultsError, sidedness_certainty, sidedness_kind};
use serde::Serialize;

use crate::failure::FAILURE;
use crate::folder::{CollectionFolder, TABLES, result_names};
use crate::job::SkippedLabel;
use crate::label_tables;
use crate::parquet::{self, Column};
use crate::{CollectionError, DescriptorSettings, Failure};

/// What the tables of a collection were made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Tables {
    /// Shapes with a result: rows of `shapes.parquet`.
    pub shapes: usize,
    /// Their regions: rows of `regions.parquet`.
    pub regions: usize,
    /// Shapes that failed: entries of `failures.json`.
    pub failures: usize,
}

/// The names of the tables.
pub(crate) const REGIONS_TABLE: &str = "regions.parquet";
pub(crate) const SHAPES_TABLE: &str = "shapes.parquet";

/// The key under which `regions.parquet` notes how its descriptors were made.
pub(crate) const SETTINGS: &str = "mser3d.descriptor_settings";

/// Makes `shapes.parquet`, `regions.parquet` and `failures.json` of all results in a folder, by name: the
/// last step of a batch that was run in shards. The same results make the same bytes. A shape that failed and has a result of an
/// earlier run is in `failures.json`, and in the tables only if its descriptors compare with those of the others.
///
/// | `shapes.parquet` | |
/// |---|---|
/// | `shape` | name, the result's folder |
/// | `path`, `sha256`, `animation`, `time` | the input |
/// | `label`, `label_name` | the label of a label map, if it is one |
/// | `domain`, `version` | volume or surface; that of mser3d |
/// | `vertices`, `voxels`, `pitch` | of the mesh and the grid; none for a surface |
/// | `measure` | volume or area |
/// | `regions`, `warnings` | how many |
/// | `sidedness`, `sidedness_certainty` | whether left and right of the largest body can be told |
///
/// | `regions.parquet` | |
/// |---|---|
/// | `shape`, `region` | name and number: a region's key |
/// | `parent`, `tree`, `altitude`, `stability`, `reliability`, `twin`, `side`, `volume`, `volume_fraction`, `voxels`, `vertices`, `x`, `y`, `z` | as in `regions.json`; x, y, z is the centroid |
/// | `descriptor` | a list of numbers; NaN where a shape is so small that it has fewer eigenpairs than the others |
///
/// # Errors
/// [`CollectionError::NotACollection`] for a folder without results,
/// [`CollectionError::DifferentDescriptors`] when the results do not belong together,
/// [`CollectionError::Busy`], and errors of reading and writing.
pub fn build_tables(folder: &Path) -> Result<Tables, CollectionError> {
    if !folder.is_dir() {
        let problem = "there is no such folder; give that of a batch".to_owned();
        return Err(CollectionError::NotACollection { folder: folder.to_owned(), problem });
    }
    build(&CollectionFolder::open(folder, None)?, &[])
}

pub(crate) fn build(folder: &CollectionFolder, skipped: &[SkippedLabel]) -> Result<Tables, CollectionError> {
    let root = folder.path();
    folder.remove_tables()?;
    let names = result_names(root)?;
    let (mut found, mut failures) = (Vec::new(), Vec::new());
    for name in names {
        let result = folder.result(&name);
        let failure = result.join(FAILURE);
        let failed = match InputFile::read_all(&failure) {
            Ok(text) => {
                let broken =
                    |e: serde_json::Error| ResultsError::Broken { path: failure, reason: e.to_string() };
                failures.push(serde_json::from_slice::<Failure>(&text).map_err(broken)?);
                true
            }
            Err(_) => false,
        };
        match Record::load(&result) {
            Ok(record) => found.push(Found { name, record, failed }),
            // What is of an earlier run, and cannot be read, has failed anyhow.
            Err(_) if failed => {}
            Err(ResultsError::NotAResult { .. }) => {}
            Err(error) => return Err(error.into()),
        }
    }
    // The descriptors of a shape with fewer eigenpairs than the others compare with none of theirs.
    let all_small = found.iter().all(|shape| has_few_eigenpairs(&shape.record));
    let is_small = |shape: &Found| has_few_eigenpairs(&shape.record) && !all_small;
    // Results that an earlier run left where this one failed come in only if they compare with the others.
    let compared = found.iter().filter(|shape| !is_small(shape));
    let first = compared.clone().find(|shape| !shape.failed).or(compared.clone().next());
    let settings = first.map(|shape| (shape.name.clone(), DescriptorSettings::of(&shape.record)));
    let mut rows = Rows::default();
    let mut records = Vec::new();
    for shape in found {
        let small = is_small(&shape);
        let Found { name, record, failed } = shape;
        let result = folder.result(&name);
        let own = DescriptorSettings::of(&record);
        let difference = settings.as_ref().filter(|_| !small).and_then(|(_, known)| known.difference(&own));
        match (difference, &settings) {
            (Some(_), _) if failed => continue,
            (Some(what), Some((first, _))) => {
                let first = folder.result(first);
                return Err(CollectionError::DifferentDescriptors { first, second: result, what });
            }
            _ => {}
        }
        let mut values = match descriptors(&result, record.regions.len()) {
            Err(_) if failed => continue,
            values => values?,
        };
        if small {
            values.fill(f64::NAN);
        }
        rows.push(name.clone(), &record, values);
        records.push((name, record));
    }
    let tables = Tables { shapes: rows.shape.len(), regions: rows.of_shape.len(), failures: failures.len() };
    if tables.shapes + tables.failures == 0 {
        let problem = "there are no results in this folder; run `mser3d batch` first".to_owned();
        return Err(CollectionError::NotACollection { folder: root.to_owned(), problem });
    }
    let path = root.join("failures.json");
    let json = serde_json::to_string_pretty(&failures).map_err(|e| CollectionError::io(&path)(e.into()))?;
    write_text(&path, &(json + "\n"))?;
    let settings = settings.map_or(String::new(), |(_, s)| serde_json::to_string(&s).unwrap_or_default());
    rows.write(root, settings)?;
    label_tables::write(root, &records, &failures, skipped)?;
    let written: Vec<&str> = TABLES.into_iter().filter(|name| root.join(name).is_file()).collect();
    Checksums::add(root, &written)?;
    Ok(tables)
}

/// A result in the folder, and whether the last run of its shape failed.
struct Found {
    name: String,
    record: Record,
    failed: bool,
}

/// Whether a shape is so small that it has fewer eigenpairs than are used by default.
fn has_few_eigenpairs(record: &Record) -> bool {
    match record.parameters.spectrum.eigenpairs {
        EigenpairRange::AtMost(wanted) => record.bodies.iter().any(|b| b.spectrum.eigenpairs < wanted),
        _ => false,
    }
}

/// The descriptors of a result's regions, row by row.
fn descriptors(result: &Path, regions: usize) -> Result<Vec<f64>, CollectionError> {
    let name = "features.npz";
    Checksums::load(result)?.check(result, name)?;
    let path = result.join(name);
    let arrays = read_npz(&path)?;
    match arrays.get("region_descriptor").map(|a| (a.shape(), a.values())) {
        Some((&[rows, width], NpyValues::F64(values))) if rows == regions && (width > 0 || rows == 0) => {
            match values.iter().all(|x| x.is_finite()) {
                true => Ok(values.to_vec()),
                false => {
                    let reason = "array region_descriptor holds a value that is not finite".to_owned();
                    Err(ResultsError::Broken { path, reason }.into())
                }
            }
        }
        _ => {
            let reason = format!("there is no array region_descriptor of {regions} rows");
            Err(ResultsError::Broken { path, reason }.into())
        }
    }
}

/// The columns of both tables.
#[derive(Default)]
struct Rows {
    shape: Vec<String>,
    path: Vec<String>,
    sha256: Vec<String>,
    animation: Vec<Option<String>>,
    time: Vec<f64>,
    label: Vec<Option<i32>>,
    label_name: Vec<Option<String>>,
    domain: Vec<String>,
    version: Vec<String>,
    vertices: Vec<Option<i32>>,
    voxels: Vec<Option<i32>>,
    pitch: Vec<Option<f64>>,
    measure: Vec<Option<f64>>,
    regions: Vec<i32>,
    warnings: Vec<i32>,
    sidedness: Vec<Option<String>>,
    sidedness_certainty: Vec<Option<f64>>,

    of_shape: Vec<String>,
    region: Vec<i32>,
    parent: Vec<Option<i32>>,
    tree: Vec<i32>,
    altitude: Vec<f64>,
    stability: Vec<Option<f64>>,
    reliability: Vec<Option<f64>>,
    twin: Vec<Option<i32>>,
    side: Vec<Option<f64>>,
    volume: Vec<f64>,
    volume_fraction: Vec<f64>,
    region_voxels: Vec<Option<i32>>,
    region_vertices: Vec<i32>,
    centroid: [Vec<f64>; 3],
    descriptor: Vec<f64>,
}

impl Rows {
    fn push(&mut self, name: String, record: &Record, descriptors: Vec<f64>) {
        let count = |n: usize| i32::try_from(n).ok();
        let (input, grid) = (&record.input, record.voxelization.as_ref());
        self.path.push(input.path.clone());
        self.sha256.push(input.sha256.clone().unwrap_or_default());
        self.animation.push(input.animation.clone());
        self.time.push(input.time);
        let body = input.volume.as_ref().and_then(|volume| volume.body.as_ref());
        self.label.push(body.and_then(|b| b.label).and_then(|label| i32::try_from(label).ok()));
        self.label_name.push(body.and_then(|b| b.name.clone()));
        self.domain.push(record.domain.to_string());
        self.version.push(record.mser3d.clone());
        self.vertices.push(input.diagnosis.as_ref().and_then(|d| count(d.vertices)));
        self.voxels.push(grid.and_then(|g| count(g.voxels)));
        self.pitch.push(grid.map(|g| g.spacing[0]));
        self.measure.push(record.measure());
        self.regions.push(record.regions.len() as i32);
        self.warnings.push(record.warnings.len() as i32);
        let sidedness = record.bodies.first().map(|body| body.sidedness);
        self.sidedness.push(sidedness.map(|s| sidedness_kind(s).to_owned()));
        self.sidedness_certainty.push(sidedness.and_then(sidedness_certainty));
        for region in &record.regions {
            self.of_shape.push(name.clone());
            self.region.push(region.id as i32);
            self.parent.push(region.parent.map(|p| p as i32));
            self.tree.push(region.tree as i32);
            self.altitude.push(region.altitude);
            self.stability.push(Some(region.stability).filter(|s| s.is_finite()));
            self.reliability.push(region.reliability);
            self.twin.push(region.twin.map(|twin| twin as i32));
            self.side.push(region.side);
            self.volume.push(region.volume);
            self.volume_fraction.push(region.volume_fraction);
            self.region_voxels.push(region.voxels.and_then(|n| i32::try_from(n).ok()));
            self.region_vertices.push(region.vertices as i32);
            (0..3).for_each(|a| self.centroid[a].push(region.centroid[a]));
        }
        self.descriptor.extend(descriptors);
        self.shape.push(name);
    }

    fn write(self, root: &Path, settings: String) -> Result<(), CollectionError> {
        let width = self.descriptor.len().checked_div(self.of_shape.len()).unwrap_or(1);
        let [x, y, z] = self.centroid;
        let regions = [
            ("shape", Column::Text(self.of_shape)),
            ("region", Column::Integer(self.region)),
            ("parent", Column::OptionalInteger(self.parent)),
            ("tree", Column::Integer(self.tree)),
            ("altitude", Column::Number(self.altitude)),
            ("stability", Column::OptionalNumber(self.stability)),
            ("reliability", Column::OptionalNumber(self.reliability)),
            ("twin", Column::OptionalInteger(self.twin)),
            ("side", Column::OptionalNumber(self.side)),
            ("volume", Column::Number(self.volume)),
            ("volume_fraction", Column::Number(self.volume_fraction)),
            ("voxels", Column::OptionalInteger(self.region_voxels)),
            ("vertices", Column::Integer(self.region_vertices)),
            ("x", Column::Number(x)),
            ("y", Column::Number(y)),
            ("z", Column::Number(z)),
            ("descriptor", Column::Numbers { width, values: self.descriptor }),
        ];
        parquet::write(&root.join(REGIONS_TABLE), &regions, &[(SETTINGS, settings)])?;
        let shapes = [
            ("shape", Column::Text(self.shape)),
            ("path", Column::Text(self.path)),
            ("sha256", Column::Text(self.sha256)),
            ("animation", Column::OptionalText(self.animation)),
            ("time", Column::Number(self.time)),
            ("label", Column::OptionalInteger(self.label)),
            ("label_name", Column::OptionalText(self.label_name)),
            ("domain", Column::Text(self.domain)),
            ("version", Column::Text(self.version)),
            ("vertices", Column::OptionalInteger(self.vertices)),
            ("voxels", Column::OptionalInteger(self.voxels)),
            ("pitch", Column::OptionalNumber(self.pitch)),
            ("measure", Column::OptionalNumber(self.measure)),
            ("regions", Column::Integer(self.regions)),
            ("warnings", Column::Integer(self.warnings)),
            ("sidedness", Column::OptionalText(self.sidedness)),
            ("sidedness_certainty", Column::OptionalNumber(self.sidedness_certainty)),
        ];
        parquet::write(&root.join(SHAPES_TABLE), &shapes, &[])
    }
}

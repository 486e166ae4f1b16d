mod voxelization;

use std::path::Path;

use mser3d::comptree::{Polarity, SelectionReport};
use mser3d::descriptors::TimeScale;
use mser3d::spectral::SpectrumReport;
use mser3d::voxelize::Diagnosis;
use mser3d::{Body, Features, Parameters, Part, RunReport, Sidedness};
use mser3d_fileio::file_stem;
use mser3d_shape::vector::scale;
use mser3d_shape::{Affine, Domain, VoxelGrid};
use serde::{Deserialize, Serialize};

pub use voxelization::VoxelizationRecord;

use crate::{FieldRecord, OrientedBox, VolumeRecord};

/// The layout of `regions.json` and `features.npz` that this version writes and reads.
pub const FORMAT: u32 = 4;

/// What `regions.json` says: what was read, how it was treated, and what was found. Its JSON Schema is
/// `docs/regions.schema.json`.
///
/// This type is the file's one author: whoever writes or reads it does so through this type.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Record {
    /// The version of mser3d that found the regions.
    pub mser3d: String,
    /// The layout of the folder: [`FORMAT`]. Programs refuse others.
    pub format: u32,
    /// What was read.
    pub input: InputRecord,
    /// What heat flowed on.
    pub domain: Domain,
    /// Every parameter that the result depends on.
    pub parameters: Parameters,
    /// The file that the weight came from; none where it came from none.
    pub field: Option<FieldRecord>,
    /// The grid of the voxels; none for surfaces.
    pub grid: Option<GridRecord>,
    /// How the mesh became voxels; none for surfaces and masks.
    pub voxelization: Option<VoxelizationRecord>,
    /// The eigenpairs of the largest body, and how good they are.
    pub spectrum: SpectrumRecord,
    /// The bodies that were searched each on its own, by descending measure. Mostly one: the whole shape.
    pub bodies: Vec<SearchedBodyRecord>,
    /// The component trees, one per time scale, body by body.
    pub trees: Vec<TreeRecord>,
    /// Regions dropped because another tree had them too.
    pub duplicates: usize,
    /// What the user should know of the input and how it was read.
    pub warnings: Vec<String>,
    /// The regions, by descending volume.
    pub regions: Vec<RegionRecord>,
    /// The parts of all bodies, by descending volume; none where they were not asked for.
    pub parts: Option<Vec<PartRecord>>,
    /// What differs from run to run.
    pub run: RunReport,
}

/// What was read. Of shapes that did not come from a file, only `path` is known: whatever names them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct InputRecord {
    /// The file.
    pub path: String,
    /// SHA-256 of the file.
    pub sha256: Option<String>,
    /// SHA-256 of the mesh's vertices and triangles as they were read: what buffers beside a glTF file and animations
    /// make of it.
    pub mesh_sha256: Option<String>,
    /// Size of the file.
    pub bytes: Option<u64>,
    /// Format of the file.
    pub format: Option<String>,
    /// The glTF animation that posed it.
    pub animation: Option<String>,
    /// When in the animation, in seconds.
    pub time: f64,
    /// The volume that the body was taken from; none for a mesh.
    pub volume: Option<VolumeRecord>,
    /// What the mesh is like; none for a volume.
    pub diagnosis: Option<Diagnosis>,
}

/// Where the voxels lie.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GridRecord {
    /// Voxels along the axes of the grid: those of the file, where the solid was read from a volume.
    pub dims: [usize; 3],
    /// Index to world, 4 x 4: the centre of voxel (i, j, k) is `affine (i, j, k, 1)`.
    pub affine: Affine,
}

impl InputRecord {
    /// An input of which only a name is known.
    pub fn named(path: impl Into<String>) -> Self {
        Self { path: path.into(), ..Self::default() }
    }
}

/// The eigenpairs, and how good they are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct SpectrumRecord {
    /// Eigenpairs that were used.
    pub eigenpairs: usize,
    /// The largest eigenvalue, in length^-2.
    pub largest_eigenvalue: Option<f64>,
    /// How they were found.
    #[serde(flatten)]
    pub report: SpectrumReport,
}

/// A body that was searched on its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct SearchedBodyRecord {
    /// Its voxels, or vertices of a surface.
    pub elements: usize,
    /// Its volume in length^3, or area in length^2.
    pub measure: f64,
    /// Its eigenpairs.
    pub spectrum: SpectrumRecord,
    /// Whether it has a left and a right.
    #[serde(default)]
    pub sidedness: Sidedness,
}

/// A component tree; its nodes are in `features.npz`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct TreeRecord {
    /// The body that it is of.
    pub body: u32,
    /// Its time scale; none for a weight without time, such as the commute time.
    pub time_scale: Option<TimeScale>,
    /// The time in length^2; none for a weight without time.
    pub time: Option<f64>,
    /// Which way it grows.
    pub polarity: Polarity,
    /// How many regions each filter cut.
    #[serde(flatten)]
    pub selection: SelectionReport,
}

/// A region.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct RegionRecord {
    /// Its place in the list.
    pub id: u32,
    /// The smallest region that contains it.
    pub parent: Option<u32>,
    /// The body it is a part of.
    pub body: u32,
    /// The tree it was found in.
    pub tree: u32,
    /// The weight at which it is complete: of the heat kernel in length^-3 in a volume, length^-2 on a surface.
    pub altitude: f64,
    /// vol(l) / (d vol / d l), where l is the altitude, by default its logarithm, or its multiple of the weight's spread (eq. 5): see [`mser3d::Region::stability`]. In JSON `"Infinity"`
    /// where the volume does not change, null where none was measured (NaN).
    #[serde(with = "stability")]
    #[cfg_attr(feature = "schema", schemars(with = "stability::Stability"))]
    pub stability: f64,
    /// How surely it is found again when the body moves, 0 to 1: see [`mser3d::Region::reliability`]. None where it was not
    /// measured.
    pub reliability: Option<f64>,
    /// How long it lasts before the real merge that ends it, in altitude (as for stability); none where no merge does.
    pub lifetime: Option<f64>,
    /// Its mirror image on the same body; none in the middle, where it was not found, and where more than two are alike.
    pub twin: Option<u32>,
    /// On which side of its body it is, from -1 to 1, near 0 in the middle: see [`mser3d::Region::side`]. None where the body
    /// has no sides.
    pub side: Option<f64>,
    /// Volume in length^3, or area in length^2.
    pub volume: f64,
    /// Volume over that of its body: of the whole shape, unless bodies are searched each on its own.
    pub volume_fraction: f64,
    /// Number of voxels; none for a surface.
    pub voxels: Option<usize>,
    /// Number of the mesh's vertices.
    pub vertices: usize,
    /// Centre of mass.
    pub centroid: [f64; 3],
    /// Where it begins: the place with the extreme weight, of heat weights the end of a limb.
    pub tip: [f64; 3],
    /// The smallest box around it along its principal axes.
    pub oriented_box: OrientedBox,
    /// Its identity in a sequence, the id of a track of `tracks.json`; not written where it is of none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub track: Option<u32>,
    /// Its colour in all pictures, red, green and blue from 0 to 255: that of its track. Not written where pictures choose.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour: Option<[u8; 3]>,
}

/// A part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct PartRecord {
    /// Its place in the list.
    pub id: u32,
    /// The body that it is a part of.
    pub body: u32,
    /// Whether it is what the other parts of its body leave.
    pub trunk: bool,
    /// The region that is most like what it grew from; none for the trunk.
    pub region: Option<u32>,
    /// The parts that are its mirror images, or equal to it.
    pub twins: Vec<u32>,
    /// Volume in length^3, or area in length^2.
    pub volume: f64,
    /// Volume over that of its body: of the whole shape, unless bodies are searched each on its own.
    pub volume_fraction: f64,
    /// Number of voxels; none for a surface.
    pub voxels: Option<usize>,
    /// Number of the mesh's vertices.
    pub vertices: usize,
    /// Centre of mass.
    pub centroid: [f64; 3],
    /// The smallest box around it along its principal axes.
    pub oriented_box: OrientedBox,
}

impl SearchedBodyRecord {
    fn new(body: &Body) -> Self {
        let spectrum = SpectrumRecord {
            eigenpairs: body.basis.eigenvalues().len(),
            largest_eigenvalue: body.basis.eigenvalues().last().copied(),
            report: body.spectrum,
        };
        let sidedness = body.sidedness;
        Self { elements: body.elements.len(), measure: body.measure(), spectrum, sidedness }
    }
}

impl Record {
    /// The record of what was found on an input. `notes` are what reading it said, before the features' own warnings.
    pub fn new(features: &Features, input: InputRecord, notes: &[String]) -> Self {
        let grid = features.shape.grid().map(VoxelGrid::frame);
        let half_edges = grid.map_or([[0.0; 3]; 3], |frame| frame.affine().steps().map(|s| scale(s, 0.5)));
        let positions = features.shape.positions();
        let mass = features.measures();
        let bodies: Vec<SearchedBodyRecord> = features.bodies.iter().map(SearchedBodyRecord::new).collect();
        let volume = grid.is_some();
        let regions = (0..).zip(&features.regions).map(|(id, r)| RegionRecord {
            id,
            parent: r.parent.map(|p| p as u32),
            body: r.body as u32,
            tree: r.tree as u32,
            altitude: r.altitude,
            stability: r.stability,
            reliability: r.reliability,
            lifetime: r.merge.map(|merge| merge.lifetime),
            twin: r.twin.map(|t| t as u32),
            side: r.side,
            volume: r.volume,
            volume_fraction: r.volume_fraction,
            voxels: volume.then_some(r.elements.len()),
            vertices: r.vertices.len(),
            centroid: r.centroid,
            tip: positions.at(r.tip),
            oriented_box: OrientedBox::around(&r.elements, positions, &mass, half_edges),
            track: None,
            colour: None,
        });
        let part = |(id, p): (u32, &Part)| PartRecord {
            id,
            body: p.body as u32,
            trunk: p.trunk,
            region: p.region.map(|region| region as u32),
            twins: p.twins.iter().map(|&twin| twin as u32).collect(),
            volume: p.volume,
            volume_fraction: p.volume_fraction,
            voxels: volume.then_some(p.elements.len()),
            vertices: p.vertices.len(),
            centroid: p.centroid,
            oriented_box: OrientedBox::around(&p.elements, positions, &mass, half_edges),
        };
        let parts = features.partition.as_ref().map(|found| (0..).zip(&found.parts).map(part).collect());
        let trees = features.trees.iter().map(|t| TreeRecord {
            body: t.body as u32,
            time_scale: t.time_scale,
            time: t.time,
            polarity: t.polarity,
            selection: t.selection.report,
        });
        let warnings = features.warnings.iter().map(ToString::to_string);
        // As the file has it, to the last bit.
        let affine = input.volume.as_ref().map(|volume| volume.affine);
        Self {
            mser3d: env!("CARGO_PKG_VERSION").to_owned(),
            format: FORMAT,
            input,
            domain: features.shape.domain(),
            grid: grid
                .map(|frame| GridRecord { dims: frame.dims(), affine: affine.unwrap_or(frame.affine()) }),
            parameters: features.parameters.clone(),
            field: None,
            voxelization: features.voxelization.as_ref().map(VoxelizationRecord::from),
            spectrum: bodies[0].spectrum.clone(),
            bodies,
            trees: trees.collect(),
            duplicates: features.duplicates,
            warnings: notes.iter().cloned().chain(warnings).collect(),
            regions: regions.collect(),
            parts,
            run: features.run.clone(),
        }
    }

    /// As `regions.json` has it, with a line end.
    ///
    /// # Errors
    /// Only in theory: every field has a form in JSON.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(self).map(|text| text + "\n")
    }

    /// The volume or area of all bodies that were searched.
    pub fn measure(&self) -> Option<f64> {
        (!self.bodies.is_empty()).then(|| self.bodies.iter().map(|body| body.measure).sum())
    }

    /// Whether a detection of this input with these parameters would find the same: same version, same bytes read, same
    /// pose, same parameters.
    pub fn is_of(&self, input: &InputRecord, domain: Domain, parameters: &Parameters) -> bool {
        let pose = |i: &InputRecord| {
            (i.sha256.clone(), i.mesh_sha256.clone(), i.animation.clone(), i.time.to_bits(), i.volume.clone())
        };
        let parameters = Parameters { polarity: Some(parameters.polarity()), ..parameters.clone() };
        self.mser3d == env!("CARGO_PKG_VERSION")
            && self.format == FORMAT
            && self.domain == domain
            && input.sha256.is_some()
            && pose(&self.input) == pose(input)
            && self.parameters.without_limits() == parameters.without_limits()
    }

    /// The input's file name, without folder and ending, and the label that was chosen.
    pub fn name(&self) -> String {
        let stem = file_stem(Path::new(&self.input.path));
        let stem = if stem.is_empty() { "shape".to_owned() } else { stem };
        let body = self.input.volume.as_ref().and_then(|volume| volume.body.as_ref());
        match body.map(|body| (body.label, &body.name)) {
            Some((Some(_), Some(name))) => format!("{stem}, {name}"),
            Some((Some(label), None)) => format!("{stem}, label {label}"),
            _ => stem,
        }
    }
}

/// JSON has neither infinity nor NaN.
mod stability {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Serialize, Deserialize)]
    #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
    #[serde(untagged)]
    pub enum Stability {
        Number(f64),
        Infinite(Infinite),
        Unknown,
    }

    #[derive(Serialize, Deserialize)]
    #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
    pub enum Infinite {
        Infinity,
    }

    pub fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
        match value {
            v if v.is_finite() => Stability::Number(*v),
            v if v.is_nan() => Stability::Unknown,
            _ => Stability::Infinite(Infinite::Infinity),
        }
        .serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(match Stability::deserialize(from)? {
            Stability::Number(v) => v,
            Stability::Infinite(Infinite::Infinity) => f64::INFINITY,
            Stability::Unknown => f64::NAN,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stability_and_time_scale_survive_json() {
        let region = RegionRecord {
            id: 3,
            parent: None,
            body: 0,
            tree: 0,
            altitude: 0.5,
            stability: 2.5,
            reliability: Some(0.75),
            lifetime: Some(0.5),
            twin: None,
            side: None,
            volume: 1.0,
            volume_fraction: 0.1,
            voxels: None,
            vertices: 4,
            centroid: [0.1, 0.2, 0.3],
            tip: [0.0; 3],
            oriented_box: OrientedBox::default(),
            track: None,
            colour: None,
        };
        for stability in [2.5, f64::INFINITY, f64::NAN] {
            let text = serde_json::to_string(&RegionRecord { stability, ..region.clone() }).unwrap();
            let back: RegionRecord = serde_json::from_str(&text).unwrap();
            assert_eq!(back.stability.to_bits(), stability.to_bits(), "{text}");
        }
        for time_scale in [TimeScale::Relative(0.5), TimeScale::Absolute(9.0)] {
            let text = serde_json::to_string(&time_scale).unwrap();
            assert_eq!(serde_json::from_str::<TimeScale>(&text).unwrap(), time_scale, "{text}");
        }
        assert_eq!(serde_json::to_string(&TimeScale::Relative(0.5)).unwrap(), r#"{"relative":0.5}"#);
    }
}

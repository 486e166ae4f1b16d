use std::path::Path;

use mser3d::{Estimate, Parameters};
use mser3d_meshio::{AnimationInfo, list_animations};
use mser3d_shape::{Bytes, Choice};
use mser3d_volumeio::ValueCounts;
use serde::Serialize;

use crate::{InputRecord, ResultsError, ShapeFile, ShapeOptions, VolumeFile};

/// All that is known of a file before any work is done on it.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Inspection {
    /// The file, and what its mesh or volume is like.
    #[serde(flatten)]
    pub input: InputRecord,
    /// Vertices of a file that repeats them, before they were merged by position.
    pub file_vertices: Option<usize>,
    /// Polygons that were cut into triangles.
    pub polygons: Option<usize>,
    /// The values of each channel of a volume.
    pub values: Vec<ValuesRecord>,
    /// Why there is no body in a volume yet, and what to choose.
    pub choose: Option<String>,
    /// Edge of a voxel, in the file's units; none where nothing is enclosed, or the voxels are given.
    pub pitch: Option<f64>,
    /// What a run will take; none where there is no body yet, or the mesh is refused.
    pub estimate: Option<Estimate>,
    /// The animations of a glTF file.
    pub animations: Vec<AnimationInfo>,
    /// What reading it said.
    pub notes: Vec<String>,
}

/// The values of a channel of a volume.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ValuesRecord {
    /// The number of the channel: what `--volume` takes.
    pub volume: usize,
    /// The values and their voxels.
    #[serde(flatten)]
    pub counts: ValueCounts,
    /// Names of those that are labels.
    pub names: Vec<(i64, String)>,
}

impl Inspection {
    /// Looks at a file; `parameters` are those of the run that is estimated.
    ///
    /// What is wrong with a mesh is in its diagnosis; a volume in which the body has to be chosen is no error.
    ///
    /// # Errors
    /// As [`ShapeFile::read`], but for [`ResultsError::Body`] and [`ResultsError::Placement`].
    pub fn of_file(
        path: &Path,
        options: &ShapeOptions,
        parameters: &Parameters,
    ) -> Result<Self, ResultsError> {
        if options.volume_format(path).is_some() && options.pose.animation.is_none() {
            return Self::of_volume(&VolumeFile::read(path, options)?, options, parameters);
        }
        Ok(Self::of_shape(&ShapeFile::read(path, options)?, parameters))
    }

    fn of_shape(file: &ShapeFile, parameters: &Parameters) -> Self {
        let (input, loaded) = (file.record(), file.loaded());
        let refused = input.diagnosis.as_ref().is_some_and(|d| d.refused.is_some());
        let estimate = (!refused).then(|| parameters.estimate(&file.volume()));
        let volume = input.diagnosis.as_ref().map(|d| d.volume).filter(|&volume| volume > 0.0);
        Self {
            file_vertices: loaded.and_then(|l| l.weld.as_ref()).map(Vec::len),
            polygons: loaded.map(|l| l.polygons),
            values: Vec::new(),
            choose: None,
            pitch: volume.zip(estimate.as_ref()).map(|(volume, e)| (volume / e.elements as f64).cbrt()),
            estimate,
            animations: list_animations(&file.path, &file.pose.limits).unwrap_or_default(),
            notes: file.notes().to_vec(),
            input,
        }
    }

    fn of_volume(
        file: &VolumeFile,
        options: &ShapeOptions,
        parameters: &Parameters,
    ) -> Result<Self, ResultsError> {
        let loaded = &file.loaded;
        let values = (0..loaded.volume.channels()).map(|volume| {
            let counts = ValueCounts::of(&loaded.volume, volume);
            let named = counts.values.iter().map(|v| v.0 as i64);
            let names = named.filter_map(|v| Some((v, loaded.name_of(v, volume)?.to_owned()))).collect();
            ValuesRecord { volume, counts, names }
        });
        let mut found = Self {
            input: InputRecord {
                sha256: file.sha256.clone(),
                bytes: file.bytes,
                format: Some(loaded.format.to_string()),
                volume: Some(file.record()),
                ..InputRecord::named(file.path.display().to_string())
            },
            file_vertices: None,
            polygons: None,
            values: values.collect(),
            choose: None,
            pitch: None,
            estimate: None,
            animations: Vec::new(),
            notes: loaded.notes.clone(),
        };
        match file.shape(&options.body) {
            Ok(shape) => {
                found.estimate = Some(parameters.estimate(&shape.volume()));
                found.notes = shape.notes().to_vec();
                found.input = shape.identity();
            }
            Err(ResultsError::Body { error, .. }) => found.choose = Some(error.to_string()),
            Err(ResultsError::Placement { error, .. }) => found.choose = Some(error.to_string()),
            Err(error) => return Err(error),
        }
        Ok(found)
    }

    /// The same as text, a name and a value a line.
    pub fn describe(&self) -> String {
        let input = &self.input;
        let mut lines = Lines(format!(
            "{} ({}, {} bytes)\n",
            // In one line, whatever the name holds.
            input.path.replace('\n', "\\u000a"),
            input.format.as_deref().unwrap_or("unknown format"),
            input.bytes.unwrap_or_default()
        ));
        self.describe_mesh(&mut lines);
        self.describe_volume(&mut lines);
        if let Some(Estimate { elements, eigenpairs, memory_bytes, seconds, .. }) = self.estimate {
            if let Some(pitch) = self.pitch {
                lines.add("pitch", format!("{pitch:.6e} for {elements} voxels"));
            }
            let memory = Bytes(memory_bytes);
            lines.add(
                "a run takes about",
                format!("{seconds:.1} s of one core, {memory} ({elements} voxels, {eigenpairs} eigenpairs)"),
            );
        }
        self.animations.iter().for_each(|a| lines.add("animation", a.to_string()));
        self.notes.iter().for_each(|note| lines.add("note", note.clone()));
        if let Some(choose) = &self.choose {
            lines.add("to be chosen", choose.clone());
        }
        lines.0
    }

    fn describe_volume(&self, lines: &mut Lines) {
        let Some(volume) = &self.input.volume else { return };
        volume.describe().into_iter().for_each(|(name, value)| lines.add(name, value));
        for ValuesRecord { volume, counts, names } in &self.values {
            let name =
                if self.values.len() == 1 { "found".to_owned() } else { format!("found in volume {volume}") };
            lines.add(&name, format!("{counts}: {}", counts.kind));
            names.iter().for_each(|(value, label)| lines.add("label", format!("{value}: {label}")));
        }
        if let Some(body) = &volume.body {
            let [x, y, z] = body.centroid;
            let pieces = if body.components == 1 { "" } else { "s" };
            lines.add(
                "body",
                format!(
                    "{} voxels in {} piece{pieces}, volume {:.6e}, centre {x:.3}, {y:.3}, {z:.3}",
                    body.voxels, body.components, body.volume
                ),
            );
        }
    }

    fn describe_mesh(&self, lines: &mut Lines) {
        let Some(d) = &self.input.diagnosis else { return };
        let mut line = |name: &str, value: String| lines.add(name, value);
        line(
            "vertices",
            match self.file_vertices {
                Some(file) => format!("{} ({file} in the file, merged by position)", d.vertices),
                None => format!("{} ({} unused)", d.vertices, d.unreferenced_vertices),
            },
        );
        line(
            "triangles",
            match self.polygons.unwrap_or_default() {
                0 => d.triangles.to_string(),
                n => format!("{} ({n} polygons cut up)", d.triangles),
            },
        );
        line(
            "closed",
            match (d.closed, d.closed_when_merged) {
                (true, _) => "yes".into(),
                (false, true) => "once vertices at equal positions are merged".into(),
                (false, false) => {
                    format!("no: {} boundary edges in {} loops", d.boundary_edges, d.boundary_loops)
                }
            },
        );
        line(
            "orientation",
            match (d.inconsistent_edges, d.inverted_bodies) {
                (0, 0) => "consistent, outwards".into(),
                (0, n) => format!("consistent, but {n} bodies face inwards"),
                (n, _) => format!("{n} edges disagree; {} triangles to turn over", d.flipped_triangles),
            },
        );
        line("components", d.components.to_string());
        line("non-manifold edges", d.non_manifold_edges.to_string());
        line("degenerate triangles", d.degenerate_triangles.to_string());
        line("duplicate triangles", d.duplicate_triangles.to_string());
        line(
            "Euler characteristic",
            match d.genus {
                Some(genus) => format!("{} (genus {genus})", d.euler_characteristic),
                None => d.euler_characteristic.to_string(),
            },
        );
        line("volume", format!("{:.6e} (signed, as oriented: {:.6e})", d.volume, d.signed_volume));
        line("area", format!("{:.6e}", d.area));
        if let Some(b) = d.bounding_box {
            let [x, y, z] = b.extent();
            line("extent", format!("{x:.6} x {y:.6} x {z:.6}, diagonal {:.6}", b.diagonal()));
        }
        line(
            "self-overlap",
            match d.overlap_fraction {
                Some(f) => format!("{:.2} % of the volume (coarse estimate)", 100.0 * f),
                None => "nothing is enclosed".into(),
            },
        );
        line("inside test", format!("{}: {}", d.inside.name(), d.reason));
        if let Some(refused) = &d.refused {
            line("a run is refused", refused.clone());
        }
    }
}

/// Names and values, one pair a line.
struct Lines(String);

impl Lines {
    fn add(&mut self, name: &str, value: String) {
        self.0.push_str(&format!("  {name:<22} {value}\n"));
    }
}

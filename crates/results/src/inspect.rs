use mser3d::{Estimate, Parameters};
use mser3d_meshio::{AnimationInfo, list_animations};
use mser3d_shape::Choice;
use serde::Serialize;

use crate::{Contents, InputRecord, ShapeFile};

/// All that is known of a file before any work is done on it.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Inspection {
    /// The file, and what its mesh is like.
    #[serde(flatten)]
    pub input: InputRecord,
    /// Vertices of a file that repeats them, before they were merged by position.
    pub file_vertices: Option<usize>,
    /// Polygons that were cut into triangles.
    pub polygons: Option<usize>,
    /// The grid of a mask.
    pub mask: Option<MaskRecord>,
    /// Edge of a voxel, in the file's units; none where nothing is enclosed, or the voxels are given.
    pub pitch: Option<f64>,
    /// What a run will take.
    pub estimate: Estimate,
    /// The animations of a glTF file.
    pub animations: Vec<AnimationInfo>,
    /// What reading it said.
    pub notes: Vec<String>,
}

/// The grid of a mask.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct MaskRecord {
    /// Voxels along x, y and z.
    pub dims: [usize; 3],
    /// Voxels inside.
    pub voxels: usize,
}

impl Inspection {
    /// Looks at a file; `parameters` are those of the run that is estimated.
    ///
    /// What is wrong with a mesh is in its diagnosis.
    pub fn new(file: &ShapeFile, parameters: &Parameters) -> Self {
        let (input, loaded) = (file.record(), file.loaded());
        let estimate = parameters.estimate(&file.volume());
        let volume = input.diagnosis.as_ref().map(|d| d.volume).filter(|&volume| volume > 0.0);
        let mask = match &file.contents {
            Contents::Mask(grid) => Some(MaskRecord { dims: grid.frame().dims(), voxels: grid.len() }),
            Contents::Mesh(_) => None,
        };
        Self {
            file_vertices: loaded.and_then(|l| l.weld.as_ref()).map(Vec::len),
            polygons: loaded.map(|l| l.polygons),
            mask,
            pitch: volume.map(|volume| (volume / estimate.elements as f64).cbrt()),
            estimate,
            animations: list_animations(&file.path).unwrap_or_default(),
            notes: loaded.map(|l| l.notes.clone()).unwrap_or_default(),
            input,
        }
    }

    /// The same as text, a name and a value a line.
    pub fn describe(&self) -> String {
        let input = &self.input;
        let mut lines = Lines(format!(
            "{} ({}, {} bytes)\n",
            input.path,
            input.format.as_deref().unwrap_or("unknown format"),
            input.bytes.unwrap_or_default()
        ));
        self.describe_mesh(&mut lines);
        if let Some(MaskRecord { dims: [x, y, z], voxels }) = &self.mask {
            lines.add("grid", format!("{x} x {y} x {z} voxels, {voxels} inside"));
        }
        let Estimate { elements, eigenpairs, memory_bytes, seconds, .. } = self.estimate;
        if let Some(pitch) = self.pitch {
            lines.add("pitch", format!("{pitch:.6e} for {elements} voxels"));
        }
        let memory = memory_bytes / 1_000_000;
        lines.add(
            "a run takes about",
            format!("{seconds:.1} s of one core, {memory} MB ({elements} voxels, {eigenpairs} eigenpairs)"),
        );
        self.animations.iter().for_each(|a| lines.add("animation", a.to_string()));
        self.notes.iter().for_each(|note| lines.add("note", note.clone()));
        lines.0
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
    }
}

/// Names and values, one pair a line.
struct Lines(String);

impl Lines {
    fn add(&mut self, name: &str, value: String) {
        self.0.push_str(&format!("  {name:<22} {value}\n"));
    }
}

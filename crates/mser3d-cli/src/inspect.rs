//! `mser3d inspect`: what a mesh file holds, before any work is done on it.

use std::fmt::Write as _;
use std::io::Write as _;

use mser3d::voxelize::{Diagnosis, diagnose};
use mser3d::{Estimate, estimate};
use mser3d_meshio::{AnimationInfo, LoadedMesh, list_animations};
use serde_json::json;

use crate::error::CliError;
use crate::input::{Contents, Input, InputArgs};
use crate::options::count;
use crate::output::{DiagnosisReport, method_name};

#[derive(clap::Args)]
pub struct InspectArgs {
    #[command(flatten)]
    pub input: InputArgs,
    /// Voxels that the estimate of memory and time is for
    #[arg(long, value_name = "N", value_parser = count, default_value_t = 45_000)]
    pub voxels: usize,
    /// Eigenpairs that the estimate is for
    #[arg(long, value_name = "K", value_parser = count, default_value_t = 100)]
    pub eigenpairs: usize,
    /// Print as JSON
    #[arg(long)]
    pub json: bool,
}

pub fn run(args: &InspectArgs) -> Result<(), CliError> {
    let input = Input::read(&args.input)?;
    let findings = Findings::new(&input, args);
    let text = if args.json { findings.to_json() } else { findings.describe() };
    std::io::stdout().lock().write_all(text.as_bytes()).map_err(CliError::Stdout)
}

/// All that is known of a file before any work is done on it.
struct Findings<'a> {
    input: &'a Input,
    /// Of meshes.
    diagnosis: Option<Diagnosis>,
    animations: Vec<AnimationInfo>,
    /// Voxels of a mask, or as many as were asked for.
    voxels: usize,
    /// Edge of a voxel; none where nothing is enclosed, or the voxels are given.
    pitch: Option<f64>,
    eigenpairs: usize,
    estimate: Estimate,
}

impl<'a> Findings<'a> {
    fn new(input: &'a Input, args: &InspectArgs) -> Self {
        let diagnosis = input.mesh().map(diagnose);
        let voxels = match &input.contents {
            Contents::Mask(mask, _) => mask.count_ones(),
            Contents::Mesh(_) => args.voxels,
        };
        let volume = diagnosis.as_ref().map(|d| d.volume).filter(|&volume| volume > 0.0);
        Self {
            input,
            diagnosis,
            animations: list_animations(&input.path).unwrap_or_default(),
            voxels,
            pitch: volume.map(|volume| (volume / voxels as f64).cbrt()),
            eigenpairs: args.eigenpairs,
            estimate: estimate(voxels, args.eigenpairs),
        }
    }

    fn to_json(&self) -> String {
        let loaded = self.input.loaded();
        let animation =
            |a: &AnimationInfo| json!({ "index": a.index, "name": a.name, "start": a.start, "end": a.end });
        let mask = match &self.input.contents {
            Contents::Mask(mask, _) => Some(json!({ "dims": mask.dims(), "voxels": self.voxels })),
            Contents::Mesh(_) => None,
        };
        let report = json!({
            "path": self.input.path.display().to_string(),
            "sha256": self.input.sha256,
            "bytes": self.input.bytes,
            "format": self.input.format(),
            "file_vertices": loaded.and_then(|l| l.weld.as_ref()).map(Vec::len),
            "polygons": loaded.map(|l| l.polygons),
            "diagnosis": self.diagnosis.as_ref().map(DiagnosisReport::new),
            "mask": mask,
            "estimate": {
                "voxels": self.voxels,
                "pitch": self.pitch,
                "eigenpairs": self.eigenpairs,
                "memory_bytes": self.estimate.memory,
                "seconds": self.estimate.seconds,
            },
            "animations": self.animations.iter().map(animation).collect::<Vec<_>>(),
            "notes": loaded.map(|l| &l.notes[..]).unwrap_or_default(),
        });
        format!("{report:#}\n")
    }

    fn describe(&self) -> String {
        let input = self.input;
        let mut lines =
            Lines(format!("{} ({}, {} bytes)\n", input.path.display(), input.format(), input.bytes));
        if let (Some(loaded), Some(diagnosis)) = (input.loaded(), &self.diagnosis) {
            describe_mesh(&mut lines, loaded, diagnosis);
        }
        if let Contents::Mask(mask, _) = &input.contents {
            let [x, y, z] = mask.dims();
            lines.add("grid", format!("{x} x {y} x {z} voxels, {} inside", self.voxels));
        }
        if let Some(pitch) = self.pitch {
            lines.add("pitch", format!("{pitch:.6e} for {} voxels", self.voxels));
        }
        let (memory, seconds) = (self.estimate.memory / 1_000_000, self.estimate.seconds);
        let (voxels, eigenpairs) = (self.voxels, self.eigenpairs);
        lines.add(
            "a run takes about",
            format!("{seconds:.1} s of one core, {memory} MB ({voxels} voxels, {eigenpairs} eigenpairs)"),
        );
        self.animations.iter().for_each(|a| lines.add("animation", a.to_string()));
        input.loaded().iter().flat_map(|l| &l.notes).for_each(|note| lines.add("note", note.clone()));
        lines.0
    }
}

/// Names and values, one pair a line.
struct Lines(String);

impl Lines {
    fn add(&mut self, name: &str, value: String) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.0, "  {name:<22} {value}");
    }
}

fn describe_mesh(lines: &mut Lines, loaded: &LoadedMesh, d: &Diagnosis) {
    let mut line = |name: &str, value: String| lines.add(name, value);
    line(
        "vertices",
        match loaded.weld.as_ref().map(Vec::len) {
            Some(file) => format!("{} ({file} in the file, merged by position)", d.vertices),
            None => format!("{} ({} unused)", d.vertices, d.unreferenced_vertices),
        },
    );
    line(
        "triangles",
        match loaded.polygons {
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
    line("inside test", format!("{}: {}", method_name(d.method), d.reason));
}

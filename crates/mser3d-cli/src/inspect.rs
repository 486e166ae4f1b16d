//! `mser3d inspect`: what a mesh file holds, before any work is done on it.

use std::io::Write;

use mser3d::estimate;
use mser3d::voxelize::{Diagnosis, diagnose};
use mser3d_meshio::list_animations;

use crate::error::CliError;
use crate::input::{Contents, Input, InputArgs};
use crate::output::DiagnosisReport;

#[derive(clap::Args)]
pub struct InspectArgs {
    #[command(flatten)]
    pub input: InputArgs,
    /// Voxels that the estimate of memory and time is for
    #[arg(long, value_name = "N", default_value_t = 45_000)]
    pub voxels: usize,
    /// Eigenpairs that the estimate is for
    #[arg(long, value_name = "K", default_value_t = 100)]
    pub eigenpairs: usize,
    /// Print as JSON
    #[arg(long)]
    pub json: bool,
}

pub fn run(args: &InspectArgs) -> Result<(), CliError> {
    let input = Input::read(&args.input)?;
    let text = match &input.contents {
        Contents::Mask(mask) => {
            format!("{}: voxel mask {:?}, {} inside\n", input.path.display(), mask.dims(), mask.count_ones())
        }
        Contents::Mesh(loaded) => {
            let diagnosis = diagnose(&loaded.mesh);
            if args.json {
                let report = serde_json::to_string_pretty(&DiagnosisReport::new(&diagnosis));
                report.unwrap_or_default() + "\n"
            } else {
                describe(&input, args, &diagnosis)
            }
        }
    };
    std::io::stdout().lock().write_all(text.as_bytes()).map_err(CliError::Stdout)
}

fn describe(input: &Input, args: &InspectArgs, d: &Diagnosis) -> String {
    let mut lines = vec![format!("{} ({}, {} bytes)", input.path.display(), input.format(), input.bytes)];
    let mut line = |name: &str, value: String| lines.push(format!("  {name:<22} {value}"));
    let (welded, polygons) = match input.loaded() {
        Some(l) => (l.weld.as_ref().map(Vec::len), l.polygons),
        None => (None, 0),
    };
    line(
        "vertices",
        match welded {
            Some(file) => format!("{} ({file} in the file, merged by position)", d.vertices),
            None => format!("{} ({} unused)", d.vertices, d.unreferenced_vertices),
        },
    );
    line(
        "triangles",
        match polygons {
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
    line("inside test", format!("{:?}: {}", d.method, d.reason).to_lowercase());
    if d.volume > 0.0 {
        let pitch = (d.volume / args.voxels as f64).cbrt();
        line("pitch", format!("{pitch:.6e} for {} voxels", args.voxels));
    }
    let estimate = estimate(args.voxels, args.eigenpairs);
    line(
        "a run takes about",
        format!(
            "{:.1} s of one core, {} MB ({} voxels, {} eigenpairs)",
            estimate.seconds,
            estimate.memory / 1_000_000,
            args.voxels,
            args.eigenpairs
        ),
    );
    if let Ok(animations) = list_animations(&input.path) {
        for a in animations {
            line("animation", a.to_string());
        }
    }
    if let Some(loaded) = input.loaded() {
        for note in &loaded.notes {
            line("note", note.clone());
        }
    }
    lines.join("\n") + "\n"
}

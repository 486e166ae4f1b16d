//! `regions.json`: what was read, how it was treated, and what was found.

use mser3d::comptree::{AltitudeScale, Mode, Polarity};
use mser3d::descriptors::TimeScale;
use mser3d::shape::Connectivity;
use mser3d::spectral::{Eigensolver, Extent};
use mser3d::voxelize::{Diagnosis, Method, Morphology, Overlap, Pitch, VoxelizeParameters, diagnose};
use mser3d::{Descriptor, Domain, Features, Parameters, Weight};
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::error::CliError;
use crate::input::{Input, InputArgs};
use crate::machine::peak_memory;
use crate::progress::Meter;

/// Version of the layout of `regions.json` and `features.npz`.
pub const FORMAT: u32 = 1;

/// The whole of `regions.json`, in the order it is written.
#[derive(Serialize)]
pub struct Report {
    mser3d: &'static str,
    format: u32,
    input: InputReport,
    domain: &'static str,
    parameters: Value,
    voxelization: Option<Value>,
    spectrum: Value,
    trees: Vec<Value>,
    duplicates: usize,
    warnings: Vec<String>,
    regions: Vec<RegionReport>,
    run: RunReport,
}

#[derive(Serialize)]
struct InputReport {
    path: String,
    sha256: String,
    /// Of the mesh as it was read: what buffers beside a glTF file and animations make of it.
    mesh_sha256: Option<String>,
    bytes: u64,
    format: String,
    animation: Option<String>,
    time: f64,
    diagnosis: Option<DiagnosisReport>,
}

#[derive(Serialize)]
struct RegionReport {
    id: usize,
    parent: Option<usize>,
    tree: usize,
    altitude: f64,
    stability: Value,
    lifetime: Option<f64>,
    volume: f64,
    volume_fraction: f64,
    voxels: Option<usize>,
    vertices: usize,
    centroid: [f64; 3],
}

/// What changes from run to run.
#[derive(Serialize)]
struct RunReport {
    threads: usize,
    seconds: f64,
    peak_memory_bytes: Option<u64>,
    stages: Vec<Value>,
}

/// A mesh's diagnosis, under the names of [`Diagnosis`].
#[derive(Serialize)]
pub struct DiagnosisReport(Map<String, Value>);

impl DiagnosisReport {
    pub fn new(d: &Diagnosis) -> Self {
        let value = json!({
            "vertices": d.vertices,
            "unreferenced_vertices": d.unreferenced_vertices,
            "triangles": d.triangles,
            "edges": d.edges,
            "closed": d.closed,
            "closed_when_merged": d.closed_when_merged,
            "boundary_edges": d.boundary_edges,
            "boundary_loops": d.boundary_loops,
            "non_manifold_edges": d.non_manifold_edges,
            "inconsistent_edges": d.inconsistent_edges,
            "flipped_triangles": d.flipped_triangles,
            "one_sided_components": d.one_sided_components,
            "components": d.components,
            "inverted_bodies": d.inverted_bodies,
            "degenerate_triangles": d.degenerate_triangles,
            "duplicate_triangles": d.duplicate_triangles,
            "signed_volume": d.signed_volume,
            "volume": d.volume,
            "area": d.area,
            "bounding_box": d.bounding_box.map(|b| [b.min, b.max]),
            "euler_characteristic": d.euler_characteristic,
            "genus": d.genus,
            "overlap_fraction": d.overlap_fraction,
            "method": method_name(d.method),
            "reason": d.reason.to_string(),
        });
        match value {
            Value::Object(map) => Self(map),
            _ => Self(Map::new()),
        }
    }
}

impl Report {
    pub fn new(
        input: &Input,
        args: &InputArgs,
        parameters: &Parameters,
        features: &Features,
        notes: Vec<String>,
        meter: &Meter,
    ) -> Self {
        let diagnosis = input.mesh().map(diagnose);
        let loaded_notes = input.loaded().map(|l| l.notes.clone()).unwrap_or_default();
        let solid_warnings =
            features.voxelization.iter().flat_map(|v| v.warnings.iter().map(|w| w.to_string()));
        Self {
            mser3d: env!("CARGO_PKG_VERSION"),
            format: FORMAT,
            input: InputReport {
                path: args.input.display().to_string(),
                sha256: input.sha256.clone(),
                mesh_sha256: input.mesh_sha256(),
                bytes: input.bytes,
                format: input.format(),
                animation: args.animation.clone(),
                time: args.time,
                diagnosis: diagnosis.as_ref().map(DiagnosisReport::new),
            },
            domain: domain_name(features.body.domain()),
            parameters: parameters_json(input, features.body.domain(), parameters),
            voxelization: voxelization_json(features),
            spectrum: json!({
                "solver": features.spectrum.solver,
                "iterations": features.spectrum.iterations,
                "applications": features.spectrum.applications,
                "largest_relative_residual": features.spectrum.residual,
                "orthogonality": features.spectrum.orthogonality,
                "zero_modes": features.spectrum.zero_modes,
                "eigenpairs": features.basis.eigenvalues().len(),
                "largest_eigenvalue": features.basis.eigenvalues().last(),
            }),
            trees: features.trees.iter().map(tree_json).collect(),
            duplicates: features.duplicates,
            warnings: loaded_notes.into_iter().chain(notes).chain(solid_warnings).collect(),
            regions: regions(features),
            run: RunReport {
                threads: rayon::current_num_threads(),
                seconds: features.times.iter().map(|t| t.seconds).sum(),
                peak_memory_bytes: peak_memory(),
                stages: features
                    .times
                    .iter()
                    .map(|t| {
                        json!({
                            "stage": t.stage.name(),
                            "seconds": t.seconds,
                            "peak_memory_bytes": meter.peak_until(t.stage),
                        })
                    })
                    .collect(),
            },
        }
    }

    /// What the user should know about the input and how it was read.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    pub fn print(&self) -> Result<(), CliError> {
        use std::io::Write;
        std::io::stdout().lock().write_all(self.to_json().as_bytes()).map_err(CliError::Stdout)
    }
}

fn regions(features: &Features) -> Vec<RegionReport> {
    let voxels = features.body.grid().is_some();
    let report = |(id, region): (usize, &mser3d::Region)| RegionReport {
        id,
        parent: region.parent,
        tree: region.tree,
        altitude: region.altitude,
        stability: number(region.stability),
        lifetime: region.merge.map(|merge| merge.lifetime),
        volume: region.volume,
        volume_fraction: region.volume_fraction,
        voxels: voxels.then_some(region.elements.len()),
        vertices: region.vertices.len(),
        centroid: region.centroid,
    };
    features.regions.iter().enumerate().map(report).collect()
}

fn tree_json(tree: &mser3d::Tree) -> Value {
    let report = &tree.selection.report;
    json!({
        "time_scale": tree.time_scale.map(time_scale_json),
        "time": tree.time,
        "nodes": report.nodes,
        "candidates": report.candidates,
        "too_small": report.too_small,
        "too_large": report.too_large,
        "unstable": report.unstable,
        "overlapping": report.overlapping,
        "kept": report.kept,
    })
}

fn voxelization_json(features: &Features) -> Option<Value> {
    let v = features.voxelization.as_ref()?;
    let frame = v.grid.frame();
    Some(json!({
        "method": method_name(v.method),
        "reason": v.reason.to_string(),
        "confidence": v.confidence,
        "ambiguous_voxels": v.ambiguous_voxels,
        "voxels": v.grid.len(),
        "dims": frame.dims(),
        "origin": frame.origin(),
        "spacing": frame.spacing(),
        "volume": v.grid.volume(),
        "dropped_components": v.dropped_components,
        "dropped_voxels": v.dropped_voxels,
        "cut_links": v.cut_links,
        "overlap_volume": v.overlap_volume,
    }))
}

/// What a result depends on, as `regions.json` has it: a result that has it is not computed again.
pub fn identity(input: &Input, args: &InputArgs, domain: Domain, parameters: &Parameters) -> Value {
    json!({
        "mser3d": env!("CARGO_PKG_VERSION"),
        "format": FORMAT,
        "input": {
            "sha256": input.sha256,
            "mesh_sha256": input.mesh_sha256(),
            "animation": args.animation,
            "time": args.time,
        },
        "domain": domain_name(domain),
        "parameters": parameters_json(input, domain, parameters),
    })
}

/// Every parameter that the result depends on, also those that the command line has no option for.
fn parameters_json(input: &Input, domain: Domain, p: &Parameters) -> Value {
    let (mode, window) = match p.stability.mode {
        Mode::Windowed { window } => ("windowed", Some(window)),
        Mode::Paper => ("paper", None),
        Mode::Baseline => ("baseline", None),
    };
    let mut json = json!({
        "spectrum": {
            "eigenpairs": match p.spectrum.eigenpairs {
                Extent::Count(count) => Some(count),
                _ => None,
            },
            "lambda_max": match p.spectrum.eigenpairs {
                Extent::Below(bound) => Some(bound),
                _ => None,
            },
            "tolerance": p.spectrum.tolerance,
            "solver": match p.spectrum.solver {
                Eigensolver::ShiftInvert => "shift-invert",
                Eigensolver::Filter => "filter",
                _ => "auto",
            },
            "max_iterations": p.spectrum.max_iterations,
        },
        "weight": match p.weight {
            Weight::Heat => "heat",
            Weight::CommuteTime => "commute",
            Weight::HeatEdge => "edge",
        },
        "polarity": match p.polarity.unwrap_or(p.weight.polarity()) {
            Polarity::Sublevel => "sublevel",
            Polarity::Superlevel => "superlevel",
        },
        "time_scales": p.time_scales.iter().copied().map(time_scale_json).collect::<Vec<_>>(),
        "reference_measure": p.reference_measure,
        "stability": {
            "mode": mode,
            "window": window,
            "altitude": match p.stability.scale {
                AltitudeScale::Log => "log",
                AltitudeScale::Linear => "linear",
            },
            "min_volume_fraction": p.stability.min_volume_fraction,
            "max_volume_fraction": p.stability.max_volume_fraction,
            "min_diversity": p.stability.min_diversity,
            "min_stability": p.stability.min_stability,
        },
        "pool": { "duplicate_overlap": p.pool.duplicate_overlap },
        "descriptor": match &p.descriptor {
            Descriptor::SizedSiHks(d) | Descriptor::SiHks(d) => json!({
                "kind": if matches!(p.descriptor, Descriptor::SiHks(_)) { "si-hks" } else { "sized-si-hks" },
                "reference_volume": d.reference_volume,
                "reference_area": d.reference_area,
                "unit": d.unit,
                "tau_start": d.tau_start,
                "tau_end": d.tau_end,
                "samples_per_octave": d.samples_per_octave,
                "frequencies": d.frequencies,
            }),
            Descriptor::Hks(d) => json!({
                "kind": "hks",
                "times": d.times.iter().copied().map(time_scale_json).collect::<Vec<_>>(),
            }),
        },
    });
    if domain == Domain::Volume {
        json["voxelize"] = voxelize_json(&p.voxelize, input.mesh().is_some());
    }
    json
}

/// A mask is voxels already: of it only their size, if it was given, and their neighbours are left to say.
fn voxelize_json(p: &VoxelizeParameters, from_mesh: bool) -> Value {
    let mut json = json!({
        "connectivity": match p.connectivity {
            Connectivity::Six => 6,
            Connectivity::TwentySix => 26,
        },
    });
    let pitch = match p.pitch {
        Pitch::Voxels(n) => json!({"voxels": n}),
        Pitch::Resolution(n) => json!({"resolution": n}),
        Pitch::Size(h) => json!({"size": h}),
        Pitch::Spacing(lengths) => json!({"spacing": lengths}),
    };
    if from_mesh || pitch.get("size").is_some() {
        json["pitch"] = pitch;
    }
    if from_mesh {
        json["method"] = method_name(p.method).into();
        json["overlap"] = match p.overlap {
            Overlap::Auto => "auto",
            Overlap::Part => "part",
            Overlap::Join => "join",
        }
        .into();
        json["cut_links"] = p.cut_links.into();
        json["morphology"] = match p.morphology {
            None => Value::Null,
            Some(Morphology::Open) => "open".into(),
            Some(Morphology::Close) => "close".into(),
        };
        json["largest_only"] = p.largest_only.into();
        json["origin"] = p.origin.into();
    }
    json
}

fn time_scale_json(scale: TimeScale) -> Value {
    match scale {
        TimeScale::Relative(t) => json!({"relative": t}),
        TimeScale::Absolute(t) => json!({"absolute": t}),
    }
}

pub fn method_name(method: Method) -> &'static str {
    match method {
        Method::Auto => "auto",
        Method::Parity => "parity",
        Method::Vote => "vote",
        Method::Winding => "winding",
    }
}

fn domain_name(domain: Domain) -> &'static str {
    match domain {
        Domain::Volume => "volume",
        Domain::Surface => "surface",
    }
}

/// JSON has no infinity: "Infinity" for a region that does not change, null where none was measured.
fn number(x: f64) -> Value {
    if x.is_nan() {
        Value::Null
    } else if x.is_infinite() {
        "Infinity".into()
    } else {
        x.into()
    }
}

//! `cargo xtask bench voxelize`: closed and open meshes at two resolutions, ours and the peers' voxels compared.

pub mod meshes;
mod ours;
mod report;

pub use ours::{TASKS, TREE_CODE};
pub use report::Row;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use mser3d::shape::TriangleMesh;
use mser3d::voxelize::{Pitch, VoxelizeParameters, inside};
use mser3d_meshio::{ReadOptions, read_mesh};
use serde_json::{Value, json};

use super::python::{Python, PythonArguments, answer};
use super::resources::processor;

/// What `cargo xtask bench voxelize` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// Meshes to voxelize instead of the built-in ones
    meshes: Vec<PathBuf>,
    /// Voxels along the longest side
    #[arg(long, value_delimiter = ',', default_values_t = [128, 512])]
    resolution: Vec<usize>,
    /// Threads of ours, one row each
    #[arg(long, value_delimiter = ',', default_value = "1,2")]
    threads: Vec<usize>,
    /// Runs of each method, of which the best counts
    #[arg(long, default_value_t = 5)]
    runs: usize,
    #[command(flatten)]
    python: PythonArguments,
    /// Folder for voxelize.md and voxelize.csv [default: docs/results, when nothing else was chosen]
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Run one task of ours and print what it took: the job's file, and the task
    #[arg(long, num_args = 2, hide = true)]
    child: Option<Vec<String>>,
}

/// Runs all cases, and prints and writes the tables.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    if let Some([job, task]) = arguments.child.as_deref() {
        return ours::run_and_print(Path::new(job), task);
    }
    let packages: &[&[&str]] = &[&["numpy"], &["scipy"], &["open3d"], &["vtk"], &["libigl"], &["trimesh"]];
    let python = Python::find(&arguments.python, packages)?;
    let heading = vec![format!("Machine: {}.", processor())];
    let mut meshes: Vec<(String, TriangleMesh)> = Vec::new();
    for path in &arguments.meshes {
        let name = path.file_name().map_or("mesh".into(), |n| n.to_string_lossy().into_owned());
        meshes.push((name, read_mesh(path, &ReadOptions::default())?.mesh));
    }
    if meshes.is_empty() {
        let figure = meshes::figure()?;
        let (open, crowd) = (meshes::with_holes(&figure)?, meshes::crowd(&figure)?);
        meshes.push(("figure".into(), figure));
        meshes.push(("figure, 1 % of the triangles missing".into(), open));
        meshes.push(("crowd of 28 figures".into(), crowd));
    }
    println!("{}", heading[0]);
    let mut rows = Vec::new();
    for (name, mesh) in &meshes {
        for &resolution in &arguments.resolution {
            // All but the fastest take minutes where the grid is fine.
            let peers: &[&str] = if resolution > 200 { &PEERS[..2] } else { &PEERS };
            let plan = Plan { tasks: &TASKS, threads: &arguments.threads, runs: arguments.runs, peers };
            rows.extend(compare(name, mesh, resolution, &python, &plan)?);
        }
    }
    let all = arguments.meshes.is_empty() && arguments.resolution == [128, 512];
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/results");
    match arguments.output.clone().or_else(|| all.then_some(default)) {
        Some(folder) => report::write(&folder, &rows, &heading),
        None => Ok(()),
    }
}

/// Who voxelizes, and how often.
pub struct Plan<'a> {
    /// Tasks of ours, and their names in the table; first what counts crossings, then what the mesh's diagnosis asks for.
    pub tasks: &'a [(&'a str, &'a str)],
    /// Threads of ours, one row each.
    pub threads: &'a [usize],
    /// The best counts.
    pub runs: usize,
    /// Of [`PEERS`].
    pub peers: &'a [&'a str],
}

/// The peers, as `peers/voxelize.py` knows them.
pub const PEERS: [&str; 4] = ["open3d", "vtk", "libigl", "trimesh"];

/// Ours, then the peers, on one grid; printed as they come.
pub fn compare(
    name: &str,
    mesh: &TriangleMesh,
    resolution: usize,
    python: &Python,
    plan: &Plan<'_>,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let parameters = VoxelizeParameters { pitch: Pitch::Resolution(resolution), ..Default::default() };
    let (frame, bits) = inside(mesh, &parameters)?;
    let ([nx, ny, nz], triangles) = (frame.dims(), mesh.triangles().len());
    let case =
        format!("{name}: {triangles} triangles, {nx} x {ny} x {nz} voxels, {} inside", bits.count_ones());
    println!("\n{case}\n{}", report::TITLES);
    let file = |name: &str| fs::canonicalize(&python.folder).map(|folder| folder.join(name));
    let bytes: Vec<u8> = mesh.vertices().iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(file("vertices.f64")?, bytes)?;
    let bytes: Vec<u8> = mesh.triangles().iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    fs::write(file("triangles.u32")?, bytes)?;
    fs::write(file("inside.bits")?, bits.words().iter().flat_map(|w| w.to_le_bytes()).collect::<Vec<u8>>())?;
    drop(bits);
    let job = json!({
        "vertices": file("vertices.f64")?, "triangles": file("triangles.u32")?, "inside": file("inside.bits")?,
        "dims": frame.dims(), "origin": frame.origin(), "spacing": frame.spacing()[0],
        "resolution": resolution, "runs": plan.runs, "slow": resolution > 200, "peers": plan.peers,
    });
    let path = file("job.json")?;
    fs::write(&path, serde_json::to_string_pretty(&job)?)?;

    let mut rows: Vec<Row> = Vec::new();
    // The clock's seconds with the most threads, the processor's with one: of counted crossings, of diagnosed meshes.
    let mut ours = [[f64::NAN; 2]; 2];
    let mut push = |row: Row| {
        println!("{}", row.line());
        rows.push(row);
    };
    for (number, &(task, label)) in plan.tasks.iter().enumerate() {
        for &threads in plan.threads {
            let mut command = Command::new(std::env::current_exe()?);
            command.args(["bench", "voxelize", "--child"]).arg(&path).arg(task);
            let found = answer(command.env("RAYON_NUM_THREADS", threads.to_string()))?;
            let (wall, cpu) = (seconds(&found, "wall"), seconds(&found, "cpu"));
            if let Some(best) = ours.get_mut(number) {
                let [most, fewest] = [plan.threads.iter().max(), plan.threads.iter().min()];
                best[0] = if most == Some(&threads) { wall } else { best[0] };
                best[1] = if fewest == Some(&threads) { cpu } else { best[1] };
            }
            let (case, library, memory) = (case.clone(), label.into(), seconds(&found, "memory"));
            let differing = found["differing"].as_u64();
            let (threads, ratios) = (Some(threads), [f64::NAN; 2]);
            push(Row { case, library, threads, wall, cpu, memory, differing, ratios });
        }
    }
    let output = python.script("voxelize.py").arg(&path).output();
    let Ok(output) = output else { return Ok(rows) };
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let peer: Value = serde_json::from_str(line)?;
        let text = |key: &str| peer[key].as_str().unwrap_or("?").to_string();
        let library = format!("{} {} ({})", text("peer"), text("version"), text("output"));
        let (wall, cpu, differing) =
            (seconds(&peer, "wall"), seconds(&peer, "cpu"), peer["differing"].as_u64());
        let ours = ours[usize::from(library.contains("winding"))];
        let ratios = [wall / ours[0], cpu / ours[1]];
        push(Row {
            case: case.clone(),
            library,
            threads: None,
            wall,
            cpu,
            memory: f64::NAN,
            differing,
            ratios,
        });
    }
    if !output.status.success() || !output.stderr.is_empty() {
        eprintln!("{}", String::from_utf8_lossy(&output.stderr).trim_end());
    }
    Ok(rows)
}

fn seconds(found: &Value, key: &str) -> f64 {
    found[key].as_f64().unwrap_or(f64::NAN)
}

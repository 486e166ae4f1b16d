//! `cargo xtask bench voxelize`: closed and open meshes at two resolutions, ours and the peers' voxels compared.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use mser3d::shape::{Frame, TriangleMesh};
use mser3d::voxelize::{Method, Pitch, VoxelizeParameters, inside, voxelize};
use mser3d_meshio::{ReadOptions, read_mesh};
use serde_json::{Value, json};

use super::process::{Stopwatch, machine};

/// Options of the comparison.
#[derive(clap::Args)]
pub struct Arguments {
    /// Meshes to voxelize instead of the built-in ones
    meshes: Vec<PathBuf>,
    /// Voxels along the longest side
    #[arg(long, value_delimiter = ',', default_values_t = [128, 512])]
    resolution: Vec<usize>,
    /// Runs of each method, of which the best counts
    #[arg(long, default_value_t = 5)]
    runs: usize,
    /// A Python with open3d, vtk, libigl, trimesh and numpy
    #[arg(long, default_value = "python3")]
    python: String,
    /// Folder for the files that the peers read
    #[arg(long, default_value = "target/peers")]
    folder: PathBuf,
}

/// Runs it, and prints one table for each mesh and resolution.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&arguments.folder)?;
    println!("{}", machine());
    let mut meshes: Vec<(String, TriangleMesh)> = Vec::new();
    for path in &arguments.meshes {
        let name = path.file_name().map_or("mesh".into(), |n| n.to_string_lossy().into_owned());
        meshes.push((name, read_mesh(path, &ReadOptions::default())?.mesh));
    }
    if meshes.is_empty() {
        let figure = figure()?;
        meshes.push(("crowd of 28 figures".into(), crowd(&figure)?));
        meshes.push(("figure, 1 % of the triangles missing".into(), with_holes(&figure)?));
        meshes.push(("figure".into(), figure));
        meshes.reverse();
    }
    for (name, mesh) in &meshes {
        for &resolution in &arguments.resolution {
            compare(name, mesh, resolution, arguments)?;
        }
    }
    Ok(())
}

fn compare(name: &str, mesh: &TriangleMesh, n: usize, arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let parameters = VoxelizeParameters { pitch: Pitch::Resolution(n), ..Default::default() };
    let parity = VoxelizeParameters { method: Method::Parity, ..parameters.clone() };
    let (frame, bits) = inside(mesh, &parameters)?;
    println!(
        "\n{name}: {} triangles, {:?} voxels, {} inside",
        mesh.triangles().len(),
        frame.dims(),
        bits.count_ones()
    );
    println!("{:48} {:>10} {:>10} {:>8} {:>10}", "", "wall s", "CPU s", "peak MB", "differing");
    let runs = arguments.runs;
    print_row("mser3d inside, parity (bits)", &best_of(runs, || inside(mesh, &parity).map(drop))?);
    print_row("mser3d inside, diagnosed (bits)", &best_of(runs, || inside(mesh, &parameters).map(drop))?);
    print_row(
        "mser3d linked solid, cut and cleaned",
        &best_of(runs, || voxelize(mesh, &parameters).map(drop))?,
    );
    let words: Vec<u8> = bits.words().iter().flat_map(|w| w.to_le_bytes()).collect();
    let job = write_job(mesh, &frame, &words, n, arguments)?;
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/voxelize.py");
    let output = Command::new(&arguments.python).arg(script).arg(job).output()?;
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let peer: Value = serde_json::from_str(line)?;
        let text = |key: &str| peer[key].as_str().unwrap_or("?").to_string();
        let seconds = |key: &str| peer[key].as_f64().unwrap_or(f64::NAN);
        let label = format!("{} {} ({})", text("peer"), text("version"), text("output"));
        let (wall, cpu, differing) = (seconds("wall"), seconds("cpu"), peer["differing"].as_u64());
        print_row(&label, &Row { wall, cpu, peak: f64::NAN, differing });
    }
    if !output.status.success() {
        eprintln!("{}", String::from_utf8_lossy(&output.stderr));
    }
    Ok(())
}

/// A line of the table.
struct Row {
    /// Seconds of the best run.
    wall: f64,
    /// CPU seconds of a run.
    cpu: f64,
    /// Highest resident memory in bytes, the mesh included.
    peak: f64,
    /// Voxels that differ from ours.
    differing: Option<u64>,
}

fn print_row(label: &str, row: &Row) {
    let optional = |known: bool, text: String| if known { text } else { String::new() };
    let peak = optional(row.peak.is_finite(), format!("{:.0}", row.peak / 1e6));
    let differing = row.differing.map_or(String::new(), |d| d.to_string());
    println!("{label:48} {:>10.5} {:>10.5} {peak:>8} {differing:>10}", row.wall, row.cpu);
}

/// What the best of some runs takes.
fn best_of<E: Error + 'static>(runs: usize, task: impl Fn() -> Result<(), E>) -> Result<Row, Box<dyn Error>> {
    let mut row = Row { wall: f64::INFINITY, cpu: f64::NAN, peak: f64::NAN, differing: None };
    let (whole, started, mut count) = (Stopwatch::start(), Instant::now(), 0);
    // CPU time comes in steps of a hundredth of a second: take the mean of many runs.
    while count < runs || started.elapsed().as_secs_f64() < 0.5 {
        let run = Instant::now();
        task()?;
        row.wall = row.wall.min(run.elapsed().as_secs_f64());
        count += 1;
    }
    let usage = whole.stop();
    Ok(Row { cpu: usage.cpu / count as f64, peak: usage.peak, ..row })
}

/// The files that the peers read, and the JSON that names them.
fn write_job(
    mesh: &TriangleMesh,
    frame: &Frame,
    words: &[u8],
    resolution: usize,
    arguments: &Arguments,
) -> Result<PathBuf, Box<dyn Error>> {
    let file = |name: &str| fs::canonicalize(&arguments.folder).map(|folder| folder.join(name));
    let (vertices, triangles, inside) = (file("vertices.f64")?, file("triangles.u32")?, file("inside.bits")?);
    let bytes: Vec<u8> = mesh.vertices().iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(&vertices, bytes)?;
    let bytes: Vec<u8> = mesh.triangles().iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    fs::write(&triangles, bytes)?;
    fs::write(&inside, words)?;
    let job = json!({
        "vertices": vertices, "triangles": triangles, "inside": inside,
        "dims": frame.dims(), "origin": frame.origin(), "spacing": frame.spacing()[0],
        "runs": arguments.runs, "slow": resolution > 200,
    });
    let path = file("job.json")?;
    fs::write(&path, serde_json::to_string_pretty(&job)?)?;
    Ok(path)
}

/// A ball pulled out into eight limbs: 32,768 triangles.
fn figure() -> Result<TriangleMesh, Box<dyn Error>> {
    let mut vertices: Vec<[f64; 3]> =
        vec![[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..6 {
        let mut middles = std::collections::HashMap::new();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for [a, b, c] in triangles {
            let mut middle = |u: u32, v: u32| {
                *middles.entry((u.min(v), u.max(v))).or_insert_with(|| {
                    let (p, q) = (vertices[u as usize], vertices[v as usize]);
                    let sum: [f64; 3] = std::array::from_fn(|i| p[i] + q[i]);
                    let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
                    vertices.push(sum.map(|x| x / length));
                    vertices.len() as u32 - 1
                })
            };
            let (d, e, f) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]);
        }
        triangles = finer;
    }
    let pulled = |p: &[f64; 3]| p.map(|x| x * (1.0 + 160.0 * (p[0] * p[1] * p[2]).powi(2)) + 0.01);
    Ok(TriangleMesh::new(vertices.iter().map(pulled).collect(), triangles)?)
}

/// The same without each hundredth triangle or so.
fn with_holes(mesh: &TriangleMesh) -> Result<TriangleMesh, Box<dyn Error>> {
    let kept = mesh.triangles().iter().enumerate().filter(|(i, _)| i * 2_654_435_761 % 1000 >= 10);
    Ok(TriangleMesh::new(mesh.vertices().to_vec(), kept.map(|t| *t.1).collect())?)
}

/// 28 copies side by side, 917,504 triangles.
fn crowd(mesh: &TriangleMesh) -> Result<TriangleMesh, Box<dyn Error>> {
    let extent = mesh.bounding_box().ok_or("no triangles")?.extent();
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for copy in 0..28u32 {
        let place = [copy % 4, copy / 4 % 4, copy / 16];
        let first = vertices.len() as u32;
        let shift: [f64; 3] = std::array::from_fn(|a| f64::from(place[a]) * extent[a] * 1.03);
        vertices.extend(mesh.vertices().iter().map(|p| [p[0] + shift[0], p[1] + shift[1], p[2] + shift[2]]));
        triangles.extend(mesh.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    Ok(TriangleMesh::new(vertices, triangles)?)
}

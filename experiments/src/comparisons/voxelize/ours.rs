//! Our side, in a process of its own, so that its memory is its own.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use mser3d::shape::TriangleMesh;
use mser3d::voxelize::{InsideTest, Pitch, VoxelizeError, VoxelizeParameters, inside, voxelize};
use serde_json::{Value, json};

use super::super::resources::{Stopwatch, resident};

/// What is measured: a name for the command line, and one for the table.
pub const TASKS: [(&str, &str); 3] = [
    ("parity", "mser3d, crossings counted (bits)"),
    ("inside", "mser3d, mesh diagnosed (bits)"),
    ("linked", "mser3d, linked solid: cut, cleaned (bits)"),
];

/// Runs one task on the mesh of a job for at least half a second and prints what it took, as JSON.
pub fn run_and_print(job: &Path, task: &str) -> Result<(), Box<dyn Error>> {
    let job: Value = serde_json::from_slice(&fs::read(job)?)?;
    let path = |key: &str| job[key].as_str().map(PathBuf::from).ok_or(format!("the job has no {key}"));
    let (resolution, runs) = (job["resolution"].as_u64().unwrap_or(128), job["runs"].as_u64().unwrap_or(5));
    let mesh = read_mesh(&path("vertices")?, &path("triangles")?)?;
    let pitch = Pitch::Resolution(resolution as usize);
    let diagnosed = VoxelizeParameters { pitch, ..Default::default() };
    let parity = VoxelizeParameters { inside: InsideTest::Parity, ..diagnosed.clone() };
    let run = || -> Result<(), VoxelizeError> {
        match task {
            "parity" => inside(&mesh, &parity).map(drop),
            "inside" => inside(&mesh, &diagnosed).map(drop),
            _ => voxelize(&mesh, &diagnosed).map(drop),
        }
    };
    let before = resident();
    let first = Stopwatch::start();
    run()?;
    let memory = first.stop().peak - before;
    let (whole, started) = (Stopwatch::start(), Instant::now());
    let (mut wall, mut count) = (f64::INFINITY, 0);
    // CPU time comes in steps of a hundredth of a second: take the mean of many runs.
    while count < runs || started.elapsed().as_secs_f64() < 0.5 {
        let one = Instant::now();
        run()?;
        wall = wall.min(one.elapsed().as_secs_f64());
        count += 1;
    }
    let cpu = whole.stop().cpu / count as f64;
    println!("{}", json!({ "wall": wall, "cpu": cpu, "memory": memory }));
    Ok(())
}

/// A mesh from raw numbers.
fn read_mesh(vertices: &Path, triangles: &Path) -> Result<TriangleMesh, Box<dyn Error>> {
    let reals: Vec<f64> = fs::read(vertices)?.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
    let numbers: Vec<u32> =
        fs::read(triangles)?.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect();
    Ok(TriangleMesh::new(reals.as_chunks().0.to_vec(), numbers.as_chunks().0.to_vec())?)
}

//! Our side, in a process of its own, so that its memory is its own.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use mser3d::shape::TriangleMesh;
use mser3d::voxelize::{InsideTest, Pitch, VoxelizeError, VoxelizeParameters, WindingTree, inside, voxelize};
use rayon::prelude::*;
use serde_json::{Value, json};

use super::super::resources::{Stopwatch, resident};

/// What is measured: a name for the command line, and one for the table.
pub const TASKS: [(&str, &str); 3] = [
    ("parity", "mser3d, crossings counted (bits)"),
    ("inside", "mser3d, mesh diagnosed (bits)"),
    ("linked", "mser3d, linked solid: cut, cleaned (bits)"),
];

/// The winding number at the centre of every voxel, by a hierarchy of the triangles: what the open mesh is compared with.
pub const TREE_CODE: (&str, &str) = ("tree", "mser3d, tree code at each voxel");

/// Runs one task on the mesh of a job for at least half a second and prints what it took, as JSON.
pub fn run_and_print(job: &Path, task: &str) -> Result<(), Box<dyn Error>> {
    let job: Value = serde_json::from_slice(&fs::read(job)?)?;
    let path = |key: &str| job[key].as_str().map(PathBuf::from).ok_or(format!("the job has no {key}"));
    let (resolution, runs) = (job["resolution"].as_u64().unwrap_or(128), job["runs"].as_u64().unwrap_or(5));
    let mesh = read_mesh(&path("vertices")?, &path("triangles")?)?;
    let pitch = Pitch::Resolution(resolution as usize);
    let diagnosed = VoxelizeParameters { pitch, ..Default::default() };
    let parity = VoxelizeParameters { inside: InsideTest::Parity, ..diagnosed.clone() };
    if task == TREE_CODE.0 {
        let watch = Stopwatch::start();
        let inside = tree_code(&mesh, &job);
        let usage = watch.stop();
        let ours = fs::read(path("inside")?)?;
        let words = inside.iter().zip(ours.as_chunks().0);
        let differing: u32 = words.map(|(w, b)| (w ^ u64::from_le_bytes(*b)).count_ones()).sum();
        println!("{}", json!({ "wall": usage.wall, "cpu": usage.cpu, "differing": differing }));
        return Ok(());
    }
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

/// The voxels with a winding number above 1/2: rows along x in words of 64 bits.
fn tree_code(mesh: &TriangleMesh, job: &Value) -> Vec<u64> {
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let dims: [usize; 3] = std::array::from_fn(|a| number(&job["dims"][a]) as usize);
    let (origin, spacing) = (&job["origin"], number(&job["spacing"]));
    let centre = |axis: usize, at: usize| number(&origin[axis]) + spacing * (at as f64 + 0.5);
    let [xs, ys, zs]: [Vec<f64>; 3] = std::array::from_fn(|a| (0..dims[a]).map(|at| centre(a, at)).collect());
    let tree = WindingTree::new(mesh);
    let mut words = vec![0; dims[0].div_ceil(64) * dims[1] * dims[2]];
    words.par_chunks_mut(dims[0].div_ceil(64)).enumerate().for_each(|(row, words)| {
        let (y, z) = (ys[row % dims[1]], zs[row / dims[1]]);
        for (i, &x) in xs.iter().enumerate() {
            words[i / 64] |= u64::from(tree.winding_number([x, y, z]) > 0.5) << (i % 64);
        }
    });
    words
}

/// A mesh from raw numbers.
fn read_mesh(vertices: &Path, triangles: &Path) -> Result<TriangleMesh, Box<dyn Error>> {
    let reals: Vec<f64> = fs::read(vertices)?.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
    let numbers: Vec<u32> =
        fs::read(triangles)?.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect();
    Ok(TriangleMesh::new(reals.as_chunks().0.to_vec(), numbers.as_chunks().0.to_vec())?)
}

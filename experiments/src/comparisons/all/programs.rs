//! The released program on one shape, and on many at once.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::thread::available_parallelism;

use mser3d::shape::TriangleMesh;
use mser3d_evaluation::shrec::{Class, transform};
use mser3d_meshio::write_off;

use super::report::Line;
use crate::comparisons::program::{Program, SETS};
use crate::comparisons::resources::{Usage, idle_seconds};
use crate::pose_sets::{SetArguments, in_repository};

/// `mser3d detect` with its defaults on a mesh: least CPU and least wall seconds of several runs.
pub fn detect(
    program: &Program,
    mesh: &Path,
    case: &[String; 2],
    runs: usize,
) -> Result<Line, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let mut least = Usage { cpu: f64::INFINITY, wall: f64::INFINITY, peak: f64::NAN };
    for _ in 0..runs {
        let usage = program.run("detect", mesh, &folder.path().join("found"), &[])?;
        least = Usage { cpu: least.cpu.min(usage.cpu), wall: least.wall.min(usage.wall), ..least };
    }
    Ok(Line::new(case, "mser3d detect", Some(cores()), &least).with(format!("least of {runs} runs")))
}

/// `mser3d batch` with its defaults on so many warped bodies.
pub fn batch(program: &Program, shapes: usize) -> Result<Line, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let input = folder.path().join("shapes");
    fs::create_dir(&input)?;
    let bodies = bodies()?;
    for (number, body) in bodies.iter().cycle().take(shapes).enumerate() {
        // Each time round the bodies are warped more strongly.
        let class = [Class::Localscale, Class::Affine][number % 2];
        let strength = 1 + number / bodies.len() % 5;
        let warped = transform(body, class, strength as u32, number as u64)?.mesh;
        write_off(&input.join(format!("{number:03}.off")), &warped)?;
    }
    let output = folder.path().join("found");
    let idle = idle_seconds();
    let usage = program.run("batch", &input, &output, &[])?;
    let idle = idle_seconds() - idle;
    let found = fs::read_dir(&output)?.flatten().filter(|entry| entry.path().join("regions.json").exists());
    let (found, rate) = (found.count(), shapes as f64 / usage.wall);
    if found < shapes {
        return Err(format!("only {found} of {shapes} shapes have results").into());
    }
    let share = |seconds: f64| 100.0 * seconds / (usage.wall * cores() as f64);
    let (busy, idle) = (share(usage.cpu), share(idle));
    let case = ["batch".into(), format!("{shapes} warped bodies, 45K voxels each")];
    let note =
        format!("{rate:.2} shapes a second; of {} cores {busy:.0} % busy with it, {idle:.0} % idle", cores());
    Ok(Line::new(&case, "mser3d batch", Some(cores()), &usage).with(note))
}

fn bodies() -> Result<Vec<TriangleMesh>, Box<dyn Error>> {
    let here = SETS.into_iter().filter(|set| in_repository(set.1).exists());
    let sets = SetArguments { sets: here.map(|set| set.0.into()).collect(), voxels: 45_000 }.read()?;
    Ok(sets.into_iter().flat_map(|set| set.poses).map(|(_, mesh)| mesh).collect())
}

/// Cores that may be used.
pub fn cores() -> usize {
    available_parallelism().map_or(1, usize::from)
}

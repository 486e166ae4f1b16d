//! The synthetic benchmark on disk.

use std::error::Error;
use std::path::PathBuf;

use mser3d::shape::Choice;
use mser3d_evaluation::shrec::{BenchmarkWriter, Class, ShapeName, isometry, transform};
use mser3d_evaluation::{NullShape, read_symmetry};
use rayon::prelude::*;

use super::arguments::Arguments;
use crate::solved::mesh;

/// Makes it, and returns the folder. That takes seconds, so it is always made anew: what lies there
/// may come from an earlier version or an interrupted run.
pub fn benchmark(arguments: &Arguments) -> Result<PathBuf, Box<dyn Error>> {
    let folder = arguments.output.join("benchmark");
    let writer = BenchmarkWriter::create(&folder)?;
    let path = arguments.synthesize.as_deref().ok_or("no mesh to make a benchmark from")?;
    let mut null = NullShape::new(mesh(path)?);
    if let Some(path) = &arguments.symmetry {
        let vertices = null.mesh().vertices().len();
        null = null.with_symmetry(read_symmetry(path, vertices)?)?;
    }
    writer.null_shape(1, &null)?;
    let tasks: Vec<(Class, u32)> = Class::ALL
        .iter()
        .flat_map(|&class| (1..=5).map(move |strength| (class, strength)))
        .filter(|(class, strength)| arguments.wants(class.name(), *strength))
        .collect();
    let make = |&(class, strength): &(Class, u32)| -> Result<(), String> {
        let name = ShapeName { null: 1, class: class.to_string(), strength };
        let made = if class == Class::Isometry {
            let Some(pose) = arguments.poses.get(strength as usize - 1) else { return Ok(()) };
            isometry(null.mesh(), &mesh(pose).map_err(|e| e.to_string())?)
        } else {
            transform(null.mesh(), class, strength, arguments.seed)
        };
        made.and_then(|shape| writer.transformed(&name, &shape)).map_err(|e| format!("{name}: {e}"))
    };
    tasks.par_iter().map(make).collect::<Result<Vec<()>, String>>()?;
    Ok(folder)
}

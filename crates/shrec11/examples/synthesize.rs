//! Writes the synthetic benchmark of a mesh, for any tool to be scored on:
//!
//! `cargo run --release -p mser3d-shrec11 --example synthesize -- OUT NULL.off [POSE.off ...]`

use std::error::Error;
use std::path::Path;

use mser3d_meshio::{ReadOptions, read_mesh};
use mser3d_shrec11::{BenchmarkWriter, Class, NullShape, ShapeName, isometry, transform};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [out, null, poses @ ..] = &arguments[..] else {
        return Err("usage: synthesize OUT NULL.off [POSE.off ...]".into());
    };
    let read = |path: &String| read_mesh(Path::new(path), &ReadOptions::default()).map(|loaded| loaded.mesh);
    let null = NullShape::new(read(null)?);
    let writer = BenchmarkWriter::create(Path::new(out))?;
    writer.null_shape(1, &null)?;
    for class in Class::ALL {
        for strength in 1..=5 {
            let shape = match (class, poses.get(strength as usize - 1)) {
                (Class::Isometry, None) => continue,
                (Class::Isometry, Some(pose)) => isometry(null.mesh(), &read(pose)?)?,
                _ => transform(null.mesh(), class, strength, 1)?,
            };
            let name = ShapeName { null: 1, class: class.name().into(), strength };
            println!(
                "{name}: {} vertices, {} triangles",
                shape.mesh.vertices().len(),
                shape.mesh.triangles().len()
            );
            writer.transformed(&name, &shape)?;
        }
    }
    Ok(())
}

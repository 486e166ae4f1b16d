//! `cargo xtask fixtures`: three figures in several poses, made from nothing.
//!
//! field (round cones, smooth union) -> surface nets -> smooth skin weights -> poses -> OFF and GLB.
//!
//! The bytes must be the same on every machine. So only `+ - * /` and `sqrt` touch the numbers that
//! are written: IEEE 754 rounds these correctly everywhere, unlike a libm's `sin` or `exp`, and
//! every sum has a fixed order.

mod field;
mod figure;
mod glb;
mod human;
mod leaf;
mod off;
mod plant;
mod quadruped;
mod random;
mod skeleton;
mod skin;
mod surface_nets;
#[cfg(test)]
mod tests;
mod vector;

pub use off::write as off;
pub use random::random_figure;

use std::error::Error;
use std::path::{Path, PathBuf};

/// What `cargo xtask fixtures` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// Folder to write to [default: the workspace's fixtures/]
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Writes every generated fixture.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let folder = arguments.output.clone().unwrap_or_else(default_folder);
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for (name, bytes) in files()? {
        let path = folder.join(name);
        std::fs::write(&path, &bytes).map_err(|e| format!("{}: {e}", path.display()))?;
        println!("{:>8}  {}", bytes.len(), path.display());
    }
    Ok(())
}

fn default_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures")
}

/// The name and the bytes of every generated file.
fn files() -> Result<Vec<(String, Vec<u8>)>, Box<dyn Error>> {
    let mut files = Vec::new();
    for figure in [human::figure()?, quadruped::figure()?, plant::figure()?] {
        let name = figure.name;
        for pose in &figure.poses {
            files.push((
                format!("{name}_{}.off", pose.name),
                off::write(&figure.posed(pose), &figure.triangles),
            ));
        }
        if let Some(mirror) = &figure.mirror {
            files.push((format!("{name}_symmetry.txt"), symmetry(mirror)));
        }
        files.push((format!("{name}.glb"), glb::write(&figure)?));
    }
    Ok(files)
}

/// Line i: the number, from 0, of the vertex that mirrors vertex i.
fn symmetry(mirror: &[u32]) -> Vec<u8> {
    mirror.iter().map(|m| format!("{m}\n")).collect::<String>().into_bytes()
}

//! `cargo xtask figures`: the paper's five figures from data at hand.
//!
//! 1 to 3 are made from the fixtures, 3 also from the shapes of `--shapes`; 4 and 5 are taken from a
//! run of `cargo xtask shrec11`.

mod collapse;
mod isometries;
mod matches;
mod poses;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use mser3d::Region;
use mser3d::shape::TriangleMesh;
use mser3d_evaluation::IndexSet;

use crate::solved::mesh;

/// What `cargo xtask figures` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// Folder of a finished `cargo xtask shrec11`, for figures 4 and 5
    #[arg(long, value_name = "DIR")]
    shrec11: Option<PathBuf>,
    /// More shapes in which figure 3 looks for regions
    #[arg(long, value_name = "MESH", num_args = 1..)]
    shapes: Vec<PathBuf>,
    /// Voxels of each solid
    #[arg(long, default_value_t = 45_000)]
    voxels: usize,
    /// Folder for the figures
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

/// Makes the figures.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let output = &arguments.output;
    fs::create_dir_all(output).map_err(|e| format!("{}: {e}", output.display()))?;
    eprintln!("figure 1: regions on poses, outside and inside");
    poses::draw(arguments.voxels, &output.join("figure_1.png"))?;
    eprintln!("figure 2: an articulation and a collapse");
    isometries::draw(arguments.voxels, output)?;
    eprintln!("figure 3: closest regions of other shapes");
    matches::draw(arguments.voxels, &arguments.shapes, &output.join("figure_3.png"))?;
    let Some(results) = &arguments.shrec11 else {
        eprintln!("figures 4 and 5 need --shrec11 with the folder of a finished `cargo xtask shrec11`");
        return Ok(());
    };
    eprintln!("figures 4 and 5: repeatability and matching score");
    let copied = [
        ("repeatability_5.svg", "figure_4.svg"),
        ("matching_5.svg", "figure_5.svg"),
        ("pictures/0001.strongest.png", "shrec11_strongest.png"),
    ];
    for (from, to) in copied {
        let from = results.join(from);
        fs::copy(&from, output.join(to)).map_err(|e| format!("{}: {e}", from.display()))?;
    }
    Ok(())
}

/// A shape of fixtures/.
fn fixture(name: &str) -> Result<TriangleMesh, Box<dyn Error>> {
    mesh(&fixture_path(name))
}

fn fixture_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures").join(name)
}

/// The vertices of each region.
fn sets(mesh: &TriangleMesh, regions: &[Region]) -> Result<Vec<IndexSet>, Box<dyn Error>> {
    let of = |r: &Region| IndexSet::from_members(mesh.vertices().len(), r.vertices.iter().copied());
    Ok(regions.iter().map(of).collect::<Result<_, _>>()?)
}

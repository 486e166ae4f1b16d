//! `cargo xtask figures`: the paper's five figures from data at hand.
//!
//! 1 to 3 are made from the fixtures, 3 also from the shapes of `--shapes`; 4 and 5 are taken from a
//! run of `cargo xtask shrec11`.

mod collapse;
mod fixture_shapes;
mod isometries;
mod matches;
mod poses;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

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

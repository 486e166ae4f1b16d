//! `cargo xtask bench`: our stages beside other people's, on the same input, in one run; and `cargo xtask peers`, our parts
//! beside theirs.

mod all;
pub mod peers;
mod program;
pub mod python;
mod refine;
pub mod resources;
mod roofline;
mod scale;
mod spectrum;
mod tree;
mod voxelize;

use std::error::Error;

/// What `cargo xtask bench` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    bench: Bench,
}

#[derive(clap::Subcommand)]
enum Bench {
    /// What all of it takes, stage by stage, beside the fastest of the others: one table
    All(all::Arguments),
    /// Eigenpairs: our two solvers, SciPy, LaPy and Spectra
    Spectrum(spectrum::Arguments),
    /// The whole program on a shape in more and more voxels: its stages, and whether regions are found again
    Scale(scale::Arguments),
    /// The stencil beside the machine's memory and arithmetic
    Roofline(roofline::Arguments),
    /// Component trees: Higra and SciPy
    Tree(tree::Arguments),
    /// Solids: Open3D, VTK, libigl and trimesh
    Voxelize(voxelize::Arguments),
}

/// Runs a benchmark.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    match &arguments.bench {
        Bench::All(arguments) => all::run(arguments),
        Bench::Spectrum(arguments) => spectrum::run(arguments),
        Bench::Scale(arguments) => scale::run(arguments),
        Bench::Roofline(arguments) => roofline::run(arguments),
        Bench::Tree(arguments) => tree::run(arguments),
        Bench::Voxelize(arguments) => voxelize::run(arguments),
    }
}

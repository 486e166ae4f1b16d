//! `mser3d`: stable volumetric regions of 3D shapes, at the command line.
//!
//! Thin by design: arguments, progress and files. The work is done by the crate `mser3d`.

mod detect;
mod error;
mod input;
mod inspect;
mod machine;
mod options;
mod output;
mod progress;
mod table;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Finds and describes stable volumetric regions in 3D shapes
/// (Litman, Bronstein & Bronstein 2012).
#[derive(Parser)]
#[command(name = "mser3d", version, propagate_version = true, max_term_width = 110)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Find the stable regions of a shape and write them to a folder
    Detect(Box<detect::DetectArgs>),
    /// Say what a mesh file holds, what is wrong with it, and what a run would take
    Inspect(inspect::InspectArgs),
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    let result = match &cli.command {
        Command::Detect(args) => detect::run(args),
        Command::Inspect(args) => inspect::run(args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("mser3d: {error}");
            error.exit_code()
        }
    }
}

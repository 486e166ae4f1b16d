//! `mser3d`: stable volumetric regions of 3D shapes, at the command line.
//!
//! Thin by design: arguments, progress, tables and exit codes. The work is done by the libraries.

mod batch;
mod choice;
mod detect;
mod error;
mod export;
mod input;
mod inspect;
mod interrupt;
mod log;
mod matching;
mod msv;
mod numbers;
mod options;
mod output;
mod progress;
mod query;
mod render;
mod run_options;
mod shell;
mod table;
mod track;
mod version;
mod view;
mod volume_options;
mod voxel_options;
mod voxelize;
mod weight_option;

use std::io::ErrorKind;
use std::process::ExitCode;

use clap::{ArgAction, Parser, Subcommand};

use crate::error::CliError;

/// Finds and describes stable volumetric regions in 3D shapes
/// (Litman, Bronstein & Bronstein 2012).
#[derive(Parser)]
#[command(
    name = "mser3d",
    version,
    long_version = version::long(),
    propagate_version = true,
    max_term_width = 110,
    allow_negative_numbers = true,
    after_help = "First steps: mser3d detect body.off -o out, then mser3d view out.\n\
                  -h prints a summary of a command's options, --help explains their values."
)]
struct Cli {
    /// Log the stages on stderr; -vv their details too; without it RUST_LOG decides
    #[arg(short, long, global = true, action = ArgAction::Count, display_order = 900)]
    verbose: u8,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Find the stable regions of a shape and write them to a folder
    #[command(allow_negative_numbers = true)]
    Detect(Box<detect::DetectArgs>),
    /// Say what a mesh or volume holds, what is wrong with it, and what a run would take
    #[command(allow_negative_numbers = true)]
    Inspect(inspect::InspectArgs),
    /// Turn a mesh into a voxel mask for other tools
    #[command(allow_negative_numbers = true)]
    Voxelize(voxelize::VoxelizeArgs),
    /// Find the maximally stable regions of a grey-value volume or an image (MSER)
    #[command(allow_negative_numbers = true)]
    Msv(msv::MsvArgs),
    /// Draw a result as a PNG picture; no display needed
    Render(render::RenderArgs),
    /// Write a result as one file for Blender, browsers, MeshLab or ParaView
    Export(export::ExportArgs),
    /// Make one HTML page of a result, to turn and explore in a browser
    View(view::ViewArgs),
    /// Find out which regions of two shapes are the same
    Match(matching::MatchArgs),
    /// Find the regions of many shapes, each in its folder, and make tables of them
    Batch(Box<batch::BatchArgs>),
    /// Follow the regions of a body through a sequence: an animation, or meshes of one moment each
    #[command(allow_negative_numbers = true)]
    Track(Box<track::TrackArgs>),
    /// Find the regions of a collection that are most like those of a shape
    Query(query::QueryArgs),
    /// Print completions for a shell
    #[command(
        after_help = "bash: mser3d completions bash > ~/.local/share/bash-completion/completions/mser3d"
    )]
    Completions(shell::CompletionsArgs),
    /// Write manual pages
    #[command(after_help = "Read them with: man DIR/mser3d-detect.1")]
    Man(shell::ManArgs),
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    interrupt::listen();
    let result = log::start(cli.verbose).and_then(|()| match &cli.command {
        Command::Detect(args) => detect::run(args),
        Command::Inspect(args) => inspect::run(args),
        Command::Voxelize(args) => voxelize::run(args),
        Command::Msv(args) => msv::run(args),
        Command::Render(args) => render::run(args),
        Command::Export(args) => export::run(args),
        Command::View(args) => view::run(args),
        Command::Match(args) => matching::run(args),
        Command::Batch(args) => batch::run(args),
        Command::Track(args) => track::run(args),
        Command::Query(args) => query::run(args),
        Command::Completions(args) => shell::completions(args),
        Command::Man(args) => shell::man(args),
    });
    match result {
        Ok(()) => ExitCode::SUCCESS,
        // Who closed the pipe, as `head` does, has read enough.
        Err(CliError::Stdout(error)) if error.kind() == ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("mser3d: {error}");
            error.exit_code()
        }
    }
}

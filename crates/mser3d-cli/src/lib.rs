//! The command `mser3d` as a library: stable volumetric regions of 3D shapes, at the command line.
//!
//! Thin by design: arguments, progress, tables and exit codes. The work is done by the libraries.
//!
//! [`main`] is the command. For whoever offers the same options in another language, [`parse`] makes of words what
//! a command was told, such as [`DetectArgs`], whose methods give the libraries' parameters or do the work; [`command`]
//! says which options there are. So their names, defaults, choices and checks have one author.
//!
//! ```
//! use mser3d::shape::{BitGrid, Frame, VoxelGrid};
//! use mser3d_cli::{DetectArgs, parse};
//!
//! let args: DetectArgs = parse("detect", ["--voxels=5000", "--polarity=superlevel", "body.off"])?;
//! assert_eq!(args.parameters()?.voxelize.pitch, mser3d::voxelize::Pitch::Voxels(5000));
//! let error = parse::<DetectArgs>("detect", ["--voxels=0", "body.off"]).err().map(|e| e.to_string());
//! assert_eq!(error.unwrap(), "invalid value '0' for '--voxels <N>': must be at least 1");
//! # Ok::<(), mser3d_cli::CliError>(())
//! ```
#![warn(missing_docs)]

mod batch;
mod choice;
mod detect;
mod error;
mod export;
mod input;
mod inspect;
mod interrupt;
mod limit_options;
mod log;
mod matching;
mod message;
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
mod verify;
mod version;
mod view;
mod volume_options;
mod voxel_options;
mod voxelize;
mod weight_option;

pub use batch::BatchArgs;
pub use clap;
pub use detect::DetectArgs;
pub use error::CliError;
pub use matching::MatchArgs;
pub use msv::MsvArgs;
pub use query::QueryArgs;
pub use render::RenderArgs;
pub use track::TrackArgs;
pub use voxelize::VoxelizeArgs;

use std::borrow::Cow;
use std::ffi::OsString;
use std::io::{ErrorKind, Write};

use clap::{ArgAction, Args, CommandFactory, Parser, Subcommand};

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
    /// Check that results and collections are whole and as they were written
    Verify(verify::VerifyArgs),
    /// Print completions for a shell
    #[command(
        after_help = "bash: mser3d completions bash > ~/.local/share/bash-completion/completions/mser3d"
    )]
    Completions(shell::CompletionsArgs),
    /// Write manual pages
    #[command(after_help = "Read them with: man DIR/mser3d-detect.1")]
    Man(shell::ManArgs),
}

/// All commands and their options, as [`main`] knows them.
pub fn command() -> clap::Command {
    let mut command = Cli::command();
    command.build();
    command
}

/// What a command is told by these words, which follow its name.
///
/// # Errors
/// [`CliError::Usage`] with what [`main`] would print of them, without the hint at `--help`.
pub fn parse<A: Args>(
    command: &'static str,
    words: impl IntoIterator<Item = impl Into<OsString> + Clone>,
) -> Result<A, CliError> {
    let words = words.into_iter().map(Into::into);
    let known = A::augment_args(clap::Command::new(command).allow_negative_numbers(true));
    let known = known.disable_help_flag(true).no_binary_name(true);
    let parsed = known.try_get_matches_from(words).and_then(|matches| A::from_arg_matches(&matches));
    parsed.map_err(|error| {
        let text = error.to_string();
        let text = text.strip_prefix("error: ").unwrap_or(&text);
        let end = ["\n\nUsage:", "\n\nFor more information"].iter().filter_map(|hint| text.find(hint)).min();
        CliError::Usage(text[..end.unwrap_or(text.len())].trim_end().to_owned())
    })
}

/// Stack of the thread that does what the command says, in bytes: what systems give the first thread of a program, where
/// nobody has limited it (`ulimit -s`).
const STACK: usize = 8 << 20;

/// The command `mser3d`, with its arguments from its own name on: does what they say and returns the exit code, 0 for
/// success, 1 for failure, 2 for wrong use, 130 and 143 when it was interrupted by SIGINT and SIGTERM.
///
/// From now on signals to stop end the process.
pub fn main(arguments: impl IntoIterator<Item = impl Into<OsString> + Clone>) -> u8 {
    interrupt::listen();
    let arguments: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().name("mser3d".into()).stack_size(STACK);
        match thread.spawn_scoped(scope, || run(&arguments)) {
            // As a program ends that has panicked, which has said why.
            Ok(thread) => thread.join().unwrap_or(101),
            Err(_) => run(&arguments),
        }
    })
}

fn run(arguments: &[OsString]) -> u8 {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) => {
            // Help and versions are no failures; a closed pipe is none either. What a user wrote is in errors.
            let text = error.to_string();
            let _ = match message::shown(&text) {
                Cow::Owned(text) => std::io::stderr().lock().write_all(text.as_bytes()),
                Cow::Borrowed(_) => error.print(),
            };
            return u8::try_from(error.exit_code()).unwrap_or(2);
        }
    };
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
        Command::Verify(args) => verify::run(args),
        Command::Completions(args) => shell::completions(args),
        Command::Man(args) => shell::man(args),
    });
    match (result, interrupt::exit_code()) {
        (Ok(()), _) => 0,
        // Who closed the pipe, as `head` does, has read enough.
        (Err(CliError::Stdout(error)), _) if error.kind() == ErrorKind::BrokenPipe => 0,
        (Err(_), Some(code)) => {
            interrupt::say();
            code
        }
        (Err(error), None) => {
            message::tell(&error.to_string());
            error.exit_code()
        }
    }
}

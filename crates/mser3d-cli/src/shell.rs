//! `mser3d completions` and `mser3d man`: what shells and `man` want to know of the command line.

use std::path::{Path, PathBuf};

use clap::CommandFactory;
use clap_complete::Shell;
use mser3d_fileio::write_atomically;
use mser3d_results::ResultsError;

use crate::Cli;
use crate::error::{CliError, print};
use crate::output::folder;

#[derive(clap::Args)]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    pub shell: Shell,
}

pub fn completions(args: &CompletionsArgs) -> Result<(), CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "mser3d", &mut script);
    print(&String::from_utf8_lossy(&script))
}

#[derive(clap::Args)]
pub struct ManArgs {
    /// Folder for mser3d.1, mser3d-detect.1 and so on; made if it isn't there
    #[arg(short, long, value_name = "DIR", value_parser = folder())]
    pub output: PathBuf,
}

pub fn man(args: &ManArgs) -> Result<(), CliError> {
    let fail = |error| ResultsError::OutputFolder { path: args.output.clone(), error };
    std::fs::create_dir_all(&args.output).map_err(fail)?;
    let mut command = Cli::command().disable_help_subcommand(true);
    command.build();
    pages(&command, &args.output)
}

/// A page for a command, and for each of its subcommands.
fn pages(command: &clap::Command, folder: &Path) -> Result<(), CliError> {
    let page = clap_mangen::Man::new(command.clone());
    write_atomically(&folder.join(page.get_filename()), |out| page.render(out))?;
    command.get_subcommands().try_for_each(|subcommand| pages(subcommand, folder))
}

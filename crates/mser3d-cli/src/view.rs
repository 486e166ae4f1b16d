//! `mser3d view`: a result as a page for the browser.

use std::io::Write;
use std::path::{Path, PathBuf};

use mser3d_meshio::write_atomically;
use mser3d_results::Results;

use crate::error::CliError;
use crate::render::UpAxis;

#[derive(clap::Args)]
pub struct ViewArgs {
    /// Folder that `mser3d detect` wrote
    pub folder: PathBuf,
    /// Page to write [default: view.html in the folder]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Axis that points up
    #[arg(long, value_enum, default_value_t = UpAxis::Y)]
    pub up: UpAxis,
}

pub fn run(args: &ViewArgs) -> Result<(), CliError> {
    let output = args.output.clone().unwrap_or_else(|| args.folder.join("view.html"));
    write_page(&args.folder, &output, args.up)?;
    writeln!(std::io::stdout().lock(), "open {} in a browser", output.display()).map_err(CliError::Stdout)
}

/// Writes the page of a results folder.
pub fn write_page(folder: &Path, output: &Path, up: UpAxis) -> Result<(), CliError> {
    let results = Results::load(folder)?;
    let html = results.page(&format!("Stable regions of {}", results.name()), up.into())?;
    write_atomically(output, |out| out.write_all(html.as_bytes()))?;
    Ok(())
}

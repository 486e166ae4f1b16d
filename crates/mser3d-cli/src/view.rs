//! `mser3d view`: a result as a page for the browser.

use std::path::{Path, PathBuf};

use mser3d_fileio::write_text;
use mser3d_results::msv::MsvResults;
use mser3d_results::{Results, Up};

use crate::choice::choice;
use crate::error::{CliError, print};
use crate::output::{PAGE, file};

#[derive(clap::Args)]
pub struct ViewArgs {
    /// Folder that `mser3d detect` or `mser3d msv` wrote
    pub folder: PathBuf,
    /// Page to write, .html [default: view.html in the folder, with --parts parts.html]
    #[arg(short, long, value_name = "FILE", value_parser = file(PAGE))]
    pub output: Option<PathBuf>,
    /// Show the parts in place of the regions
    #[arg(long)]
    pub parts: bool,
    /// Axis that points up
    #[arg(long, value_parser = choice::<Up>(), default_value_t = Up::default())]
    pub up: Up,
}

pub fn run(args: &ViewArgs) -> Result<(), CliError> {
    let name = if args.parts { "parts.html" } else { "view.html" };
    let output = args.output.clone().unwrap_or_else(|| args.folder.join(name));
    write_page(&args.folder, &output, args.up, args.parts)?;
    print(&format!("open {} in a browser\n", output.display()))
}

/// Writes the page of a results folder: of its regions, or of its parts.
pub fn write_page(folder: &Path, output: &Path, up: Up, parts: bool) -> Result<(), CliError> {
    let html = if MsvResults::is_in(folder) && !parts {
        let results = MsvResults::load(folder)?;
        results.page(&format!("Stable volumes of {}", results.name()), up)?
    } else if parts {
        let results = Results::load(folder)?.with_parts_as_regions()?;
        results.page(&format!("Parts of {}", results.name()), up)?
    } else {
        let results = Results::load(folder)?;
        results.page(&format!("Stable regions of {}", results.name()), up)?
    };
    Ok(write_text(output, &html)?)
}

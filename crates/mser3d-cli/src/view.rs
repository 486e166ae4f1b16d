//! `mser3d view`: a result as a page for the browser.

use std::path::{Path, PathBuf};

use mser3d_fileio::{ReadLimits, STDIN, write_text};
use mser3d_meshio::ReadOptions;
use mser3d_results::msv::MsvResults;
use mser3d_results::{Results, ShapeOptions, Up, VolumeFile};
use mser3d_volumeio::Volume;

use crate::choice::choice;
use crate::error::{CliError, print};
use crate::message::{name, tell};
use crate::output::{PAGE, file};

#[derive(clap::Args)]
pub struct ViewArgs {
    /// Folder that `mser3d detect` or `mser3d msv` wrote
    pub folder: PathBuf,
    /// Page to write, .html [default: view.html in the folder]
    #[arg(short, long, value_name = "FILE", value_parser = file(PAGE))]
    pub output: Option<PathBuf>,
    /// Axis that points up
    #[arg(long, value_parser = choice::<Up>(), default_value_t = Up::default())]
    pub up: Up,
}

pub fn run(args: &ViewArgs) -> Result<(), CliError> {
    let output = args.output.clone().unwrap_or_else(|| args.folder.join("view.html"));
    write_page(&args.folder, &output, args.up)?;
    print(&format!("open {} in a browser\n", name(&output.to_string_lossy())))
}

/// Writes the page of a results folder.
pub fn write_page(folder: &Path, output: &Path, up: Up) -> Result<(), CliError> {
    let html = if MsvResults::is_in(folder) {
        let results = MsvResults::load(folder)?;
        let volume = match volume(&results) {
            Ok(volume) => Some(volume),
            Err(why) => {
                tell(&format!("note: the grey values are not shown: {why}"));
                None
            }
        };
        results.page(&format!("Stable volumes of {}", results.name()), up, volume.as_ref())?
    } else {
        let results = Results::load(folder)?;
        let what = if results.record.parts.is_some() { "Parts and stable regions" } else { "Stable regions" };
        results.page(&format!("{what} of {}", results.name()), up)?
    };
    Ok(write_text(output, &html)?)
}

/// The volume that regions were found in, read again, or why it cannot be.
fn volume(results: &MsvResults) -> Result<Volume, String> {
    let (record, path) = (&results.record, PathBuf::from(&results.record.volume));
    if path == Path::new(STDIN) {
        return Err("they came from standard input".into());
    }
    if !path.is_file() {
        return Err(format!("{}: there is no such file", path.display()));
    }
    // A larger one is not the volume that was searched.
    let max_box_voxels = record.dims.iter().fold(1u64, |n, &axis| n.saturating_mul(axis as u64));
    let pose =
        ReadOptions { limits: ReadLimits { max_box_voxels, ..Default::default() }, ..Default::default() };
    let options = ShapeOptions { pose, ..Default::default() };
    let file = VolumeFile::read(&path, &options).map_err(|e| e.to_string())?;
    let volume = file.loaded.grey(None).map_err(|e| format!("{}: {e}", path.display()))?;
    if (volume.dims(), volume.channels()) != (record.dims, record.channels) {
        return Err(format!("{}: it is not the volume that was searched", path.display()));
    }
    Ok(volume)
}

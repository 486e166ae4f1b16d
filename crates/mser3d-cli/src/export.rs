//! `mser3d export`: a result as one file for another program.

use std::path::PathBuf;

use mser3d_results::{Checksums, Results};

use crate::error::CliError;
use crate::message::tell;
use crate::output::{EXPORT, file};

#[derive(clap::Args)]
pub struct ExportArgs {
    /// Folder that `mser3d detect` wrote
    pub folder: PathBuf,
    /// File to write, coloured by region; its ending says the format: .glb (Blender, browsers), .ply,
    /// .vtp (surface, for ParaView), .vti (voxels, for ParaView), .nii.gz (label map on the input's grid) or .mrk.json
    /// (landmarks for 3D Slicer)
    #[arg(short, long, value_name = "FILE", value_parser = file(EXPORT))]
    pub output: PathBuf,
    /// Write the parts in place of the regions
    #[arg(long)]
    pub parts: bool,
}

pub fn run(args: &ExportArgs) -> Result<(), CliError> {
    let results = Results::load(&args.folder)?;
    let results = if args.parts { results.with_parts_as_regions()? } else { results };
    for note in results.export(&args.output)? {
        tell(&format!("note: {}: {note}", args.output.display()));
    }
    // It may be a file of a result's folder.
    Ok(Checksums::renew(&args.output)?)
}

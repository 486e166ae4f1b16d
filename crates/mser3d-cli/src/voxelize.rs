//! `mser3d voxelize`: from a mesh to a voxel mask.

use std::io::Write;
use std::path::PathBuf;

use mser3d::voxelize::{Voxelization, voxelize};
use mser3d_volumeio::{Placement, Volume, VolumeFormat, write_nifti, write_npy};
use serde_json::json;

use crate::error::CliError;
use crate::input::{Input, InputArgs};
use crate::output::method_name;
use crate::voxel_options::VoxelOptions;

#[derive(clap::Args)]
pub struct VoxelizeArgs {
    #[command(flatten)]
    pub input: InputArgs,
    /// Mask to write, 1 inside and 0 outside: NIfTI (.nii, .nii.gz), which keeps the grid's place, or NumPy
    /// (.npy), indexed [x, y, z]
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Print what was made as JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub options: VoxelOptions,
}

pub fn run(args: &VoxelizeArgs) -> Result<(), CliError> {
    let write = match VolumeFormat::of(&args.output) {
        Some(VolumeFormat::Npy) => write_npy,
        Some(VolumeFormat::Nifti) => write_nifti,
        _ => {
            let name = args.output.display();
            return Err(CliError::Usage(format!("{name}: masks are written as .npy, .nii or .nii.gz")));
        }
    };
    let parameters = args.options.parameters()?;
    let input = Input::read(&args.input)?;
    let Some(mesh) = input.mesh() else {
        return Err(CliError::Usage(format!("{}: a mask is voxels already", input.path.display())));
    };
    let failed = |e| CliError::Shape { path: input.path.clone(), source: mser3d::Error::from(e) };
    let solid = voxelize(mesh, &parameters).map_err(failed)?;
    let frame = solid.grid.frame();
    let placement =
        Placement { origin: frame.centre([0; 3]), spacing: frame.spacing(), ..Default::default() };
    write(&args.output, &Volume::from_mask(solid.grid.occupancy(), placement)?)?;
    for warning in &solid.warnings {
        eprintln!("mser3d: warning: {}: {warning}", input.path.display());
    }
    let text = if args.json { to_json(&solid) } else { describe(&solid) };
    std::io::stdout().lock().write_all(text.as_bytes()).map_err(CliError::Stdout)
}

fn to_json(solid: &Voxelization) -> String {
    let (frame, topology) = (solid.grid.frame(), solid.topology);
    let report = json!({
        "voxels": solid.grid.len(),
        "dims": frame.dims(),
        "origin": frame.origin(),
        "spacing": frame.spacing(),
        "method": method_name(solid.method),
        "reason": solid.reason.to_string(),
        "confidence": solid.confidence,
        "components": topology.components,
        "tunnels": topology.tunnels,
        "cavities": topology.cavities,
        "cut_links": solid.cut_links,
        "overlap_volume": solid.overlap_volume,
        "warnings": solid.warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
    });
    format!("{report:#}\n")
}

fn describe(solid: &Voxelization) -> String {
    let (frame, topology) = (solid.grid.frame(), solid.topology);
    let ([nx, ny, nz], [x, y, z], [hx, hy, hz]) = (frame.dims(), frame.origin(), frame.spacing());
    format!(
        "{} voxels inside, of {nx} x {ny} x {nz}\n\
         spacing {hx},{hy},{hz} from {x},{y},{z}\n\
         {}: {}\n\
         {} components, {} tunnels, {} cavities; {} links cut by the surface, which a mask does not keep\n",
        solid.grid.len(),
        method_name(solid.method),
        solid.reason,
        topology.components,
        topology.tunnels,
        topology.cavities,
        solid.cut_links,
    )
}

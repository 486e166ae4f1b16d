//! `mser3d voxelize`: from a mesh to a voxel mask.

use std::ops::ControlFlow;
use std::path::PathBuf;

use mser3d::shape::Connectivity;
use mser3d::shape::TriangleMesh;
use mser3d::voxelize::{Voxelization, VoxelizeError, VoxelizeParameters, estimate, voxelize_with};
use mser3d_meshio::ReadOptions;
use mser3d_results::{ShapeFile, ShapeOptions, VoxelizationRecord};
use mser3d_volumeio::{Volume, VolumeFormat, write_nifti, write_npy};
use serde::Serialize;

use crate::error::{CliError, print, print_json};
use crate::input::{InputArgs, output_beside};
use crate::limit_options::LimitOptions;
use crate::message::tell;
use crate::output::{MASK, file};
use crate::voxel_options::VoxelOptions;

/// What `mser3d voxelize` is told.
#[derive(clap::Args, Clone, Debug)]
pub struct VoxelizeArgs {
    #[command(flatten)]
    pub(crate) input: InputArgs,
    /// Mask to write, 1 inside and 0 outside: NIfTI (.nii, .nii.gz), which keeps the grid's place, or NumPy
    /// (.npy), indexed [x, y, z] [default: the input's name, as .nii.gz]
    #[arg(short, long, value_name = "FILE", value_parser = file(MASK))]
    pub output: Option<PathBuf>,
    /// Print what was made as JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub(crate) options: VoxelOptions,
    #[command(flatten)]
    pub(crate) limits: LimitOptions,
}

impl VoxelizeArgs {
    /// Reads the shape.
    ///
    /// # Errors
    /// [`CliError::Results`], [`CliError::Usage`] for a time or an animation that is none.
    pub fn read(&self) -> Result<ShapeFile, CliError> {
        let pose = ReadOptions { limits: self.limits.reading(), ..self.input.pose() };
        let format = self.input.format.format;
        self.input.read(&ShapeOptions { pose, format, ..Default::default() })
    }

    /// The neighbours of a voxel.
    pub fn connectivity(&self) -> Connectivity {
        self.options.connectivity()
    }

    /// The solid inside the mesh.
    ///
    /// # Errors
    /// [`CliError::Usage`] for a volume and for values out of range, [`CliError::Shape`],
    /// [`CliError::MemoryLimit`], [`CliError::TimeLimit`].
    pub fn find(&self, file: &ShapeFile) -> Result<Voxelization, CliError> {
        let parameters = self.options.parameters(&self.limits)?;
        let Some(mesh) = file.mesh() else {
            return Err(CliError::Usage(format!("{}: a volume is voxels already", file.path.display())));
        };
        let deadline = self.limits.deadline();
        self.check_memory(file, mesh, &parameters)?;
        let found = voxelize_with(mesh, &parameters, &|| deadline.go_on());
        if let Err(VoxelizeError::Cancelled) = found {
            CliError::in_time(&deadline, &file.path)?;
        }
        found.map_err(|e| CliError::detection(&file.path, e.into()))
    }
}

/// Bytes for a voxel of the box: the grid while it is made, and the mask.
const BOX_VOXEL: f64 = 2.0;
/// Bytes for a triangle while it is voxelized.
const TRIANGLE: f64 = 360.0;

impl VoxelizeArgs {
    fn check_memory(
        &self,
        file: &ShapeFile,
        mesh: &TriangleMesh,
        parameters: &VoxelizeParameters,
    ) -> Result<(), CliError> {
        // What is wrong with the mesh or the box is said by the work itself.
        let Ok(cost) = estimate(mesh, parameters, &|| ControlFlow::Continue(())) else { return Ok(()) };
        let [nx, ny, nz] = cost.dims;
        let voxels = nx as f64 * ny as f64 * nz as f64;
        let bytes = BOX_VOXEL * voxels + TRIANGLE * mesh.triangles().len() as f64;
        self.limits.check_memory(&file.path, bytes, || format!("a grid of {nx} x {ny} x {nz} voxels"))
    }
}

pub(crate) fn run(args: &VoxelizeArgs) -> Result<(), CliError> {
    // What is wrong with the parameters is said first.
    args.options.parameters(&args.limits)?;
    let _watch = args.limits.watch(&args.input.input);
    let file = args.read()?;
    let output = args.output.clone().unwrap_or_else(|| output_beside(&file.path, ".nii.gz"));
    let write = if VolumeFormat::of(&output) == Some(VolumeFormat::Npy) { write_npy } else { write_nifti };
    let solid = args.find(&file)?;
    let frame = solid.grid.frame();
    write(&output, &Volume::from_mask(solid.grid.occupancy(), frame.affine())?)?;
    for warning in &solid.warnings {
        tell(&format!("warning: {}: {warning}", file.path.display()));
    }
    if args.json { print_json(&Report::new(&solid)) } else { print(&describe(&solid)) }
}

/// What `--json` prints.
#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    voxelization: VoxelizationRecord,
    warnings: Vec<String>,
}

impl Report {
    fn new(solid: &Voxelization) -> Self {
        let warnings = solid.warnings.iter().map(ToString::to_string).collect();
        Self { voxelization: solid.into(), warnings }
    }
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
        solid.inside,
        solid.reason,
        topology.components,
        topology.tunnels,
        topology.cavities,
        solid.cut_links,
    )
}

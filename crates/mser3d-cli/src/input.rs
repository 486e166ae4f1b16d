//! The input file: a mesh, or a solid as a voxel mask.

use std::path::{Path, PathBuf};

use mser3d::shape::{BitGrid, Frame, TriangleMesh};
use mser3d_meshio::{LoadedMesh, MeshFormat, MeshIoError, ReadOptions, read_mask, read_mesh_from};
use mser3d_volumeio::{VolumeFormat, read_volume};
use sha2::{Digest, Sha256};

use crate::error::CliError;

/// Which file, and which pose in it.
#[derive(clap::Args, Clone, Debug)]
pub struct InputArgs {
    /// Mesh (.obj .gltf .glb .off .ply .stl), or a solid as a voxel mask: .npy, indexed [x, y, z], .nii,
    /// .nii.gz, .nrrd or .tif, whose voxels that are not 0 are inside
    pub input: PathBuf,
    /// glTF animation that poses the figure, by name or number from 0
    #[arg(long, value_name = "NAME", help_heading = "Input")]
    pub animation: Option<String>,
    /// When in the animation, in seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, help_heading = "Input")]
    pub time: f64,
}

/// What the file holds.
pub enum Contents {
    Mesh(Box<LoadedMesh>),
    /// The voxels inside, and their grid.
    Mask(BitGrid, Frame),
}

/// A file that was read.
pub struct Input {
    pub path: PathBuf,
    pub sha256: String,
    pub bytes: u64,
    pub contents: Contents,
}

impl Input {
    pub fn read(args: &InputArgs) -> Result<Self, CliError> {
        let path = &args.input;
        let options = ReadOptions { animation: args.animation.clone(), time: args.time };
        if let Err(MeshIoError::BadParameter { parameter, reason }) = options.validate() {
            return Err(CliError::Usage(format!("--{parameter}: {reason}")));
        }
        let read = |source| MeshIoError::Read { path: path.clone(), source };
        let bytes = std::fs::read(path).map_err(read)?;
        let sha256 = hex(Sha256::digest(&bytes));
        let format = VolumeFormat::of(path);
        if format.is_some() && args.animation.is_some() {
            return Err(CliError::Usage(
                "--animation needs a glTF file; a voxel mask has no animations".into(),
            ));
        }
        let contents = if let Some(format) = format {
            let (mask, frame) = read_solid(path, format)?;
            Contents::Mask(mask, frame)
        } else {
            let format = MeshFormat::of(path, &bytes)?;
            Contents::Mesh(Box::new(read_mesh_from(format, &bytes, path, &options)?))
        };
        let input = Self { path: path.clone(), sha256, bytes: bytes.len() as u64, contents };
        let counts = input.mesh().map(|mesh| (mesh.vertices().len(), mesh.triangles().len()));
        let (vertices, triangles) = counts.unzip();
        tracing::info!(path = %path.display(), format = input.format(), vertices, triangles, "read");
        Ok(input)
    }

    pub fn mesh(&self) -> Option<&TriangleMesh> {
        self.loaded().map(|loaded| &loaded.mesh)
    }

    pub fn loaded(&self) -> Option<&LoadedMesh> {
        match &self.contents {
            Contents::Mesh(loaded) => Some(loaded),
            Contents::Mask(..) => None,
        }
    }

    /// A hash of the mesh's vertices and triangles.
    pub fn mesh_sha256(&self) -> Option<String> {
        let mesh = self.mesh()?;
        let mut hash = Sha256::new();
        hash.update((mesh.vertices().len() as u64).to_le_bytes());
        mesh.vertices().iter().flatten().for_each(|x| hash.update(x.to_le_bytes()));
        mesh.triangles().iter().flatten().for_each(|v| hash.update(v.to_le_bytes()));
        Some(hex(hash.finalize()))
    }

    pub fn format(&self) -> String {
        match (self.loaded(), VolumeFormat::of(&self.path)) {
            (Some(loaded), _) => loaded.format.to_string(),
            (None, Some(format)) => format!("{format} mask"),
            (None, None) => "mask".into(),
        }
    }
}

fn hex(digest: impl AsRef<[u8]>) -> String {
    digest.as_ref().iter().map(|b| format!("{b:02x}")).collect()
}

/// A mask, and its grid: of an array, which has no place of its own, that of voxels of size 1 from the origin on.
fn read_solid(path: &Path, format: VolumeFormat) -> Result<(BitGrid, Frame), CliError> {
    let failed = |e| CliError::Shape { path: path.to_path_buf(), source: mser3d::Error::from(e) };
    if format == VolumeFormat::Npy {
        let mask = read_mask(path)?;
        let frame = Frame::new(mask.dims(), [0.0; 3], [1.0; 3]).map_err(failed)?;
        return Ok((mask, frame));
    }
    let volume = read_volume(path)?;
    let mask = volume.mask()?;
    if mask.count_ones() == 0 {
        return Err(CliError::EmptyMask { path: path.to_path_buf() });
    }
    Ok((mask, volume.frame()?))
}

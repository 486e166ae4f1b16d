use std::path::{Path, PathBuf};

use mser3d::Input;
use mser3d::voxelize::{Pitch, diagnose};
use mser3d_fileio::read_bytes;
use mser3d_meshio::{LoadedMesh, MeshFormat, ReadOptions, read_mesh_from};
use mser3d_shape::{Domain, Frame, TriangleMesh, VoxelGrid};
use mser3d_volumeio::{VolumeFormat, read_mask, read_volume};
use sha2::{Digest, Sha256};

use crate::{InputRecord, ResultsError};

/// A file with a shape that was read: what a detector takes, and what a record says of it.
///
/// ```no_run
/// use mser3d::{Detector, Domain};
/// use mser3d_meshio::ReadOptions;
/// use mser3d_results::{Results, ShapeFile};
///
/// // The fox, half a second into its second animation.
/// let pose = ReadOptions { animation: Some("1".to_owned()), time: 0.5 };
/// let file = ShapeFile::read("Fox.glb".as_ref(), &pose)?;
/// let features = Detector::default().detect(file.input(Domain::Volume)?)?;
/// Results::of_file(&features, &file)?.write("fox".as_ref())?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ShapeFile {
    /// The file.
    pub path: PathBuf,
    /// SHA-256 of the file.
    pub sha256: String,
    /// Its size.
    pub bytes: u64,
    /// The frame of an animation that was read.
    pub pose: ReadOptions,
    /// What it holds.
    pub contents: Contents,
}

/// What a [`ShapeFile`] holds.
#[derive(Clone, Debug)]
pub enum Contents {
    /// A mesh.
    Mesh(Box<LoadedMesh>),
    /// A solid as a voxel mask.
    Mask(Box<VoxelGrid>),
}

impl ShapeFile {
    /// Reads a mesh, or a voxel mask; the name's ending says which. `pose` chooses a frame of a glTF animation.
    ///
    /// # Errors
    /// [`ResultsError::Mesh`], [`ResultsError::Volume`], [`ResultsError::File`], naming the file;
    /// [`ResultsError::EmptyMask`]; [`ResultsError::NoMesh`] for an animation of a mask.
    pub fn read(path: &Path, pose: &ReadOptions) -> Result<Self, ResultsError> {
        pose.validate()?;
        let bytes = read_bytes(path)?;
        let sha256 = hex(Sha256::digest(&bytes));
        let contents = match VolumeFormat::of(path) {
            Some(_) if pose.animation.is_some() => {
                return Err(ResultsError::NoMesh { path: path.to_owned(), option: "--animation" });
            }
            Some(format) => Contents::Mask(Box::new(read_solid(path, format)?)),
            None => {
                let format = MeshFormat::of(path, &bytes)?;
                Contents::Mesh(Box::new(read_mesh_from(format, &bytes, path, pose)?))
            }
        };
        let bytes = bytes.len() as u64;
        let file = Self { path: path.to_owned(), sha256, bytes, pose: pose.clone(), contents };
        let counts = file.mesh().map(|mesh| (mesh.vertices().len(), mesh.triangles().len()));
        let (vertices, triangles) = counts.unzip();
        tracing::info!(path = %path.display(), format = file.format(), vertices, triangles, "read");
        Ok(file)
    }

    /// The same, with voxels of a mask of the size given by [`Pitch::Size`], from the origin on. Other pitches and meshes
    /// change nothing.
    ///
    /// # Errors
    /// [`ResultsError::Shape`] for a size that is not positive.
    pub fn with_pitch(mut self, pitch: Pitch) -> Result<Self, ResultsError> {
        if let (Contents::Mask(grid), Pitch::Size(h)) = (&mut self.contents, pitch) {
            let frame = Frame::new(grid.frame().dims(), [0.0; 3], [h; 3])?;
            **grid = VoxelGrid::solid(frame, grid.occupancy().clone())?;
        }
        Ok(self)
    }

    /// The mesh, if it is one.
    pub fn mesh(&self) -> Option<&TriangleMesh> {
        self.loaded().map(|loaded| &loaded.mesh)
    }

    /// The mesh, and what reading it told.
    pub fn loaded(&self) -> Option<&LoadedMesh> {
        match &self.contents {
            Contents::Mesh(loaded) => Some(loaded),
            Contents::Mask(_) => None,
        }
    }

    /// What a detector takes: the solid or the surface of a mesh, or the solid of a mask.
    ///
    /// # Errors
    /// [`ResultsError::NoMesh`] for the surface of a mask.
    pub fn input(&self, domain: Domain) -> Result<Input<'_>, ResultsError> {
        match (domain, self.mesh()) {
            (Domain::Volume, _) => Ok(self.volume()),
            (Domain::Surface, Some(mesh)) => Ok(Input::Surface(mesh)),
            (Domain::Surface, None) => {
                Err(ResultsError::NoMesh { path: self.path.clone(), option: "--surface" })
            }
        }
    }

    /// The solid of a mesh, or of a mask.
    pub fn volume(&self) -> Input<'_> {
        match &self.contents {
            Contents::Mesh(loaded) => Input::Volume(&loaded.mesh),
            Contents::Mask(grid) => Input::Solid(grid),
        }
    }

    /// Its format, in words.
    pub fn format(&self) -> String {
        match (self.loaded(), VolumeFormat::of(&self.path)) {
            (Some(loaded), _) => loaded.format.to_string(),
            (None, Some(format)) => format!("{format} mask"),
            (None, None) => "mask".into(),
        }
    }

    /// What a record says of it, but for the diagnosis.
    pub fn identity(&self) -> InputRecord {
        InputRecord {
            path: self.path.display().to_string(),
            sha256: Some(self.sha256.clone()),
            mesh_sha256: self.mesh().map(mesh_sha256),
            bytes: Some(self.bytes),
            format: Some(self.format()),
            animation: self.pose.animation.clone(),
            time: self.pose.time,
            diagnosis: None,
        }
    }

    /// What a record says of it.
    pub fn record(&self) -> InputRecord {
        InputRecord { diagnosis: self.mesh().map(diagnose), ..self.identity() }
    }
}

/// A hash of the mesh's vertices and triangles.
fn mesh_sha256(mesh: &TriangleMesh) -> String {
    let mut hash = Sha256::new();
    hash.update((mesh.vertices().len() as u64).to_le_bytes());
    mesh.vertices().iter().flatten().for_each(|x| hash.update(x.to_le_bytes()));
    mesh.triangles().iter().flatten().for_each(|v| hash.update(v.to_le_bytes()));
    hex(hash.finalize())
}

fn hex(digest: impl AsRef<[u8]>) -> String {
    digest.as_ref().iter().map(|b| format!("{b:02x}")).collect()
}

/// A mask, and its grid: of an array, which has no place of its own, that of voxels of size 1 from the origin on.
fn read_solid(path: &Path, format: VolumeFormat) -> Result<VoxelGrid, ResultsError> {
    if format == VolumeFormat::Npy {
        let mask = read_mask(path)?;
        let frame = Frame::new(mask.dims(), [0.0; 3], [1.0; 3])?;
        return Ok(VoxelGrid::solid(frame, mask)?);
    }
    let volume = read_volume(path)?;
    let mask = volume.mask()?;
    if mask.count_ones() == 0 {
        return Err(ResultsError::EmptyMask { path: path.to_owned() });
    }
    Ok(VoxelGrid::solid(volume.frame()?, mask)?)
}

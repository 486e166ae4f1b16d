use std::path::{Path, PathBuf};

use mser3d::Input;
use mser3d::voxelize::diagnose;
use mser3d_fileio::{ReadLimits, STDIN, read_bytes_within};
use mser3d_meshio::{LoadedMesh, MeshFormat, MeshIoError, ReadOptions, read_mesh_from};
use mser3d_shape::{Domain, InvalidParameter, TriangleMesh};
use mser3d_volumeio::{BodyParameters, LabelName, PlacementParameters, VolumeFormat};
use sha2::{Digest, Sha256};

use crate::{InputRecord, ResultsError, ShapeFormat, SolidVolume, VolumeFile};

/// How a shape is read from a file. By default nothing is chosen or replaced.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShapeOptions {
    /// The format of the file, in place of what its name says.
    pub format: Option<ShapeFormat>,
    /// The frame of a glTF animation, and the limits of reading, which hold for volumes as well.
    pub pose: ReadOptions,
    /// Which voxels of a volume are the body.
    pub body: BodyParameters,
    /// Where a volume lies, in place of what its file says.
    pub placement: PlacementParameters,
    /// Names of labels, in place of the file's own.
    pub label_names: Vec<LabelName>,
}

/// A file with a shape that was read: what a detector takes, and what a record says of it. [`ShapeFile::of_mesh`] and
/// [`VolumeFile::of_volume`] make the same of what is in memory.
///
/// ```no_run
/// use mser3d::{Detector, Domain};
/// use mser3d_meshio::ReadOptions;
/// use mser3d_results::{Results, ShapeFile, ShapeOptions};
///
/// // The fox, half a second into its second animation.
/// let pose = ReadOptions { animation: Some("1".to_owned()), time: 0.5, ..Default::default() };
/// let file = ShapeFile::read("Fox.glb".as_ref(), &ShapeOptions { pose, ..Default::default() })?;
/// let features = Detector::default().detect(file.input(Domain::Volume)?)?;
/// Results::of_file(&features, &file)?.write("fox".as_ref())?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ShapeFile {
    /// The file, or the name of what is in memory.
    pub path: PathBuf,
    /// SHA-256 of the file; none of what was in memory.
    pub sha256: Option<String>,
    /// Its size; none of what was in memory.
    pub bytes: Option<u64>,
    /// The frame of an animation that was read.
    pub pose: ReadOptions,
    /// What it holds.
    pub contents: Contents,
}

/// What a [`ShapeFile`] holds.
#[derive(Clone, Debug)]
pub enum Contents {
    /// A mesh from a file.
    Mesh(Box<LoadedMesh>),
    /// A mesh that was in memory.
    BareMesh(Box<TriangleMesh>),
    /// The body in a volume.
    Volume(Box<SolidVolume>),
}

impl ShapeFile {
    /// Reads a mesh, or the body in a volume; the name's ending says which, if no format is chosen.
    ///
    /// # Errors
    /// [`ResultsError::Mesh`], [`ResultsError::Volume`], [`ResultsError::File`], [`ResultsError::Body`],
    /// [`ResultsError::Placement`], naming the file; [`ResultsError::UnknownFormat`], [`ResultsError::OtherContents`],
    /// [`ResultsError::NoFormat`];
    /// [`ResultsError::NoMesh`] for an animation of a volume, [`ResultsError::NoVolume`] for a label, a threshold or a
    /// place of a mesh.
    pub fn read(path: &Path, options: &ShapeOptions) -> Result<Self, ResultsError> {
        options.pose.validate()?;
        if options.volume_format(path).is_some() {
            if options.pose.animation.is_some() {
                return Err(ResultsError::NoMesh { path: path.to_owned(), option: "--animation" });
            }
            let file = VolumeFile::read(path, options)?.shape(&options.body)?;
            tracing::info!(path = %path.display(), format = file.format(), "read");
            return Ok(file);
        }
        if let Some(option) = options.first_of_volumes() {
            return Err(ResultsError::NoVolume { path: path.to_owned(), option });
        }
        let bytes = read_bytes_within(path, &options.pose.limits, 1)?;
        let sha256 = hex(Sha256::digest(&bytes));
        let format = options.mesh_format(path, &bytes)?;
        let loaded = read_mesh_from(format, &bytes, path, &options.pose)?;
        let (vertices, triangles) = (loaded.mesh.vertices().len(), loaded.mesh.triangles().len());
        tracing::info!(path = %path.display(), %format, vertices, triangles, "read");
        Ok(Self {
            path: path.to_owned(),
            sha256: Some(sha256),
            bytes: Some(bytes.len() as u64),
            pose: options.pose.clone(),
            contents: Contents::Mesh(Box::new(loaded)),
        })
    }

    /// A mesh that is in memory; `name` tells people where it came from.
    ///
    /// # Errors
    /// [`ResultsError::NoVolume`] for a label, a threshold or a place; [`ResultsError::InvalidParameter`] for an animation.
    pub fn of_mesh(mesh: TriangleMesh, name: &str, options: &ShapeOptions) -> Result<Self, ResultsError> {
        let path = PathBuf::from(name);
        if let Some(option) = options.first_of_volumes() {
            return Err(ResultsError::NoVolume { path, option });
        }
        if let Some(animation) = &options.pose.animation {
            let expected = "none: only glTF files have animations";
            return Err(InvalidParameter::new("animation", animation, expected).into());
        }
        let contents = Contents::BareMesh(Box::new(mesh));
        Ok(Self { path, sha256: None, bytes: None, pose: ReadOptions::default(), contents })
    }

    /// The mesh, if it is one.
    pub fn mesh(&self) -> Option<&TriangleMesh> {
        match &self.contents {
            Contents::Mesh(loaded) => Some(&loaded.mesh),
            Contents::BareMesh(mesh) => Some(mesh),
            Contents::Volume(_) => None,
        }
    }

    /// The mesh of a file, and what reading it told.
    pub fn loaded(&self) -> Option<&LoadedMesh> {
        match &self.contents {
            Contents::Mesh(loaded) => Some(loaded),
            Contents::BareMesh(_) | Contents::Volume(_) => None,
        }
    }

    /// The solid of a volume, if it is one.
    pub fn solid(&self) -> Option<&SolidVolume> {
        match &self.contents {
            Contents::Mesh(_) | Contents::BareMesh(_) => None,
            Contents::Volume(solid) => Some(solid),
        }
    }

    /// What reading it said.
    pub fn notes(&self) -> &[String] {
        match &self.contents {
            Contents::Mesh(loaded) => &loaded.notes,
            Contents::BareMesh(_) => &[],
            Contents::Volume(solid) => &solid.notes,
        }
    }

    /// What a detector takes: the solid or the surface of a mesh, or the body in a volume.
    ///
    /// # Errors
    /// [`ResultsError::NoMesh`] for the surface of a volume.
    pub fn input(&self, domain: Domain) -> Result<Input<'_>, ResultsError> {
        match (domain, self.mesh()) {
            (Domain::Volume, _) => Ok(self.volume()),
            (Domain::Surface, Some(mesh)) => Ok(Input::Surface(mesh)),
            (Domain::Surface, None) => {
                Err(ResultsError::NoMesh { path: self.path.clone(), option: "--surface" })
            }
        }
    }

    /// The solid of a mesh, or the body in a volume.
    pub fn volume(&self) -> Input<'_> {
        match &self.contents {
            Contents::Mesh(loaded) => Input::Volume(&loaded.mesh),
            Contents::BareMesh(mesh) => Input::Volume(mesh),
            Contents::Volume(solid) => Input::Solid(&solid.grid),
        }
    }

    /// Its format, in words.
    pub fn format(&self) -> String {
        match &self.contents {
            Contents::Mesh(loaded) => loaded.format.to_string(),
            Contents::BareMesh(_) => "mesh in memory".into(),
            Contents::Volume(solid) => match solid.format {
                Some(format) => format!("{format} mask"),
                None => "mask".into(),
            },
        }
    }

    /// What a record says of it, but for the diagnosis.
    pub fn identity(&self) -> InputRecord {
        InputRecord {
            path: self.path.display().to_string(),
            sha256: self.sha256.clone(),
            mesh_sha256: self.mesh().map(mesh_sha256),
            bytes: self.bytes,
            format: Some(self.format()),
            animation: self.pose.animation.clone(),
            time: self.pose.time,
            volume: self.solid().map(|solid| solid.record.clone()),
            diagnosis: None,
        }
    }

    /// What a record says of it.
    pub fn record(&self) -> InputRecord {
        InputRecord { diagnosis: self.mesh().map(diagnose), ..self.identity() }
    }
}

impl ShapeOptions {
    /// What reading may take, and where a file may lead.
    pub fn limits(&self) -> &ReadLimits {
        &self.pose.limits
    }

    /// The same limits, and nothing chosen or replaced.
    #[must_use]
    pub fn limits_alone(&self) -> Self {
        let limits = self.limits().clone();
        Self { pose: ReadOptions { limits, ..Default::default() }, ..Default::default() }
    }

    /// The format of a volume: what was chosen, or what the name says; none of a mesh.
    pub fn volume_format(&self, path: &Path) -> Option<VolumeFormat> {
        match self.format {
            Some(ShapeFormat::Volume(format)) => Some(format),
            Some(ShapeFormat::Mesh(_)) => None,
            None => VolumeFormat::of(path),
        }
    }

    /// The format of a mesh: what was chosen, or what the name says. Contents that are another one's are an error. Standard
    /// input has no name; there the contents say it.
    fn mesh_format(&self, path: &Path, bytes: &[u8]) -> Result<MeshFormat, ResultsError> {
        let contents = MeshFormat::from_contents(bytes);
        match (self.format, contents) {
            (Some(ShapeFormat::Mesh(given)), Some(contents)) if given != contents => {
                let (path, given) = (path.to_owned(), ShapeFormat::Mesh(given));
                Err(ResultsError::OtherContents { path, given, contents: ShapeFormat::Mesh(contents) })
            }
            (Some(ShapeFormat::Mesh(given)), _) => Ok(given),
            (_, Some(contents)) if path == Path::new(STDIN) => Ok(contents),
            (_, None) if path == Path::new(STDIN) => {
                Err(ResultsError::NoFormat { path: path.to_owned(), choices: ShapeFormat::names() })
            }
            _ => MeshFormat::of(path, bytes).map_err(|error| match error {
                source @ MeshIoError::UnknownFormat { .. } => ResultsError::UnknownFormat { source },
                error => error.into(),
            }),
        }
    }

    /// The first option that is given and that only volumes have.
    fn first_of_volumes(&self) -> Option<&'static str> {
        let options = [
            ("--volume", self.body.volume.is_some()),
            ("--label", self.body.label.is_some()),
            ("--threshold", self.body.threshold.is_some()),
            ("--affine", self.placement.affine.is_some()),
            ("--labels", !self.label_names.is_empty()),
        ];
        options.into_iter().find_map(|(name, given)| given.then_some(name))
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

pub(crate) fn hex(digest: impl AsRef<[u8]>) -> String {
    digest.as_ref().iter().map(|b| format!("{b:02x}")).collect()
}

use mser3d_fileio::abridged;
use std::path::PathBuf;

use thiserror::Error;

/// Why a shape cannot be read, or a result not written, read or drawn.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ResultsError {
    /// The folder holds no result.
    #[error(
        "{}: there is no regions.json, so this is no result; give the folder that `mser3d detect INPUT -o FOLDER` wrote",
        folder.display()
    )]
    NotAResult {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder holds regions of a grey-value volume, which have no descriptors.
    #[error(
        "{}: this is a result of `mser3d msv`, whose regions can be viewed and rendered, but not matched, searched or \
         exported; give the folder that `mser3d detect INPUT -o FOLDER` wrote",
        folder.display()
    )]
    GreyValueResult {
        /// The folder.
        folder: PathBuf,
    },
    /// The eigenfunctions of a result were not kept.
    #[error(
        "{}: there is no eigenfunctions.npz; run `mser3d detect INPUT --write eigenfunctions -o {}` again",
        folder.display(),
        folder.display()
    )]
    NoEigenfunctions {
        /// The result's folder.
        folder: PathBuf,
    },
    /// The result was written in another format.
    #[error(
        "{}: written by mser3d {version} in format {found}, this program reads format {expected}; run `mser3d detect` again",
        path.display()
    )]
    OtherFormat {
        /// The file.
        path: PathBuf,
        /// The version that wrote it.
        version: String,
        /// Its format.
        found: u32,
        /// The format this version reads.
        expected: u32,
    },
    /// A file does not say what it should.
    #[error("{}: {}; run `mser3d detect` again", path.display(), abridged(reason))]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A file is not what was written.
    #[error(
        "{}: damaged: {what}; run again what wrote it (`mser3d detect`, `msv`, `batch` or `track`), or, if it was changed on \
         purpose, remove checksums.json beside it",
        path.display()
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// How that is known.
        what: String,
    },
    /// A folder that another process writes to.
    #[error(
        "{}: another run is writing to this folder; wait until it is done, or choose another with -o",
        folder.display()
    )]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
    /// More memory than there is.
    #[error(
        "{}: {what} needs {bytes} bytes of memory, and {available} are available; use a machine with more",
        path.display()
    )]
    TooLarge {
        /// The file or folder.
        path: PathBuf,
        /// What needs it.
        what: String,
        /// How much.
        bytes: u64,
        /// How much there is.
        available: u64,
    },
    /// The ending belongs to no known format.
    #[error("{source}; of volumes {}", mser3d_volumeio::VolumeFormat::LIST)]
    UnknownFormat {
        /// What the reader of meshes says.
        source: mser3d_meshio::MeshIoError,
    },
    /// The contents are of another format than the chosen one.
    #[error("{}: to be read as {given}, but its contents are {contents}; choose --format {contents}", path.display())]
    OtherContents {
        /// The file.
        path: PathBuf,
        /// The format that was chosen.
        given: crate::ShapeFormat,
        /// The format of the contents.
        contents: crate::ShapeFormat,
    },
    /// Standard input does not show what it is.
    #[error("{}: its first bytes do not tell its format; say it with --format: {choices}", path.display())]
    NoFormat {
        /// What stands for standard input.
        path: PathBuf,
        /// The names of all formats.
        choices: String,
    },
    /// A volume does not say what its body is.
    #[error("{}: {error}", path.display())]
    Body {
        /// The file.
        path: PathBuf,
        /// Why, and what to do.
        #[source]
        error: mser3d_volumeio::BodyError,
    },
    /// The voxels of a volume do not lie on a grid with right angles.
    #[error("{}: {error}", path.display())]
    Placement {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what to do.
        #[source]
        error: mser3d_shape::ShapeError,
    },
    /// A parameter out of range.
    #[error(transparent)]
    InvalidParameter(#[from] mser3d_shape::InvalidParameter),
    /// A weight from a file that does not belong to the shape, or is none.
    #[error("{}: {reason}", path.display())]
    Field {
        /// The file.
        path: PathBuf,
        /// Why, and what is expected.
        reason: String,
    },
    /// Something that only volumes have was asked of a mesh.
    #[error("{}: {option} needs a volume (mask or label map), and this is a mesh", path.display())]
    NoVolume {
        /// The file.
        path: PathBuf,
        /// What was asked for, as an option of the command line.
        option: &'static str,
    },
    /// Parts were to be shown of a shape that was not divided into parts.
    #[error("{path}: this result has no parts; run `mser3d detect` again with --parts auto or --parts N")]
    NoParts {
        /// What was searched.
        path: String,
    },
    /// A label map of results that are not on one grid.
    #[error("the results are not on one grid of voxels, so that no label map can hold them")]
    OtherGrid,
    /// Something that only meshes have was asked of a volume.
    #[error("{}: {option} needs a mesh, and this is a volume", path.display())]
    NoMesh {
        /// The file.
        path: PathBuf,
        /// What was asked for, as an option of the command line.
        option: &'static str,
    },
    /// A folder cannot be written to.
    #[error("{}: cannot be used as output folder: {error}; choose another with -o", path.display())]
    OutputFolder {
        /// The folder.
        path: PathBuf,
        /// Why.
        #[source]
        error: std::io::Error,
    },
    /// A file or folder cannot be read, made or removed.
    #[error("{}: {error}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        #[source]
        error: std::io::Error,
    },
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] mser3d_fileio::FileError),
    /// A mesh cannot be read or written.
    #[error(transparent)]
    Mesh(#[from] mser3d_meshio::MeshIoError),
    /// A volume cannot be read or written.
    #[error(transparent)]
    Volume(#[from] mser3d_volumeio::VolumeIoError),
    /// A picture or page cannot be made.
    #[error(transparent)]
    Viewer(#[from] mser3d_viewer::ViewerError),
    /// A grey-value volume in which nothing was found.
    #[error(
        "{volume}: no maximally stable regions were found in it, so there is nothing to show; search again with a \
         smaller --delta or a larger --max-variation"
    )]
    NoRegions {
        /// The volume.
        volume: String,
    },
    /// Dark or bright regions of colours.
    #[error("{}: dark and bright need one grey value a voxel; colours have no order", path.display())]
    NoOrder {
        /// The volume.
        path: PathBuf,
    },
    /// Signatures cannot be computed.
    #[error("{0}")]
    Signatures(#[source] Box<mser3d::Error>),
    /// The tree of a large shape cannot be made anew.
    #[error("{0}")]
    TreeOfFeatures(#[source] Box<mser3d::Error>),
    /// Maximally stable volumes cannot be searched.
    #[error(transparent)]
    Tree(#[from] mser3d::comptree::TreeError),
    /// A file of that name cannot be exported.
    #[error("{}: {reason}", path.display())]
    Export {
        /// The file.
        path: PathBuf,
        /// Why, and what to do.
        reason: &'static str,
    },
    /// The mesh is not the one that the features were found on.
    #[error("the mesh has {found} vertices, but the features were found on one of {expected}; give that one")]
    OtherMesh {
        /// Vertices of the mesh.
        found: usize,
        /// Vertices of the mesh the features belong to.
        expected: usize,
    },
    /// The voxels that places of the surface see cannot be found.
    #[error(transparent)]
    Sight(#[from] mser3d::Error),
    /// A shape cannot be put together.
    #[error(transparent)]
    Shape(#[from] mser3d_shape::ShapeError),
}

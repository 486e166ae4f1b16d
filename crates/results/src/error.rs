use std::path::PathBuf;

use thiserror::Error;

/// Why a result cannot be written, read or drawn.
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
        found: u64,
        /// The format this version reads.
        expected: u64,
    },
    /// A file does not say what it should.
    #[error("{}: {reason}; run `mser3d detect` again", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A file or folder cannot be read or made.
    #[error("{}: {error}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        #[source]
        error: std::io::Error,
    },
    /// A mesh or an array cannot be read or written.
    #[error(transparent)]
    File(#[from] mser3d_meshio::MeshIoError),
    /// A picture or page cannot be made.
    #[error(transparent)]
    Viewer(#[from] mser3d_viewer::ViewerError),
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
    /// A shape cannot be put together.
    #[error(transparent)]
    Shape(#[from] mser3d_shape::ShapeError),
}

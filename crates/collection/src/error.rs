use std::path::PathBuf;

use thiserror::Error;

/// Why results cannot be compared, collected or searched.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CollectionError {
    /// A result cannot be read.
    #[error(transparent)]
    Results(#[from] mser3d_results::ResultsError),
    /// A stage of the search failed.
    #[error(transparent)]
    Detect(#[from] mser3d::Error),
    /// A shape has no regions to compare.
    #[error(
        "{}: this shape has no regions, so there is nothing to compare; detect with a smaller --min-volume or --window",
        folder.display()
    )]
    NoRegions {
        /// The result's folder.
        folder: PathBuf,
    },
    /// Descriptors that do not measure the same.
    #[error(
        "{} and {}: descriptors of different settings cannot be compared: {what}; detect one of them again with the settings of the other",
        first.display(),
        second.display()
    )]
    DifferentDescriptors {
        /// One result or collection.
        first: PathBuf,
        /// The other.
        second: PathBuf,
        /// What differs.
        what: String,
    },
    /// Two shapes said to have the same vertices have not.
    #[error(
        "{} has {first_vertices} vertices and {} has {second_vertices}, so vertex i of one is not vertex i of the other; leave out the ground truth",
        first.display(),
        second.display()
    )]
    OtherVertices {
        /// One result.
        first: PathBuf,
        /// Its vertices.
        first_vertices: usize,
        /// The other result.
        second: PathBuf,
        /// Its vertices.
        second_vertices: usize,
    },
    /// No map can be made between the vertices of two shapes.
    #[error("{} and {}: no map between them: {reason}", first.display(), second.display())]
    NoMap {
        /// One result.
        first: PathBuf,
        /// The other.
        second: PathBuf,
        /// Why, and what to do.
        reason: String,
    },
    /// A parameter is out of range.
    #[error(transparent)]
    InvalidParameter(#[from] mser3d_shape::InvalidParameter),
    /// A parameter of the matching is out of range, or descriptors do not fit together.
    #[error(transparent)]
    Descriptors(#[from] mser3d::descriptors::DescriptorError),
    /// A ground truth cannot be read or does not fit.
    #[error(transparent)]
    GroundTruth(#[from] mser3d_evaluation::EvaluationError),
    /// An input names no shape.
    #[error("{input}: {problem}")]
    Input {
        /// The input as it was given.
        input: String,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// An animated file cannot be read.
    #[error(transparent)]
    Mesh(#[from] mser3d_meshio::MeshIoError),
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] mser3d_fileio::FileError),
    /// The detector's progress function asked to stop.
    #[error("cancelled; run again to go on")]
    Cancelled,
    /// Another process writes to the collection.
    #[error(
        "{}: another batch is writing to this collection{part}; wait until it is done, or give another folder",
        folder.display()
    )]
    Busy {
        /// The collection.
        folder: PathBuf,
        /// Which part of it.
        part: String,
    },
    /// A folder is no collection, or none that is finished.
    #[error("{}: {problem}", folder.display())]
    NotACollection {
        /// The folder.
        folder: PathBuf,
        /// What is missing, and what to do.
        problem: String,
    },
    /// A page would be too large to be sent and opened.
    #[error(
        "the page would have {bytes} bytes, more than {limit}, for its {pictures} pictures; ask for fewer (-k), or \
         for one region (--region)"
    )]
    LargePage {
        /// Bytes of the page.
        bytes: usize,
        /// How many there may be.
        limit: usize,
        /// Pictures on it.
        pictures: usize,
    },
    /// A page of a sequence would be too large to be sent and opened.
    #[error(
        "a page of two frames would have {bytes} bytes, more than {limit}; track meshes of fewer vertices, or leave out --html"
    )]
    LargeSequence {
        /// Bytes of the page.
        bytes: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A table cannot be written or read.
    #[error("{}: {reason}", path.display())]
    Table {
        /// The table.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A file or folder cannot be read, made or renamed.
    #[error("{}: {error}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        #[source]
        error: std::io::Error,
    },
}

impl CollectionError {
    pub(crate) fn io(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        |error| Self::Io { path, error }
    }
}

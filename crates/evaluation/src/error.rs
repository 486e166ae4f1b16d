use std::path::PathBuf;

use thiserror::Error;

/// Why regions cannot be compared, or a benchmark cannot be read, made or scored.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum EvaluationError {
    /// Two things that belong together differ in size.
    #[error("{what}: {found} given, {expected} needed")]
    SizeMismatch {
        /// What is wrong.
        what: &'static str,
        /// Its size.
        found: usize,
        /// The size it should have.
        expected: usize,
    },
    /// A number names a vertex or triangle that is not there.
    #[error("{what} {number} names {index}, but there are only {count} (numbered from 0)")]
    OutOfRange {
        /// What names it.
        what: &'static str,
        /// Which one of these, from 0.
        number: usize,
        /// What it names.
        index: u64,
        /// How many there are.
        count: usize,
    },
    /// A coordinate, a weight or a descriptor is NaN or infinite.
    #[error("{what} {number} is not finite")]
    NotFinite {
        /// What is wrong.
        what: &'static str,
        /// Which one, from 0.
        number: usize,
    },
    /// A strength, a threshold or another parameter that is out of its range.
    #[error(transparent)]
    InvalidParameter(#[from] mser3d_shape::InvalidParameter),
    /// An isometry was asked without a pose.
    #[error("an isometry is another pose of the null shape: give a mesh with the same triangles")]
    PoseNeeded,
    /// Nothing to transform, or nothing left of it.
    #[error("{class}: the mesh has no surface, or none would be left of it")]
    NoSurface {
        /// The class of the transform.
        class: crate::shrec::Class,
    },
    /// A transformed mesh that is none.
    #[error(transparent)]
    Shape(#[from] mser3d_shape::ShapeError),
    /// A mesh that cannot be rasterized.
    #[error(transparent)]
    Voxelize(#[from] mser3d_voxelize::VoxelizeError),
    /// A text that cannot be written.
    #[error(transparent)]
    File(#[from] mser3d_fileio::FileError),
    /// A mesh file that cannot be read.
    #[error(transparent)]
    Mesh(#[from] mser3d_meshio::MeshIoError),
    /// A file or folder that cannot be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file or folder that cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file with something wrong in one line.
    #[error("{}:{line}: {problem}", path.display())]
    BadLine {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        problem: String,
    },
    /// A file that is not what it should be.
    #[error("{}: {problem}", path.display())]
    BadFile {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// A folder without shapes.
    #[error("{}: no shapes; the benchmark's are named NNNN.<class>.<strength>.off, the first one 0001.null.0.off", folder.display())]
    NoShapes {
        /// The folder.
        folder: PathBuf,
    },
}

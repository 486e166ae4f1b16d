use std::io::Write;
use std::path::{Path, PathBuf};

use mser3d::voxelize::VoxelizeError;
use mser3d::{Deadline, DeadlinePassed};
use mser3d_collection::CollectionError;
use mser3d_results::ResultsError;
use mser3d_viewer::ViewerError;
use mser3d_volumeio::BodyError;

use crate::message::shown;

/// Why a command failed. Displayed as one line on stderr.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CliError {
    /// Arguments that contradict each other or are out of range: exit code 2.
    #[error("{0}")]
    Usage(String),
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] mser3d_fileio::FileError),
    /// A volume cannot be read or written.
    #[error(transparent)]
    Volume(#[from] mser3d_volumeio::VolumeIoError),
    /// Many shapes, or a collection of results.
    #[error(transparent)]
    Collection(#[from] CollectionError),
    /// A shape cannot be read, or a result not read, written or drawn.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// A shape in which nothing could be searched.
    #[error("{}: {source}{}", path.display(), advice(source))]
    Shape {
        /// The file.
        path: PathBuf,
        /// Why.
        source: mser3d::Error,
    },
    /// The work on a file would take more memory than it is allowed.
    #[error(
        "{}: {what} takes about {needed_mb} MB of memory, more than the limit of {limit_mb} MB; if that is meant, raise \
         --memory-limit", path.display()
    )]
    MemoryLimit {
        /// The file.
        path: PathBuf,
        /// The work.
        what: String,
        /// What it would take.
        needed_mb: u64,
        /// The limit.
        limit_mb: u64,
    },
    /// The work on a file was not done in time.
    #[error("{}: {source}", path.display())]
    TimeLimit {
        /// The file.
        path: PathBuf,
        /// The limit, and what to do.
        source: DeadlinePassed,
    },
    /// The user asked to stop.
    #[error("interrupted; nothing was written")]
    Interrupted,
    /// A batch went through, but not with all shapes.
    #[error("{0}")]
    Incomplete(String),
    /// Standard output cannot be written to.
    #[error("standard output: {0}")]
    Stdout(std::io::Error),
}

/// What the command line can do about an error of the library.
fn advice(error: &mser3d::Error) -> &'static str {
    match error {
        mser3d::Error::Voxelize(VoxelizeError::NoVolume { .. }) => {
            ", or search the surface alone (--surface)"
        }
        mser3d::Error::Voxelize(VoxelizeError::Soup { .. }) => ": --inside vote",
        _ => "",
    }
}

impl CliError {
    /// Why there are no features of a file.
    pub fn detection(path: &Path, source: mser3d::Error) -> Self {
        match source {
            mser3d::Error::Cancelled => Self::Interrupted,
            source => Self::Shape { path: path.to_owned(), source },
        }
    }

    /// An error when the deadline of the work on a file has passed.
    pub(crate) fn in_time(deadline: &Deadline, path: &Path) -> Result<(), Self> {
        deadline.check().map_err(|source| Self::TimeLimit { path: path.to_owned(), source })
    }

    /// What [`main`](crate::main) returns of it.
    pub fn exit_code(&self) -> u8 {
        let wrong_use = match self {
            Self::Usage(_) => true,
            Self::Results(ResultsError::Body { error, .. }) => !matches!(error, BodyError::Empty { .. }),
            Self::Results(error) => matches!(
                error,
                ResultsError::Viewer(ViewerError::InvalidParameter(_))
                    | ResultsError::Export { .. }
                    | ResultsError::NoMesh { .. }
                    | ResultsError::NoOrder { .. }
                    | ResultsError::NoVolume { .. }
                    | ResultsError::InvalidParameter(_)
            ),
            Self::Collection(error) => matches!(
                error,
                CollectionError::InvalidParameter(_)
                    | CollectionError::GroundTruth(mser3d_evaluation::EvaluationError::InvalidParameter(_))
            ),
            _ => false,
        };
        match self {
            // As shells report a program that ended by SIGINT.
            Self::Interrupted | Self::Collection(CollectionError::Cancelled) => 130,
            _ if wrong_use => 2,
            _ => 1,
        }
    }
}

/// Writes to standard output, as it may be shown.
pub fn print(text: &str) -> Result<(), CliError> {
    std::io::stdout().lock().write_all(shown(text).as_bytes()).map_err(CliError::Stdout)
}

/// Writes a value to standard output as JSON.
pub fn print_json(value: &impl serde::Serialize) -> Result<(), CliError> {
    let text = serde_json::to_string_pretty(value).map_err(|e| CliError::Stdout(e.into()))?;
    print(&(text + "\n"))
}

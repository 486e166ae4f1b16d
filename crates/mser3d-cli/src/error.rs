use std::path::PathBuf;
use std::process::ExitCode;

use mser3d::voxelize::VoxelizeError;
use mser3d_collection::CollectionError;
use mser3d_results::ResultsError;
use mser3d_viewer::ViewerError;

/// Why a command failed. Displayed as one line on stderr.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// Arguments that contradict each other or are out of range: exit code 2.
    #[error("{0}")]
    Usage(String),
    #[error(transparent)]
    File(#[from] mser3d_meshio::MeshIoError),
    #[error(transparent)]
    Volume(#[from] mser3d_volumeio::VolumeIoError),
    #[error(transparent)]
    Collection(#[from] CollectionError),
    #[error(transparent)]
    Results(#[from] mser3d_results::ResultsError),
    #[error("{}: {source}{}", path.display(), advice(source))]
    Shape { path: PathBuf, source: mser3d::Error },
    #[error("{}: the mask is zero everywhere: there is no solid", path.display())]
    EmptyMask { path: PathBuf },
    #[error("{}: cannot be used as output folder: {source}; choose another with -o", path.display())]
    OutputFolder { path: PathBuf, source: std::io::Error },
    #[error("interrupted; nothing was written")]
    Interrupted,
    /// A batch went through, but not with all shapes.
    #[error("{0}")]
    Incomplete(String),
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
    pub fn exit_code(&self) -> ExitCode {
        let wrong_option = |e: &ResultsError| {
            matches!(e, ResultsError::Viewer(ViewerError::BadOption { .. }) | ResultsError::Export { .. })
        };
        let wrong_use = match self {
            Self::Usage(_) => true,
            Self::Results(error) => wrong_option(error),
            Self::Collection(error) => matches!(error, CollectionError::BadParameter { .. }),
            _ => false,
        };
        ExitCode::from(match self {
            // As shells report a program that ended by SIGINT.
            Self::Interrupted => 130,
            _ if wrong_use => 2,
            _ => 1,
        })
    }
}

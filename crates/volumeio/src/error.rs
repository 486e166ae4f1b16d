use crate::VolumeFormat;
use mser3d_fileio::{FileError, OverLimit, abridged};
use std::path::{Path, PathBuf};

/// Why a volume could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VolumeIoError {
    /// The extension belongs to no known format.
    #[error("{}: unknown file extension for a volume; known are {}", path.display(), VolumeFormat::LIST)]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The contents break the format's rules, or hold no usable volume.
    #[error("{}: {reason}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What is wrong and what to do.
        reason: String,
    },
    /// The contents are legal, but of a variant that is not read or cannot be written.
    #[error("{}: {reason}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What is not supported and what to do.
        reason: String,
    },
    /// The parts of a volume do not fit together.
    #[error("{reason}")]
    InvalidVolume {
        /// What is wrong.
        reason: String,
    },
    /// The operating system refused to read or to write, a file is over the limits of reading, or a NumPy file is broken.
    #[error(transparent)]
    File(#[from] FileError),
}

/// What a parser finds wrong, before the path is known.
#[derive(Debug)]
pub(crate) enum Fault {
    Io(std::io::Error),
    Invalid(String),
    Unsupported(String),
    OverLimit(OverLimit),
}

impl Fault {
    pub fn invalid(reason: impl Into<String>) -> Self {
        Self::Invalid(reason.into())
    }

    pub fn unsupported(reason: impl Into<String>) -> Self {
        Self::Unsupported(reason.into())
    }

    /// What is wrong in a file that another one names.
    pub fn of_part(self, part: &Path) -> Self {
        let name = part.file_name().unwrap_or_default().to_string_lossy();
        match self {
            Self::Io(error) => Self::Invalid(format!("its data file {name} cannot be read: {error}")),
            Self::Invalid(reason) => Self::Invalid(format!("its data file {name}: {reason}")),
            Self::Unsupported(reason) => Self::Unsupported(format!("its data file {name}: {reason}")),
            Self::OverLimit(over) => Self::OverLimit(over),
        }
    }

    pub fn in_file(self, path: &Path) -> VolumeIoError {
        let path = path.to_path_buf();
        match self {
            Self::Io(source) => VolumeIoError::File(FileError::Read { path, source }),
            Self::Invalid(reason) => VolumeIoError::Invalid { path, reason: abridged(&reason) },
            Self::Unsupported(reason) => VolumeIoError::Unsupported { path, reason: abridged(&reason) },
            Self::OverLimit(source) => VolumeIoError::File(FileError::OverLimit { path, source }),
        }
    }
}

impl From<OverLimit> for Fault {
    fn from(over: OverLimit) -> Self {
        Self::OverLimit(over)
    }
}

/// Bytes that cannot be unpacked are the file's fault.
impl From<std::io::Error> for Fault {
    fn from(error: std::io::Error) -> Self {
        use std::io::ErrorKind::{InvalidData, InvalidInput, UnexpectedEof};
        match error.kind() {
            UnexpectedEof => Self::invalid("the file ends too early; copy or export it again"),
            InvalidData | InvalidInput => Self::invalid(format!("damaged data: {error}")),
            _ => Self::Io(error),
        }
    }
}

impl From<mser3d_shape::ShapeError> for Fault {
    fn from(error: mser3d_shape::ShapeError) -> Self {
        Self::invalid(error.to_string())
    }
}

impl From<VolumeIoError> for Fault {
    fn from(error: VolumeIoError) -> Self {
        Self::invalid(error.to_string())
    }
}

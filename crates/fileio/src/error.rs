use crate::OverLimit;
use std::path::{Path, PathBuf};

/// Why a file could not be read or written. Each message names the file and says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The operating system refused to read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// It declares or holds more than the limits of reading allow; refused before memory is taken.
    #[error("{}: {source}", path.display())]
    OverLimit {
        /// The file.
        path: PathBuf,
        /// What it declares, the limit, and what to do.
        source: OverLimit,
    },
    /// The operating system refused to write; nothing was left behind.
    #[error("{}: cannot be written: {source}; check that the folder exists, is writable and has room", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The contents break the format's rules.
    #[error("{}: {reason}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What is wrong and what to do.
        reason: String,
    },
    /// The contents are legal, but of a variant that is not read.
    #[error("{}: {reason}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What is not supported and what to do.
        reason: String,
    },
    /// The shape of an array does not fit the number of its values.
    #[error("array: {reason}")]
    InvalidArray {
        /// What is wrong.
        reason: String,
    },
}

/// What a parser finds wrong, before the path is known.
#[derive(Debug)]
pub(crate) enum Fault {
    Invalid(String),
    Unsupported(String),
}

impl Fault {
    pub(crate) fn invalid(reason: impl Into<String>) -> Self {
        Self::Invalid(reason.into())
    }

    pub(crate) fn unsupported(reason: impl Into<String>) -> Self {
        Self::Unsupported(reason.into())
    }

    pub(crate) fn into_reason(self) -> String {
        match self {
            Self::Invalid(reason) | Self::Unsupported(reason) => reason,
        }
    }

    pub(crate) fn in_file(self, path: &Path) -> FileError {
        let path = path.to_path_buf();
        match self {
            Self::Invalid(reason) => FileError::Invalid { path, reason: abridged(&reason) },
            Self::Unsupported(reason) => FileError::Unsupported { path, reason: abridged(&reason) },
        }
    }
}

/// What is wrong with a file, without the middle of what it quotes from the file if that is long.
///
/// ```
/// let reason = format!("{:?} is not a number", "a".repeat(10_000));
/// let short = mser3d_fileio::abridged(&reason);
/// assert!(short.len() < 700 && short.starts_with("\"aaa") && short.ends_with("aaa\" is not a number"));
/// assert_eq!(mser3d_fileio::abridged("\"x\" is not a number"), "\"x\" is not a number");
/// ```
pub fn abridged(reason: &str) -> String {
    const KEPT: [usize; 2] = [300, 250];
    let length = reason.chars().count();
    if length <= KEPT[0] + KEPT[1] {
        return reason.to_owned();
    }
    let start: String = reason.chars().take(KEPT[0]).collect();
    let end: String = reason.chars().skip(length - KEPT[1]).collect();
    format!("{start} ... ({} more characters) ... {end}", length - KEPT[0] - KEPT[1])
}

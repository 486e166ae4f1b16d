use crate::{AnimationInfo, MeshFormat};
use mser3d_fileio::{FileError, OverLimit, abridged};
use mser3d_shape::{InvalidParameter, ShapeError};
use std::fmt;
use std::path::{Path, PathBuf};

/// Why a file could not be read or written. Each message names the file, the line where there is
/// one, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshIoError {
    /// The operating system refused to read or to write, or the file is over the limits of reading.
    #[error(transparent)]
    File(#[from] FileError),
    /// The extension belongs to no known format.
    #[error(
        "{}: unknown file extension{}; known are {}", path.display(), Guess(path, *contents), MeshFormat::LIST
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// What its contents look like.
        contents: Option<MeshFormat>,
    },
    /// The extension says one format, the contents another.
    #[error(
        "{}: named as {extension}, but its contents are {contents}; rename it to .{}{}",
        path.display(), contents.extension(), Packed(path)
    )]
    WrongExtension {
        /// The file.
        path: PathBuf,
        /// The format its name promises.
        extension: MeshFormat,
        /// The format it has.
        contents: MeshFormat,
    },
    /// The contents break the format's rules, or hold no usable mesh.
    #[error("{}{}: {reason}", path.display(), Line(*line))]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Line number, from 1, in formats made of lines.
        line: Option<usize>,
        /// What is wrong and what to do.
        reason: String,
    },
    /// The contents are legal, but of a variant that is not read or that the format cannot hold.
    #[error("{}{}: {reason}", path.display(), Line(*line))]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// Line number, from 1, in formats made of lines.
        line: Option<usize>,
        /// What is not supported and what to do.
        reason: String,
    },
    /// The animation asked for is not in the file.
    #[error("{}: no animation {wanted:?}; {}", path.display(), Available(available))]
    NoAnimation {
        /// The file.
        path: PathBuf,
        /// The name or number asked for.
        wanted: String,
        /// The animations that are there.
        available: Vec<AnimationInfo>,
    },
    /// The time asked for is beyond the end of the animation.
    #[error(
        "{}: animation {animation} ends at {} s, before the time asked for, {time} s; choose a time from 0 to its end",
        path.display(), animation.end
    )]
    BeyondAnimation {
        /// The file.
        path: PathBuf,
        /// The animation.
        animation: AnimationInfo,
        /// The time asked for, in seconds.
        time: f64,
    },
    /// A parameter is out of its range.
    #[error(transparent)]
    InvalidParameter(#[from] InvalidParameter),
    /// An array does not have one value for each vertex or voxel.
    #[error(transparent)]
    Shape(#[from] ShapeError),
}

struct Line(Option<usize>);

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.0.map_or(Ok(()), |line| write!(f, ":{line}"))
    }
}

/// `.gz` for a file that is named so.
struct Packed<'a>(&'a Path);

impl fmt::Display for Packed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(if MeshFormat::is_named_packed(self.0) { ".gz" } else { "" })
    }
}

struct Guess<'a>(&'a Path, Option<MeshFormat>);

impl fmt::Display for Guess<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.1.map_or(Ok(()), |format| {
            let (extension, packed) = (format.extension(), Packed(self.0));
            write!(f, " (the contents look like {format}: rename it to .{extension}{packed})")
        })
    }
}

struct Available<'a>(&'a [AnimationInfo]);

impl fmt::Display for Available<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str("the file has no animations");
        }
        f.write_str("choose by name or number from")?;
        for (i, info) in self.0.iter().enumerate() {
            write!(f, "{} {info}", if i == 0 { "" } else { "," })?;
        }
        Ok(())
    }
}

impl From<OverLimit> for Fault {
    fn from(over: OverLimit) -> Self {
        Self { over: Some(over.clone()), ..Self::new(over.to_string()) }
    }
}

/// What a parser finds wrong, before the path is known.
#[derive(Debug)]
pub(crate) struct Fault {
    line: Option<usize>,
    unsupported: bool,
    over: Option<OverLimit>,
    reason: String,
}

impl Fault {
    pub(crate) fn new(reason: impl Into<String>) -> Self {
        Self { line: None, unsupported: false, over: None, reason: reason.into() }
    }

    pub(crate) fn at(line: usize, reason: impl Into<String>) -> Self {
        Self { line: Some(line), ..Self::new(reason) }
    }

    pub(crate) fn unsupported(line: Option<usize>, reason: impl Into<String>) -> Self {
        Self { line, unsupported: true, over: None, reason: reason.into() }
    }

    /// The same, with what to do about it; faults of what is not supported say so themselves.
    pub(crate) fn advise(mut self, advice: &str) -> Self {
        if !self.unsupported {
            self.reason = format!("{}; {advice}", self.reason);
        }
        self
    }

    /// The same, with the part of the file that it is about.
    pub(crate) fn within(mut self, what: &str) -> Self {
        self.reason = format!("{what}: {}", self.reason);
        self
    }

    pub(crate) fn line(&self) -> Option<usize> {
        self.line
    }

    pub(crate) fn into_reason(self) -> String {
        self.reason
    }

    pub(crate) fn in_file(self, path: &Path) -> MeshIoError {
        let Self { line, unsupported, over, reason } = self;
        let (path, reason) = (path.to_path_buf(), abridged(&reason));
        if let Some(source) = over {
            return FileError::OverLimit { path, source }.into();
        }
        match unsupported {
            true => MeshIoError::Unsupported { path, line, reason },
            false => MeshIoError::Invalid { path, line, reason },
        }
    }
}

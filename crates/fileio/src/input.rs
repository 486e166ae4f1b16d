//! Files that are opened to be read: regular ones, and standard input where the program has taken it.

use std::fs::{File, FileType};
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::OnceLock;

use crate::FileError;

/// The path that stands for what [`take_stdin`] read.
pub const STDIN: &str = "/dev/stdin";

static TAKEN: OnceLock<Vec<u8>> = OnceLock::new();

/// Reads standard input to its end. From now on [`STDIN`] is a file that holds this, for all readers and as often as they like.
///
/// # Errors
/// [`FileError::Read`]: also for more bytes than `limit`, before they take memory, and when it was taken before.
pub fn take_stdin(limit: u64) -> Result<(), FileError> {
    let fail = |source| FileError::Read { path: STDIN.into(), source };
    let mut bytes = Vec::new();
    io::stdin().lock().take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(fail)?;
    if bytes.len() as u64 > limit {
        let why = format!("it has more than the {limit} bytes that there is memory for; give a file");
        return Err(fail(io::Error::other(why)));
    }
    TAKEN.set(bytes).map_err(|_| fail(io::Error::other("it was read before")))
}

/// A file that is open to be read.
#[derive(Debug)]
pub enum InputFile {
    /// A regular file.
    Regular(File),
    /// Standard input.
    Stdin(Cursor<&'static [u8]>),
}

impl InputFile {
    /// Opens a regular file, or what [`take_stdin`] read. Pipes and devices are refused: to read them may take for ever, and
    /// they can be read only once.
    ///
    /// # Errors
    /// Those of the system, and what the path is if it is no regular file.
    pub fn open(path: &Path) -> io::Result<Self> {
        if let (true, Some(bytes)) = (path == Path::new(STDIN), TAKEN.get()) {
            return Ok(Self::Stdin(Cursor::new(bytes)));
        }
        // Before it is opened, which may take for ever too.
        let kind = std::fs::metadata(path)?.file_type();
        if kind.is_file() {
            return Ok(Self::Regular(File::open(path)?));
        }
        Err(io::Error::new(io::ErrorKind::InvalidInput, irregular(kind)))
    }

    /// All bytes of a file, which is [opened](Self::open).
    ///
    /// # Errors
    /// As [`InputFile::open`].
    pub fn read_all(path: &Path) -> io::Result<Vec<u8>> {
        let mut file = Self::open(path)?;
        let mut bytes = Vec::with_capacity(file.size()?.try_into().unwrap_or(0));
        file.read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    /// Its size in bytes.
    ///
    /// # Errors
    /// Those of the system.
    pub fn size(&self) -> io::Result<u64> {
        match self {
            Self::Regular(file) => Ok(file.metadata()?.len()),
            Self::Stdin(bytes) => Ok(bytes.get_ref().len() as u64),
        }
    }
}

/// What something is that is no regular file.
fn irregular(kind: FileType) -> &'static str {
    if kind.is_dir() {
        return "it is a folder; name a file in it";
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if kind.is_fifo() {
            return "it is a pipe and no file; have its contents piped in, and name - as the input";
        }
        if kind.is_socket() {
            return "it is a socket and no file";
        }
    }
    "it is a device and no file"
}

impl Read for InputFile {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Regular(file) => file.read(buffer),
            Self::Stdin(bytes) => bytes.read(buffer),
        }
    }
}

impl Seek for InputFile {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        match self {
            Self::Regular(file) => file.seek(position),
            Self::Stdin(bytes) => bytes.seek(position),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn only_regular_files_are_opened() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let socket = folder.path().join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        let cases = [
            (pipe.as_path(), "it is a pipe and no file"),
            (socket.as_path(), "it is a socket and no file"),
            (folder.path(), "it is a folder"),
            (Path::new("/dev/zero"), "it is a device and no file"),
            (Path::new("/nowhere"), "No such file"),
        ];
        for (path, why) in cases {
            let error = InputFile::open(path).unwrap_err().to_string();
            assert!(error.starts_with(why), "{}: {error}", path.display());
            let error = crate::read_bytes(path).unwrap_err().to_string();
            assert!(error.contains(why) && error.contains(&*path.to_string_lossy()), "{error}");
        }
        std::fs::write(folder.path().join("file"), "abc").unwrap();
        std::os::unix::fs::symlink("file", folder.path().join("link")).unwrap();
        let mut file = InputFile::open(&folder.path().join("link")).unwrap();
        assert_eq!(file.size().unwrap(), 3);
        let mut text = String::new();
        file.seek(SeekFrom::Start(1)).unwrap();
        file.read_to_string(&mut text).unwrap();
        assert_eq!(text, "bc");
    }
}

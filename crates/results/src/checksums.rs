//! What `checksums.json` says: the size and the SHA-256 of each file of a folder.

use std::collections::BTreeMap;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use mser3d_fileio::{InputFile, write_text};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::ResultsError;
use crate::beside::beside;

/// What `checksums.json` says: the size and the SHA-256 of each file that was written with it. Its JSON Schema is
/// `docs/checksums.schema.json`.
///
/// Whoever reads a file of a folder checks it first. A file that is not listed, as of a folder of an earlier version or one
/// that was put there later, is not checked.
///
/// ```
/// use mser3d_results::Checksums;
/// # let folder = std::env::temp_dir().join(format!("mser3d-checksums-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// std::fs::write(folder.join("a.csv"), "region,volume\n")?;
/// Checksums::of(&folder, &["a.csv"])?.write(&folder)?;
/// let listed = Checksums::load(&folder)?;
/// assert!(listed.check(&folder, "a.csv").is_ok());
/// std::fs::write(folder.join("a.csv"), "region;volume\n")?;
/// assert!(listed.check(&folder, "a.csv").is_err());
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Checksums {
    /// The files by name, without those in folders and without `checksums.json` itself.
    pub files: BTreeMap<String, FileChecksum>,
}

/// What is known of a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FileChecksum {
    /// Its size.
    pub bytes: u64,
    /// The SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
}

impl FileChecksum {
    fn of(path: &Path) -> std::io::Result<Self> {
        let mut file = InputFile::open(path)?;
        let mut hash = Sha256::new();
        let mut buffer = vec![0; 1 << 18];
        let mut bytes = 0;
        loop {
            match file.read(&mut buffer) {
                Ok(0) => break,
                Ok(count) => {
                    hash.update(&buffer[..count]);
                    bytes += count as u64;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(Self { bytes, sha256: hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect() })
    }
}

impl Checksums {
    /// The name of the file.
    pub const FILE: &'static str = "checksums.json";

    /// Of these files of a folder.
    ///
    /// # Errors
    /// [`ResultsError::Io`] for a file that cannot be read.
    pub fn of(folder: &Path, names: &[impl AsRef<str> + Sync]) -> Result<Self, ResultsError> {
        let of = |name: &str| -> Result<_, ResultsError> {
            let path = folder.join(name);
            let sum = FileChecksum::of(&path).map_err(|error| ResultsError::Io { path, error })?;
            Ok((name.to_owned(), sum))
        };
        let files = beside(names, |name| of(name.as_ref()));
        Ok(Self { files: files.into_iter().collect::<Result<_, _>>()? })
    }

    /// Reads the file in a folder; where there is none, nothing is listed.
    ///
    /// # Errors
    /// [`ResultsError::Io`], [`ResultsError::Broken`].
    pub fn load(folder: &Path) -> Result<Self, ResultsError> {
        let path = folder.join(Self::FILE);
        let text = match std::fs::read(&path) {
            Err(error) if [ErrorKind::NotFound, ErrorKind::NotADirectory].contains(&error.kind()) => {
                return Ok(Self::default());
            }
            text => text.map_err(|error| ResultsError::Io { path: path.clone(), error })?,
        };
        let broken = |reason: String| ResultsError::Broken { path: path.clone(), reason };
        let read: Self = serde_json::from_slice(&text).map_err(|e| broken(e.to_string()))?;
        let plain = |name: &str| Path::new(name).file_name().is_some_and(|own| own == name);
        match read.files.keys().find(|name| !plain(name)) {
            Some(name) => Err(broken(format!("{name:?} is no name of a file of this folder"))),
            None => Ok(read),
        }
    }

    /// Writes the file into a folder.
    ///
    /// # Errors
    /// [`ResultsError::File`].
    pub fn write(&self, folder: &Path) -> Result<(), ResultsError> {
        let path = folder.join(Self::FILE);
        let json = serde_json::to_string_pretty(self);
        let json = json.map_err(|error| ResultsError::Io { path: path.clone(), error: error.into() })?;
        Ok(write_text(&path, &(json + "\n"))?)
    }

    /// Takes these files of a folder into its `checksums.json`, which is made if it is not there.
    ///
    /// # Errors
    /// [`ResultsError::Io`], [`ResultsError::Broken`], [`ResultsError::File`].
    pub fn add(folder: &Path, names: &[impl AsRef<str> + Sync]) -> Result<(), ResultsError> {
        let mut all = Self::load(folder)?;
        all.files.extend(Self::of(folder, names)?.files);
        all.write(folder)
    }

    /// Takes these files out of a folder's `checksums.json`, because they are about to change. Without any file left it goes.
    ///
    /// # Errors
    /// [`ResultsError::Io`], [`ResultsError::File`].
    pub fn forget(folder: &Path, names: &[impl AsRef<str>]) -> Result<(), ResultsError> {
        let path = folder.join(Self::FILE);
        if !path.is_file() {
            return Ok(());
        }
        // One that cannot be read vouches for nothing.
        let mut all = Self::load(folder).unwrap_or_default();
        let known = all.files.len();
        names.iter().for_each(|name| drop(all.files.remove(name.as_ref())));
        match (all.files.is_empty(), all.files.len() == known) {
            // Another thread or process may have been quicker.
            (true, _) => match std::fs::remove_file(&path) {
                Err(error) if error.kind() != ErrorKind::NotFound => Err(ResultsError::Io { path, error }),
                _ => Ok(()),
            },
            (false, true) => Ok(()),
            (false, false) => all.write(folder),
        }
    }

    /// Tells the `checksums.json` beside a file that was written anew of it, if it lists a file of that name.
    ///
    /// # Errors
    /// As [`Checksums::add`].
    pub fn renew(path: &Path) -> Result<(), ResultsError> {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return Ok(()) };
        match folder.join(Self::FILE).is_file() && Self::load(folder)?.files.contains_key(name) {
            true => Self::add(folder, &[name]),
            false => Ok(()),
        }
    }

    /// Checks a file that was written together with another: it is listed if that is.
    ///
    /// # Errors
    /// As [`Checksums::check`].
    pub(crate) fn check_beside(&self, folder: &Path, name: &str, mate: &str) -> Result<(), ResultsError> {
        if self.files.contains_key(mate) && !self.files.contains_key(name) {
            let (path, what) = (folder.join(name), format!("{} lists {mate}, but not this", Self::FILE));
            return Err(ResultsError::Damaged { path, what });
        }
        self.check(folder, name)
    }

    /// Checks a file of the folder, if it is listed.
    ///
    /// # Errors
    /// [`ResultsError::Damaged`] where it is missing, or is not what was written; [`ResultsError::Io`].
    pub fn check(&self, folder: &Path, name: &str) -> Result<(), ResultsError> {
        let Some(listed) = self.files.get(name) else { return Ok(()) };
        let path = folder.join(name);
        let damaged = |path: PathBuf, what: String| Err(ResultsError::Damaged { path, what });
        let size = match std::fs::metadata(&path) {
            Ok(found) => found.len(),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                return damaged(path, "it is not there any more".into());
            }
            Err(error) => return Err(ResultsError::Io { path, error }),
        };
        // The size is known without reading.
        if size != listed.bytes {
            return damaged(path, format!("it has {size} bytes, but {} were written", listed.bytes));
        }
        let found = FileChecksum::of(&path);
        let found = found.map_err(|error| ResultsError::Io { path: path.clone(), error })?;
        match found == *listed {
            true => Ok(()),
            false => damaged(path, "its SHA-256 is not that of what was written".into()),
        }
    }
}

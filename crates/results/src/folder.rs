use std::cell::Cell;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::Duration;

use mser3d::Features;
use mser3d_fileio::{FolderLock, Unfinished, Writing, sync_folder, sync_names};

use crate::msv::MsvResults;
use crate::{Checksums, Extra, Results, ResultsError};

/// Where a result is written, in the folder that it will be in.
const PARTIAL: &str = ".new.partial";
/// The name that this takes when it is complete: from then on the files are only renamed.
const COMPLETE: &str = ".new";

/// A folder that will hold a whole result or none.
///
/// It is made before the work, so that a folder that cannot be written to is found out early, and no other run can begin to
/// write to it meanwhile. If nothing gets written, what was made is taken away again.
///
/// # What is promised
/// A result is written to the side, in a hidden folder of the same folder, and put in the place of an older one when it is
/// complete. Until then the older one stays as it is, whatever happens: a full disk, an error, a kill. A process that is killed
/// while files are renamed leaves a complete result, and whoever reads or writes it next finishes that.
/// Where there is an older result, the new one is on the disk before it goes, so that a power loss takes none of both. A result
/// that replaces none may be lost in a power loss, as far as the system had not written it; then its
/// [`Checksums`] tell that it is damaged.
pub struct ResultsFolder {
    path: PathBuf,
    /// The folders we made, innermost first.
    made: Vec<PathBuf>,
    done: Cell<bool>,
    _lock: FolderLock,
}

/// A kind of result: its files, and which of them says that the others are there.
pub(crate) struct Kind {
    /// The first file to go and the last to appear.
    pub record: &'static str,
    /// All others that go when a new result comes.
    pub others: &'static [&'static str],
}

impl ResultsFolder {
    /// Makes the folder if it is not there, finds out whether it can be written to, and keeps others from it.
    ///
    /// # Errors
    /// [`ResultsError::OutputFolder`]; [`ResultsError::Busy`] when another process is at it.
    pub fn create(path: &Path) -> Result<Self, ResultsError> {
        let fail = |error| ResultsError::OutputFolder { path: path.to_owned(), error };
        let missing = path.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists());
        let made = missing.map(Path::to_path_buf).collect();
        fs::create_dir_all(path).map_err(fail)?;
        let lock = FolderLock::exclusive(path).map_err(fail)?;
        let lock = lock.ok_or_else(|| ResultsError::Busy { folder: path.to_owned() })?;
        let folder = Self { path: path.to_owned(), made, done: false.into(), _lock: lock };
        finish(path)?;
        remove_folder(&path.join(PARTIAL))?;
        tempfile::tempfile_in(path).map_err(fail)?;
        Ok(folder)
    }

    /// The folders that were made, innermost first.
    pub fn made(&self) -> &[PathBuf] {
        &self.made
    }

    /// Writes a result, in place of an older one, and with it what is asked for besides. `regions.json` is the first file
    /// to go and the last to appear: while it is there, the others belong to it.
    ///
    /// # Errors
    /// [`ResultsError::Io`], [`ResultsError::File`] or [`ResultsError::Mesh`], naming the file.
    pub fn write(&self, results: &Results, extras: &[Extra]) -> Result<(), ResultsError> {
        self.replace(&Results::FILES, |staged| results.write_files(staged, extras, None))
    }

    /// The same of results that were found just now. The trees of a large shape, which the results do not have
    /// ([`Results::trees`]), are made one after the other.
    ///
    /// # Errors
    /// As [`write`](Self::write); [`ResultsError::TreeOfFeatures`].
    pub fn write_found(
        &self,
        results: &Results,
        features: &Features,
        extras: &[Extra],
    ) -> Result<(), ResultsError> {
        self.replace(&Results::FILES, |staged| results.write_files(staged, extras, Some(features)))
    }

    /// Writes the maximally stable volumes of a grey-value volume, in place of older ones; see [`MsvResults::write`].
    ///
    /// # Errors
    /// [`ResultsError::Io`], [`ResultsError::File`], [`ResultsError::Mesh`] or [`ResultsError::Volume`], naming the file.
    pub fn write_msv(&self, results: &MsvResults) -> Result<(), ResultsError> {
        self.replace(&MsvResults::FILES, |staged| results.write_files(staged))
    }

    /// Writes which regions of two results are the same, in place of older matches: `write` gets a folder for `matches.json` and the
    /// files beside it, `matches.csv`, `matches.png`, `matches.html` and `map.npy`.
    ///
    /// # Errors
    /// Those of `write`, [`ResultsError::Io`] and [`ResultsError::File`].
    pub fn write_matches(
        &self,
        write: impl FnOnce(&Path) -> Result<(), ResultsError>,
    ) -> Result<(), ResultsError> {
        self.replace(&MATCHES, write)
    }

    /// Puts what `write` writes, with checksums, in the place of what there is of these files.
    pub(crate) fn replace(
        &self,
        kind: &Kind,
        write: impl FnOnce(&Path) -> Result<(), ResultsError>,
    ) -> Result<(), ResultsError> {
        let (partial, complete) = (self.path.join(PARTIAL), self.path.join(COMPLETE));
        remove_folder(&partial)?;
        let made = Unfinished::make(|| Ok((partial.clone(), fs::create_dir(&partial)?)));
        let (unfinished, ()) = made.map_err(io(&partial))?;
        write(&partial)?;
        let mut sums = Checksums::of(&partial, &names_in(&partial)?)?;
        // What is not of this kind stays, and is checked as before.
        let goes = |name: &str| name == kind.record || kind.others.contains(&name);
        let old = Checksums::load(&self.path).unwrap_or_default().files.into_iter();
        let staying = old.filter(|(name, _)| !goes(name) && !sums.files.contains_key(name));
        sums.files.extend(staying.collect::<Vec<_>>());
        sums.write(&partial)?;
        let replaces = self.path.join(kind.record).exists();
        if replaces {
            sync_folder(&partial).map_err(io(&partial))?;
        }
        let _whole = Writing::begin();
        unfinished.finish(|partial| fs::rename(partial, &complete)).map_err(io(&complete))?;
        finish(&self.path)?;
        if replaces {
            sync_names(&self.path).map_err(io(&self.path))?;
        }
        self.done.set(true);
        Ok(())
    }
}

impl Drop for ResultsFolder {
    fn drop(&mut self) {
        if !self.done.get() {
            // Only what is still empty goes.
            self.made.iter().take_while(|path| fs::remove_dir(path).is_ok()).for_each(drop);
        }
    }
}

/// Puts a complete new result, if there is one, in the place of the old. May be interrupted and done again at any point.
fn finish(folder: &Path) -> Result<(), ResultsError> {
    let complete = folder.join(COMPLETE);
    if !complete.is_dir() {
        return Ok(());
    }
    let come = |name: &str| {
        let (from, to) = (complete.join(name), folder.join(name));
        ignore_missing(fs::rename(&from, &to)).map_err(io(&to))
    };
    for kind in [&Results::FILES, &MsvResults::FILES, &MATCHES] {
        if !complete.join(kind.record).is_file() {
            continue;
        }
        let sums = complete.join(Checksums::FILE);
        // Without them, all but the record has come.
        if sums.is_file() {
            // After a power loss they may be cut short: then the new result is lost, and the old one stays.
            let Ok(Checksums { files: listed }) = Checksums::load(&complete) else { break };
            remove_file(&folder.join(kind.record))?;
            for name in kind.others.iter().filter(|name| !listed.contains_key(**name)) {
                remove_file(&folder.join(name))?;
            }
            listed.keys().filter(|name| *name != kind.record).try_for_each(|name| come(name))?;
            come(Checksums::FILE)?;
        }
        come(kind.record)?;
    }
    remove_folder(&complete)
}

/// Has a result that a killed process had nearly put in its place put there. Does nothing where a process is at it right now, but waits
/// for it.
pub(crate) fn recover(folder: &Path, record: &str) -> Result<(), ResultsError> {
    // Renaming takes no longer, be the folder on another machine.
    for _ in 0..200 {
        if folder.join(record).is_file() || !folder.join(COMPLETE).is_dir() {
            break;
        }
        if let Some(_lock) = FolderLock::exclusive(folder).map_err(io(folder))? {
            return finish(folder);
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    Ok(())
}

/// Whether something is being written to a folder, or was when its process was killed.
pub(crate) fn is_left_over(folder: &Path) -> bool {
    folder.join(PARTIAL).is_dir()
}

impl Results {
    /// The files of a result.
    pub(crate) const FILES: Kind = Kind {
        record: "regions.json",
        others: &[
            "features.npz",
            "surface.ply",
            "volume.vti",
            "view.html",
            "failure.json",
            Extra::Nifti.file_name(),
            Extra::Landmarks.file_name(),
            Extra::Eigenfunctions.file_name(),
            Extra::Signatures.file_name(),
            Extra::Fields.file_name(),
            Extra::FineSurface.file_name(),
        ],
    };
}

/// The files of matches.
pub(crate) const MATCHES: Kind =
    Kind { record: "matches.json", others: &["matches.csv", "matches.png", "matches.html", "map.npy"] };

/// The files in a folder, by name.
fn names_in(folder: &Path) -> Result<Vec<String>, ResultsError> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).map_err(io(folder))? {
        names.push(entry.map_err(io(folder))?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}

fn remove_folder(path: &Path) -> Result<(), ResultsError> {
    ignore_missing(fs::remove_dir_all(path)).map_err(io(path))
}

fn remove_file(path: &Path) -> Result<(), ResultsError> {
    ignore_missing(fs::remove_file(path)).map_err(io(path))
}

fn ignore_missing(result: std::io::Result<()>) -> std::io::Result<()> {
    match result {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        other => other,
    }
}

fn io(path: &Path) -> impl FnOnce(std::io::Error) -> ResultsError {
    let path = path.to_owned();
    |error| ResultsError::Io { path, error }
}

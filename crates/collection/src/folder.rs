use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use mser3d_fileio::{FolderLock, Unfinished, sync_folder, sync_names};
use mser3d_results::Checksums;

use crate::label_tables::{LABELS, REGIONS};
use crate::{CollectionError, Shard};

/// The folder of a collection, while a batch writes to it: as long as this is held, no other batch can begin in it.
///
/// ```text
/// collection/
///   NAME/regions.json ...    a result,
///   NAME/failure.json        why there is none, or why it is of an earlier run
///   .NAME.partial/           a result that is being written (.NAME.WRITER.partial/ by one of several processes)
///   .NAME.old/               one that is being replaced
///   shapes.parquet, regions.parquet, failures.json: made of all results, when nothing is under way
///   labels.csv, regions.csv: of label maps, the same
///   checksums.json: of all of these tables
/// ```
///
/// # What is promised
/// A result takes the place of an older one as a whole, and is on the disk before that goes. A batch that is killed in between has
/// the older one put back by the next. Results that replace none, and tables, may be lost in a power loss, as far as the system had
/// not written them: then checksums tell, and the next run makes them again.
pub struct CollectionFolder {
    path: PathBuf,
    /// In the names of results that are being written: none where no other process writes the same.
    writer: Option<String>,
    /// Held as long as the batch runs; the system lets go of them when it is killed.
    _locks: Vec<File>,
    /// The same for whoever writes a single result into this folder.
    _folder: FolderLock,
}

/// What is made of all results: the last to appear and the first to go.
pub(crate) const TABLES: [&str; 7] = [
    "shapes.parquet",
    "regions.parquet",
    "failures.json",
    LABELS,
    REGIONS,
    "regions.nii.gz",
    "landmarks.mrk.json",
];

impl CollectionFolder {
    /// Makes the folder if it is not there, and keeps other batches out of it (other shards are welcome).
    ///
    /// # Errors
    /// [`CollectionError::Busy`] when another process is at it, [`CollectionError::Io`].
    pub fn open(path: &Path, shard: Option<Shard>) -> Result<Self, CollectionError> {
        fs::create_dir_all(path).map_err(CollectionError::io(path))?;
        let folder = lock_folder(path, shard.is_some())?;
        let mut locks = vec![lock(path, ".lock", shard.is_some(), "")?];
        if let Some(shard) = shard {
            let name = format!(".lock-{}", shard.to_string().replace('/', "-of-"));
            locks.push(lock(path, &name, false, &format!(", as shard {shard}"))?);
        }
        Ok(Self { path: path.to_owned(), writer: None, _locks: locks, _folder: folder })
    }

    /// The folder of a batch that several processes write to, which do not know of each other.
    pub(crate) fn join(path: &Path) -> Result<Self, CollectionError> {
        let folder = lock_folder(path, true)?;
        let locks = vec![lock(path, ".lock", true, "")?];
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let writer = Some(format!("{}-{}", std::process::id(), since.as_nanos()));
        Ok(Self { path: path.to_owned(), writer, _locks: locks, _folder: folder })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn result(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Whether a shape has a result, of this run or an earlier one.
    pub(crate) fn has_result(&self, name: &str) -> bool {
        self.result(name).join("regions.json").is_file()
    }

    /// Takes the tables away, because results are about to change.
    pub(crate) fn remove_tables(&self) -> Result<(), CollectionError> {
        Checksums::forget(&self.path, &TABLES)?;
        TABLES.iter().map(|name| self.path.join(name)).try_for_each(|file| remove_file(&file))
    }

    /// An empty hidden folder to write a result into.
    pub(crate) fn begin(&self, name: &str) -> Result<Unfinished, CollectionError> {
        let partial = match &self.writer {
            None => self.path.join(format!(".{name}.partial")),
            Some(writer) => self.path.join(format!(".{name}.{writer}.partial")),
        };
        remove_folder(&partial)?;
        let made = Unfinished::make(|| Ok((partial.clone(), fs::create_dir(&partial)?)));
        let (unfinished, ()) = made.map_err(CollectionError::io(&partial))?;
        Ok(unfinished)
    }

    /// Gives a hidden folder its name, in place of the result before it.
    pub(crate) fn publish(&self, name: &str, partial: Unfinished) -> Result<(), CollectionError> {
        let (result, old) = (self.result(name), self.path.join(format!(".{name}.old")));
        let replaces = result.exists();
        if replaces {
            if !is_ours(&result) {
                return Err(CollectionError::NotACollection {
                    folder: result,
                    problem:
                        "is in the way and no result of a batch; move it, or give another folder with -o"
                            .to_owned(),
                });
            }
            sync_folder(partial.path()).map_err(CollectionError::io(partial.path()))?;
            remove_folder(&old)?;
        }
        let swap = |partial: &Path| {
            if replaces {
                fs::rename(&result, &old)?;
            }
            fs::rename(partial, &result)?;
            if replaces {
                sync_names(&self.path)?;
            }
            ignore_missing(fs::remove_dir_all(&old))
        };
        partial.finish(swap).map_err(CollectionError::io(&result))
    }

    /// Removes what batches that were killed left behind. A result that one was about to replace comes back.
    pub(crate) fn sweep(&self) -> Result<(), CollectionError> {
        for entry in fs::read_dir(&self.path).map_err(CollectionError::io(&self.path))? {
            let entry = entry.map_err(CollectionError::io(&self.path))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let Some(hidden) = name.strip_prefix('.') else { continue };
            if let Some(own) = hidden.strip_suffix(".old") {
                let result = self.result(own);
                if !own.is_empty() && !result.exists() && is_ours(&entry.path()) {
                    fs::rename(entry.path(), &result).map_err(CollectionError::io(&result))?;
                    continue;
                }
            } else if !hidden.ends_with(".partial") {
                continue;
            }
            if entry.path().is_dir() {
                remove_folder(&entry.path())?;
            } else {
                remove_file(&entry.path())?;
            }
        }
        Ok(())
    }
}

/// Locks the folder itself.
fn lock_folder(path: &Path, shared: bool) -> Result<FolderLock, CollectionError> {
    let lock = if shared { FolderLock::shared(path) } else { FolderLock::exclusive(path) };
    let busy = || CollectionError::Busy { folder: path.to_owned(), part: String::new() };
    lock.map_err(CollectionError::io(path))?.ok_or_else(busy)
}

/// Locks a file of the folder, which is made if it is not there.
fn lock(folder: &Path, name: &str, shared: bool, part: &str) -> Result<File, CollectionError> {
    let file = folder.join(name);
    let locked = File::options().create(true).append(true).open(&file);
    let locked = locked.map_err(CollectionError::io(&file))?;
    let attempt = if shared { locked.try_lock_shared() } else { locked.try_lock() };
    match attempt {
        Err(TryLockError::WouldBlock) => {
            Err(CollectionError::Busy { folder: folder.to_owned(), part: part.to_owned() })
        }
        // Some network file systems have no locks; then the user has to take care.
        _ => Ok(locked),
    }
}

/// The folders in a collection that may hold results, by name.
pub(crate) fn result_names(root: &Path) -> Result<Vec<String>, CollectionError> {
    let mut names = Vec::new();
    for entry in fs::read_dir(root).map_err(CollectionError::io(root))? {
        let entry = entry.map_err(CollectionError::io(root))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if !name.starts_with('.') && entry.path().is_dir() {
            names.push(name);
        }
    }
    names.sort();
    Ok(names)
}

/// Whether a folder holds what batches write, or nothing.
fn is_ours(folder: &Path) -> bool {
    let has = |name: &str| folder.join(name).is_file();
    has("regions.json")
        || has("failure.json")
        || fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none())
}

pub(crate) fn remove_folder(path: &Path) -> Result<(), CollectionError> {
    ignore_missing(fs::remove_dir_all(path)).map_err(CollectionError::io(path))
}

pub(crate) fn remove_file(path: &Path) -> Result<(), CollectionError> {
    ignore_missing(fs::remove_file(path)).map_err(CollectionError::io(path))
}

fn ignore_missing(result: std::io::Result<()>) -> std::io::Result<()> {
    match result {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(()),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_a_collection_but_nobody_does_the_same_work_twice() {
        let folder = tempfile::tempdir().unwrap();
        let shard = |i| Some(Shard::new(i, 2).unwrap());
        let first = CollectionFolder::open(folder.path(), shard(1)).unwrap();
        let second = CollectionFolder::open(folder.path(), shard(2)).unwrap();
        for (wanted, named) in [(shard(1), "as shard 1/2"), (None, "another batch")] {
            let error = CollectionFolder::open(folder.path(), wanted).err().unwrap().to_string();
            assert!(error.contains(named), "{error}");
        }
        drop((first, second));
        let whole = CollectionFolder::open(folder.path(), None).unwrap();
        assert!(matches!(CollectionFolder::open(folder.path(), shard(1)), Err(CollectionError::Busy { .. })));
        drop(whole);
    }

    #[test]
    fn a_result_is_replaced_as_a_whole_and_leftovers_go() {
        let root = tempfile::tempdir().unwrap();
        let folder = CollectionFolder::open(root.path(), None).unwrap();
        for text in ["first", "second"] {
            let partial = folder.begin("a").unwrap();
            fs::write(partial.path().join("regions.json"), text).unwrap();
            fs::write(partial.path().join(text), "").unwrap();
            folder.publish("a", partial).unwrap();
            assert_eq!(fs::read_to_string(root.path().join("a/regions.json")).unwrap(), text);
        }
        assert!(!root.path().join("a/first").exists());
        assert!(folder.begin("b").unwrap().path().is_dir());
        assert!(!root.path().join(".b.partial").exists(), "what is given up goes");
        fs::create_dir(root.path().join(".b.partial")).unwrap();
        folder.sweep().unwrap();
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 2, "a and the lock");
    }

    #[test]
    fn a_result_that_was_about_to_be_replaced_comes_back() {
        let root = tempfile::tempdir().unwrap();
        let folder = CollectionFolder::open(root.path(), None).unwrap();
        // Killed between the two renames, and killed after them.
        for name in [".a.old", ".b.old", "b"] {
            fs::create_dir(root.path().join(name)).unwrap();
            fs::write(root.path().join(name).join("regions.json"), name).unwrap();
        }
        fs::create_dir(root.path().join(".a.partial")).unwrap();
        folder.sweep().unwrap();
        assert_eq!(fs::read_to_string(root.path().join("a/regions.json")).unwrap(), ".a.old");
        assert_eq!(fs::read_to_string(root.path().join("b/regions.json")).unwrap(), "b");
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 3, "a, b and the lock");
    }

    #[test]
    fn other_peoples_folders_are_left_alone() {
        let root = tempfile::tempdir().unwrap();
        let folder = CollectionFolder::open(root.path(), None).unwrap();
        fs::create_dir(root.path().join("a")).unwrap();
        fs::write(root.path().join("a/notes.txt"), "mine").unwrap();
        let partial = folder.begin("a").unwrap();
        let error = folder.publish("a", partial).unwrap_err().to_string();
        assert!(error.contains("in the way"), "{error}");
        assert_eq!(fs::read_to_string(root.path().join("a/notes.txt")).unwrap(), "mine");
    }
}

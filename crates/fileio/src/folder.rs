use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::Path;

/// A folder that this process has for itself, or shares with others that share it. The system lets go of it when the process ends,
/// however it ends.
///
/// On Unix the folder itself is locked, and nothing is left behind; elsewhere a file `.folder-lock` in it. Some network file systems
/// have no locks: there nobody is kept out.
///
/// ```
/// use mser3d_fileio::FolderLock;
/// # let folder = std::env::temp_dir().join(format!("mser3d-lock-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// let lock = FolderLock::exclusive(&folder)?;
/// assert!(lock.is_some());
/// assert!(FolderLock::exclusive(&folder)?.is_none());
/// drop(lock);
/// assert!(FolderLock::shared(&folder)?.is_some());
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct FolderLock {
    _file: File,
}

impl FolderLock {
    /// The folder for this process alone; `None` where another has it.
    ///
    /// # Errors
    /// Those of opening the folder.
    pub fn exclusive(folder: &Path) -> io::Result<Option<Self>> {
        Self::take(folder, File::try_lock)
    }

    /// The folder together with others that share it; `None` where another has it alone.
    ///
    /// # Errors
    /// Those of opening the folder.
    pub fn shared(folder: &Path) -> io::Result<Option<Self>> {
        Self::take(folder, File::try_lock_shared)
    }

    fn take(folder: &Path, lock: fn(&File) -> Result<(), TryLockError>) -> io::Result<Option<Self>> {
        #[cfg(unix)]
        let file = File::open(folder)?;
        #[cfg(not(unix))]
        let file = File::options().create(true).append(true).open(folder.join(".folder-lock"))?;
        match lock(&file) {
            Err(TryLockError::WouldBlock) => Ok(None),
            // Without locks the user has to take care.
            _ => Ok(Some(Self { _file: file })),
        }
    }
}

/// Waits until the files of a folder, and their names in it, are on the disk, so that a power loss takes none of them. Folders in it
/// are left out.
///
/// # Errors
/// What the operating system says. A file system that cannot wait is no error.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_file() {
            files.push(entry.path());
        }
    }
    // Each waits for the disk, which does them together.
    let results: Vec<io::Result<()>> = std::thread::scope(|scope| {
        let sync = |path| move || put_on_disk(&File::options().read(true).write(true).open(path)?);
        let waiting: Vec<_> = files.iter().map(|path| scope.spawn(sync(path))).collect();
        let failed = |_| Err(io::Error::other("a thread that waits for the disk has died"));
        waiting.into_iter().map(|thread| thread.join().unwrap_or_else(failed)).collect()
    });
    results.into_iter().collect::<io::Result<()>>()?;
    sync_names(folder)
}

/// Waits until the names in a folder are on the disk: what was made, renamed and removed in it. Only on Unix can that be asked for.
///
/// # Errors
/// As [`sync_folder`].
pub fn sync_names(folder: &Path) -> io::Result<()> {
    #[cfg(unix)]
    put_on_disk(&File::open(folder)?)?;
    #[cfg(not(unix))]
    let _ = folder;
    Ok(())
}

/// Waits until a file is on the disk, where the file system knows how.
pub(crate) fn put_on_disk(file: &File) -> io::Result<()> {
    match file.sync_all() {
        Err(error) if [ErrorKind::InvalidInput, ErrorKind::Unsupported].contains(&error.kind()) => Ok(()),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_had_by_one_or_shared() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = [(); 2].map(|()| FolderLock::shared(folder.path()).unwrap());
        assert!(first.is_some() && second.is_some());
        assert!(FolderLock::exclusive(folder.path()).unwrap().is_none());
        drop((first, second));
        let alone = FolderLock::exclusive(folder.path()).unwrap();
        assert!(alone.is_some() && FolderLock::shared(folder.path()).unwrap().is_none());
        drop(alone);
        assert!(FolderLock::exclusive(folder.path()).unwrap().is_some());
        assert!(FolderLock::exclusive(&folder.path().join("none")).is_err());
        if cfg!(unix) {
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        }
    }

    #[test]
    fn folders_are_put_on_the_disk() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a"), "1").unwrap();
        fs::create_dir(folder.path().join("b")).unwrap();
        sync_folder(folder.path()).unwrap();
        assert!(sync_folder(&folder.path().join("none")).is_err());
    }
}

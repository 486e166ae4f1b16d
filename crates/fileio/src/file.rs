use crate::folder::put_on_disk;
use crate::{FileError, InputFile, ReadLimits, Unfinished};
use std::fs::File;
use std::io::{self, BufWriter, Read, Write};
use std::path::Path;

/// Reads a whole file, which has to be a regular one ([`InputFile`]).
///
/// # Errors
/// [`FileError::Read`].
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, FileError> {
    InputFile::read_all(path).map_err(|source| FileError::Read { path: path.to_path_buf(), source })
}

/// Reads a whole file that must not take more memory than the limits allow, `each` bytes for a byte of it: those of the file
/// itself and of what is made of it.
///
/// # Errors
/// [`FileError::Read`], [`FileError::OverLimit`].
pub fn read_bytes_within(path: &Path, limits: &ReadLimits, each: u64) -> Result<Vec<u8>, FileError> {
    let fault = |source| FileError::Read { path: path.to_path_buf(), source };
    let over = |source| FileError::OverLimit { path: path.to_path_buf(), source };
    let file = InputFile::open(path).map_err(fault)?;
    let length = file.size().map_err(fault)?;
    let check = |bytes: u64| {
        limits.check_memory(bytes.saturating_mul(each), || format!("it has {bytes} bytes")).map_err(over)
    };
    check(length)?;
    // It may grow.
    let most = limits.left() / each.max(1);
    let mut bytes = Vec::new();
    file.take(most.saturating_add(1)).read_to_end(&mut bytes).map_err(fault)?;
    check(bytes.len() as u64)?;
    Ok(bytes)
}

/// The name of a file without its folder and ending, which may be a double one: `brain` of `brain.nii.gz`.
///
/// ```
/// assert_eq!(mser3d_fileio::file_stem("scans/brain.nii.gz".as_ref()), "brain");
/// assert_eq!(mser3d_fileio::file_stem("body.off".as_ref()), "body");
/// assert_eq!(mser3d_fileio::file_stem(".off".as_ref()), ".off");
/// ```
pub fn file_stem(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let packed = name.len() > 3
        && name.is_char_boundary(name.len() - 3)
        && name[name.len() - 3..].eq_ignore_ascii_case(".gz");
    let name = if packed { &name[..name.len() - 3] } else { &name[..] };
    match name.rfind('.') {
        Some(at) if at > 0 => name[..at].to_owned(),
        _ => name.to_owned(),
    }
}

/// Writes a file so that nobody ever sees half of it: into a temporary file of the same folder,
/// which takes the name when it is complete. After an error or a crash, what was at `path` before
/// is still there. (A process that is killed leaves `.NAME.*.partial` behind; one that is told to stop can
/// [`abandon`](crate::abandon) it.)
///
/// A file that takes another's place is on the disk before it does: after a power loss, the old one or the new one is
/// there. One that takes no other's place may be gone then, or cut short.
///
/// A link is followed, and stays. What is no file, such as a pipe or `/dev/stdout`, is written to as it is.
///
/// ```
/// use std::io::Write;
/// # let folder = std::env::temp_dir().join(format!("mser3d-atomic-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// let path = folder.join("regions.csv");
/// mser3d_fileio::write_atomically(&path, |out| writeln!(out, "id,volume"))?;
/// assert_eq!(std::fs::read(&path)?, b"id,volume\n");
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FileError::Write`], also for an error that `write` returns.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> Result<(), FileError> {
    let attempt = || {
        let there = std::fs::metadata(path).ok().map(|found| found.file_type());
        if there.is_some_and(|kind| !kind.is_file() && !kind.is_dir()) {
            let device = File::options().write(true).open(path)?;
            let mut out = BufWriter::with_capacity(1 << 16, &device);
            write(&mut out)?;
            return out.flush();
        }
        let target = if path.is_symlink() { path.canonicalize()? } else { path.to_owned() };
        let path = target.as_path();
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let prefix = format!(".{name}.");
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).suffix(".partial");
        // Temporary files are private by default; a result is as readable as any new file.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let (unfinished, file) = Unfinished::make(|| {
            let file = builder.tempfile_in(folder)?;
            Ok((file.path().to_owned(), file))
        })?;
        let mut out = BufWriter::with_capacity(1 << 16, file.as_file());
        write(&mut out)?;
        out.flush()?;
        drop(out);
        if there.is_some() {
            put_on_disk(file.as_file())?;
        }
        unfinished.finish(|_| file.persist(path).map(drop).map_err(|e| e.error))
    };
    attempt().map_err(|source| FileError::Write { path: path.to_path_buf(), source })
}

/// Writes a whole text by [`write_atomically`].
///
/// # Errors
/// [`FileError::Write`].
pub fn write_text(path: &Path, text: &str) -> Result<(), FileError> {
    write_atomically(path, |out| out.write_all(text.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_atomically(&path, |out| out.write_all(b"old")).unwrap();
        let error = write_atomically(&path, |out| {
            out.write_all(&[0; 1 << 20])?;
            Err(io::Error::other("no more"))
        });
        assert!(error.unwrap_err().to_string().contains("a.txt: cannot be written: no more"));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
        assert!(write_atomically(&folder.path().join("none/b"), |_| Ok(())).is_err());
        assert!(write_atomically(folder.path(), |_| Ok(())).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn links_and_devices_stay_what_they_are() {
        use std::os::unix::fs::{FileTypeExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        std::fs::write(&file, "old").unwrap();
        symlink(&file, &link).unwrap();
        write_atomically(&link, |out| out.write_all(b"new")).unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), b"new");
        assert!(link.is_symlink());
        // A socket stands for all that is no file: it cannot be opened, but must not be replaced either.
        let socket = folder.path().join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        assert!(write_atomically(&socket, |out| out.write_all(b"file")).is_err());
        assert!(std::fs::metadata(&socket).unwrap().file_type().is_socket());
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 3);
    }

    #[cfg(unix)]
    #[test]
    fn the_file_has_the_permissions_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let mode = |name: &str| std::fs::metadata(folder.path().join(name)).unwrap().permissions().mode();
        write_atomically(&folder.path().join("a"), |_| Ok(())).unwrap();
        File::create(folder.path().join("b")).unwrap();
        assert_eq!(mode("a"), mode("b"));
    }
}

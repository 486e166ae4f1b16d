use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// What reading a file may take, and where it may lead. One of these goes to every reader.
///
/// What a file declares is compared with it before memory is taken, and so is what is packed, while it is unpacked.
///
/// ```
/// use mser3d_fileio::ReadLimits;
/// let limits = ReadLimits { max_box_voxels: 1000, ..Default::default() };
/// assert!(limits.check_voxels([10, 10, 10]).is_ok());
/// let error = limits.check_voxels([2000, 2000, 2000]).unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "it declares 2000 x 2000 x 2000 voxels, more than the limit of 1000 voxels; if that is meant, raise \
///      --max-box-voxels"
/// );
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadLimits {
    /// Most voxels of a volume. Default: 2^32.
    pub max_box_voxels: u64,
    /// Most bytes of memory that reading takes, with those that are held already. Default: no limit.
    pub memory: u64,
    /// Bytes that are held already: the program's own. Default: 0.
    pub held: u64,
    /// Whether the files that a file names may lie outside of its folder. Default: no.
    pub allow_outside: bool,
}

impl Default for ReadLimits {
    fn default() -> Self {
        Self { max_box_voxels: 1 << 32, memory: u64::MAX, held: 0, allow_outside: false }
    }
}

/// A file declares or holds more than its reader is allowed to take.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{needs}, more than the limit of {limit}; if that is meant, raise {option}")]
pub struct OverLimit {
    needs: String,
    limit: String,
    option: &'static str,
}

impl ReadLimits {
    /// Refuses a volume of too many voxels.
    ///
    /// # Errors
    /// [`OverLimit`], also where the number of voxels overflows.
    pub fn check_voxels(&self, dims: [usize; 3]) -> Result<(), OverLimit> {
        let voxels = dims.iter().try_fold(1u64, |n, &axis| n.checked_mul(axis as u64));
        if voxels.is_some_and(|voxels| voxels <= self.max_box_voxels) {
            return Ok(());
        }
        let [nx, ny, nz] = dims;
        Err(OverLimit {
            needs: format!("it declares {nx} x {ny} x {nz} voxels"),
            limit: format!("{} voxels", self.max_box_voxels),
            option: "--max-box-voxels",
        })
    }

    /// Bytes that reading may take beside those that are held.
    pub fn left(&self) -> u64 {
        self.memory.saturating_sub(self.held)
    }

    /// Refuses what takes too many bytes of memory; `what` is a whole statement, such as `it holds 12 pages`.
    ///
    /// # Errors
    /// [`OverLimit`].
    pub fn check_memory(&self, bytes: u64, what: impl FnOnce() -> String) -> Result<(), OverLimit> {
        if bytes <= self.left() {
            return Ok(());
        }
        let beside = match self.held {
            0 => String::new(),
            held => format!(" beside the {} that the program holds", megabytes(held)),
        };
        Err(OverLimit {
            needs: format!("{}, and reading that takes about {}{beside}", what(), megabytes(bytes)),
            limit: megabytes(self.memory),
            option: "--memory-limit",
        })
    }

    /// The file of this name, which the file `by` names: it must be a file, and lie in the folder of `by` or below it,
    /// links followed. With [`allow_outside`](Self::allow_outside) it may lie anywhere.
    ///
    /// # Errors
    /// What is wrong, and what to do.
    ///
    /// ```
    /// use mser3d_fileio::ReadLimits;
    /// let limits = ReadLimits::default();
    /// let error = limits.named_file("scans/a.nhdr".as_ref(), "../secret.raw").unwrap_err();
    /// assert!(error.contains("outside of its folder"), "{error}");
    /// ```
    pub fn named_file(&self, by: &Path, name: &str) -> Result<PathBuf, String> {
        if name.is_empty() {
            return Err("it names a file with an empty name; write the name of the file beside it".into());
        }
        let folder = by.parent().unwrap_or(Path::new(""));
        let path = folder.join(name);
        let outside = || {
            format!(
                "the file {} that it names lies outside of its folder; put it beside the other and name it so, or allow \
                 this with --allow-outside",
                name.escape_debug()
            )
        };
        if !self.allow_outside && leads_up(name) {
            return Err(outside());
        }
        let named = || format!("the file {} that it names", name.escape_debug());
        // Before it is opened: opening a pipe waits.
        match std::fs::metadata(&path) {
            Ok(found) if found.is_file() => {}
            Ok(_) => return Err(format!("{} is no regular file", named())),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                return Err(format!("{} is missing; both belong into the same folder", named()));
            }
            Err(error) => return Err(format!("{} cannot be read: {error}", named())),
        }
        if !self.allow_outside {
            let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
            let inside = here.canonicalize().and_then(|here| Ok(path.canonicalize()?.starts_with(here)));
            if !inside.is_ok_and(|inside| inside) {
                return Err(outside());
            }
        }
        Ok(path)
    }
}

/// Whether a name leads out of the folder by itself, on this system or another.
fn leads_up(name: &str) -> bool {
    let mut depth = 0i64;
    for part in name.split(['/', '\\']) {
        match part {
            ".." => depth -= 1,
            "" | "." => {}
            _ => depth += 1,
        }
        if depth < 0 {
            return true;
        }
    }
    Path::new(name).has_root() || name.starts_with(['/', '\\']) || name.as_bytes().get(1) == Some(&b':')
}

/// Bytes for people, rounded up.
pub(crate) fn megabytes(bytes: u64) -> String {
    match bytes {
        _ if !bytes.is_multiple_of(1_000_000) && bytes < 10_000_000 => {
            format!("{:.1} MB", (bytes as f64 / 1e5).ceil() / 10.0)
        }
        _ => format!("{} MB", bytes.div_ceil(1_000_000)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_overflows_is_over_the_limit() {
        let limits = ReadLimits { max_box_voxels: u64::MAX, ..Default::default() };
        assert!(limits.check_voxels([usize::MAX; 3]).is_err());
        assert!(limits.check_voxels([1 << 20; 3]).is_ok());
        let limits = ReadLimits { memory: 1_000_000, ..Default::default() };
        assert!(limits.check_memory(1_000_000, String::new).is_ok());
        let error = limits.check_memory(1_000_001, || "it holds text".into()).unwrap_err().to_string();
        assert!(
            error.starts_with(
                "it holds text, and reading that takes about 1.1 MB, more than the limit of 1 MB"
            )
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_named_file_is_a_file_and_lies_in_the_folder() {
        use std::os::unix::fs::symlink;
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        std::fs::create_dir_all(at("in/deep")).unwrap();
        for name in ["out.raw", "in/a.raw", "in/deep/b.raw"] {
            std::fs::write(at(name), name).unwrap();
        }
        symlink(at("out.raw"), at("in/link.raw")).unwrap();
        symlink(at("in/a.raw"), at("in/inner.raw")).unwrap();
        symlink(root.path(), at("in/up")).unwrap();
        let header = at("in/a.nhdr");
        let strict = ReadLimits::default();
        let free = ReadLimits { allow_outside: true, ..Default::default() };
        for good in ["a.raw", "./a.raw", "deep/b.raw", "deep/../a.raw", "inner.raw"] {
            assert_eq!(strict.named_file(&header, good).unwrap(), at("in").join(good), "{good}");
        }
        let absolute = at("out.raw").display().to_string();
        for outside in ["../out.raw", "deep/../../out.raw", "link.raw", "up/out.raw", &absolute] {
            let error = strict.named_file(&header, outside).unwrap_err();
            assert!(error.contains("outside of its folder") && error.contains("--allow-outside"), "{error}");
            assert_eq!(std::fs::read(free.named_file(&header, outside).unwrap()).unwrap(), b"out.raw");
        }
        for other in ["C:\\a.raw", "..\\a.raw", "\\\\server\\a.raw"] {
            assert!(strict.named_file(&header, other).unwrap_err().contains("outside"), "{other}");
        }
        for none in ["deep", ".", "/dev/zero", "/dev/null"] {
            let error = free.named_file(&header, none).unwrap_err();
            assert!(error.contains("is no regular file"), "{none}: {error}");
        }
        assert!(strict.named_file(&header, "").unwrap_err().contains("empty"));
        assert!(strict.named_file(&header, "b.raw").unwrap_err().contains("missing"));
        // A list in the current folder.
        let error = strict.named_file(Path::new("list.txt"), "no such file.off").unwrap_err();
        assert!(error.contains("is missing"), "{error}");
    }
}

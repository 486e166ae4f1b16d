use crate::error::{Fault, FileError};
use crate::file::{read_bytes, write_atomically};
use crate::npy::{self, NpyArray};
use std::collections::BTreeMap;
use std::io::{self, Cursor, Read, Seek, SeekFrom, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;

/// Writes named arrays as one file that `numpy.load` opens. The same arrays make the same bytes:
/// nothing in the file depends on the clock.
///
/// # Errors
/// [`FileError::Write`], also for a name given twice.
pub fn write_npz(path: &Path, arrays: &[(impl AsRef<str>, NpyArray)]) -> Result<(), FileError> {
    write_npz_by(path, |npz| arrays.iter().try_for_each(|(name, array)| npz.add(name.as_ref(), array)))
}

/// As [`write_npz`], of arrays that are made one after the other, so that they need not all be there at once.
///
/// ```
/// use mser3d_fileio::{FileError, NpyArray, read_npz, write_npz_by};
/// # let folder = std::env::temp_dir().join(format!("mser3d-npz-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// let path = folder.join("squares.npz");
/// write_npz_by(&path, |npz| {
///     (0..3u32).try_for_each(|n| npz.add(&format!("{n}"), &NpyArray::flat(vec![n * n])))
/// })?;
/// assert_eq!(read_npz(&path)?["2"], NpyArray::flat(vec![4u32]));
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FileError::Write`], and those of `write`, after which there is no file.
pub fn write_npz_by<E: From<FileError>>(
    path: &Path,
    write: impl FnOnce(&mut NpzWriter) -> Result<(), E>,
) -> Result<(), E> {
    let mut failed = None;
    let written = write_atomically(path, |out| {
        archive(out, |add| {
            let mut npz = NpzWriter { path, add };
            write(&mut npz).map_err(|error| {
                failed = Some(error);
                io::Error::other("not all arrays were made")
            })
        })
    });
    failed.map_or(written.map_err(E::from), Err)
}

/// Takes the arrays of a file.
pub struct NpzWriter<'a> {
    path: &'a Path,
    add: &'a mut dyn FnMut(&str, &NpyArray) -> io::Result<()>,
}

impl NpzWriter<'_> {
    /// Writes an array.
    ///
    /// # Errors
    /// [`FileError::Write`], also for a name given twice.
    pub fn add(&mut self, name: &str, array: &NpyArray) -> Result<(), FileError> {
        let fail = |source| FileError::Write { path: self.path.to_path_buf(), source };
        (self.add)(name, array).map_err(fail)
    }
}

fn archive(
    out: impl Write + Seek,
    write: impl FnOnce(&mut dyn FnMut(&str, &NpyArray) -> io::Result<()>) -> io::Result<()>,
) -> io::Result<()> {
    let mut target = Target { out, fault: None, position: 0, length: 0 };
    let mut archive = zip::ZipWriter::new(&mut target);
    write(&mut |name, array| {
        let options = SimpleFileOptions::DEFAULT
            .compression_method(zip::CompressionMethod::Stored)
            .last_modified_time(zip::DateTime::DEFAULT)
            .unix_permissions(0o644)
            .large_file(array.byte_len() > u64::from(u32::MAX));
        archive.start_file(format!("{name}.npy"), options)?;
        array.write(&mut archive)
    })?;
    archive.finish()?;
    target.fault.map_or(Ok(()), Err)
}

/// Where an archive goes. Its writer tries to end what it has begun even after a fault, and complains on stderr if that fails too;
/// so the first fault is kept, and what comes after it goes nowhere.
struct Target<W> {
    out: W,
    fault: Option<io::Error>,
    position: u64,
    length: u64,
}

impl<W> Target<W> {
    fn unless_at_fault<T>(&mut self, done: impl FnOnce(&mut W) -> io::Result<T>) {
        if self.fault.is_none() {
            self.fault = done(&mut self.out).err();
        }
    }
}

impl<W: Write> Write for Target<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.unless_at_fault(|out| out.write_all(bytes));
        self.position += bytes.len() as u64;
        self.length = self.length.max(self.position);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.unless_at_fault(W::flush);
        Ok(())
    }
}

impl<W: Seek> Seek for Target<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.unless_at_fault(|out| out.seek(to));
        let position = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::Current(step) => self.position.checked_add_signed(step),
            SeekFrom::End(step) => self.length.checked_add_signed(step),
        };
        self.position = position.ok_or(io::ErrorKind::InvalidInput)?;
        Ok(self.position)
    }
}

/// Reads the arrays of a file written by [`write_npz`] or `numpy.savez` (uncompressed), by name.
///
/// # Errors
/// [`FileError::Read`], [`FileError::Invalid`], [`FileError::Unsupported`].
pub fn read_npz(path: &Path) -> Result<BTreeMap<String, NpyArray<'static>>, FileError> {
    let bytes = read_bytes(path)?;
    parse(&bytes).map_err(|fault| fault.in_file(path))
}

fn parse(bytes: &[u8]) -> Result<BTreeMap<String, NpyArray<'static>>, Fault> {
    let broken = |e: zip::result::ZipError| match e {
        zip::result::ZipError::UnsupportedArchive(_) => {
            Fault::unsupported("compressed arrays are not supported; save them with numpy.savez")
        }
        e => Fault::invalid(format!("not a whole .npz file: {e}")),
    };
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
    let mut arrays = BTreeMap::new();
    // Stored one after the other, so that all arrays together are no larger than the file.
    let mut left = bytes.len() as u64;
    for number in 0..archive.len() {
        let mut file = archive.by_index(number).map_err(broken)?;
        let name = file.name().map_err(broken)?.into_owned();
        let name = name.strip_suffix(".npy").unwrap_or(&name).to_owned();
        let in_array = |reason: String| Fault::invalid(format!("array {name:?}: {reason}"));
        let mut data = Vec::new();
        file.by_ref().take(left + 1).read_to_end(&mut data).map_err(|e| in_array(e.to_string()))?;
        let rest = left.checked_sub(data.len() as u64);
        left = rest.ok_or_else(|| in_array("it shares its bytes with another array".into()))?;
        let stored = npy::parse(&data).map_err(|fault| in_array(fault.into_reason()))?;
        if stored.first_axis_fastest && stored.array.shape().len() > 1 {
            return Err(in_array("it is in Fortran order; save it through numpy.ascontiguousarray".into()));
        }
        arrays.insert(name, stored.array);
    }
    Ok(arrays)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_come_back_and_bytes_repeat() {
        let folder = tempfile::tempdir().unwrap();
        let arrays = [
            ("vertex_region", NpyArray::flat(vec![-1i32, 0, 3])),
            ("voxel_index", NpyArray::new(&[2, 3], vec![0u32, 1, 2, 3, 4, 5]).unwrap()),
            ("eigenvalues", NpyArray::flat(vec![0.0, 0.25])),
        ];
        let paths = ["a.npz", "b.npz"].map(|name| folder.path().join(name));
        for path in &paths {
            write_npz(path, &arrays).unwrap();
        }
        let bytes = std::fs::read(&paths[0]).unwrap();
        assert_eq!(bytes, std::fs::read(&paths[1]).unwrap());
        let read = read_npz(&paths[0]).unwrap();
        assert_eq!(read.len(), 3);
        for (name, array) in &arrays {
            assert_eq!(&read[*name], array);
        }
        for end in 0..bytes.len() {
            assert!(parse(&bytes[..end]).is_err());
        }
        // Any byte may be wrong: an error or other arrays, never a panic.
        for at in 0..bytes.len() {
            for flip in [1, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] ^= flip;
                let _ = parse(&damaged);
            }
        }
        let twice = [arrays[0].clone(), arrays[0].clone()];
        assert!(write_npz(&paths[0], &twice).unwrap_err().to_string().contains("a.npz"));
        assert_eq!(std::fs::read(&paths[0]).unwrap(), bytes);
    }

    #[test]
    fn after_a_fault_nothing_is_written_and_nothing_said() {
        /// A disk with room for so many bytes.
        struct Disk(Cursor<Vec<u8>>, usize);
        impl Write for Disk {
            fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
                let full = self.0.position() as usize + bytes.len() > self.1;
                if full { Err(io::ErrorKind::StorageFull.into()) } else { self.0.write(bytes) }
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        impl Seek for Disk {
            fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
                self.0.seek(to)
            }
        }
        let arrays = [("a", NpyArray::flat(vec![1u8; 300])), ("b", NpyArray::flat(vec![2u8; 300]))];
        let mut whole = Disk(Cursor::default(), usize::MAX);
        let write = |disk: &mut Disk| {
            archive(disk, |add| arrays.iter().try_for_each(|(name, array)| add(name, array)))
        };
        write(&mut whole).unwrap();
        for room in 0..whole.0.get_ref().len() {
            let mut disk = Disk(Cursor::default(), room);
            assert_eq!(write(&mut disk).unwrap_err().kind(), io::ErrorKind::StorageFull, "{room}");
        }
    }

    #[test]
    fn arrays_that_share_their_bytes_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.npz");
        write_npz(&path, &[("a", NpyArray::flat(vec![0u8; 100_000]))]).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(parse(&bytes).unwrap().len(), 1);
        // The directory is at the end: the entry, and 22 bytes that say how many there are and where they begin.
        let end = bytes.len() - 22;
        let start = u32::from_le_bytes(bytes[end + 16..end + 20].try_into().unwrap()) as usize;
        let (entry, mut last) = (&bytes[start..end], bytes[end..].to_vec());
        let mut bomb = bytes[..start].to_vec();
        let count = 26u16;
        for letter in 0..count as u8 {
            let mut entry = entry.to_vec();
            let name = entry.windows(5).position(|w| w == b"a.npy").unwrap();
            entry[name] = b'a' + letter;
            bomb.extend(entry);
        }
        last[8..10].copy_from_slice(&count.to_le_bytes());
        last[10..12].copy_from_slice(&count.to_le_bytes());
        last[12..16].copy_from_slice(&(entry.len() as u32 * u32::from(count)).to_le_bytes());
        bomb.extend(last);
        let error = parse(&bomb).unwrap_err().into_reason();
        assert!(error.contains("shares its bytes with another array"), "{error}");
    }
}

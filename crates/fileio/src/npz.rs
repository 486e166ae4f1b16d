use crate::InputFile;
use crate::error::{Fault, FileError};
use crate::file::write_atomically;
use crate::npy::{self, NpyArray};
use std::collections::BTreeMap;
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
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

/// Reads the arrays of a file written by [`write_npz`] or `numpy.savez` (uncompressed), by name. To hold not all of them at
/// once: [`NpzReader`].
///
/// # Errors
/// [`FileError::Read`], [`FileError::Invalid`], [`FileError::Unsupported`].
pub fn read_npz(path: &Path) -> Result<BTreeMap<String, NpyArray<'static>>, FileError> {
    let mut reader = NpzReader::open(path)?;
    let names: Vec<String> = reader.names().map(str::to_owned).collect();
    let mut arrays = BTreeMap::new();
    for name in names {
        arrays.extend(reader.read(&name)?.map(|array| (name, array)));
    }
    Ok(arrays)
}

/// An open file of arrays, each of which is read when it is asked for. Memory is twice the array's size while it is read.
///
/// ```
/// use mser3d_fileio::{NpyArray, NpzReader, write_npz};
/// # let folder = std::env::temp_dir().join(format!("mser3d-reader-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// let path = folder.join("arrays.npz");
/// write_npz(&path, &[("large", NpyArray::flat(vec![0.0; 100_000])), ("small", NpyArray::flat(vec![1u8, 2]))])?;
/// let mut reader = NpzReader::open(&path)?;
/// assert!(reader.names().eq(["large", "small"]));
/// assert_eq!(reader.read("small")?, Some(NpyArray::flat(vec![1u8, 2])));
/// assert_eq!(reader.read("third")?, None);
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct NpzReader {
    path: PathBuf,
    archive: Archive<BufReader<InputFile>>,
}

impl NpzReader {
    /// Reads what arrays there are.
    ///
    /// # Errors
    /// [`FileError::Read`]; [`FileError::Invalid`] for a file that is no archive, or whose arrays share their bytes.
    pub fn open(path: &Path) -> Result<Self, FileError> {
        let file =
            InputFile::open(path).map_err(|source| FileError::Read { path: path.to_owned(), source })?;
        let archive = Archive::open(BufReader::new(file)).map_err(|fault| fault.in_file(path))?;
        Ok(Self { path: path.to_owned(), archive })
    }

    /// The names of the arrays, ascending.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.archive.places.keys().map(String::as_str)
    }

    /// Reads an array; none of this name, `None`.
    ///
    /// # Errors
    /// [`FileError::Invalid`]; [`FileError::Unsupported`] for a compressed array, one in Fortran order, and other types of numbers.
    pub fn read(&mut self, name: &str) -> Result<Option<NpyArray<'static>>, FileError> {
        self.archive.read(name).map_err(|fault| fault.in_file(&self.path))
    }
}

/// Where arrays are in an archive.
struct Archive<R> {
    archive: zip::ZipArchive<R>,
    places: BTreeMap<String, usize>,
}

impl<R: Read + Seek> Archive<R> {
    fn open(mut file: R) -> Result<Self, Fault> {
        let unread = |e: io::Error| Fault::invalid(format!("not a whole .npz file: {e}"));
        let length = file.seek(SeekFrom::End(0)).map_err(unread)?;
        let mut archive = zip::ZipArchive::new(file).map_err(broken)?;
        let (mut places, mut stored) = (BTreeMap::new(), 0u64);
        for place in 0..archive.len() {
            let file = archive.by_index_raw(place).map_err(broken)?;
            let name = file.name().map_err(broken)?.into_owned();
            let name = name.strip_suffix(".npy").unwrap_or(&name).to_owned();
            // Stored one after the other, so that all arrays together are no larger than the file.
            stored = stored.saturating_add(file.compressed_size());
            if stored > length {
                return Err(Fault::invalid(format!(
                    "array {name:?}: it shares its bytes with another array"
                )));
            }
            places.insert(name, place);
        }
        Ok(Self { archive, places })
    }

    fn read(&mut self, name: &str) -> Result<Option<NpyArray<'static>>, Fault> {
        let Some(&place) = self.places.get(name) else { return Ok(None) };
        let in_array = |reason: String| Fault::invalid(format!("array {name:?}: {reason}"));
        let mut file = self.archive.by_index(place).map_err(broken)?;
        let size = file.compressed_size();
        let mut data = Vec::with_capacity(size as usize);
        // To the end of the array, where its checksum is looked at.
        file.by_ref()
            .take(size.saturating_add(1))
            .read_to_end(&mut data)
            .map_err(|e| in_array(e.to_string()))?;
        let stored = npy::parse(&data).map_err(|fault| in_array(fault.into_reason()))?;
        if stored.first_axis_fastest && stored.array.shape().len() > 1 {
            return Err(in_array("it is in Fortran order; save it through numpy.ascontiguousarray".into()));
        }
        Ok(Some(stored.array))
    }
}

fn broken(error: zip::result::ZipError) -> Fault {
    match error {
        zip::result::ZipError::UnsupportedArchive(_) => {
            Fault::unsupported("compressed arrays are not supported; save them with numpy.savez")
        }
        error => Fault::invalid(format!("not a whole .npz file: {error}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn parse(bytes: &[u8]) -> Result<Vec<NpyArray<'static>>, Fault> {
        let mut archive = Archive::open(Cursor::new(bytes))?;
        let names: Vec<String> = archive.places.keys().cloned().collect();
        names.iter().filter_map(|name| archive.read(name).transpose()).collect()
    }

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

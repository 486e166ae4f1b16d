//! Files as streams of bytes, unpacked where they are packed, and numbers at fixed places in them.
use crate::error::Fault;
use flate2::bufread::MultiGzDecoder;
use mser3d_fileio::{InputFile, ReadLimits};
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// The contents of a file; of one that begins as gzip does, what is packed in it.
pub(crate) fn open(path: &Path) -> Result<Box<dyn BufRead>, Fault> {
    let mut source = open_raw(path)?;
    Ok(match source.fill_buf()?.starts_with(&[0x1f, 0x8b]) {
        true => Box::new(BufReader::new(MultiGzDecoder::new(source))),
        false => Box::new(source),
    })
}

/// The bytes of a file as they are.
pub(crate) fn open_raw(path: &Path) -> Result<BufReader<InputFile>, Fault> {
    Ok(BufReader::with_capacity(1 << 16, InputFile::open(path).map_err(Fault::Io)?))
}

/// A file that a header names, which lies beside it.
pub(crate) fn beside(header: &Path, name: &str, limits: &ReadLimits) -> Result<PathBuf, Fault> {
    limits.named_file(header, name).map_err(Fault::Invalid)
}

/// The text that a file goes on with; beside it, what is made of it takes `beside` bytes.
pub(crate) fn text(source: impl BufRead, limits: &ReadLimits, beside: u64) -> Result<Vec<u8>, Fault> {
    let mut text = Vec::new();
    source.take(limits.left().saturating_sub(beside).saturating_add(1)).read_to_end(&mut text)?;
    let all = beside.saturating_add(text.len() as u64);
    limits.check_memory(all, || "its values are a long text".into())?;
    Ok(text)
}

/// Passes over bytes; whether they were there is seen when what follows is read.
pub(crate) fn skip(source: &mut impl Read, bytes: u64) -> Result<(), Fault> {
    std::io::copy(&mut source.take(bytes), &mut std::io::sink())?;
    Ok(())
}

/// So many bytes may follow the values of a packed file.
const MOST_BEHIND: u64 = 256 << 20;

/// Reads on to the end, where packed files have their checksum: what is damaged or cut off there is an error, and so is
/// what does not come to an end.
pub(crate) fn finish(source: impl Read) -> Result<(), Fault> {
    match std::io::copy(&mut source.take(MOST_BEHIND), &mut std::io::sink()) {
        Ok(MOST_BEHIND) => Err(Fault::invalid(format!(
            "more than {} MB are packed behind the values that its header promises; header and data do not belong together",
            MOST_BEHIND >> 20
        ))),
        // Bytes behind the end, as from a tape, are not packed.
        Err(error) if error.to_string().contains("invalid gzip header") => Ok(()),
        other => other.map(drop).map_err(Fault::from),
    }
}

/// The name of number `number` by a pattern of C's printf with one whole number, such as `slice%03d.raw`.
pub(crate) fn numbered(pattern: &str, number: i64) -> Option<String> {
    let (before, rest) = pattern.split_once('%')?;
    let digits = rest.find(|c: char| !c.is_ascii_digit())?;
    let (width, rest) = rest.split_at(digits);
    let after = rest.strip_prefix(['d', 'i', 'u'])?;
    let zeros = width.starts_with('0');
    let width: usize = if width.is_empty() { 0 } else { width.parse().ok().filter(|&w| w < 64)? };
    Some(match zeros {
        true => format!("{before}{number:0width$}{after}"),
        false => format!("{before}{number:width$}{after}"),
    })
}

/// The names `pattern` makes of the numbers from `first` to `last`; none for a step that does not lead there,
/// and for more than a hundred thousand.
pub(crate) fn all_numbered(pattern: &str, [first, last, step]: [i64; 3]) -> Option<Vec<String>> {
    let count = last.checked_sub(first)?.checked_div(step).filter(|n| (0..100_000).contains(n))? + 1;
    (0..count).map(|i| numbered(pattern, first + i * step)).collect()
}

/// Numbers at fixed places of a header.
pub(crate) struct Fields<'a> {
    pub bytes: &'a [u8],
    pub big_endian: bool,
}

impl Fields<'_> {
    fn raw<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut bytes = [0; N];
        bytes.copy_from_slice(&self.bytes[at..at + N]);
        if self.big_endian {
            bytes.reverse();
        }
        bytes
    }

    pub fn i16(&self, at: usize) -> i64 {
        i16::from_le_bytes(self.raw(at)).into()
    }

    pub fn i32(&self, at: usize) -> i64 {
        i32::from_le_bytes(self.raw(at)).into()
    }

    pub fn i64(&self, at: usize) -> i64 {
        i64::from_le_bytes(self.raw(at))
    }

    pub fn f32(&self, at: usize) -> f64 {
        f32::from_le_bytes(self.raw(at)).into()
    }

    pub fn f64(&self, at: usize) -> f64 {
        f64::from_le_bytes(self.raw(at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_numbered_as_printf_does() {
        assert_eq!(numbered("a%03d.raw", 7).unwrap(), "a007.raw");
        assert_eq!(numbered("a%d", 12).unwrap(), "a12");
        assert_eq!(numbered("%3i.x", 7).unwrap(), "  7.x");
        for bad in ["a", "a%s", "a%", "a%99999999999d", "%f"] {
            assert_eq!(numbered(bad, 1), None, "{bad}");
        }
        assert_eq!(all_numbered("%d", [4, 0, -2]).unwrap(), ["4", "2", "0"]);
        assert_eq!(all_numbered("%d", [0, 4, 0]), None);
        assert_eq!(all_numbered("%d", [0, i64::MAX, 1]), None);
    }
}

//! The pages' directories: tags with their values, in TIFF 6.0 and BigTIFF.
use crate::error::Fault;
use std::collections::{HashMap, HashSet};
use std::io::{Read, Seek, SeekFrom};

/// A TIFF file of which pieces are read.
pub(super) struct Source<R> {
    reader: R,
    /// Bytes of the whole file.
    length: u64,
    pub big_endian: bool,
    big: bool,
    /// Bytes that all directories hold.
    held: u64,
}

/// The entries of one page, by tag.
#[derive(Default)]
pub(super) struct Directory {
    entries: HashMap<u16, Entry>,
}

struct Entry {
    kind: u16,
    /// The values, in the file's order of bytes.
    bytes: Vec<u8>,
}

/// Bytes of a value of each kind of entry.
fn width(kind: u16) -> Option<u64> {
    Some(match kind {
        1 | 2 | 6 | 7 => 1,
        3 | 8 => 2,
        4 | 9 | 11 | 13 => 4,
        5 | 10 | 12 | 16 | 17 | 18 => 8,
        _ => return None,
    })
}

impl<R: Read + Seek> Source<R> {
    /// The file, and where its first directory is.
    pub fn open(mut reader: R) -> Result<(Self, u64), Fault> {
        let length = reader.seek(SeekFrom::End(0))?;
        let mut source = Self { reader, length, big_endian: false, big: false, held: 0 };
        let start = source.at(0, 8)?;
        source.big_endian = match &start[..2] {
            b"II" => false,
            b"MM" => true,
            _ => return Err(Fault::invalid("not a TIFF file: it does not begin with II or MM")),
        };
        let first = match source.unsigned(&start[2..4]) {
            42 => source.unsigned(&start[4..8]),
            43 => {
                source.big = true;
                let bytes = source.at(8, 8)?;
                source.unsigned(&bytes)
            }
            other => {
                return Err(Fault::invalid(format!("not a TIFF file: its version is {other}, not 42 or 43")));
            }
        };
        Ok((source, first))
    }

    /// Bytes of the file. No more are asked for than there are.
    pub fn at(&mut self, offset: u64, count: u64) -> Result<Vec<u8>, Fault> {
        let end = offset.checked_add(count).filter(|&end| end <= self.length);
        if end.is_none() {
            return Err(Fault::invalid(format!(
                "the file ends too early: it refers to {count} bytes from {offset} on, but has {}; copy or export it \
                 again",
                self.length
            )));
        }
        self.reader.seek(SeekFrom::Start(offset))?;
        let mut bytes = vec![0; count as usize];
        self.reader.read_exact(&mut bytes)?;
        Ok(bytes)
    }

    /// Bytes from a place to the end of the file.
    pub fn left(&self, offset: u64) -> u64 {
        self.length.saturating_sub(offset)
    }

    fn unsigned(&self, bytes: &[u8]) -> u64 {
        let shift = |value: u64, &byte: &u8| value << 8 | u64::from(byte);
        if self.big_endian { bytes.iter().fold(0, shift) } else { bytes.iter().rev().fold(0, shift) }
    }

    /// The directories of all pages.
    pub fn directories(&mut self, first: u64) -> Result<Vec<Directory>, Fault> {
        let (mut all, mut seen, mut next) = (Vec::new(), HashSet::new(), first);
        while next != 0 {
            if !seen.insert(next) {
                return Err(Fault::invalid("its pages follow each other in a circle; export it again"));
            }
            let directory;
            (directory, next) = self.directory(next)?;
            all.push(directory);
        }
        if all.is_empty() {
            return Err(Fault::invalid("the file has no page"));
        }
        Ok(all)
    }

    /// A directory, and where the next one is.
    fn directory(&mut self, offset: u64) -> Result<(Directory, u64), Fault> {
        // BigTIFF has 8 bytes where TIFF has 2, and 8 where it has 4.
        let (counted, each, word) = if self.big { (8, 20, 8) } else { (2, 12, 4) };
        let count = self.at(offset, counted)?;
        let count = self.unsigned(&count);
        let table = self.at(offset + counted, count.saturating_mul(each).saturating_add(word))?;
        let (entries, next) = table.split_at(table.len() - word as usize);
        let mut directory = Directory::default();
        self.hold(size_of::<Directory>() as u64)?;
        for entry in entries.chunks_exact(each as usize) {
            let (tag, kind) = (self.unsigned(&entry[..2]) as u16, self.unsigned(&entry[2..4]) as u16);
            let (count, value) = entry[4..].split_at(word as usize);
            let Some(width) = width(kind) else { continue };
            let bytes = self.unsigned(count).saturating_mul(width);
            let bytes = match bytes <= word {
                true => value[..bytes as usize].to_vec(),
                false => {
                    self.hold(bytes)?;
                    self.at(self.unsigned(value), bytes)?
                }
            };
            directory.entries.insert(tag, Entry { kind, bytes });
        }
        let next = self.unsigned(next);
        Ok((directory, next))
    }

    /// Counts what the directories hold. Each entry has bytes of its own in the file, so they are not much more than it; more
    /// are the same bytes again and again, to fill the memory.
    fn hold(&mut self, bytes: u64) -> Result<(), Fault> {
        self.held = self.held.saturating_add(bytes);
        if self.held > self.length.saturating_mul(2).saturating_add(16 << 20) {
            let reason = format!(
                "the directories of its pages refer to {} bytes, but it has {}; export it again",
                self.held, self.length
            );
            return Err(Fault::invalid(reason));
        }
        Ok(())
    }

    /// The whole numbers of an entry, if it is there and holds such.
    pub fn numbers(&self, directory: &Directory, tag: u16) -> Option<Vec<u64>> {
        let entry = directory.entries.get(&tag)?;
        let width = match entry.kind {
            1 | 3 | 4 | 13 | 16 | 18 => width(entry.kind)? as usize,
            _ => return None,
        };
        Some(entry.bytes.chunks_exact(width).map(|bytes| self.unsigned(bytes)).collect())
    }

    /// The first number of an entry.
    pub fn number(&self, directory: &Directory, tag: u16) -> Option<u64> {
        self.numbers(directory, tag)?.first().copied()
    }

    /// A fraction, or a number that stands for it; none for one that is not positive.
    pub fn fraction(&self, directory: &Directory, tag: u16) -> Option<f64> {
        let entry = directory.entries.get(&tag)?;
        let value = match (entry.kind, entry.bytes.len()) {
            (5, 8..) => self.unsigned(&entry.bytes[..4]) as f64 / self.unsigned(&entry.bytes[4..8]) as f64,
            (11, 4..) => f64::from(f32::from_bits(self.unsigned(&entry.bytes[..4]) as u32)),
            (12, 8..) => f64::from_bits(self.unsigned(&entry.bytes[..8])),
            _ => self.number(directory, tag)? as f64,
        };
        Some(value).filter(|value| value.is_normal() && *value > 0.0)
    }

    /// A text, up to its end mark.
    pub fn text(&self, directory: &Directory, tag: u16) -> Option<String> {
        let entry = directory.entries.get(&tag).filter(|entry| matches!(entry.kind, 1 | 2 | 7))?;
        let bytes = entry.bytes.split(|&b| b == 0).next().unwrap_or_default();
        Some(match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            // ImageJ writes Latin-1.
            Err(_) => bytes.iter().map(|&b| char::from(b)).collect(),
        })
    }
}

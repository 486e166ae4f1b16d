//! Tables that [`crate::parquet::write`] wrote, read again.
//!
//! Read by hand, and not by the crate that writes them: that one takes a file at its word, and panics, or asks for all memory, where
//! it is damaged. What is read here is what is written there: uncompressed pages of version 1, plain or by dictionary.

use mser3d_fileio::InputFile;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::CollectionError;
use crate::thrift::{Bytes, Struct};

/// What a footer may take: that of ours has a few thousand bytes.
const LARGEST_FOOTER: usize = 1 << 22;
/// Values, and bytes of texts, that a column may have for each byte of the file. Repeated ones take less than a byte; but no table has
/// only such columns.
const MOST_PER_BYTE: usize = 16;

/// A table.
pub(crate) struct Table {
    path: PathBuf,
    bytes: Vec<u8>,
    rows: usize,
    notes: Vec<(String, String)>,
    columns: Vec<Leaf>,
}

/// A column, and where its pages lie.
struct Leaf {
    /// The first part of its name.
    name: String,
    kind: i64,
    /// How often an optional or repeated step leads to it, and how often a repeated one.
    definition: u32,
    repetition: u32,
    chunks: Vec<Chunk>,
}

struct Chunk {
    at: Range<usize>,
    values: usize,
}

/// A type of values.
pub(crate) trait Plain: Clone {
    const KIND: i64;
    fn read(bytes: &mut Bytes) -> Option<Self>;
    /// Bytes that a value takes elsewhere.
    fn extra(&self) -> usize {
        0
    }
}

impl Plain for i32 {
    const KIND: i64 = 1;
    fn read(bytes: &mut Bytes) -> Option<Self> {
        bytes.array().map(Self::from_le_bytes)
    }
}

impl Plain for f64 {
    const KIND: i64 = 5;
    fn read(bytes: &mut Bytes) -> Option<Self> {
        bytes.array().map(Self::from_le_bytes)
    }
}

impl Plain for String {
    const KIND: i64 = 6;
    fn read(bytes: &mut Bytes) -> Option<Self> {
        let length = bytes.array().map(u32::from_le_bytes)?;
        String::from_utf8(bytes.take(length as usize)?.to_vec()).ok()
    }
    fn extra(&self) -> usize {
        self.len()
    }
}

/// The values of a column, and how many steps to each are there: 0 begins a row in `repetition`, and is no value in `definition`.
struct Values<T> {
    values: Vec<T>,
    definition: Vec<u32>,
    repetition: Vec<u32>,
}

impl Table {
    /// Reads a table.
    ///
    /// # Errors
    /// [`CollectionError::Io`], [`CollectionError::Table`].
    pub fn open(path: &Path) -> Result<Self, CollectionError> {
        let bytes = InputFile::read_all(path).map_err(CollectionError::io(path))?;
        let damaged = || broken(path, "damaged: it does not end as a Parquet table does");
        Self::parse(path, bytes).ok_or_else(damaged)
    }

    fn parse(path: &Path, bytes: Vec<u8>) -> Option<Self> {
        let (mut rows, mut notes) = (0, Vec::new());
        let mut columns: Vec<Leaf> = Vec::new();
        {
            let body = bytes.strip_prefix(b"PAR1")?.strip_suffix(b"PAR1")?;
            let (body, length) = body.split_last_chunk::<4>()?;
            let length = u32::from_le_bytes(*length) as usize;
            let footer = body.get(body.len().checked_sub(length)?..)?;
            if length > LARGEST_FOOTER {
                return None;
            }
            let pages = bytes.len() - 8 - length;
            let footer = Struct::read(&mut Bytes(footer))?;
            for note in footer.structures(5) {
                notes.push((note.text(1)?.to_owned(), note.text(2).unwrap_or_default().to_owned()));
            }
            let mut schema = footer.structures(2);
            let top = schema.next()?.count(5)?;
            for _ in 0..top {
                leaves(&mut schema, None, 0, 0, &mut columns)?;
            }
            for group in footer.structures(4) {
                rows += group.count(3)?;
                let mut chunks = group.structures(1);
                for leaf in &mut columns {
                    let about = chunks.next()?.structure(3)?;
                    let first = about.count(11).filter(|&at| at > 0).unwrap_or(usize::MAX);
                    let start = about.count(9)?.min(first);
                    let at = start..start.checked_add(about.count(7)?)?;
                    let values = about.count(5)?;
                    if values == 0 {
                        continue;
                    }
                    let good = about.integer(1) == Some(leaf.kind) && about.integer(4) == Some(0);
                    if !good || at.start < 4 || at.end > pages {
                        return None;
                    }
                    leaf.chunks.push(Chunk { at, values });
                }
            }
            if footer.count(3) != Some(rows) || rows > MOST_PER_BYTE.saturating_mul(bytes.len()) {
                return None;
            }
        }
        Some(Self { path: path.to_owned(), bytes, rows, notes, columns })
    }

    /// What was noted with the table.
    pub fn note(&self, key: &str) -> Option<&str> {
        self.notes.iter().find(|note| note.0 == key).map(|note| note.1.as_str())
    }

    pub fn rows(&self) -> usize {
        self.rows
    }

    /// A column with a value in each row.
    pub fn column<T: Plain>(&self, name: &str) -> Result<Vec<T>, CollectionError> {
        let found = self.values::<T>(name)?;
        match found.values.len() == self.rows && found.repetition.is_empty() {
            true => Ok(found.values),
            false => Err(self.damaged(name)),
        }
    }

    /// A column that may lack values.
    pub fn optional<T: Plain>(&self, name: &str) -> Result<Vec<Option<T>>, CollectionError> {
        let found = self.values::<T>(name)?;
        if found.definition.len() != self.rows || !found.repetition.is_empty() {
            return Err(self.damaged(name));
        }
        let mut values = found.values.into_iter();
        Ok(found.definition.into_iter().map(|level| if level > 0 { values.next() } else { None }).collect())
    }

    /// A column of lists, all of one length: that length, and the elements of all rows.
    pub fn lists(&self, name: &str) -> Result<(usize, Vec<f64>), CollectionError> {
        let found = self.values::<f64>(name)?;
        let width = found.values.len().checked_div(self.rows).unwrap_or(0);
        let begins = |(place, &level): (usize, &u32)| (level == 0) == place.is_multiple_of(width.max(1));
        let good = found.values.len() == width * self.rows
            && found.repetition.len() == found.values.len()
            && found.repetition.iter().enumerate().all(begins);
        if good { Ok((width, found.values)) } else { Err(self.damaged(name)) }
    }

    fn damaged(&self, name: &str) -> CollectionError {
        broken(&self.path, &format!("damaged: column {name} cannot be read"))
    }

    fn values<T: Plain>(&self, name: &str) -> Result<Values<T>, CollectionError> {
        let leaf = self.columns.iter().find(|leaf| leaf.name == name && leaf.kind == T::KIND);
        let none = || broken(&self.path, &format!("there is no column {name} of the right type"));
        let leaf = leaf.ok_or_else(none)?;
        self.read(leaf).ok_or_else(|| self.damaged(name))
    }

    fn read<T: Plain>(&self, leaf: &Leaf) -> Option<Values<T>> {
        let mut found = Values { values: Vec::new(), definition: Vec::new(), repetition: Vec::new() };
        let mut budget = MOST_PER_BYTE.saturating_mul(self.bytes.len());
        for chunk in &leaf.chunks {
            budget = budget.checked_sub(chunk.values)?;
            let mut bytes = Bytes(self.bytes.get(chunk.at.clone())?);
            let mut dictionary: Vec<T> = Vec::new();
            let mut left = chunk.values;
            while left > 0 {
                let head = Struct::read(&mut bytes)?;
                let mut page = Bytes(bytes.take(head.count(3)?)?);
                match head.integer(1)? {
                    0 => {
                        let about = head.structure(5)?;
                        let count = about.count(1).filter(|&n| n > 0 && n <= left)?;
                        left -= count;
                        let mut present = count;
                        if leaf.repetition > 0 {
                            levels(&mut page, leaf.repetition, count, &mut found.repetition)?;
                        }
                        if leaf.definition > 0 {
                            let before = found.definition.len();
                            levels(&mut page, leaf.definition, count, &mut found.definition)?;
                            let there = |level: &&u32| **level == leaf.definition;
                            present = found.definition[before..].iter().filter(there).count();
                        }
                        match about.integer(2)? {
                            0 => {
                                for _ in 0..present {
                                    let value = T::read(&mut page)?;
                                    budget = budget.checked_sub(value.extra())?;
                                    found.values.push(value);
                                }
                            }
                            2 | 8 if present > 0 => {
                                let width = u32::from(page.byte()?);
                                let mut places = Vec::new();
                                hybrid(&mut page, width, present, &mut places)?;
                                for place in places {
                                    let value = dictionary.get(place as usize)?;
                                    budget = budget.checked_sub(value.extra())?;
                                    found.values.push(value.clone());
                                }
                            }
                            2 | 8 => {}
                            _ => return None,
                        }
                    }
                    2 => {
                        let about = head.structure(7)?;
                        for _ in 0..about.count(1)? {
                            dictionary.push(T::read(&mut page)?);
                        }
                    }
                    _ => return None,
                }
            }
        }
        Some(found)
    }
}

fn broken(path: &Path, what: &str) -> CollectionError {
    let reason = format!("{what}; run `mser3d batch` again, or `mser3d batch --merge` for the tables alone");
    CollectionError::Table { path: path.to_owned(), reason }
}

/// The columns below the next element of a schema.
fn leaves<'s, 'a: 's>(
    schema: &mut impl Iterator<Item = &'s Struct<'a>>,
    name: Option<&str>,
    definition: u32,
    repetition: u32,
    columns: &mut Vec<Leaf>,
) -> Option<()> {
    let own = schema.next()?;
    let name = name.or(own.text(4))?.to_owned();
    let kept = own.integer(3)?;
    // No table of ours is deeper than a list.
    let (definition, repetition) = (definition + u32::from(kept > 0), repetition + u32::from(kept == 2));
    if definition > 2 {
        return None;
    }
    match own.count(5) {
        None | Some(0) => {
            columns.push(Leaf { name, kind: own.integer(1)?, definition, repetition, chunks: Vec::new() });
        }
        // A group of one: a list, and what it repeats.
        Some(1) if columns.len() < 1000 => leaves(schema, Some(&name), definition, repetition, columns)?,
        Some(_) => return None,
    }
    Some(())
}

/// The levels of a page, with their length before them.
fn levels(page: &mut Bytes, most: u32, count: usize, to: &mut Vec<u32>) -> Option<()> {
    let length = page.array().map(u32::from_le_bytes)?;
    let before = to.len();
    hybrid(&mut Bytes(page.take(length as usize)?), u32::BITS - most.leading_zeros(), count, to)?;
    to[before..].iter().all(|&level| level <= most).then_some(())
}

/// Numbers of so many bits in runs: of equal ones, or of eight packed.
fn hybrid(bytes: &mut Bytes, width: u32, count: usize, to: &mut Vec<u32>) -> Option<()> {
    if width > 32 {
        return None;
    }
    let end = to.len() + count;
    while to.len() < end {
        let head = usize::try_from(bytes.varint()?).ok()?;
        let room = end - to.len();
        if head & 1 == 0 {
            let mut value = [0; 4];
            let given = bytes.take(width.div_ceil(8) as usize)?;
            value[..given.len()].copy_from_slice(given);
            if head == 0 {
                return None;
            }
            to.extend(std::iter::repeat_n(u32::from_le_bytes(value), (head >> 1).min(room)));
        } else {
            let groups = head >> 1;
            let packed = bytes.take(groups.checked_mul(width as usize)?)?;
            if groups == 0 {
                return None;
            }
            let bit = |at: usize| u32::from(packed[at / 8] >> (at % 8) & 1);
            let number =
                |n: usize| (0..width as usize).map(|b| bit(n * width as usize + b) << b).sum::<u32>();
            to.extend((0..groups.saturating_mul(8).min(room)).map(number));
        }
    }
    Some(())
}

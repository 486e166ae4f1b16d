//! What comes beside points and cells: fields, and data of points and cells. It is skipped, but for the parts
//! that cells belong to.

use super::{File, truncated};
use crate::error::Fault;
use crate::vtk::names_parts;

impl File<'_> {
    /// Lines up to an empty one.
    pub(super) fn metadata(&mut self) {
        self.tokens.take_line();
        while !self.tokens.rest().is_empty() && !self.tokens.take_line().trim_ascii().is_empty() {}
    }

    /// Arrays with names; one of cells may say which part each belongs to.
    pub(super) fn field(&mut self, of_cells: bool) -> Result<(), Fault> {
        self.tokens.word("the field's name")?;
        let arrays = self.tokens.whole::<u64>("the number of arrays")?;
        for _ in 0..arrays {
            let mut name = self.tokens.word("the array's name")?;
            if name.eq_ignore_ascii_case(b"METADATA") {
                self.metadata();
                name = self.tokens.word("the array's name")?;
            }
            let components = self.tokens.whole::<u64>("the number of components")?;
            let rows = self.tokens.whole::<u64>("the number of rows")?;
            self.values(name, components, rows, of_cells)?;
        }
        Ok(())
    }

    /// The type and the values of an array.
    fn values(&mut self, name: &[u8], components: u64, rows: u64, of_cells: bool) -> Result<(), Fault> {
        let count = components.saturating_mul(rows);
        let mut ahead = self.tokens.clone();
        let kind = ahead.word("the type of the numbers")?;
        if kind.eq_ignore_ascii_case(b"string") {
            self.tokens = ahead;
            self.tokens.take_line();
            return self.skip_words(count);
        }
        let values = self.floats(count)?;
        let name = String::from_utf8_lossy(name).replace("%3A", ":");
        if of_cells && components == 1 && names_parts(&name) && self.parts.is_empty() {
            self.parts = values.into_iter().map(|x| x as i64).collect();
        }
        Ok(())
    }

    /// Words: a line each, or in binary files each after its length, whose first two bits say in how many bytes
    /// that is.
    fn skip_words(&mut self, count: u64) -> Result<(), Fault> {
        for _ in 0..count.min(self.tokens.rest().len() as u64) {
            if !self.binary {
                self.tokens.take_line();
                continue;
            }
            let bytes = 1 << (3 - self.tokens.rest().first().map_or(0, |b| b >> 6));
            let length =
                self.tokens.take_bytes(bytes).map(|b| b.iter().fold(0, |n: u64, &b| n << 8 | u64::from(b)));
            let length = length.map(|n| n & !(3 << (8 * bytes - 2))).and_then(|n| usize::try_from(n).ok());
            let word = length.and_then(|n| self.tokens.take_bytes(n));
            word.ok_or_else(|| truncated(self.tokens.line(), count))?;
        }
        Ok(())
    }

    pub(super) fn cell_data(&mut self) -> Result<(), Fault> {
        let rows = self.tokens.whole::<u64>("the number of cells")?;
        while let Some(word) = self.tokens.next() {
            match word.to_ascii_uppercase().as_slice() {
                b"FIELD" => self.field(true)?,
                b"METADATA" => self.metadata(),
                b"VECTORS" | b"NORMALS" => {
                    let name = self.tokens.word("the array's name")?;
                    self.values(name, 3, rows, true)?;
                }
                b"SCALARS" => {
                    let name = self.tokens.word("the array's name")?;
                    // `SCALARS name type [components]`, `LOOKUP_TABLE name`, values.
                    let kind = self.tokens.word("the type of the numbers")?;
                    let components = if self.tokens.at_line_end() {
                        1
                    } else {
                        self.tokens.whole("the number of components")?
                    };
                    let table = self.tokens.word("LOOKUP_TABLE")?;
                    if !table.eq_ignore_ascii_case(b"LOOKUP_TABLE") {
                        return Ok(());
                    }
                    self.tokens.word("the table's name")?;
                    let values = self.integers(kind, rows.saturating_mul(components))?;
                    if components == 1 && names_parts(&String::from_utf8_lossy(name)) && self.parts.is_empty()
                    {
                        self.parts = values;
                    }
                }
                _ => return Ok(()),
            }
        }
        Ok(())
    }

    pub(super) fn skip_to_cell_data(&mut self) {
        const WORD: &[u8] = b"\nCELL_DATA";
        let at = self.tokens.rest().windows(WORD.len()).position(|w| w == WORD);
        self.tokens.take_bytes(at.map_or(self.tokens.rest().len(), |at| at + WORD.len()));
    }
}

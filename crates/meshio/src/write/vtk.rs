//! What VTK's XML files have in common: arrays declared in the text, their bytes appended raw.

use std::fmt::Write as _;
use std::io::{self, Write};

/// An array to append: its declaration and how to write its values.
pub(super) struct Appended<'a> {
    /// VTK's name of the type and the bytes that a value takes.
    pub kind: (&'static str, u64),
    pub name: &'a str,
    /// Values in a row: 3 for points.
    pub components: u64,
    pub rows: u64,
    /// Writes all values, little-endian.
    pub write: Box<dyn Fn(&mut dyn Write) -> io::Result<()> + 'a>,
}

impl Appended<'_> {
    fn bytes(&self) -> u64 {
        self.kind.1 * self.components * self.rows
    }
}

/// The text of a file in the making, and the arrays it has declared.
pub(super) struct VtkFile<'a> {
    root: &'static str,
    text: String,
    arrays: Vec<Appended<'a>>,
    offset: u64,
}

impl<'a> VtkFile<'a> {
    /// A file with one data set of the given kind.
    pub(super) fn new(root: &'static str) -> Self {
        let text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{root}\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\">\n"
        );
        Self { root, text, arrays: Vec::new(), offset: 0 }
    }

    /// Adds a line of XML.
    pub(super) fn line(&mut self, xml: &str) {
        self.text.push_str(xml);
        self.text.push('\n');
    }

    /// Declares an array at this place.
    pub(super) fn array(&mut self, array: Appended<'a>) {
        // A string is an infallible writer.
        let _ = writeln!(
            self.text,
            "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>",
            array.kind.0, array.name, array.components, self.offset
        );
        // Each array's bytes follow their number.
        self.offset += 8 + array.bytes();
        self.arrays.push(array);
    }

    pub(super) fn write(self, out: &mut impl Write) -> io::Result<()> {
        out.write_all(self.text.as_bytes())?;
        write!(out, "</{}>\n<AppendedData encoding=\"raw\">\n_", self.root)?;
        for array in &self.arrays {
            out.write_all(&array.bytes().to_le_bytes())?;
            (array.write)(out)?;
        }
        out.write_all(b"\n</AppendedData>\n</VTKFile>\n")
    }
}

pub(super) const INT32: (&str, u64) = ("Int32", 4);
pub(super) const UINT8: (&str, u64) = ("UInt8", 1);
pub(super) const INT64: (&str, u64) = ("Int64", 8);
pub(super) const FLOAT64: (&str, u64) = ("Float64", 8);

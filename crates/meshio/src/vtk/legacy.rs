//! VTK's older files (`.vtk`), versions 1 to 5.1: four lines, then the data set as text or as big-endian
//! bytes.

mod attributes;

use super::array::Number;
use super::{Sink, span};
use crate::cells::Cells;
use crate::error::Fault;
use crate::read::Parsed;
use crate::text::{Tokens, show};

pub(crate) const HEADER: &[u8] = b"# vtk DataFile Version";

pub(crate) fn parse(bytes: &[u8]) -> Result<Parsed, Fault> {
    let mut tokens = Tokens::without_comments(bytes);
    if !tokens.take_line().starts_with(HEADER) {
        return Err(Fault::at(1, "a file of VTK begins with \"# vtk DataFile Version\"; this one doesn't"));
    }
    tokens.take_line(); // A title.
    let binary = match tokens.word("ASCII or BINARY")? {
        word if word.eq_ignore_ascii_case(b"ASCII") => false,
        word if word.eq_ignore_ascii_case(b"BINARY") => true,
        word => return Err(tokens.fault(format!("{}; expected ASCII or BINARY", show(word)))),
    };
    File { tokens, binary, vertices: Vec::new(), groups: Vec::new(), types: Vec::new(), parts: Vec::new() }
        .read()
}

/// Lists of nodes, where each ends, and the type of the cells (`None`: each has its own).
struct Group {
    number: Option<i64>,
    nodes: Vec<i64>,
    ends: Vec<i64>,
}

struct File<'a> {
    tokens: Tokens<'a>,
    binary: bool,
    vertices: Vec<[f64; 3]>,
    groups: Vec<Group>,
    types: Vec<i64>,
    parts: Vec<i64>,
}

impl File<'_> {
    fn read(mut self) -> Result<Parsed, Fault> {
        while let Some(word) = self.tokens.next() {
            match word.to_ascii_uppercase().as_slice() {
                b"DATASET" => self.data_set()?,
                b"POINTS" => {
                    if !self.vertices.is_empty() {
                        return Err(self
                            .tokens
                            .fault("POINTS come a second time; a file holds one data set"));
                    }
                    let count = self.tokens.whole::<u64>("the number of points")?;
                    let values = self.floats(count.saturating_mul(3))?;
                    self.vertices = values.as_chunks().0.to_vec();
                }
                b"CELLS" => self.lists(None)?,
                b"VERTICES" => self.lists(Some(2))?,
                b"LINES" => self.lists(Some(4))?,
                b"POLYGONS" => self.lists(Some(7))?,
                b"TRIANGLE_STRIPS" => self.lists(Some(6))?,
                b"CELL_TYPES" => {
                    let count = self.tokens.whole("the number of cells")?;
                    self.types = self.integers(b"int", count)?;
                }
                b"METADATA" => self.metadata(),
                b"FIELD" => self.field(false)?,
                // What cells carry may say which part they belong to. Nothing after the cells is needed, so
                // what is not understood there ends the file without harm.
                b"CELL_DATA" => {
                    let _ = self.cell_data();
                    break;
                }
                b"POINT_DATA" => {
                    self.skip_to_cell_data();
                    let _ = self.cell_data();
                    break;
                }
                _ => {
                    let reason = format!("{} has no place in a file of VTK here", show(word));
                    return Err(self.tokens.fault(reason));
                }
            }
        }
        self.mesh()
    }

    fn data_set(&mut self) -> Result<(), Fault> {
        let name = self.tokens.word("the data set's name")?;
        if name.eq_ignore_ascii_case(b"UNSTRUCTURED_GRID") || name.eq_ignore_ascii_case(b"POLYDATA") {
            return Ok(());
        }
        let reason = format!(
            "data set {} is not supported, only UNSTRUCTURED_GRID and POLYDATA; convert it to one of these \
             (ParaView: Extract Surface), or a volume to .nrrd or .nii",
            show(name)
        );
        Err(Fault::unsupported(Some(self.tokens.line()), reason))
    }

    fn mesh(self) -> Result<Parsed, Fault> {
        let Self { vertices, groups, types, parts, .. } = self;
        let mut cells = Cells::default();
        let mut sink = Sink::new(&mut cells, 0, vertices.len());
        for group in &groups {
            if let Some(number) = group.number {
                sink.push_all(number, &group.nodes, &group.ends)?;
                continue;
            }
            if types.len() != group.ends.len() {
                return Err(Fault::new(format!(
                    "{} cells have {} types; the file is truncated or damaged; export it again",
                    group.ends.len(),
                    types.len()
                )));
            }
            let mut start = 0;
            for (cell, (&number, &end)) in types.iter().zip(&group.ends).enumerate() {
                sink.push(number, span(&group.nodes, start, end)?, parts.get(cell).copied())?;
                start = end;
            }
        }
        cells.into_mesh(vertices)
    }

    /// `n size` and lists that begin with their length; from version 5 on, `offsets size`, the offsets and
    /// the nodes.
    fn lists(&mut self, number: Option<i64>) -> Result<(), Fault> {
        let count = self.tokens.whole::<u64>("the number of cells")?;
        let size = self.tokens.whole::<u64>("the size of the cells")?;
        let mut ahead = self.tokens.clone();
        if ahead.next().is_some_and(|w| w.eq_ignore_ascii_case(b"OFFSETS")) {
            self.tokens = ahead;
            let kind = self.tokens.word("the type of the offsets")?;
            let mut ends = self.integers(kind, count)?;
            let connectivity = self.tokens.word("CONNECTIVITY")?;
            if !connectivity.eq_ignore_ascii_case(b"CONNECTIVITY") {
                return Err(self.tokens.fault(format!("{}; expected CONNECTIVITY", show(connectivity))));
            }
            let kind = self.tokens.word("the type of the nodes")?;
            let nodes = self.integers(kind, size)?;
            if ends.first().is_some_and(|&first| first != 0) {
                return Err(self.tokens.fault("the offsets of cells do not begin with 0"));
            }
            ends.drain(..1.min(ends.len()));
            self.groups.push(Group { number, nodes, ends });
            return Ok(());
        }
        let values = self.integers(b"int", size)?;
        let fault = || {
            self.tokens.fault(
                "the lists of cells do not have the declared size; the file is damaged; export it again",
            )
        };
        let (mut nodes, mut ends) = (Vec::with_capacity(values.len()), Vec::new());
        let mut rest = &values[..];
        while let [length, after @ ..] = rest {
            let (list, after) =
                usize::try_from(*length).ok().and_then(|n| after.split_at_checked(n)).ok_or_else(fault)?;
            nodes.extend_from_slice(list);
            ends.push(nodes.len() as i64);
            rest = after;
        }
        if ends.len() as u64 != count {
            return Err(fault());
        }
        self.groups.push(Group { number, nodes, ends });
        Ok(())
    }

    /// Numbers whose type is the next word.
    fn floats(&mut self, count: u64) -> Result<Vec<f64>, Fault> {
        let kind = self.tokens.word("the type of the numbers")?;
        if !self.binary {
            self.check_fits(count, 2)?;
            return (0..count).map(|_| self.tokens.number("a coordinate")).collect();
        }
        let number = number(kind).ok_or_else(|| self.tokens.fault(format!("type {}", show(kind))))?;
        Ok(number.floats(self.bytes(count, number)?, true))
    }

    fn integers(&mut self, kind: &[u8], count: u64) -> Result<Vec<i64>, Fault> {
        if !self.binary {
            self.check_fits(count, 2)?;
            return (0..count).map(|_| self.tokens.whole("a number of the cells")).collect();
        }
        let number = number(kind).ok_or_else(|| self.tokens.fault(format!("type {}", show(kind))))?;
        Ok(number.integers(self.bytes(count, number)?, true))
    }

    /// Big-endian bytes from the next line on.
    fn bytes(&mut self, count: u64, number: Number) -> Result<&[u8], Fault> {
        self.tokens.take_line();
        let bytes = usize::try_from(count.saturating_mul(number.size() as u64)).unwrap_or(usize::MAX);
        let line = self.tokens.line();
        self.tokens.take_bytes(bytes).ok_or_else(|| truncated(line, count))
    }

    fn check_fits(&self, count: u64, size: u64) -> Result<(), Fault> {
        if count.saturating_mul(size) > self.tokens.rest().len() as u64 + 1 {
            return Err(truncated(self.tokens.line(), count));
        }
        Ok(())
    }
}

fn truncated(line: usize, count: u64) -> Fault {
    Fault::at(
        line,
        format!(
            "{count} values are declared, more than the rest of the file holds; it is truncated or the count is wrong; copy or export it again"
        ),
    )
}

/// The type of binary values.
fn number(name: &[u8]) -> Option<Number> {
    Some(match name.to_ascii_lowercase().as_slice() {
        b"char" | b"signed_char" => Number::I8,
        b"unsigned_char" => Number::U8,
        b"short" => Number::I16,
        b"unsigned_short" => Number::U16,
        b"int" | b"vtkidtype" | b"vtktypeint32" => Number::I32,
        b"unsigned_int" | b"vtktypeuint32" => Number::U32,
        b"long" | b"long_long" | b"vtktypeint64" => Number::I64,
        b"unsigned_long" | b"vtktypeuint64" | b"unsigned_long_long" => Number::U64,
        b"float" => Number::F32,
        b"double" => Number::F64,
        _ => return None,
    })
}

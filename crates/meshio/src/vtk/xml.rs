//! VTK's XML files of unstructured grids (`.vtu`) and of polygons (`.vtp`).

use super::array::{Appended, Array, Encoding, appended};
use super::tags::Tags;
use super::{Sink, names_parts, span};
use crate::budget::Budget;
use crate::cells::Cells;
use crate::error::Fault;
use crate::read::Parsed;
use crate::text::show;

/// The data sets that are read.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum DataSet {
    UnstructuredGrid,
    PolyData,
}

impl DataSet {
    fn name(self) -> &'static str {
        match self {
            Self::UnstructuredGrid => "UnstructuredGrid",
            Self::PolyData => "PolyData",
        }
    }
}

/// What the root of an XML file of VTK says that it holds.
pub(crate) fn data_set(bytes: &[u8]) -> Option<&str> {
    let (_, tag) = Tags::new(bytes).next().ok()??;
    if tag.name == "VTKFile" { tag.attribute("type") } else { None }
}

/// One `Piece` of the file: its arrays with the section each stands in.
#[derive(Default)]
struct Piece<'a> {
    points: u64,
    arrays: Vec<(&'a str, Array<'a>)>,
}

impl<'a> Piece<'a> {
    fn find(&self, section: &str, is_it: impl Fn(&Array) -> bool) -> Option<&Array<'a>> {
        self.arrays.iter().find(|(s, array)| *s == section && is_it(array)).map(|(_, array)| array)
    }
}

pub(crate) fn parse(bytes: &[u8], expected: DataSet, budget: &Budget) -> Result<Parsed, Fault> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let (encoding, pieces, appended) = outline(bytes, expected, budget)?;
    let mut vertices = Vec::new();
    let mut cells = Cells::default();
    for piece in &pieces {
        let first = vertices.len();
        read_points(piece, encoding, appended, &mut vertices)?;
        if vertices.len() > u32::MAX as usize {
            return Err(Fault::new("the file has more than 2^32 points"));
        }
        let count = vertices.len() - first;
        let sink = Sink::new(&mut cells, first, count);
        match expected {
            DataSet::UnstructuredGrid => read_cells(piece, encoding, appended, sink)?,
            DataSet::PolyData => read_polygons(piece, encoding, appended, sink)?,
        }
    }
    if pieces.len() > 1 {
        cells.notes.push(format!("the file's {} pieces are one mesh", pieces.len()));
    }
    cells.into_mesh(vertices)
}

/// What the file declares, without the arrays' values.
fn outline<'a>(
    bytes: &'a [u8],
    expected: DataSet,
    budget: &'a Budget,
) -> Result<(Encoding<'a>, Vec<Piece<'a>>, Appended<'a>), Fault> {
    let mut tags = Tags::new(bytes);
    let mut root = None;
    let mut pieces: Vec<Piece> = Vec::new();
    let mut section = "";
    let mut data = Appended::default();
    let mut ended = false;
    while let Some((_, tag)) = tags.next()? {
        match tag.name {
            "VTKFile" if tag.opens => {
                let kind = tag.attribute("type").unwrap_or_default();
                if kind != expected.name() {
                    let reason = format!(
                        "the file holds VTK's {}, where {} is expected; convert it to one (ParaView: Extract Surface, saved as .vtp)",
                        show(kind.as_bytes()),
                        expected.name()
                    );
                    return Err(tags.fault(reason));
                }
                root = Some(Encoding::new(&tag, budget)?);
            }
            "VTKFile" => ended = true,
            "Piece" if tag.opens => {
                pieces.push(Piece { points: tag.count("NumberOfPoints")?, ..Piece::default() })
            }
            "Points" | "Cells" | "CellData" | "PointData" | "FieldData" | "Verts" | "Lines" | "Strips"
            | "Polys" => {
                section = if tag.closes { "" } else { tag.name };
            }
            "DataArray" if tag.opens => {
                let text = if tag.closes { &[][..] } else { array_text(&mut tags)? };
                let array = Array::new(&tag, text).map_err(|fault| tags.fault(fault.into_reason()))?;
                if let Some(piece) = pieces.last_mut() {
                    piece.arrays.push((section, array));
                }
            }
            "AppendedData" if tag.opens => {
                data = appended(&tag, tags.rest()).unwrap_or_default();
                ended = true;
                break;
            }
            _ => {}
        }
    }
    let Some(root) = root else {
        return Err(Fault::new("there is no tag VTKFile in it; is it of another format?"));
    };
    if !ended {
        return Err(tags.fault("the file ends before its last tag; it is truncated; copy or export it again"));
    }
    Ok((root, pieces, data))
}

/// The text of an array, which may hold tags with information too.
fn array_text<'a>(tags: &mut Tags<'a>) -> Result<&'a [u8], Fault> {
    let mut found: &[u8] = &[];
    let mut depth = 1;
    while depth > 0 {
        let Some((text, tag)) = tags.next()? else {
            return Err(tags.fault("the file ends within an array; it is truncated; copy or export it again"));
        };
        if depth == 1 && found.is_empty() {
            found = text.trim_ascii();
        }
        depth += usize::from(tag.opens);
        depth -= usize::from(tag.closes);
    }
    Ok(found)
}

fn read_points(
    piece: &Piece,
    encoding: Encoding,
    appended: Appended,
    vertices: &mut Vec<[f64; 3]>,
) -> Result<(), Fault> {
    let Some(array) = piece.find("Points", |_| true) else {
        return if piece.points == 0 { Ok(()) } else { Err(Fault::new("a piece has no points")) };
    };
    if ![0, 3].contains(&array.components) && piece.points > 0 {
        return Err(Fault::new(format!("points have {} coordinates; three are needed", array.components)));
    }
    let values = array.floats(encoding, appended)?;
    check_length("points", values.len() as u64, piece.points.saturating_mul(3))?;
    vertices.extend_from_slice(values.as_chunks().0);
    Ok(())
}

fn check_length(what: &str, found: u64, expected: u64) -> Result<(), Fault> {
    if found == expected {
        return Ok(());
    }
    Err(Fault::new(format!(
        "array {what:?} has {found} values, where {expected} are declared; the file is truncated or damaged; copy or export it again"
    )))
}

fn read_cells(piece: &Piece, encoding: Encoding, appended: Appended, mut sink: Sink) -> Result<(), Fault> {
    let whole = |name: &str| match piece.find("Cells", |a| a.name == name) {
        Some(array) => array.integers(encoding, appended),
        None => Ok(Vec::new()),
    };
    let (types, ends, nodes) = (whole("types")?, whole("offsets")?, whole("connectivity")?);
    check_length("offsets", ends.len() as u64, types.len() as u64)?;
    let parts = match piece.find("CellData", |a| names_parts(a.name) && a.is_whole() && a.components <= 1) {
        Some(array) => array.integers(encoding, appended)?,
        None => Vec::new(),
    };
    let mut start = 0;
    for (cell, (&number, &end)) in types.iter().zip(&ends).enumerate() {
        sink.push(number, span(&nodes, start, end)?, parts.get(cell).copied())?;
        start = end;
    }
    Ok(())
}

fn read_polygons(piece: &Piece, encoding: Encoding, appended: Appended, mut sink: Sink) -> Result<(), Fault> {
    for (section, number) in [("Verts", 2), ("Lines", 4), ("Polys", 7), ("Strips", 6)] {
        let whole = |name: &str| match piece.find(section, |a| a.name == name) {
            Some(array) => array.integers(encoding, appended),
            None => Ok(Vec::new()),
        };
        sink.push_all(number, &whole("connectivity")?, &whole("offsets")?)?;
    }
    Ok(())
}

use crate::error::Fault;
use crate::text::{Lines, Words, parse as number, show};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes of a value in binary files.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

#[derive(Debug)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
}

#[derive(Debug)]
pub(super) struct Element {
    /// Of its declaration.
    pub line: usize,
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

#[derive(Debug)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
}

impl Header {
    /// The header, and the lines after it.
    pub(super) fn parse(bytes: &[u8]) -> Result<(Self, Lines<'_>), Fault> {
        let mut lines = Lines::new(bytes);
        if lines.next().is_none_or(|line| line.text.trim_ascii() != b"ply") {
            return Err(Fault::at(1, "a PLY file begins with a line \"ply\"; this one doesn't"));
        }
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        while let Some(line) = lines.next() {
            let mut words = line.words();
            let fault = |reason: String| Fault::at(line.number, reason);
            match words.next() {
                Some(b"format") => encoding = Some(parse_encoding(words, line.number)?),
                Some(b"element") => {
                    let name = words.next().ok_or_else(|| fault("an element without a name".into()))?;
                    elements.push(Element {
                        line: line.number,
                        name: String::from_utf8_lossy(name).into_owned(),
                        count: words.whole("the number of elements")?,
                        properties: Vec::new(),
                    });
                }
                Some(b"property") => {
                    let property = parse_property(words)
                        .ok_or_else(|| fault(format!("no property of PLY: {}", show(line.text))))?;
                    let element = elements.last_mut();
                    element
                        .ok_or_else(|| fault("a property before any element".into()))?
                        .properties
                        .push(property);
                }
                Some(b"end_header") => {
                    let encoding =
                        encoding.ok_or_else(|| fault("the header has no line \"format\"".into()))?;
                    return Ok((Self { encoding, elements }, lines));
                }
                Some(b"comment" | b"obj_info") | None => {}
                Some(word) => return Err(fault(format!("{} has no place in a PLY header", show(word)))),
            }
        }
        Err(Fault::at(
            lines.number(),
            "the file ends before end_header; it is truncated; copy or export it again",
        ))
    }
}

fn parse_encoding(mut words: Words, line: usize) -> Result<Encoding, Fault> {
    let (encoding, version) = (words.next().unwrap_or_default(), words.next());
    if version.is_some_and(|v| number::<f64>(v) != Some(1.0)) {
        return Err(Fault::unsupported(Some(line), "only version 1.0 of PLY is supported"));
    }
    match encoding {
        b"ascii" => Ok(Encoding::Ascii),
        b"binary_little_endian" => Ok(Encoding::LittleEndian),
        b"binary_big_endian" => Ok(Encoding::BigEndian),
        _ => {
            let encoding = show(encoding);
            Err(Fault::at(
                line,
                format!("format {encoding}; expected ascii, binary_little_endian or binary_big_endian"),
            ))
        }
    }
}

fn parse_property(mut words: Words) -> Option<Property> {
    let kind = match words.next()? {
        b"list" => {
            Kind::List { count: Scalar::from_name(words.next()?)?, item: Scalar::from_name(words.next()?)? }
        }
        scalar => Kind::Scalar(Scalar::from_name(scalar)?),
    };
    Some(Property { name: String::from_utf8_lossy(words.next()?).into_owned(), kind })
}

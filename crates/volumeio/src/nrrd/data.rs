//! The values: in the file itself, in another or in many.
use super::header::Header;
use crate::Samples;
use crate::bytes::{all_numbered, beside, finish, open_raw, skip, text};
use crate::error::Fault;
use crate::sample_type::SampleType;
use crate::text_values::unhex;
use bzip2::bufread::MultiBzDecoder;
use flate2::bufread::MultiGzDecoder;
use mser3d_fileio::ReadLimits;
use std::io::{BufRead, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

pub(super) fn read(
    header: &Header,
    count: usize,
    source: impl BufRead,
    path: &Path,
    limits: &ReadLimits,
) -> Result<Samples, Fault> {
    let coding = Coding::of(header)?;
    let Some(place) = header.data_file() else {
        if coding.at_end {
            let reason = "byte skip -1 is for data in another file; save the file again without it";
            return Err(Fault::unsupported(reason));
        }
        return coding.read(count, source, limits);
    };
    let files = data_files(header, place, path, limits)?;
    let each = count / files.len();
    if each * files.len() != count {
        let files = files.len();
        return Err(Fault::invalid(format!("{count} values do not fit into {files} files of equal size")));
    }
    let mut all: Option<Samples> = None;
    for file in files {
        let mut source = open_raw(&file)?;
        if coding.at_end {
            let wanted = each.saturating_mul(coding.sample.bytes()) as u64;
            let length = source.get_ref().size()?;
            source.seek(SeekFrom::Start(length.saturating_sub(wanted)))?;
        }
        let part = coding.read(each, source, limits).map_err(|fault| fault.of_part(&file))?;
        match &mut all {
            None => all = Some(part),
            Some(all) => {
                all.append(part);
            }
        }
    }
    all.ok_or_else(|| Fault::invalid("its list of data files is empty"))
}

/// The files that `data file` names, which lie beside the header.
fn data_files(header: &Header, place: &str, path: &Path, limits: &ReadLimits) -> Result<Vec<PathBuf>, Fault> {
    let beside = |name: &String| beside(path, name, limits);
    if place.split_whitespace().next() == Some("LIST") {
        let files = header.listed.iter().map(beside).collect::<Result<Vec<_>, _>>()?;
        if files.is_empty() {
            return Err(Fault::invalid("its list of data files is empty"));
        }
        return Ok(files);
    }
    // A pattern is followed by the first and the last number and the step, and perhaps by a dimension.
    let words: Vec<&str> = place.split_whitespace().collect();
    if let [pattern, numbers @ ..] = &words[..]
        && pattern.contains('%')
        && matches!(numbers.len(), 3 | 4)
    {
        let numbers = numbers.iter().map(|word| word.parse().ok()).collect::<Option<Vec<i64>>>();
        let names = numbers.and_then(|n| all_numbered(pattern, [n[0], n[1], n[2]]));
        let names =
            names.ok_or_else(|| Fault::invalid(format!("data file: {place}: no pattern with numbers")))?;
        return names.iter().map(beside).collect();
    }
    Ok(vec![beside(&place.to_owned())?])
}

/// How the values are written.
struct Coding {
    sample: SampleType,
    big_endian: bool,
    encoding: Encoding,
    /// Lines to leave out before anything is unpacked.
    lines: u64,
    /// Bytes to leave out after that.
    bytes: u64,
    /// The data stands at the end of its file.
    at_end: bool,
}

#[derive(PartialEq)]
enum Encoding {
    Raw,
    Text,
    Hex,
    Gzip,
    Bzip2,
}

impl Coding {
    fn of(header: &Header) -> Result<Self, Fault> {
        let encoding = match header.required("encoding")?.to_ascii_lowercase().as_str() {
            "raw" => Encoding::Raw,
            "ascii" | "text" | "txt" => Encoding::Text,
            "hex" => Encoding::Hex,
            "gzip" | "gz" => Encoding::Gzip,
            "bzip2" | "bz2" => Encoding::Bzip2,
            other => {
                return Err(Fault::unsupported(format!("encoding {other:?}; save the file as raw or gzip")));
            }
        };
        let skip = |name: &str| -> Result<i64, Fault> {
            match header.text(name) {
                None => Ok(0),
                Some(_) => Ok(header.numbers(name)?.first().copied().unwrap_or(0)),
            }
        };
        let (lines, bytes) = (skip("line skip")?, skip("byte skip")?);
        let at_end = bytes == -1 && encoding == Encoding::Raw;
        if lines < 0 || (bytes < 0 && !at_end) {
            return Err(Fault::invalid(format!(
                "line skip {lines} and byte skip {bytes} are not possible here"
            )));
        }
        let sample = sample(header)?;
        let endian = header.text("endian").map(str::to_ascii_lowercase);
        let needs_endian = !matches!(encoding, Encoding::Text) && sample.bytes() > 1;
        let big_endian = match endian.as_deref() {
            Some("big") => true,
            Some("little") => false,
            None if !needs_endian => false,
            None => {
                let reason =
                    "the header does not say the order of bytes; add the line \"endian: little\" or big";
                return Err(Fault::invalid(reason));
            }
            Some(other) => {
                return Err(Fault::invalid(format!("endian is {other:?}, neither little nor big")));
            }
        };
        let bytes = if at_end { 0 } else { bytes as u64 };
        Ok(Self { sample, big_endian, encoding, lines: lines as u64, bytes, at_end })
    }

    fn read(&self, count: usize, mut source: impl BufRead, limits: &ReadLimits) -> Result<Samples, Fault> {
        for _ in 0..self.lines {
            if source.skip_until(b'\n')? == 0 {
                return Err(Fault::invalid("the file ends within the lines that line skip leaves out"));
            }
        }
        match self.encoding {
            Encoding::Raw => self.raw(count, &mut source),
            Encoding::Gzip => self.packed(count, MultiGzDecoder::new(source)),
            Encoding::Bzip2 => self.packed(count, MultiBzDecoder::new(source)),
            Encoding::Text => {
                skip(&mut source, self.bytes)?;
                self.sample.read_text(count, &text(source, limits, self.sample.kept(count))?)
            }
            Encoding::Hex => {
                skip(&mut source, self.bytes)?;
                self.sample.read(
                    count,
                    self.big_endian,
                    &unhex(&text(source, limits, self.sample.kept(count).saturating_mul(2))?)?[..],
                )
            }
        }
    }

    fn packed(&self, count: usize, mut source: impl Read) -> Result<Samples, Fault> {
        let values = self.raw(count, &mut source)?;
        finish(source)?;
        Ok(values)
    }

    fn raw(&self, count: usize, source: &mut impl Read) -> Result<Samples, Fault> {
        skip(source, self.bytes)?;
        self.sample.read(count, self.big_endian, source)
    }
}

/// The type of the numbers.
pub(super) fn sample(header: &Header) -> Result<SampleType, Fault> {
    let name = header.required("type")?;
    Ok(match name.to_ascii_lowercase().as_str() {
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => SampleType::U8,
        "signed char" | "int8" | "int8_t" => SampleType::I8,
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => SampleType::U16,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => SampleType::I16,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => SampleType::U32,
        "int" | "signed int" | "int32" | "int32_t" => SampleType::I32,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => {
            SampleType::U64
        }
        "longlong"
        | "long long"
        | "long long int"
        | "signed long long"
        | "signed long long int"
        | "int64"
        | "int64_t" => SampleType::I64,
        "float" => SampleType::F32,
        "double" => SampleType::F64,
        _ => return Err(Fault::unsupported(format!("numbers of type {name:?}; save them as float"))),
    })
}

//! The values: after the header, in another file or in many.
use super::header::Header;
use crate::Samples;
use crate::bytes::{all_numbered, beside, finish, open_raw, skip, text};
use crate::error::Fault;
use crate::sample_type::SampleType;
use flate2::bufread::{MultiGzDecoder, ZlibDecoder};
use mser3d_fileio::ReadLimits;
use std::io::{BufRead, Read, Seek, SeekFrom};
use std::path::Path;

/// How the values are written.
pub(super) struct Coding {
    pub sample: SampleType,
    big_endian: bool,
    text: bool,
    packed: bool,
    /// Bytes before the values in a file of their own; none where they stand at its end.
    skip: Option<u64>,
}

impl Coding {
    pub fn of(header: &Header) -> Result<Self, Fault> {
        let kind = header.text(&["ElementType"]).unwrap_or_default();
        let sample = match kind.strip_suffix("_ARRAY").unwrap_or(kind) {
            "MET_UCHAR" => SampleType::U8,
            "MET_CHAR" => SampleType::I8,
            "MET_USHORT" => SampleType::U16,
            "MET_SHORT" => SampleType::I16,
            // Its long has 32 bits, whatever the machine's.
            "MET_UINT" | "MET_ULONG" => SampleType::U32,
            "MET_INT" | "MET_LONG" => SampleType::I32,
            "MET_ULONG_LONG" => SampleType::U64,
            "MET_LONG_LONG" => SampleType::I64,
            "MET_FLOAT" => SampleType::F32,
            "MET_DOUBLE" => SampleType::F64,
            other => {
                return Err(Fault::unsupported(format!(
                    "ElementType {other:?}; save the values as MET_FLOAT"
                )));
            }
        };
        let skip = header.numbers::<i64>(&["HeaderSize"], 1)?.map_or(0, |n| n[0]);
        if skip < -1 {
            return Err(Fault::invalid(format!("HeaderSize is {skip}")));
        }
        Ok(Self {
            sample,
            big_endian: header.is_true(&["BinaryDataByteOrderMSB", "ElementByteOrderMSB"]),
            // Binary is what everybody writes, and some do not say.
            text: header.text(&["BinaryData"]).is_some() && !header.is_true(&["BinaryData"]),
            packed: header.is_true(&["CompressedData"]),
            skip: u64::try_from(skip).ok(),
        })
    }

    /// Reads what `ElementDataFile` names, of a volume with `layers` layers.
    pub fn read(
        &self,
        header: &Header,
        count: usize,
        mut source: impl BufRead,
        path: &Path,
        limits: &ReadLimits,
    ) -> Result<Samples, Fault> {
        let place = header.data_file.as_str();
        if place.eq_ignore_ascii_case("LOCAL") {
            return self.values(count, source, limits);
        }
        let words: Vec<&str> = place.split_whitespace().collect();
        let mut names = vec![place.to_owned()];
        if words.first() == Some(&"LIST") {
            let mut text = String::new();
            source.by_ref().take(16 << 20).read_to_string(&mut text)?;
            names = text.lines().map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect();
        } else if let [pattern, numbers @ ..] = &words[..]
            && pattern.contains('%')
            && (2..=3).contains(&numbers.len())
        {
            let numbers = numbers.iter().map(|word| word.parse().ok()).collect::<Option<Vec<i64>>>();
            let numbers = numbers.map(|n| [n[0], n[1], n.get(2).copied().unwrap_or(1)]);
            names = numbers.and_then(|numbers| all_numbered(pattern, numbers)).ok_or_else(|| {
                Fault::invalid(format!("ElementDataFile = {place}: no pattern with numbers"))
            })?;
        }
        let each = count / names.len().max(1);
        if names.is_empty() || each * names.len() != count {
            let files = names.len();
            return Err(Fault::invalid(format!(
                "{count} values do not fit into {files} files of equal size"
            )));
        }
        let files = names.iter().map(|name| beside(path, name, limits)).collect::<Result<Vec<_>, _>>()?;
        let mut all: Option<Samples> = None;
        for file in files {
            let part = self.file(each, &file, limits).map_err(|fault| fault.of_part(&file))?;
            match &mut all {
                None => all = Some(part),
                Some(all) => {
                    all.append(part);
                }
            }
        }
        all.ok_or_else(|| Fault::invalid("its list of data files is empty"))
    }

    fn file(&self, count: usize, path: &Path, limits: &ReadLimits) -> Result<Samples, Fault> {
        let mut source = open_raw(path)?;
        match self.skip {
            Some(bytes) => skip(&mut source, bytes)?,
            None => {
                let wanted = count.saturating_mul(self.sample.bytes()) as u64;
                let length = source.get_ref().size()?;
                source.seek(SeekFrom::Start(length.saturating_sub(wanted)))?;
            }
        }
        self.values(count, source, limits)
    }

    fn values<'a>(
        &self,
        count: usize,
        mut source: impl BufRead + 'a,
        limits: &ReadLimits,
    ) -> Result<Samples, Fault> {
        if self.packed {
            // zlib's wrapping by the standard; gzip's by hand.
            let mut unpacked: Box<dyn Read> = match source.fill_buf()?.starts_with(&[0x1f, 0x8b]) {
                true => Box::new(MultiGzDecoder::new(source)),
                false => Box::new(ZlibDecoder::new(source)),
            };
            let values = self.sample.read(count, self.big_endian, &mut unpacked)?;
            finish(unpacked)?;
            return Ok(values);
        }
        if self.text {
            return self.sample.read_text(count, &text(source, limits, self.sample.kept(count))?);
        }
        self.sample.read(count, self.big_endian, source)
    }
}

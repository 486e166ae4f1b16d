//! The values of one page: strips or tiles, unpacked and put together.
use super::codec::{Codec, undo_differences};
use super::directory::{Directory, Source};
use super::fax::WIDEST;
use super::layout::{Layout, spread};
use crate::Samples;
use crate::error::Fault;
use crate::half::halves;
use crate::sample_type::SampleType;
use std::io::{Read, Seek};

/// How a page is stored.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Page {
    pub width: usize,
    pub height: usize,
    /// Numbers of a pixel.
    pub samples: usize,
    pub bits: u32,
    format: Format,
    pub photometric: u64,
    /// Whether the first extra number of a pixel is its opacity.
    pub has_alpha: bool,
    layout: Layout,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Unsigned,
    Signed,
    Float,
}

impl Page {
    pub fn of(source: &Source<impl Read + Seek>, directory: &Directory) -> Result<Self, Fault> {
        let number = |tag: u16, usual: u64| source.number(directory, tag).unwrap_or(usual);
        let list = |tag: u16| source.numbers(directory, tag);
        let size = |tag: u16| usize::try_from(number(tag, 0)).ok().filter(|&n| n > 0 && n <= 1 << 31);
        let (Some(width), Some(height)) = (size(256), size(257)) else {
            return Err(Fault::invalid("a page has no width or height"));
        };
        if number(32997, 1) > 1 {
            return Err(Fault::unsupported("pages with a depth; export a page for each layer"));
        }
        let samples = usize::try_from(number(277, 1)).ok().filter(|n| (1..=65535).contains(n));
        let samples = samples.ok_or_else(|| Fault::invalid("a page has no samples in its pixels"))?;
        let alike = |tag: u16, usual: u64| {
            let all = list(tag).unwrap_or_default();
            let first = all.first().copied().unwrap_or(usual);
            if all.iter().all(|&x| x == first) { Ok(first) } else { Err(all) }
        };
        let mixed = |all: Vec<u64>| {
            Fault::unsupported(format!(
                "the samples of a pixel are stored in different ways ({all:?}); export them alike"
            ))
        };
        let bits = alike(258, 1).map_err(mixed)?;
        let format = match alike(339, 1).map_err(mixed)? {
            1 | 4 => Format::Unsigned,
            2 => Format::Signed,
            3 => Format::Float,
            _ => return Err(Fault::unsupported("complex numbers; export their magnitudes")),
        };
        let known = match format {
            Format::Unsigned => matches!(bits, 1..=32 | 64),
            Format::Signed => matches!(bits, 8 | 16 | 32 | 64),
            Format::Float => matches!(bits, 16 | 32 | 64),
        };
        if !known {
            return Err(Fault::unsupported(format!(
                "numbers of {bits} bits ({format:?}); export 8, 16 or 32 bits"
            )));
        }
        let layout = Layout::of(source, directory, width, height, samples)?;
        if matches!(layout.codec, Codec::Fax(_)) {
            if (bits, samples) != (1, 1) {
                return Err(Fault::invalid("packed as fax, but its pixels are not of one bit"));
            }
            let widest = width.max(layout.piece[0]);
            if widest > WIDEST {
                return Err(Fault::invalid(format!("a row of {widest} pixels is too wide for fax")));
            }
        }
        if layout.predictor != 1 && !matches!(bits, 8 | 16 | 32 | 64) {
            let predictor = layout.predictor;
            return Err(Fault::unsupported(format!(
                "predictor {predictor} of numbers of {bits} bits; export 8, 16 or 32 bits, or without compression"
            )));
        }
        let extra = list(338).unwrap_or_default();
        let photometric = number(262, 1);
        if matches!(photometric, 6 | 32844 | 32845) {
            return Err(Fault::unsupported("colours as YCbCr or LogLuv; export grey values or RGB"));
        }
        Ok(Self {
            width,
            height,
            samples,
            bits: bits as u32,
            format,
            photometric,
            has_alpha: matches!(extra.first(), Some(1 | 2)),
            layout,
        })
    }

    /// Whether both are pages of one stack.
    pub fn is_like(&self, other: &Self) -> bool {
        let key = |p: &Self| (p.width, p.height, p.samples, p.bits, p.format);
        key(self) == key(other)
    }

    /// `30 x 40 pixels of 1 x 8 bits`.
    pub fn describe(&self) -> String {
        format!("{} x {} pixels of {} x {} bits", self.width, self.height, self.samples, self.bits)
    }

    /// The page with `count` more of its size behind it, which no directory tells of: how ImageJ saves beyond 4 GB.
    pub fn repeated(&self, count: usize) -> Result<Self, Fault> {
        let layout = &self.layout;
        let follows = layout
            .offsets
            .windows(2)
            .zip(&layout.counts)
            .all(|(pair, &n)| pair[0].checked_add(n) == Some(pair[1]));
        if layout.codec != Codec::None || layout.planar || layout.tiled || !follows {
            return Err(Fault::unsupported(format!(
                "{count} images are promised with one directory, but packed or in tiles; export a page for each"
            )));
        }
        let height = self.height.checked_mul(count).filter(|&h| h <= 1 << 40);
        let height = height.ok_or_else(|| Fault::invalid(format!("{count} images are promised")))?;
        let bytes = height.checked_mul(self.row_bytes(self.width, self.samples));
        let bytes = bytes.ok_or_else(|| Fault::invalid(format!("{count} images are promised")))?;
        let layout = Layout {
            offsets: layout.offsets[..1].to_vec(),
            counts: vec![bytes as u64],
            piece: [self.width, height],
            ..layout.clone()
        };
        Ok(Self { height, layout, ..self.clone() })
    }

    /// Whether `count` images of this size fit into the file from the first on.
    pub fn has_room(&self, source: &Source<impl Read + Seek>, count: usize) -> bool {
        let bytes = (self.row_bytes(self.width, self.samples) as u64).saturating_mul(self.height as u64);
        let start = self.layout.offsets.first().copied().unwrap_or(u64::MAX);
        bytes.saturating_mul(count as u64) <= source.left(start)
    }

    fn row_bytes(&self, width: usize, samples: usize) -> usize {
        (width as u64 * samples as u64 * u64::from(self.bits)).div_ceil(8) as usize
    }

    /// The values row by row, the numbers of a pixel side by side.
    pub fn read(&self, source: &mut Source<impl Read + Seek>) -> Result<Samples, Fault> {
        let Layout { piece: [across, down], planar, .. } = self.layout;
        let planes = if planar { self.samples } else { 1 };
        let within = self.samples / planes;
        let [columns, rows] = [self.width.div_ceil(across), self.height.div_ceil(down)];
        let pieces = columns.checked_mul(rows).and_then(|n| n.checked_mul(planes)).unwrap_or(usize::MAX);
        let (offsets, counts) = (&self.layout.offsets, &self.layout.counts);
        if offsets.len() < pieces || counts.len() < pieces {
            let found = offsets.len().min(counts.len());
            return Err(Fault::invalid(format!("a page needs {pieces} strips or tiles, but has {found}")));
        }
        // What a piece is said to have beyond the end of the file is not there.
        let there = offsets.iter().zip(counts).map(|(&offset, &count)| count.min(source.left(offset)));
        let stored = there.fold(0u64, |sum, n| sum.saturating_add(n));
        let row = self.row_bytes(self.width, self.samples) as u64;
        let promised = row.saturating_mul(self.height as u64);
        if promised > self.layout.codec.most(stored, row) {
            return Err(Fault::invalid(format!(
                "a page promises {promised} bytes of values, but there are {stored}; copy or export the file again"
            )));
        }
        let unit = self.unit();
        let values = self.width.checked_mul(self.height).and_then(|n| n.checked_mul(self.samples * unit));
        let total = values.ok_or_else(|| Fault::invalid("a page is larger than any memory"))?;
        let mut out = vec![0u8; total];
        for plane in 0..planes {
            for row in 0..rows {
                for column in 0..columns {
                    let (x, y) = (column * across, row * down);
                    let [w, h] = [across.min(self.width - x), down.min(self.height - y)];
                    // Strips end with the page; tiles are always whole.
                    let held = if self.layout.tiled { down } else { h };
                    let number = (plane * rows + row) * columns + column;
                    let bytes = self.piece(source, number, [across, held], within)?;
                    let line = across * within * unit;
                    for j in 0..h {
                        let from = &bytes[j * line..][..w * within * unit];
                        let to = ((y + j) * self.width + x) * self.samples * unit;
                        if planes == 1 {
                            out[to..to + from.len()].copy_from_slice(from);
                            continue;
                        }
                        for (i, value) in from.chunks_exact(unit).enumerate() {
                            let to = to + (i * self.samples + plane) * unit;
                            out[to..to + unit].copy_from_slice(value);
                        }
                    }
                }
            }
        }
        match (self.format, self.bits) {
            (Format::Float, 16) => Ok(halves(&SampleType::U16.decode(out, false))),
            _ => Ok(self.sample_type().decode(out, false)),
        }
    }

    /// A strip or tile, a whole number of bytes for each value, little end first.
    fn piece(
        &self,
        source: &mut Source<impl Read + Seek>,
        number: usize,
        [across, down]: [usize; 2],
        samples: usize,
    ) -> Result<Vec<u8>, Fault> {
        let Layout { offsets, counts, codec, predictor, reversed, .. } = &self.layout;
        let row = self.row_bytes(across, samples);
        let wanted = row.saturating_mul(down);
        let short = |found: usize| {
            Fault::invalid(format!(
                "strip or tile {} holds {found} of {wanted} bytes; copy or export the file again",
                number + 1
            ))
        };
        let count = counts[number];
        if wanted as u64 > codec.most(count, row as u64) {
            return Err(short(count as usize));
        }
        let mut packed = source.at(offsets[number], count)?;
        if *reversed {
            packed.iter_mut().for_each(|byte| *byte = byte.reverse_bits());
        }
        let mut bytes = codec.unpack(packed, wanted, [across, down])?;
        if bytes.len() < wanted {
            return Err(short(bytes.len()));
        }
        bytes.truncate(wanted);
        let unit = self.unit();
        undo_differences(&mut bytes, *predictor, row, samples, unit, source.big_endian)?;
        if !matches!(self.bits, 8 | 16 | 32 | 64) {
            let values = across * samples;
            return Ok(bytes
                .chunks_exact(row)
                .flat_map(|row| spread(row, self.bits, unit, values))
                .collect());
        }
        // The prediction of floating-point numbers has an order of bytes of its own.
        if source.big_endian && unit > 1 && *predictor != 3 {
            bytes.chunks_exact_mut(unit).for_each(<[u8]>::reverse);
        }
        Ok(bytes)
    }

    /// Bytes of a value when it is unpacked.
    fn unit(&self) -> usize {
        match self.bits {
            ..=8 => 1,
            9..=16 => 2,
            17..=32 => 4,
            _ => 8,
        }
    }

    /// Bytes of a value in memory.
    pub fn value_bytes(&self) -> usize {
        // Half numbers are numbers of 16 bits first.
        if self.format == Format::Float && self.bits == 16 { 6 } else { self.unit() }
    }

    fn sample_type(&self) -> SampleType {
        match (self.format, self.unit()) {
            (Format::Unsigned, 1) => SampleType::U8,
            (Format::Unsigned, 2) => SampleType::U16,
            (Format::Unsigned, 4) => SampleType::U32,
            (Format::Unsigned, _) => SampleType::U64,
            (Format::Signed, 1) => SampleType::I8,
            (Format::Signed, 2) => SampleType::I16,
            (Format::Signed, 4) => SampleType::I32,
            (Format::Signed, _) => SampleType::I64,
            (Format::Float, 4) => SampleType::F32,
            (Format::Float, _) => SampleType::F64,
        }
    }
}

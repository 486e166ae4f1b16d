//! Where the strips or tiles of a page are, and how they are packed.
use super::codec::Codec;
use super::directory::{Directory, Source};
use crate::error::Fault;
use std::io::{Read, Seek};

/// No way of packing makes more bytes than this of one.
pub(super) const MOST_PACKED: u64 = 4096;

/// Where the pieces of a page are, and how they are packed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    pub offsets: Vec<u64>,
    pub counts: Vec<u64>,
    /// Pixels of a strip or tile.
    pub piece: [usize; 2],
    /// The numbers of a pixel lie in planes of their own.
    pub planar: bool,
    pub tiled: bool,
    pub codec: Codec,
    pub predictor: u64,
    pub reversed: bool,
}

/// Numbers of other than 8, 16, 32 or 64 bits, the first in the highest bits, as `unit` bytes each.
pub(super) fn spread(row: &[u8], bits: u32, unit: usize, count: usize) -> Vec<u8> {
    let mut values = Vec::with_capacity(count * unit);
    let (mut held, mut have) = (0u64, 0);
    let mut bytes = row.iter();
    for _ in 0..count {
        while have < bits {
            held = held << 8 | u64::from(bytes.next().copied().unwrap_or(0));
            have += 8;
        }
        have -= bits;
        let value = held >> have & ((1 << bits) - 1);
        values.extend_from_slice(&value.to_le_bytes()[..unit]);
    }
    values
}

impl Layout {
    pub fn of(
        source: &Source<impl Read + Seek>,
        directory: &Directory,
        width: usize,
        height: usize,
        samples: usize,
    ) -> Result<Self, Fault> {
        let number = |tag: u16, usual: u64| source.number(directory, tag).unwrap_or(usual);
        let list = |tag: u16| source.numbers(directory, tag);
        let tiled = list(324).is_some();
        let (offsets, counts) = if tiled { (list(324), list(325)) } else { (list(273), list(279)) };
        let offsets = offsets.filter(|all| !all.is_empty());
        let offsets = offsets.ok_or_else(|| Fault::invalid("a page does not say where its values are"))?;
        let side = |tag: u16, usual: usize| {
            let side = usize::try_from(number(tag, usual as u64)).unwrap_or(usize::MAX);
            if side == 0 { usual } else { side }
        };
        let piece = match tiled {
            true => [side(322, width), side(323, height)].map(|side| side.min(1 << 24)),
            false => [width, side(278, height).min(height)],
        };
        let codec = Codec::of(number(259, 1))?;
        let counts = match counts {
            Some(counts) => counts,
            // A single strip that does not say how long it is goes on to the end.
            None if offsets.len() == 1 => vec![source.left(offsets[0])],
            None => return Err(Fault::invalid("a page does not say how long its strips are")),
        };
        Ok(Self {
            offsets,
            counts,
            piece,
            planar: number(284, 1) == 2 && samples > 1,
            tiled,
            codec,
            predictor: number(317, 1),
            reversed: number(266, 1) == 2,
        })
    }
}

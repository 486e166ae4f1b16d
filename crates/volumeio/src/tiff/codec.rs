//! How pieces of a page are packed.
use crate::error::Fault;
use flate2::read::ZlibDecoder;
use std::io::Read;
use weezl::{BitOrder, LzwStatus, decode::Decoder};

/// A way of packing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Codec {
    None,
    Lzw,
    Deflate,
    PackBits,
    /// Of fax machines, of this group.
    Fax(u8),
}

impl Codec {
    /// The way of this number; `t4` are the options of group 3.
    pub fn of(number: u64, t4: u64) -> Result<Self, Fault> {
        let name = match number {
            1 => return Ok(Self::None),
            5 => return Ok(Self::Lzw),
            8 | 32946 => return Ok(Self::Deflate),
            32773 => return Ok(Self::PackBits),
            3 if t4 & 1 == 0 => return Ok(Self::Fax(3)),
            4 => return Ok(Self::Fax(4)),
            2 | 3 => "fax of group 3 in two dimensions or without ends of lines",
            6 | 7 => "JPEG",
            34712 => "JPEG 2000",
            34925 => "LZMA",
            50000 => "Zstandard",
            50001 => "WebP",
            34887 => "LERC",
            _ => "unknown",
        };
        Err(Fault::unsupported(format!(
            "packed by method {number} ({name}); export it uncompressed, or with LZW or Deflate"
        )))
    }

    /// More bytes than this, in rows of `row` bytes, cannot be packed in `packed` bytes.
    pub fn most(self, packed: u64, row: u64) -> u64 {
        match self {
            // A white row has one bit.
            Self::Fax(_) => packed.saturating_mul(8).saturating_add(64).saturating_mul(row),
            Self::None => packed,
            // Deflate makes a thousand bytes of one, LZW less than three thousand, PackBits 64.
            Self::Lzw | Self::Deflate | Self::PackBits => packed.saturating_add(4096).saturating_mul(4096),
        }
    }

    /// What is packed, but no more than `most` bytes.
    /// Only fax needs to know how many pixels and rows there are.
    pub fn unpack(self, packed: Vec<u8>, most: usize, size: [usize; 2]) -> Result<Vec<u8>, Fault> {
        match self {
            Self::None => Ok(packed),
            Self::Deflate => {
                let mut out = Vec::new();
                ZlibDecoder::new(&packed[..]).take(most as u64).read_to_end(&mut out)?;
                Ok(out)
            }
            Self::Lzw => lzw(&packed, most),
            Self::PackBits => Ok(pack_bits(&packed, most)),
            Self::Fax(group) => super::fax::unpack(group, &packed, size),
        }
    }
}

fn lzw(packed: &[u8], most: usize) -> Result<Vec<u8>, Fault> {
    // Before TIFF 5.0 the codes began at the low end.
    let old = matches!(packed, [0, second, ..] if second & 1 == 1);
    let mut decoder = match old {
        true => Decoder::new(BitOrder::Lsb, 8),
        false => Decoder::with_tiff_size_switch(BitOrder::Msb, 8),
    };
    let mut out = vec![0; most];
    let (mut read, mut written) = (0, 0);
    while written < most {
        let step = decoder.decode_bytes(&packed[read..], &mut out[written..]);
        read += step.consumed_in;
        written += step.consumed_out;
        match step.status {
            Ok(LzwStatus::Ok) => {}
            Ok(LzwStatus::NoProgress | LzwStatus::Done) => break,
            Err(error) => return Err(Fault::invalid(format!("damaged data: {error}"))),
        }
    }
    out.truncate(written);
    Ok(out)
}

fn pack_bits(packed: &[u8], most: usize) -> Vec<u8> {
    let mut out = Vec::new();
    let mut rest = packed;
    while let Some((&head, after)) = rest.split_first() {
        if out.len() >= most {
            break;
        }
        rest = after;
        match head as i8 {
            count @ 0.. => {
                let (run, after) = rest.split_at(rest.len().min(count as usize + 1));
                out.extend_from_slice(run);
                rest = after;
            }
            -128 => {}
            count => {
                let Some((&byte, after)) = rest.split_first() else { break };
                out.extend(std::iter::repeat_n(byte, usize::from(count.unsigned_abs()) + 1));
                rest = after;
            }
        }
    }
    out
}

/// Undoes a predictor: values were stored as differences from the one before in the row.
pub(super) fn undo_differences(
    bytes: &mut [u8],
    predictor: u64,
    row: usize,
    samples: usize,
    unit: usize,
    big_endian: bool,
) -> Result<(), Fault> {
    match predictor {
        1 => {}
        2 => bytes.chunks_exact_mut(row).for_each(|row| sums(row, samples, unit, big_endian)),
        3 => bytes.chunks_exact_mut(row).for_each(|row| floating(row, samples, unit)),
        other => return Err(Fault::unsupported(format!("predictor {other}; export it without compression"))),
    }
    Ok(())
}

fn sums(row: &mut [u8], samples: usize, unit: usize, big_endian: bool) {
    let step = samples * unit;
    for at in (step..row.len()).step_by(unit) {
        let number = |bytes: &[u8]| {
            let shift = |value: u64, &byte: &u8| value << 8 | u64::from(byte);
            if big_endian { bytes.iter().fold(0, shift) } else { bytes.iter().rev().fold(0, shift) }
        };
        let sum = number(&row[at..at + unit]).wrapping_add(number(&row[at - step..at - step + unit]));
        let target = &mut row[at..at + unit];
        target.copy_from_slice(&sum.to_le_bytes()[..unit]);
        if big_endian {
            target.reverse();
        }
    }
}

/// Adobe's: the bytes of all numbers by significance, each stored as the difference from the one before. The result
/// has the little end first.
fn floating(row: &mut [u8], samples: usize, unit: usize) {
    for at in samples..row.len() {
        row[at] = row[at].wrapping_add(row[at - samples]);
    }
    let count = row.len() / unit;
    let planes = row.to_vec();
    for i in 0..count {
        for byte in 0..unit {
            // The highest byte comes first.
            row[i * unit + unit - 1 - byte] = planes[byte * count + i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pack_bits_of_the_specification() {
        let packed =
            [0xfe, 0xaa, 0x02, 0x80, 0x00, 0x2a, 0xfd, 0xaa, 0x03, 0x80, 0x00, 0x2a, 0x22, 0xf7, 0xaa];
        let mut wanted = vec![0xaa; 3];
        wanted.extend([0x80, 0x00, 0x2a, 0xaa, 0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0x22]);
        wanted.extend([0xaa; 10]);
        assert_eq!(pack_bits(&packed, 24), wanted);
    }

    #[test]
    fn differences_add_up_in_both_orders_of_bytes() {
        let mut bytes = [0, 1, 0, 2, 0, 255];
        sums(&mut bytes, 1, 2, true);
        assert_eq!(bytes, [0, 1, 0, 3, 1, 2]);
        let mut bytes = [1, 10, 2, 20, 255, 1];
        sums(&mut bytes, 2, 1, false);
        assert_eq!(bytes, [1, 10, 3, 30, 2, 31]);
    }
}

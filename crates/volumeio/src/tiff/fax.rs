//! Bilevel pages packed as for fax machines: CCITT's T.4 (group 3, one-dimensional) and T.6 (group 4).
use crate::error::Fault;
use fax::decoder::{DecodeStatus, Group3Decoder, Group4Decoder};
use std::convert::Infallible;

/// No machine has rows of more pixels. A row may take a single bit, so a short file could declare any number.
pub(super) const WIDEST: usize = 1 << 17;

/// Rows of bits, the first pixel highest; 1 is black.
pub(super) fn unpack(group: u8, packed: &[u8], [width, rows]: [usize; 2]) -> Result<Vec<u8>, Fault> {
    let columns = u32::try_from(width).map_err(|_| Fault::invalid("a page is too wide for fax"))?;
    let damaged = |row: usize| Fault::invalid(format!("damaged data: row {} of {rows} is no fax", row + 1));
    let bytes = |packed: Vec<u8>| packed.into_iter().map(Ok::<u8, Infallible>);
    let mut out = vec![0; width.div_ceil(8).saturating_mul(rows)];
    let lines = out.chunks_exact_mut(width.div_ceil(8)).enumerate();
    if group == 3 {
        // TIFF has an end of line before each row; the decoder wants the marks after the last one too.
        let end = [0x00, 0x10, 0x01].repeat(4);
        let mut decoder = Group3Decoder::new(bytes([packed, &end].concat())).map_err(|_| damaged(0))?;
        let mut status = DecodeStatus::Incomplete;
        for (row, line) in lines {
            if status == DecodeStatus::End {
                return Err(damaged(row));
            }
            status = decoder.advance().map_err(|_| damaged(row))?;
            blacken(line, decoder.transitions(), columns);
        }
        return Ok(out);
    }
    let mut decoder = Group4Decoder::new(bytes(packed.to_vec()), columns).map_err(|_| damaged(0))?;
    for (row, line) in lines {
        // White rows at the end may be left out.
        if decoder.advance().map_err(|_| damaged(row))? == DecodeStatus::End {
            break;
        }
        blacken(line, decoder.transition(), columns);
    }
    Ok(out)
}

/// Sets the bits between the first and the second change of colour, the third and the fourth, ...
fn blacken(line: &mut [u8], changes: &[u32], width: u32) {
    for run in changes.chunks(2) {
        let end = run.get(1).copied().unwrap_or(width).min(width);
        let [start, end] = [run[0].min(end), end].map(|x| x as usize);
        let (first, last) = (start / 8, end / 8);
        // From the first bit on, and up to the one before the last.
        let [from, to] = [0xffu8 >> (start % 8), !(0xffu8 >> (end % 8))];
        if first == last {
            if start < end {
                line[first] |= from & to;
            }
            continue;
        }
        line[first] |= from;
        line[first + 1..last].fill(0xff);
        if to != 0 {
            line[last] |= to;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_black_from_their_first_pixel_to_the_one_before_their_last() {
        for (start, end) in (0..40).flat_map(|start| (0..45).map(move |end| (start, end))) {
            let mut line = [0; 5];
            blacken(&mut line, &[start, end], 40);
            for x in 0..40 {
                let black = line[x as usize / 8] >> (7 - x % 8) & 1 == 1;
                assert_eq!(black, (start..end).contains(&x), "{start}..{end}: {x}");
            }
        }
    }
}

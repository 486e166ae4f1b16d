//! Bilevel pages packed as for fax machines: CCITT's T.4 (group 3, one-dimensional) and T.6 (group 4).
use crate::error::Fault;
use fax::decoder::{DecodeStatus, Group3Decoder, Group4Decoder};
use std::convert::Infallible;

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
        for x in run[0]..end {
            line[x as usize / 8] |= 0x80 >> (x % 8);
        }
    }
}

//! Files packed by gzip.

use crate::budget::Budget;
use crate::error::Fault;
use flate2::read::MultiGzDecoder;
use std::borrow::Cow;
use std::io::Read;

/// Whether a file begins as gzip's do.
pub(crate) fn is_packed(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1f, 0x8b, 8])
}

/// What a packed file begins with, and how long it says that it is; of others, the file. The first bytes of a
/// damaged file may be fewer.
pub(crate) fn peek(bytes: &[u8]) -> (Cow<'_, [u8]>, u64) {
    if !is_packed(bytes) {
        return (bytes.into(), bytes.len() as u64);
    }
    let mut start = Vec::new();
    // Reading tells what is wrong with the file.
    let _ = MultiGzDecoder::new(bytes).take(4096).read_to_end(&mut start);
    let length = bytes.last_chunk::<4>().map_or(0, |&b| u32::from_le_bytes(b).into());
    (start.into(), length)
}

/// No mesh is packed to less than a 256th; what would be is taken for a trap once it is longer than this.
const SURELY_FINE: usize = 1 << 30;

/// The contents of a file that may be packed.
pub(crate) fn unpack<'a>(bytes: &'a [u8], budget: &Budget) -> Result<Cow<'a, [u8]>, Fault> {
    if !is_packed(bytes) {
        return Ok(bytes.into());
    }
    budget.take(bytes.len() as u64, || format!("it has {} bytes", bytes.len()))?;
    let most = budget.left();
    let limit = SURELY_FINE.max(bytes.len().saturating_mul(256));
    let mut out: Vec<u8> = Vec::new();
    let mut decoder = MultiGzDecoder::new(bytes);
    let mut chunk = vec![0; 1 << 16];
    loop {
        let read = decoder.read(&mut chunk).map_err(|e| {
            let reason =
                format!("the gzip file cannot be unpacked: {e}; it is truncated or damaged; copy it again");
            Fault::new(reason)
        })?;
        if read == 0 {
            return Ok(out.into());
        }
        if (out.len() + read) as u64 > most {
            budget.take((out.len() + read) as u64, || {
                format!("its {} bytes unpack to more than {}", bytes.len(), out.len())
            })?;
        }
        if out.len() + read > limit || out.try_reserve(read).is_err() {
            let reason = format!(
                "the gzip file of {} bytes unpacks to more than {}; unpack it by gunzip if that is meant",
                bytes.len(),
                out.len()
            );
            return Err(Fault::new(reason));
        }
        out.extend_from_slice(&chunk[..read]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::GzEncoder};
    use mser3d_fileio::ReadLimits;
    use std::io::Write;

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut out = GzEncoder::new(Vec::new(), Compression::default());
        out.write_all(bytes).unwrap();
        out.finish().unwrap()
    }

    #[test]
    fn members_follow_one_another_and_truncation_is_an_error() {
        let two = [packed(b"OFF 1"), packed(b" 2 3")].concat();
        assert_eq!(unpack(&two, &Budget::new(&ReadLimits::default())).unwrap(), &b"OFF 1 2 3"[..]);
        assert_eq!(unpack(b"OFF", &Budget::new(&ReadLimits::default())).unwrap(), &b"OFF"[..]);
        let one = packed(&[b'v'; 999]);
        assert_eq!(peek(&one), (vec![b'v'; 999].into(), 999));
        for end in 3..one.len() {
            assert!(
                unpack(&one[..end], &Budget::new(&ReadLimits::default())).is_err(),
                "{end} of {} bytes",
                one.len()
            );
        }
    }
}

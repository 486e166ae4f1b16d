//! Bytes from raw data or from base64, taken piece by piece.

use crate::error::Fault;

/// Encoded bytes. Base64 may be padded in its middle, where one encoded piece follows another.
pub(super) struct Stream<'a> {
    rest: &'a [u8],
    base64: bool,
    /// Decoded, and not yet taken.
    ready: Vec<u8>,
}

impl<'a> Stream<'a> {
    pub(super) fn new(bytes: &'a [u8], base64: bool) -> Self {
        Self { rest: bytes, base64, ready: Vec::new() }
    }

    /// The most bytes that may be left.
    pub(super) fn left(&self) -> u64 {
        let encoded = self.rest.len() as u64;
        self.ready.len() as u64 + if self.base64 { encoded / 4 * 3 + 3 } else { encoded }
    }

    /// The next bytes.
    pub(super) fn take(&mut self, count: u64) -> Result<Vec<u8>, Fault> {
        let short = || {
            Fault::new("an array is shorter than it declares; the file is truncated; copy or export it again")
        };
        if count > self.left() {
            return Err(short());
        }
        let count = count as usize;
        if !self.base64 {
            let (bytes, rest) = self.rest.split_at_checked(count).ok_or_else(short)?;
            self.rest = rest;
            return Ok(bytes.to_vec());
        }
        let mut out = std::mem::take(&mut self.ready);
        out.reserve(count.saturating_sub(out.len()) + 3);
        while out.len() < count {
            decode_group(&mut self.rest, &mut out).ok_or_else(short)??;
        }
        self.ready = out.split_off(count);
        Ok(out)
    }
}

const INVALID: u8 = 255;

const VALUES: [u8; 256] = {
    let mut values = [INVALID; 256];
    let alphabet = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut i = 0;
    while i < 64 {
        values[alphabet[i] as usize] = i as u8;
        i += 1;
    }
    values
};

/// Decodes four characters to one to three bytes; `None` at the end.
#[inline]
fn decode_group(rest: &mut &[u8], out: &mut Vec<u8>) -> Option<Result<(), Fault>> {
    let mut group = [0u8; 4];
    if let Some((four, after)) = rest.split_first_chunk::<4>() {
        let values = four.map(|c| VALUES[usize::from(c)]);
        if values.iter().all(|&v| v != INVALID) {
            *rest = after;
            push(values, 3, out);
            return Some(Ok(()));
        }
    }
    let (mut filled, mut padding) = (0, 0);
    while filled + padding < 4 {
        let (&c, after) = rest.split_first()?;
        *rest = after;
        if c.is_ascii_whitespace() {
            continue;
        }
        match VALUES[usize::from(c)] {
            INVALID if c == b'=' && filled >= 2 => padding += 1,
            value if value != INVALID && padding == 0 => {
                group[filled] = value;
                filled += 1;
            }
            _ => {
                return Some(Err(Fault::new(format!(
                    "an array's base64 holds the byte {c}; the file is damaged; export it again"
                ))));
            }
        }
    }
    push(group, 3 - padding, out);
    Some(Ok(()))
}

#[inline]
fn push([a, b, c, d]: [u8; 4], bytes: usize, out: &mut Vec<u8>) {
    let three = [a << 2 | b >> 4, b << 4 | c >> 2, c << 6 | d];
    out.extend_from_slice(&three[..bytes]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::base64::Engine;

    #[test]
    fn pieces_may_be_encoded_together_or_apart() {
        let engine = ::base64::engine::general_purpose::STANDARD;
        let (head, tail): (Vec<u8>, Vec<u8>) = ((0..8).collect(), (100..200).collect());
        let together = engine.encode([head.clone(), tail.clone()].concat());
        let apart = format!("\n {}\n{}", engine.encode(&head), engine.encode(&tail));
        for text in [together, apart] {
            let mut stream = Stream::new(text.as_bytes(), true);
            assert_eq!(stream.take(8).unwrap(), head);
            assert_eq!(stream.take(40).unwrap(), tail[..40]);
            assert_eq!(stream.take(60).unwrap(), tail[40..]);
            assert!(stream.take(1).is_err());
        }
        assert!(Stream::new(b"A=AA", true).take(1).is_err());
        assert!(Stream::new(b"AAAA", true).take(u64::MAX).is_err());
    }
}

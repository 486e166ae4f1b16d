//! Numbers of a .msh file, one after another: words or bytes.

use crate::error::Fault;
use crate::text::{Tokens, show};

/// The file, and how its numbers are stored.
pub(super) struct Source<'a> {
    pub tokens: Tokens<'a>,
    binary: bool,
    big_endian: bool,
}

impl<'a> Source<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { tokens: Tokens::without_comments(bytes), binary: false, big_endian: false }
    }

    pub(super) fn is_binary(&self) -> bool {
        self.binary
    }

    /// From here on, numbers are bytes; the first is 1.
    pub(super) fn begin_binary(&mut self) -> Result<(), Fault> {
        self.tokens.take_line();
        self.binary = true;
        let one: [u8; 4] = self.take()?;
        self.big_endian = match i32::from_le_bytes(one) {
            1 => false,
            0x0100_0000 => true,
            other => {
                return Err(self.fault(format!("the number that shows the byte order is {other}, not 1")));
            }
        };
        Ok(())
    }

    /// The name of the next section; the bytes of a binary one follow.
    pub(super) fn next_section(&mut self) -> Result<Option<&'a [u8]>, Fault> {
        let Some(word) = self.tokens.next() else { return Ok(None) };
        let Some(name) = word.strip_prefix(b"$") else {
            return Err(self.fault(format!("{}; expected a section that begins with $", show(word))));
        };
        if self.binary {
            self.tokens.take_line();
        }
        Ok(Some(name))
    }

    /// Moves behind `$EndName`.
    pub(super) fn end_section(&mut self, name: &[u8]) -> Result<(), Fault> {
        let end = [b"$End", name].concat();
        let rest = self.tokens.rest();
        let truncated =
            format!("the section {} has no end; the file is truncated; copy or export it again", show(name));
        let Some(at) = rest.windows(end.len()).position(|w| w == end) else {
            return Err(self.fault(truncated));
        };
        if self.binary {
            self.tokens.take_bytes(at + end.len());
        } else {
            // By words, so that lines are counted.
            while self.tokens.word("the end of a section")? != end {}
        }
        Ok(())
    }

    /// A fault at the present line; bytes have none.
    pub(super) fn fault(&self, reason: impl Into<String>) -> Fault {
        if self.binary { Fault::new(reason) } else { self.tokens.fault(reason) }
    }

    pub(super) fn unsupported(&self, reason: &str) -> Fault {
        Fault::unsupported((!self.binary).then(|| self.tokens.line()), reason)
    }

    /// A fault if so many things of at least so many numbers cannot be left.
    pub(super) fn check_fits(&self, count: u64, numbers: u64, what: &str) -> Result<usize, Fault> {
        let size = if self.binary { 4 } else { 2 };
        if count.saturating_mul(numbers).saturating_mul(size) > self.tokens.rest().len() as u64 + 1 {
            return Err(self.fault(format!(
                "{count} {what} are declared, more than the rest of the file holds; it is truncated or the count is wrong; copy or export it again"
            )));
        }
        Ok(count as usize)
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let bytes = self.tokens.take_bytes(N).and_then(|b| b.try_into().ok());
        let mut bytes: [u8; N] = bytes.ok_or_else(|| {
            Fault::new("the file ends within a section; it is truncated; copy or export it again")
        })?;
        if self.big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// A number that is a line of text in binary files too.
    pub(super) fn text_size(&mut self, what: &str) -> Result<u64, Fault> {
        let number = self.tokens.whole(what)?;
        if self.binary {
            self.tokens.take_line();
        }
        Ok(number)
    }

    /// An `int`.
    #[inline]
    pub(super) fn int(&mut self, what: &str) -> Result<i64, Fault> {
        if self.binary { Ok(i32::from_le_bytes(self.take()?).into()) } else { self.tokens.whole(what) }
    }

    /// A `size_t`.
    #[inline]
    pub(super) fn size(&mut self, what: &str) -> Result<u64, Fault> {
        if self.binary { Ok(u64::from_le_bytes(self.take()?)) } else { self.tokens.whole(what) }
    }

    /// A `double`.
    #[inline]
    pub(super) fn double(&mut self, what: &str) -> Result<f64, Fault> {
        if self.binary { Ok(f64::from_le_bytes(self.take()?)) } else { self.tokens.number(what) }
    }
}

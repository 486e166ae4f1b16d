use super::header::{Element, Kind, Scalar};
use crate::error::Fault;
use crate::text::{Lines, Tokens, Words, parse as number, show};

/// The values after the header, one after another, each as f64 (exact for all of PLY's types).
pub(super) trait Values {
    /// Bytes that are left.
    fn left(&self) -> u64;
    /// The fewest bytes that a property takes.
    fn smallest(&self, kind: Kind) -> u64;
    /// Moves to the next element.
    fn begin(&mut self, element: &Element, number: u64) -> Result<(), Fault>;
    fn scalar(&mut self, scalar: Scalar) -> Result<f64, Fault>;
    /// A fault at the present place.
    fn fault(&self, reason: String) -> Fault;

    fn list_length(&mut self, count: Scalar) -> Result<u64, Fault> {
        let length = self.scalar(count)?;
        if length >= 0.0 && length.fract() == 0.0 {
            return Ok(length as u64);
        }
        Err(self.fault(format!("a list of {length} items")))
    }

    fn skip(&mut self, kind: Kind) -> Result<(), Fault> {
        match kind {
            Kind::Scalar(scalar) => self.scalar(scalar).map(|_| ()),
            Kind::List { count, item } => {
                for _ in 0..self.list_length(count)? {
                    self.scalar(item)?;
                }
                Ok(())
            }
        }
    }
}

/// One element a line.
pub(super) struct AsciiValues<'a> {
    lines: Lines<'a>,
    words: Words<'a>,
}

impl<'a> AsciiValues<'a> {
    pub(super) fn new(lines: Lines<'a>) -> Self {
        Self { lines, words: Words::default() }
    }
}

impl Values for AsciiValues<'_> {
    fn left(&self) -> u64 {
        self.lines.rest().len() as u64 + 1 // The last line may lack its end.
    }

    fn smallest(&self, _: Kind) -> u64 {
        2 // A digit and what parts it from the next.
    }

    fn begin(&mut self, element: &Element, number: u64) -> Result<(), Fault> {
        let Some(line) = self.lines.next_full() else {
            let Element { count, name, .. } = element;
            return Err(self.fault(format!(
                "the file ends after {number} of {count} elements \"{name}\"; it is truncated or the count is wrong; copy or export it again"
            )));
        };
        self.words = line.words();
        Ok(())
    }

    fn scalar(&mut self, _: Scalar) -> Result<f64, Fault> {
        let Some(word) = self.words.next() else {
            return Err(self.fault("the line has fewer values than the header declares".into()));
        };
        number(word).ok_or_else(|| self.fault(format!("{} is not a number", show(word))))
    }

    fn fault(&self, reason: String) -> Fault {
        Fault::at(self.lines.number(), reason)
    }
}

/// Values one after another, wherever lines end.
pub(super) struct WordValues<'a>(Tokens<'a>);

impl<'a> WordValues<'a> {
    pub(super) fn new(rest: &'a [u8]) -> Self {
        Self(Tokens::new(rest))
    }

    /// Whether all values have been read.
    pub(super) fn is_done(&self) -> bool {
        self.0.clone().next().is_none()
    }
}

impl Values for WordValues<'_> {
    fn left(&self) -> u64 {
        self.0.rest().len() as u64 + 1
    }

    fn smallest(&self, _: Kind) -> u64 {
        2
    }

    fn begin(&mut self, _: &Element, _: u64) -> Result<(), Fault> {
        Ok(())
    }

    fn scalar(&mut self, _: Scalar) -> Result<f64, Fault> {
        self.0.number("a value")
    }

    fn fault(&self, reason: String) -> Fault {
        self.0.fault(reason)
    }
}

pub(super) struct BinaryValues<'a> {
    rest: &'a [u8],
    big_endian: bool,
    /// Of which element, for messages.
    place: String,
}

impl<'a> BinaryValues<'a> {
    pub(super) fn new(rest: &'a [u8], big_endian: bool) -> Self {
        Self { rest, big_endian, place: String::new() }
    }

    #[inline]
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let Some((&bytes, rest)) = self.rest.split_first_chunk::<N>() else {
            return Err(self.fault(format!(
                "the file ends within the elements \"{}\"; it is truncated; copy or export it again",
                self.place
            )));
        };
        self.rest = rest;
        let mut bytes = bytes;
        if self.big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

impl Values for BinaryValues<'_> {
    fn left(&self) -> u64 {
        self.rest.len() as u64
    }

    fn smallest(&self, kind: Kind) -> u64 {
        match kind {
            Kind::Scalar(scalar) | Kind::List { count: scalar, .. } => scalar.size() as u64,
        }
    }

    #[inline]
    fn begin(&mut self, element: &Element, number: u64) -> Result<(), Fault> {
        if number == 0 {
            self.place.clone_from(&element.name);
        }
        Ok(())
    }

    #[inline]
    fn scalar(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        Ok(match scalar {
            Scalar::I8 => i8::from_le_bytes(self.take()?).into(),
            Scalar::U8 => u8::from_le_bytes(self.take()?).into(),
            Scalar::I16 => i16::from_le_bytes(self.take()?).into(),
            Scalar::U16 => u16::from_le_bytes(self.take()?).into(),
            Scalar::I32 => i32::from_le_bytes(self.take()?).into(),
            Scalar::U32 => u32::from_le_bytes(self.take()?).into(),
            Scalar::F32 => f32::from_le_bytes(self.take()?).into(),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    fn fault(&self, reason: String) -> Fault {
        Fault::new(reason)
    }
}

//! Thrift's compact protocol, in which Parquet files say what is in them.

use std::collections::BTreeMap;

/// Bytes that are read one after another. What would reach beyond the end is `None`.
#[derive(Clone, Debug)]
pub(crate) struct Bytes<'a>(pub &'a [u8]);

impl<'a> Bytes<'a> {
    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    pub fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    pub fn byte(&mut self) -> Option<u8> {
        self.array().map(|[byte]| byte)
    }

    /// A number in groups of 7 bits, the lowest first.
    pub fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }

    fn zigzag(&mut self) -> Option<i64> {
        self.varint().map(|n| (n >> 1) as i64 ^ -((n & 1) as i64))
    }
}

/// Structures in structures, beyond which there is no table.
const DEEPEST: usize = 16;

/// A value. Those of types that tables have no use for are passed over.
#[derive(Debug)]
pub(crate) enum Value<'a> {
    Integer(i64),
    Binary(&'a [u8]),
    List(Vec<Value<'a>>),
    Struct(Struct<'a>),
    Other,
}

/// The fields of a structure by number.
#[derive(Debug, Default)]
pub(crate) struct Struct<'a>(BTreeMap<i64, Value<'a>>);

impl<'a> Struct<'a> {
    /// Reads a structure. Every value takes a byte at least, so memory is bounded by what is there.
    pub fn read(bytes: &mut Bytes<'a>) -> Option<Self> {
        Self::at(bytes, DEEPEST)
    }

    fn at(bytes: &mut Bytes<'a>, deeper: usize) -> Option<Self> {
        let mut fields = BTreeMap::new();
        let mut last = 0;
        loop {
            let head = bytes.byte()?;
            if head == 0 {
                return Some(Self(fields));
            }
            let number = match head >> 4 {
                0 => bytes.zigzag()?,
                more => i64::checked_add(last, more.into())?,
            };
            last = number;
            let value = match head & 0xf {
                // Of a field, the type is the value.
                1 | 2 => Value::Other,
                kind => value(bytes, kind, deeper)?,
            };
            fields.insert(number, value);
        }
    }

    pub fn integer(&self, field: i64) -> Option<i64> {
        match self.0.get(&field)? {
            Value::Integer(value) => Some(*value),
            _ => None,
        }
    }

    /// A number of things.
    pub fn count(&self, field: i64) -> Option<usize> {
        usize::try_from(self.integer(field)?).ok()
    }

    pub fn text(&self, field: i64) -> Option<&'a str> {
        match self.0.get(&field)? {
            Value::Binary(bytes) => std::str::from_utf8(bytes).ok(),
            _ => None,
        }
    }

    pub fn structure(&self, field: i64) -> Option<&Self> {
        match self.0.get(&field)? {
            Value::Struct(value) => Some(value),
            _ => None,
        }
    }

    /// The structures of a list; none where there is no such list.
    pub fn structures(&self, field: i64) -> impl Iterator<Item = &Self> {
        let list = match self.0.get(&field) {
            Some(Value::List(list)) => &list[..],
            _ => &[],
        };
        list.iter().filter_map(|value| match value {
            Value::Struct(value) => Some(value),
            _ => None,
        })
    }
}

fn value<'a>(bytes: &mut Bytes<'a>, kind: u8, deeper: usize) -> Option<Value<'a>> {
    let deeper = deeper.checked_sub(1)?;
    Some(match kind {
        1..=3 => {
            bytes.byte()?;
            Value::Other
        }
        4..=6 => Value::Integer(bytes.zigzag()?),
        7 => {
            bytes.take(8)?;
            Value::Other
        }
        8 => {
            let length = usize::try_from(bytes.varint()?).ok()?;
            Value::Binary(bytes.take(length)?)
        }
        9 | 10 => {
            let head = bytes.byte()?;
            let count = if head >> 4 == 15 { bytes.varint()? } else { u64::from(head >> 4) };
            let mut list = Vec::new();
            for _ in 0..count {
                list.push(value(bytes, head & 0xf, deeper)?);
            }
            Value::List(list)
        }
        11 => {
            let count = bytes.varint()?;
            let kinds = if count > 0 { bytes.byte()? } else { 0 };
            for _ in 0..count {
                value(bytes, kinds >> 4, deeper)?;
                value(bytes, kinds & 0xf, deeper)?;
            }
            Value::Other
        }
        12 => Value::Struct(Struct::at(bytes, deeper)?),
        13 => {
            bytes.take(16)?;
            Value::Other
        }
        _ => return None,
    })
}

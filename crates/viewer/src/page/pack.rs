use serde_json::{Value, json};

/// Typed arrays packed into one block of little-endian bytes, each at a multiple of four.
#[derive(Debug, Default)]
pub(crate) struct Pack {
    bytes: Vec<u8>,
}

impl Pack {
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Appends an array; the value says where it is and what.
    fn push<const N: usize>(&mut self, kind: &str, items: impl Iterator<Item = [u8; N]>) -> Value {
        let start = self.bytes.len();
        items.for_each(|item| self.bytes.extend(item));
        let length = (self.bytes.len() - start) / N;
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        json!({ "type": kind, "start": start, "length": length })
    }

    pub fn f32(&mut self, items: impl Iterator<Item = f32>) -> Value {
        self.push("f32", items.map(f32::to_le_bytes))
    }

    pub fn u32(&mut self, items: impl Iterator<Item = u32>) -> Value {
        self.push("u32", items.map(u32::to_le_bytes))
    }

    pub fn u16(&mut self, items: impl Iterator<Item = u16>) -> Value {
        self.push("u16", items.map(u16::to_le_bytes))
    }

    /// Numbers below `count`, in as few bytes as they fit.
    pub fn indices(&mut self, items: impl Iterator<Item = u32>, count: usize) -> Value {
        match count {
            0..=0x1_0000 => self.u16(items.map(|i| i as u16)),
            _ => self.u32(items),
        }
    }

    pub fn i16(&mut self, items: impl Iterator<Item = i16>) -> Value {
        self.push("i16", items.map(i16::to_le_bytes))
    }

    pub fn u8(&mut self, items: impl Iterator<Item = u8>) -> Value {
        self.push("u8", items.map(|b| [b]))
    }

    /// A set of numbers below `count`, one bit each, lowest first.
    pub fn bits(&mut self, members: &[u32], count: usize) -> Value {
        let mut bytes = vec![0u8; count.div_ceil(8)];
        for &m in members {
            bytes[m as usize / 8] |= 1 << (m % 8);
        }
        self.u8(bytes.into_iter())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_aligned_and_located() {
        let mut pack = Pack::default();
        assert_eq!(pack.u8([1, 2, 3].into_iter()), json!({"type": "u8", "start": 0, "length": 3}));
        assert_eq!(pack.i16([-2].into_iter()), json!({"type": "i16", "start": 4, "length": 1}));
        assert_eq!(pack.bits(&[0, 9], 10), json!({"type": "u8", "start": 8, "length": 2}));
        assert_eq!(pack.bytes(), [1, 2, 3, 0, 254, 255, 0, 0, 1, 2, 0, 0]);
        let mut kind = |last: u32| pack.indices([last].into_iter(), last as usize + 1)["type"].clone();
        assert_eq!([kind(0xffff), kind(0x1_0000)], ["u16", "u32"]);
    }
}

//! Values that a file writes out as text.
use crate::Samples;
use crate::error::Fault;
use crate::sample_type::SampleType;

impl SampleType {
    /// Reads `count` numbers, parted by white space or commas.
    pub fn read_text(self, count: usize, text: &[u8]) -> Result<Samples, Fault> {
        let text = std::str::from_utf8(text)
            .map_err(|_| Fault::invalid("the values are no text; copy or export the file again"))?;
        let words = text.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
        macro_rules! parse {
            ($type:ty) => {{
                let mut values: Vec<$type> = Vec::new();
                for word in words.take(count) {
                    // Whole numbers may be written as 1e3.
                    let whole = || word.parse::<f64>().ok().filter(|&x| (x as $type) as f64 == x);
                    let value = word.parse().ok().or_else(|| whole().map(|x| x as $type));
                    values.push(value.ok_or_else(|| {
                        Fault::invalid(format!(
                            "the value {word:?} is not a number of type {}",
                            stringify!($type)
                        ))
                    })?);
                }
                Samples::from(values)
            }};
        }
        let values = match self {
            Self::U8 => parse!(u8),
            Self::I8 => parse!(i8),
            Self::U16 => parse!(u16),
            Self::I16 => parse!(i16),
            Self::U32 => parse!(u32),
            Self::I32 => parse!(i32),
            Self::U64 => parse!(u64),
            Self::I64 => parse!(i64),
            Self::F32 => parse!(f32),
            Self::F64 => parse!(f64),
        };
        if values.len() < count {
            let found = values.len();
            return Err(Fault::invalid(format!("{count} values are promised, {found} are there")));
        }
        Ok(values)
    }
}

/// The bytes that pairs of hexadecimal digits stand for; white space between them does not count.
pub(crate) fn unhex(text: &[u8]) -> Result<Vec<u8>, Fault> {
    let mut bytes = Vec::with_capacity(text.len() / 2);
    let mut high = None;
    for &c in text.iter().filter(|c| !c.is_ascii_whitespace()) {
        let digit = char::from(c)
            .to_digit(16)
            .ok_or_else(|| Fault::invalid(format!("{:?} is not a hexadecimal digit", char::from(c))))?
            as u8;
        high = match high {
            None => Some(digit),
            Some(high) => {
                bytes.push(high << 4 | digit);
                None
            }
        };
    }
    Ok(bytes)
}

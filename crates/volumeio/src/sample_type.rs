//! How files store numbers.
use crate::Samples;
use crate::error::Fault;
use std::io::Read;

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SampleType {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
}

/// Bytes that are read at a time: whole numbers of every type.
const CHUNK: u64 = 1 << 20;

impl SampleType {
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// Bytes of so many numbers.
    pub fn kept(self, count: usize) -> u64 {
        (count as u64).saturating_mul(self.bytes() as u64)
    }

    /// Reads exactly `count` numbers. Memory follows what is there, not what a header promises.
    pub fn read(self, count: usize, big_endian: bool, source: impl Read) -> Result<Samples, Fault> {
        let wanted = count
            .checked_mul(self.bytes())
            .ok_or_else(|| Fault::invalid(format!("{count} voxels are more than any memory holds")))?;
        let mut source = source.take(wanted as u64);
        let mut values = self.decode(Vec::new(), big_endian);
        let mut held = 0;
        loop {
            let mut bytes = Vec::new();
            source.by_ref().take(CHUNK).read_to_end(&mut bytes)?;
            if bytes.is_empty() {
                break;
            }
            held += bytes.len();
            values.append(self.decode(bytes, big_endian));
        }
        if held < wanted {
            return Err(Fault::invalid(format!(
                "the header promises {wanted} bytes of values, but there are {held}; copy or export the file again"
            )));
        }
        Ok(values)
    }

    /// The numbers that bytes stand for.
    pub fn decode(self, bytes: Vec<u8>, big_endian: bool) -> Samples {
        macro_rules! decode {
            ($type:ty) => {{
                let (chunks, _) = bytes.as_chunks();
                let numbers = chunks.iter().map(|&chunk| match big_endian {
                    true => <$type>::from_be_bytes(chunk),
                    false => <$type>::from_le_bytes(chunk),
                });
                Samples::from(numbers.collect::<Vec<$type>>())
            }};
        }
        match self {
            Self::U8 => Samples::U8(bytes),
            Self::I8 => decode!(i8),
            Self::U16 => decode!(u16),
            Self::I16 => decode!(i16),
            Self::U32 => decode!(u32),
            Self::I32 => decode!(i32),
            Self::U64 => decode!(u64),
            Self::I64 => decode!(i64),
            Self::F32 => decode!(f32),
            Self::F64 => decode!(f64),
        }
    }
}

//! The numbers of a volume, and their bytes in files.
use crate::error::Fault;
use std::io::Read;

macro_rules! values {
    ($($(#[$doc:meta])* $variant:ident($type:ty);)*) => {
        /// The numbers of a [`Volume`](crate::Volume), x fastest; of several channels, those of a voxel
        /// follow each other.
        #[derive(Clone, Debug, PartialEq)]
        #[allow(missing_docs)]
        pub enum Values {
            $($(#[$doc])* $variant(Vec<$type>),)*
        }

        impl Values {
            /// How many there are.
            pub fn len(&self) -> usize {
                match self { $(Self::$variant(values) => values.len(),)* }
            }

            /// Whether there are none.
            pub fn is_empty(&self) -> bool {
                self.len() == 0
            }

            /// The name of their type in Rust.
            pub fn type_name(&self) -> &'static str {
                match self { $(Self::$variant(_) => stringify!($type),)* }
            }

            /// All as f64, exactly.
            pub fn to_f64(&self) -> Vec<f64> {
                match self { $(Self::$variant(values) => values.iter().map(|&x| f64::from(x)).collect(),)* }
            }

            /// Where they are not zero.
            pub fn nonzero(&self) -> impl Iterator<Item = usize> + '_ {
                (0..self.len()).filter(|&i| match self { $(Self::$variant(values) => values[i] != <$type>::default(),)* })
            }

            /// Value i of the result is value `from(i)` of this.
            pub(crate) fn permuted(&self, from: impl Fn(usize) -> usize) -> Self {
                let all = 0..self.len();
                match self { $(Self::$variant(values) => Self::$variant(all.map(|i| values[from(i)]).collect()),)* }
            }

            /// The bytes, little end first.
            pub(crate) fn write(&self, out: &mut dyn std::io::Write) -> std::io::Result<()> {
                match self {
                    $(Self::$variant(values) => values.iter().try_for_each(|x| out.write_all(&x.to_le_bytes())),)*
                }
            }
        }

        $(impl From<Vec<$type>> for Values {
            fn from(values: Vec<$type>) -> Self {
                Self::$variant(values)
            }
        })*
    };
}

values! {
    U8(u8);
    I8(i8);
    U16(u16);
    I16(i16);
    U32(u32);
    I32(i32);
    F32(f32);
    F64(f64);
}

/// How a number is stored. 64-bit integers are read as f64, rounded beyond 2^53.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sample {
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

impl Sample {
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// Reads exactly `count` numbers. Memory follows what is there, not what a header promises.
    pub fn read(self, count: usize, big_endian: bool, source: impl Read) -> Result<Values, Fault> {
        let wanted = count
            .checked_mul(self.bytes())
            .ok_or_else(|| Fault::invalid(format!("{count} voxels are more than any memory holds")))?;
        let mut bytes = Vec::new();
        source.take(wanted as u64).read_to_end(&mut bytes)?;
        if bytes.len() < wanted {
            let held = bytes.len();
            return Err(Fault::invalid(format!(
                "the header promises {wanted} bytes of values, but there are {held}; copy or export the file again"
            )));
        }
        macro_rules! decode {
            ($type:ty as $into:ty) => {{
                let (chunks, _) = bytes.as_chunks();
                let numbers = chunks.iter().map(|&chunk| match big_endian {
                    true => <$type>::from_be_bytes(chunk) as $into,
                    false => <$type>::from_le_bytes(chunk) as $into,
                });
                Values::from(numbers.collect::<Vec<$into>>())
            }};
        }
        Ok(match self {
            Self::U8 => Values::U8(bytes),
            Self::I8 => decode!(i8 as i8),
            Self::U16 => decode!(u16 as u16),
            Self::I16 => decode!(i16 as i16),
            Self::U32 => decode!(u32 as u32),
            Self::I32 => decode!(i32 as i32),
            Self::U64 => decode!(u64 as f64),
            Self::I64 => decode!(i64 as f64),
            Self::F32 => decode!(f32 as f32),
            Self::F64 => decode!(f64 as f64),
        })
    }
}

//! The numbers of a volume.
use crate::sample_type::SampleType;

macro_rules! samples {
    ($($(#[$doc:meta])* $variant:ident($type:ty);)*) => {
        /// The numbers of a [`Volume`](crate::Volume), x fastest; of several channels, those of a voxel
        /// follow each other.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Samples {
            $($(#[$doc])* $variant(Vec<$type>),)*
        }

        impl Samples {
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

            /// Number `i` as f64. 64-bit integers are rounded beyond 2^53, all others are exact.
            ///
            /// # Panics
            /// When there are no more than `i` numbers.
            #[inline]
            pub fn value(&self, i: usize) -> f64 {
                match self { $(Self::$variant(values) => values[i] as f64,)* }
            }

            /// All as f64, as by [`Samples::value`].
            pub fn to_f64(&self) -> Vec<f64> {
                match self { $(Self::$variant(values) => values.iter().map(|&x| x as f64).collect(),)* }
            }

            /// Where they are not zero.
            pub fn nonzero(&self) -> impl Iterator<Item = usize> + '_ {
                (0..self.len()).filter(|&i| match self { $(Self::$variant(values) => values[i] != <$type>::default(),)* })
            }

            /// `count` numbers; the i-th is number `from(i)` of these.
            pub(crate) fn picked(&self, count: usize, from: impl Fn(usize) -> usize) -> Self {
                match self {
                    $(Self::$variant(values) => Self::$variant((0..count).map(|i| values[from(i)]).collect()),)*
                }
            }

            /// Adds numbers of the same type at the end; whether they were.
            pub(crate) fn append(&mut self, more: Self) -> bool {
                match (self, more) {
                    $((Self::$variant(values), Self::$variant(more)) => {
                        values.extend(more);
                        true
                    })*
                    _ => false,
                }
            }

            /// The bytes, little end first.
            pub(crate) fn write(&self, out: &mut dyn std::io::Write) -> std::io::Result<()> {
                match self {
                    $(Self::$variant(values) => values.iter().try_for_each(|x| out.write_all(&x.to_le_bytes())),)*
                }
            }

            pub(crate) fn sample_type(&self) -> SampleType {
                match self { $(Self::$variant(_) => SampleType::$variant,)* }
            }
        }

        $(impl From<Vec<$type>> for Samples {
            fn from(values: Vec<$type>) -> Self {
                Self::$variant(values)
            }
        })*
    };
}

samples! {
    /// 8-bit integers without a sign.
    U8(u8);
    /// 8-bit integers.
    I8(i8);
    /// 16-bit integers without a sign.
    U16(u16);
    /// 16-bit integers.
    I16(i16);
    /// 32-bit integers without a sign.
    U32(u32);
    /// 32-bit integers.
    I32(i32);
    /// 64-bit integers without a sign.
    U64(u64);
    /// 64-bit integers.
    I64(i64);
    /// Floating-point numbers of 32 bits.
    F32(f32);
    /// Floating-point numbers of 64 bits.
    F64(f64);
}

impl Samples {
    /// In another order: number i of the result is number `from(i)` of these.
    pub(crate) fn permuted(&self, from: impl Fn(usize) -> usize) -> Self {
        self.picked(self.len(), from)
    }
}

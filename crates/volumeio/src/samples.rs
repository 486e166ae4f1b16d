//! The numbers of a volume.

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
    /// Floating-point numbers of 32 bits.
    F32(f32);
    /// Floating-point numbers of 64 bits.
    F64(f64);
}

use std::fmt;

/// An enum of which one value is chosen, by a name that is the same in code, on the command line, in JSON and in the
/// documentation. Made by [`choice!`](crate::choice!).
pub trait Choice: Copy + fmt::Display + std::str::FromStr<Err = UnknownChoice> + 'static {
    /// What is chosen, in words.
    const WHAT: &'static str;
    /// All values, in the order of the documentation.
    const ALL: &'static [Self];

    /// Its name.
    fn name(self) -> &'static str;

    /// What it means, in a sentence.
    fn about(self) -> &'static str;
}

/// A name that no value of a [`Choice`] has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownChoice {
    /// What was to be chosen.
    pub what: &'static str,
    /// The name given.
    pub name: String,
    /// The names there are.
    pub known: Vec<&'static str>,
}

impl UnknownChoice {
    /// The error of a name that no value of `T` has.
    pub fn of<T: Choice>(name: &str) -> Self {
        Self {
            what: T::WHAT,
            name: name.to_owned(),
            known: T::ALL.iter().map(|&value| value.name()).collect(),
        }
    }
}

impl fmt::Display for UnknownChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "there is no {} {:?}; choose one of {}", self.what, self.name, self.known.join(", "))
    }
}

impl std::error::Error for UnknownChoice {}

/// Defines an enum without data whose values have names, and with it `Display`, `FromStr`, [`Choice`], and where the
/// calling crate has the features `serde` and `schema`, the traits of these.
///
/// The first documentation line of each value is what the command line's help says of it.
///
/// ```
/// mser3d_shape::choice! {
///     /// Which way is up.
///     pub enum Up("axis that points up") {
///         /// The second axis, as in most meshes
///         #[default]
///         Y = "y",
///         /// The third axis, as in most scans
///         Z = "z",
///     }
/// }
/// use mser3d_shape::Choice;
/// assert_eq!("z".parse(), Ok(Up::Z));
/// assert_eq!(Up::default().to_string(), "y");
/// assert_eq!(Up::Z.about(), "The third axis, as in most scans");
/// let error = "x".parse::<Up>().unwrap_err().to_string();
/// assert_eq!(error, "there is no axis that points up \"x\"; choose one of y, z");
/// ```
#[macro_export]
macro_rules! choice {
    (
        $(#[$outer:meta])*
        $visibility:vis enum $choice:ident($what:literal) {
            $(#[doc = $first:literal] $(#[doc = $more:literal])* $(#[default $($default:tt)?])? $value:ident = $name:literal,)*
        }
    ) => {
        $(#[$outer])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        $visibility enum $choice {
            $(#[doc = $first] $(#[doc = $more])* $(#[default $($default)?])? $value,)*
        }

        impl $crate::Choice for $choice {
            const WHAT: &'static str = $what;
            const ALL: &'static [Self] = &[$(Self::$value),*];

            fn name(self) -> &'static str {
                match self { $(Self::$value => $name,)* }
            }

            fn about(self) -> &'static str {
                match self { $(Self::$value => $first.trim_ascii(),)* }
            }
        }

        impl ::std::fmt::Display for $choice {
            fn fmt(&self, f: &mut ::std::fmt::Formatter<'_>) -> ::std::fmt::Result {
                f.pad($crate::Choice::name(*self))
            }
        }

        impl ::std::str::FromStr for $choice {
            type Err = $crate::UnknownChoice;

            fn from_str(name: &str) -> ::std::result::Result<Self, Self::Err> {
                match name {
                    $($name => Ok(Self::$value),)*
                    _ => Err($crate::UnknownChoice::of::<Self>(name)),
                }
            }
        }

        #[cfg(feature = "serde")]
        impl ::serde::Serialize for $choice {
            fn serialize<S: ::serde::Serializer>(&self, to: S) -> ::std::result::Result<S::Ok, S::Error> {
                to.serialize_str($crate::Choice::name(*self))
            }
        }

        #[cfg(feature = "serde")]
        impl<'de> ::serde::Deserialize<'de> for $choice {
            fn deserialize<D: ::serde::Deserializer<'de>>(from: D) -> ::std::result::Result<Self, D::Error> {
                // Owned, so that it reads from streams too.
                let name = <::std::string::String as ::serde::Deserialize>::deserialize(from)?;
                name.parse().map_err(::serde::de::Error::custom)
            }
        }

        #[cfg(feature = "schema")]
        impl ::schemars::JsonSchema for $choice {
            fn schema_name() -> ::std::borrow::Cow<'static, str> {
                stringify!($choice).into()
            }

            fn json_schema(_: &mut ::schemars::SchemaGenerator) -> ::schemars::Schema {
                ::schemars::json_schema!({
                    "description": concat!("The ", $what, "."),
                    "type": "string",
                    "enum": [$($name),*],
                })
            }
        }
    };
}

use thiserror::Error;

/// Why a benchmark cannot be read, made or scored.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ShrecError {
    /// Two things that belong together differ in size.
    #[error("{what}: {found} given, {expected} needed")]
    SizeMismatch {
        /// What is wrong.
        what: &'static str,
        /// Its size.
        found: usize,
        /// The size it should have.
        expected: usize,
    },
    /// A number names a vertex or triangle that is not there.
    #[error("{what} {number} names {index}, but there are only {count} (numbered from 0)")]
    OutOfRange {
        /// What names it.
        what: &'static str,
        /// Which one of these, from 0.
        number: usize,
        /// What it names.
        index: u64,
        /// How many there are.
        count: usize,
    },
    /// A coordinate, a weight or a descriptor is NaN or infinite.
    #[error("{what} {number} is not finite")]
    NotFinite {
        /// What is wrong.
        what: &'static str,
        /// Which one, from 0.
        number: usize,
    },
}

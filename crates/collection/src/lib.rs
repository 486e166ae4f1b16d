//! Collections of results.
#![warn(missing_docs)]

mod error;
mod matching;
mod settings;
mod truth;

pub use error::CollectionError;
pub use matching::{Matching, RegionMatch, Shape, match_shapes};
pub use settings::DescriptorSettings;
pub use truth::{Precision, Truth, Verdict, judge};

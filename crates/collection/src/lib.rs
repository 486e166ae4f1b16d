//! Collections of results.
#![warn(missing_docs)]

mod batch;
mod budget;
mod cache;
mod error;
mod folder;
mod job;
mod matching;
mod parquet;
mod query;
mod settings;
mod tables;
mod truth;

pub use batch::{BatchParameters, BatchSummary, Event, Outcome, Ready, Work, run_batch};
pub use cache::{CacheUse, SpectrumCache};
pub use error::CollectionError;
pub use job::{Frames, Job, Shard, plan};
pub use matching::{Matching, RegionMatch, Shape, match_shapes};
pub use query::{Hit, Index};
pub use settings::DescriptorSettings;
pub use tables::{Tables, build_tables};
pub use truth::{Precision, Truth, Verdict, judge};

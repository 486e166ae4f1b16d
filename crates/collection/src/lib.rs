//! Collections: many shapes, computed safely, as tables, matched and searched.
//!
//! * [`match_results`] finds out which regions of two shapes are the same, by descriptor; [`judge_matching`] says how
//!   many of the matches are right, where the truth is known.
//! * [`plan`] lists the shapes that files, folders and patterns name; [`run_batch`] runs a detector over them, each
//!   with a result in a folder of its own;
//!   [`build_tables`] makes `regions.parquet` and `shapes.parquet` of them, and of label maps `labels.csv` and `regions.csv`.
//! * [`ScheduledBatch`] and [`ScheduledShape`] are the same for a batch whose shapes another program hands out to processes
//!   on many machines.
//! * [`Index`] finds the regions of a collection that are nearest to those of a shape, and shows them.
//! * [`verify_folder`] finds out whether results and tables are as they were written.
//! * [`SpectrumCache`] keeps spectra, so that none is computed twice.
//!
//! # What holds
//! * A result appears as a whole or not at all. A batch that is killed at any moment can be run again: it
//!   keeps what is there and ends with the same bytes as one that was never disturbed (the times in
//!   `regions.json` aside). Tables hold no times, and rows in the order of names.
//! * Tables are there only while no batch is under way: who finds them, finds them complete.
//! * Results whose input, parameters or version changed are redone, and those that are damaged; a shape that fails is recorded, and
//!   the rest go on. A result of an earlier run is never replaced by a failure.
//! * Descriptors of different settings are never compared; the error names the difference.
//! * Search is exact. 100,000 regions take less than a tenth of a second, reading them included.
//!
//! # Limits
//! Results of shapes that are no longer among the inputs stay in the collection until their folder is
//! removed. A collection is on one file system, since results are renamed into place.
//!
//! # Example
//! ```
//! use mser3d::voxelize::Pitch;
//! use mser3d::{Detector, Domain, Parameters};
//! use mser3d_collection::{BatchParameters, DescribedResult, Index, PlanParameters, match_results, plan, run_batch};
//!
//! # // Two shapes: a block with a handle, longer in the second.
//! # let folder = std::env::temp_dir().join(format!("mser3d-collection-doc-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder)?;
//! # for (name, length) in [("short", 5.0), ("long", 6.0)] {
//! #     let mut off = String::from("OFF\n16 24 0\n");
//! #     for (x, z) in [(2.0, [0.0, 4.0]), (0.6, [3.9, 3.9 + length])] {
//! #         for i in 0..8 {
//! #             let sign = |bit: i32| if i >> bit & 1 == 0 { -x } else { x };
//! #             off += &format!("{} {} {}\n", sign(0), sign(1), z[i as usize >> 2]);
//! #         }
//! #     }
//! #     for o in [0, 8] {
//! #         for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
//! #             off += &format!("3 {} {} {}\n3 {} {} {}\n", o + a, o + b, o + c, o + a, o + c, o + d);
//! #         }
//! #     }
//! #     std::fs::write(folder.join(format!("{name}.off")), off)?;
//! # }
//! # let shapes = folder.clone();
//! let mut parameters = Parameters::default();
//! parameters.voxelize.pitch = Pitch::Voxels(2500);
//! parameters.spectrum.eigenpairs = 30.into();
//! let detector = Detector::new(parameters);
//!
//! // All shapes in a folder of meshes and masks.
//! let (plan, collection) = (plan(&[shapes], &PlanParameters::default())?, folder.join("results"));
//! let run = || {
//!     let batch = BatchParameters::default();
//!     run_batch(&collection, &plan, Domain::Volume, &detector, &batch, &|_| {})
//! };
//! assert_eq!(run()?.computed, 2);
//! assert_eq!(run()?.kept, 2); // nothing is computed twice
//!
//! let short = DescribedResult::load(&collection.join("short"))?;
//! let long = DescribedResult::load(&collection.join("long"))?;
//! let matching = match_results(&short, &long, &Default::default())?;
//! assert_eq!(matching.matches.len(), long.descriptors.len());
//! let closest = Index::load(&collection)?.nearest(&short, 1, Some("short"))?;
//! assert!(closest.iter().all(|found| found.closest[0].shape == "long"));
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![warn(missing_docs)]

mod advance;
mod batch;
mod budget;
mod cache;
mod dense_map;
mod descriptor_settings;
mod error;
mod failure;
mod folder;
mod ground_truth;
mod job;
mod label_tables;
mod matching;
mod parquet;
mod parquet_table;
mod query;
mod query_page;
mod recent_volumes;
mod scheduled;
mod shape_run;
mod tables;
mod thrift;
mod track;
mod verify;

pub use batch::{BatchParameters, BatchSummary, DamagedShape, Event, run_batch, run_batch_in};
pub use cache::{CacheUse, SpectrumCache};
pub use dense_map::map_vertices;
pub use descriptor_settings::DescriptorSettings;
pub use error::CollectionError;
pub use failure::Failure;
pub use folder::CollectionFolder;
pub use ground_truth::judge_matching;
pub use job::{Frames, Job, LEAST_LABEL_VOXELS, Plan, PlanParameters, Shard, SkippedLabel, plan};
pub use label_tables::write_label_map;
pub use matching::{DescribedResult, MatchRecord, Matching, MatchingParameters, RegionMatch, match_results};
pub use query::{Hit, Index, QueryRecord, RegionHits};
pub use scheduled::{Need, ScheduledBatch, ScheduledShape};
pub use shape_run::Outcome;
pub use tables::{Tables, build_tables};
pub use track::{
    Sampling, plan_sequence, share_parameters, track_glb, track_page, track_pictures, track_results,
};
pub use verify::{Verification, verify_folder};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

//! Collections: many shapes, computed safely, as tables, matched and searched.
//!
//! * [`match_shapes`] finds out which regions of two shapes are the same, by descriptor; [`judge`] says how
//!   many of the matches are right, where the truth is known.
//! * [`plan`] and [`run_batch`] compute the results of many shapes, each in a folder of its own;
//!   [`build_tables`] makes `regions.parquet` and `shapes.parquet` of them.
//! * [`Index`] finds the regions of a collection that are nearest to those of a shape, and shows them.
//! * [`SpectrumCache`] keeps spectra, so that none is computed twice.
//!
//! # What holds
//! * A result appears as a whole or not at all. A batch that is killed at any moment can be run again: it
//!   keeps what is there and ends with the same bytes as one that was never disturbed (the times in
//!   `regions.json` aside). Tables hold no times, and rows in the order of names.
//! * Tables are there only while no batch is under way: who finds them, finds them complete.
//! * Results whose input, parameters or version changed are redone; a shape that fails is recorded, and
//!   the rest go on.
//! * Descriptors of different settings are never compared; the error names the difference.
//! * Search is exact. 100,000 regions take less than a tenth of a second, reading them included.
//!
//! # Limits
//! Results of shapes that are no longer among the inputs stay in the collection until their folder is
//! removed. A collection is on one file system, since results are renamed into place.
//!
//! # Example
//! The batch's work is whatever writes a result; here, a box.
//! ```
//! use std::path::Path;
//! use mser3d::{Domain, Parameters, detect};
//! use mser3d::shape::TriangleMesh;
//! use mser3d_collection::{BatchParameters, Index, Job, Ready, Shape, Work, match_shapes, run_batch};
//! use mser3d_results::Results;
//! use serde_json::json;
//!
//! struct Bars(Parameters);
//!
//! impl Work for Bars {
//!     type Input = TriangleMesh;
//!
//!     fn read(&self, job: &Job) -> Result<Ready<TriangleMesh>, String> {
//!         // A handle on a block, longer in each shape.
//!         let length = 5.0 + job.time;
//! #       let corners = |x: f64, z: [f64; 2]| (0..8u32).map(move |i| [
//! #           if i & 1 == 0 { -x } else { x }, if i & 2 == 0 { -x } else { x }, z[(i >> 2) as usize]]);
//! #       let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
//! #       let faces = |o: u32| quads.iter().flat_map(move |&[a, b, c, d]| [[a, b, c], [a, c, d]])
//! #           .map(move |t| t.map(|v| v + o));
//! #       let vertices = corners(2.0, [0.0, 4.0]).chain(corners(0.6, [3.9, 3.9 + length])).collect();
//! #       let triangles = faces(0).chain(faces(8)).collect();
//!         let mesh = TriangleMesh::new(vertices, triangles).map_err(|e| e.to_string())?;
//!         Ok(Ready { input: mesh, identity: json!({"input": {"path": job.name}}), memory: 100_000_000 })
//!     }
//!
//!     fn run(&self, job: &Job, mesh: TriangleMesh, folder: &Path) -> Result<(), String> {
//!         let features = detect(&mesh, Domain::Volume, &self.0, &mser3d::no_progress);
//!         let features = features.map_err(|e| e.to_string())?;
//!         let mut results =
//!             Results::new(&features, Some(&mesh), &job.name).map_err(|e| e.to_string())?;
//!         let spectrum = json!({"eigenpairs": features.basis.eigenvalues().len()});
//!         let parameters = json!({"spectrum": spectrum, "descriptor": {"kind": "si-hks"}});
//!         results.record.more.insert("parameters".into(), parameters);
//!         results.write(folder).map_err(|e| e.to_string())
//!     }
//! }
//!
//! let mut parameters = Parameters::default();
//! parameters.voxelize.pitch = mser3d::voxelize::Pitch::Voxels(2500);
//! parameters.spectrum.eigenpairs = 30.into();
//! let job = |name: &str, time| Job { name: name.into(), path: name.into(), animation: None, time };
//! let jobs = vec![job("long", 1.0), job("short", 0.0)];
//! # let folder = std::env::temp_dir().join(format!("mser3d-collection-{}", std::process::id()));
//! let summary = run_batch(&folder, jobs.clone(), &Bars(parameters.clone()), &BatchParameters::default(), &|_| {})?;
//! assert_eq!((summary.done, summary.failed.len()), (2, 0));
//! let again = run_batch(&folder, jobs, &Bars(parameters), &BatchParameters::default(), &|_| {})?;
//! assert_eq!((again.done, again.kept), (0, 2));
//!
//! let (short, long) = (Shape::load(&folder.join("short"))?, Shape::load(&folder.join("long"))?);
//! let matching = match_shapes(&short, &long, &Default::default())?;
//! assert_eq!(matching.matches.len(), long.descriptors.len());
//! let closest = Index::load(&folder)?.nearest(&short, 1, Some("short"))?;
//! assert!(closest.iter().all(|hits| hits[0].shape == "long"));
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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
mod query_page;
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

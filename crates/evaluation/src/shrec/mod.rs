//! The SHREC'10 and SHREC'11 feature detection benchmarks: their files, their classes of transforms, and a synthetic
//! benchmark in the same files.
//!
//! A folder holds `NNNN.<class>.<strength>.off`, the null shape `0001.null.0.off`, the ground truth
//! `corr/<name>.corr`, and where it is known the null shape's symmetry `NNNN.null.0.sym.mat`.
//!
//! * [`Benchmark`] reads such a folder, and names what is missing;
//! * [`transform`] makes the transforms of the synthetic benchmark, [`BenchmarkWriter`] writes them in the same files;
//! * [`ShapeScore`] and [`mean_score`] average measures over classes and strengths.
//!
//! The benchmarks: Bronstein et al., *SHREC 2010: robust feature detection and description benchmark*;
//! Boyer et al., *SHREC 2011: robust feature detection and description benchmark*. Their meshes are not part of this
//! crate.

mod benchmark;
mod corr;
mod name;
mod score;
mod transforms;
mod write;

pub use benchmark::Benchmark;
pub use name::{NotAShapeName, ShapeName};
pub use score::{ShapeScore, mean_score};
pub use transforms::{Class, SpaceMap, Transformed, isometry, space_map, transform};
pub use write::BenchmarkWriter;

//! The benchmark's folder: `NNNN.<class>.<strength>.off`, `corr/<name>.corr`, `NNNN.null.0.sym.mat`.

mod benchmark;
mod corr;
mod detection;
mod mat5;
mod name;
mod symmetry;
mod write;

pub use benchmark::Benchmark;
pub use detection::Detection;
pub use name::{NotAShapeName, ShapeName};
pub use symmetry::read_symmetry;
pub use write::BenchmarkWriter;

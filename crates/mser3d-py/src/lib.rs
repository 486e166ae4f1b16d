//! The native half of the Python package `mser3d`: arrays in, arrays out. What users see is in `python/mser3d`.
//!
//! Options arrive as the words of the command line and are parsed by its own parser ([`mser3d_cli::parse`]). Work runs
//! on a thread of its own while the interpreter is free ([`run`](run::run)).

mod arrays;
mod batch;
mod describe;
mod detect;
mod errors;
mod matching;
mod msv;
mod operators;
mod options;
mod query;
mod result;
mod run;
mod signatures;
mod track;
mod trees;
mod voxels;

use pyo3::prelude::*;

/// The native half of mser3d.
#[pymodule]
mod _native {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::batch::{BatchPlan, compute_shape, examine_shape, fail_shape};
    #[pymodule_export]
    use crate::describe::{commands, options};
    #[pymodule_export]
    use crate::detect::{detect, detect_volume};
    #[pymodule_export]
    use crate::main;
    #[pymodule_export]
    use crate::matching::match_results;
    #[pymodule_export]
    use crate::msv::{Msv, msv};
    #[pymodule_export]
    use crate::operators::{Operator, cotangent_laplacian, eigs, grid_laplacian};
    #[pymodule_export]
    use crate::query::Index;
    #[pymodule_export]
    use crate::result::{Result, load};
    #[pymodule_export]
    use crate::run::last_seconds;
    #[pymodule_export]
    use crate::signatures::{heat_kernel, si_hks};
    #[pymodule_export]
    use crate::track::track;
    #[pymodule_export]
    use crate::trees::{ComponentTree, graph_tree, grid_tree, solid_tree};
    #[pymodule_export]
    use crate::voxels::{Voxels, solid, voxelize};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

/// The command `mser3d` with these arguments, its own name first: its exit code.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<std::ffi::OsString>) -> u8 {
    py.detach(|| {
        let code = mser3d_cli::main(arguments);
        // Nobody else flushes Rust's buffer when Python ends.
        let _ = std::io::Write::flush(&mut std::io::stdout());
        code
    })
}

//! The list of targets.

use crate::{
    arguments, arrays, collections, correspondences, meshes, results, soups, spectra, trees, volumes,
};

/// What is fed with inputs.
pub struct Target {
    /// As the command line calls it.
    pub name: &'static str,
    /// Takes an input; panics where a promise is broken.
    pub run: fn(&[u8]),
    /// Inputs to begin with.
    pub seeds: fn() -> Vec<Vec<u8>>,
}

macro_rules! targets {
    ($($name:literal: $run:expr, $seeds:expr;)*) => {
        /// All of them.
        pub const TARGETS: &[Target] = &[$(Target { name: $name, run: $run, seeds: $seeds }),*];
    };
}

targets! {
    "obj": meshes::run::<{ meshes::OBJ }>, meshes::seeds::<{ meshes::OBJ }>;
    "off": meshes::run::<{ meshes::OFF }>, meshes::seeds::<{ meshes::OFF }>;
    "ply": meshes::run::<{ meshes::PLY }>, meshes::seeds::<{ meshes::PLY }>;
    "stl": meshes::run::<{ meshes::STL }>, meshes::seeds::<{ meshes::STL }>;
    "vtu": meshes::run::<{ meshes::VTU }>, meshes::seeds::<{ meshes::VTU }>;
    "vtp": meshes::run::<{ meshes::VTP }>, meshes::seeds::<{ meshes::VTP }>;
    "vtk": meshes::run::<{ meshes::VTK }>, meshes::seeds::<{ meshes::VTK }>;
    "msh": meshes::run::<{ meshes::MSH }>, meshes::seeds::<{ meshes::MSH }>;
    "medit": meshes::run::<{ meshes::MEDIT }>, meshes::seeds::<{ meshes::MEDIT }>;
    "gltf": meshes::run::<{ meshes::GLTF }>, meshes::seeds::<{ meshes::GLTF }>;
    "glb": meshes::run::<{ meshes::GLB }>, meshes::seeds::<{ meshes::GLB }>;
    "nifti": volumes::run::<{ volumes::NIFTI }>, volumes::seeds::<{ volumes::NIFTI }>;
    "nrrd": volumes::run::<{ volumes::NRRD }>, volumes::seeds::<{ volumes::NRRD }>;
    "metaimage": volumes::run::<{ volumes::METAIMAGE }>, volumes::seeds::<{ volumes::METAIMAGE }>;
    "mgh": volumes::run::<{ volumes::MGH }>, volumes::seeds::<{ volumes::MGH }>;
    "tiff": volumes::run::<{ volumes::TIFF }>, volumes::seeds::<{ volumes::TIFF }>;
    "npy": volumes::run::<{ volumes::NPY }>, volumes::seeds::<{ volumes::NPY }>;
    "npz": arrays::npz, arrays::npz_seeds;
    "field": arrays::field, arrays::field_seeds;
    "tables": arrays::tables, arrays::table_seeds;
    "correspondences": correspondences::run, correspondences::seeds;
    "results": results::run, results::seeds;
    "msv-results": results::run_msv, results::msv_seeds;
    "tracks": results::run_tracks, results::track_seeds;
    "cache": collections::cache, collections::cache_seeds;
    "parquet": collections::parquet, collections::parquet_seeds;
    "arguments": arguments::run, arguments::seeds;
    "voxelize": soups::run, soups::seeds;
    "trees": trees::run, trees::seeds;
    "spectra": spectra::run, spectra::seeds;
}

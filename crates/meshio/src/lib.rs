//! Files of meshes, voxels and arrays to the shapes of mser3d and back.
#![warn(missing_docs)]

mod error;
mod format;
mod gltf;
mod obj;
mod off;
mod ply;
mod polygon;
mod read;
mod stl;
mod text;
mod weld;

pub use error::MeshIoError;
pub use format::MeshFormat;
pub use gltf::{AnimationInfo, list_animations};
pub use read::{LoadedMesh, ReadOptions, read_mesh, read_mesh_from};

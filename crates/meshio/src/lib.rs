//! Files of meshes, voxels and arrays to the shapes of mser3d and back.
#![warn(missing_docs)]

mod atomic;
mod error;
mod format;
mod gltf;
mod mask;
mod npy;
mod npz;
mod obj;
mod off;
mod ply;
mod polygon;
mod read;
mod stl;
mod text;
mod weld;
mod write;

pub use atomic::write_atomically;
pub use error::MeshIoError;
pub use format::MeshFormat;
pub use gltf::{AnimationInfo, list_animations};
pub use mask::read_mask;
pub use npy::{NpyArray, NpyValues};
pub use npz::{read_npz, write_npz};
pub use read::{LoadedMesh, ReadOptions, read_mesh, read_mesh_from};
pub use write::{VertexAttributes, VoxelField, VoxelValues, write_glb, write_off, write_ply, write_vti};

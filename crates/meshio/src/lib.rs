//! Mesh files to triangle meshes and back; voxel grids to ParaView.
//!
//! | | read | written |
//! |---|---|---|
//! | OBJ | polygons, groups, negative indices, continued lines (by tobj) | |
//! | glTF, GLB | all triangle primitives of the scene; node transforms, instances, morph targets, skins, animations; sparse and quantized accessors; buffers inside and beside the file | GLB with normals, colours and regions |
//! | OFF | ASCII, also with normals and colours, a line for each vertex and face or over line ends | yes |
//! | PLY | ASCII, binary of both byte orders; faces and triangle strips | binary, with normals, colours and regions |
//! | STL | ASCII, binary, several in one file | |
//! | VTU | cells of solids or polygons: text, base64 or appended bytes, perhaps packed by zlib, both byte orders | |
//! | VTP | polygons and strips, stored in the same ways | meshes for ParaView |
//! | VTK | versions 1 to 5.1, ASCII and binary: unstructured grids and polygons | |
//! | Gmsh `.msh` | versions 2, 4.0 and 4.1, ASCII and binary: cells of solids or polygons | |
//! | Medit `.mesh` | ASCII: cells of solids or polygons | |
//! | VTI | | voxel grids for ParaView |
//!
//! Each file may be packed by gzip (`name.obj.gz`).
//!
//! # Cells
//! A file of tetrahedra, hexahedra, voxels, wedges or pyramids is a solid, and its mesh is the solid's boundary: the
//! faces that belong to one cell only, seen from outside, whichever way the cells themselves turn. Polygons beside
//! such cells are left out, as Gmsh saves them too. Quadratic and higher cells count by their corners. Cells of
//! several parts are one solid. Vertices at equal positions count as the first of them there. All this is noted, and
//! so are cells that overlap. A file with polygons only is read as any other mesh.
//!
//! # What holds
//! * **Vertex i is the i-th vertex of the file**, whether a face uses it or not and however often its position
//!   occurs, for all formats but glTF and STL. These repeat a vertex for each primitive or
//!   triangle; there, vertices at equal positions (-0.0 equals 0.0) become one, numbered by first
//!   occurrence, and [`LoadedMesh::weld`] leads from each vertex of the file to its mesh vertex.
//!   For glTF, the file's vertices are those of the triangle primitives in the order in which the
//!   scene's nodes, depth first, show them; the welding is that of the rest pose, so all frames of
//!   an animation share vertices and triangles.
//! * Coordinates are read as f64 with every digit; decimals have a point in every locale. Polygons
//!   become triangles: fans where these don't fold over, else by clipping ears.
//! * Nothing is repaired in silence: what was left out is in [`LoadedMesh::notes`].
//! * A file may hold anything. Damaged ones end in a [`MeshIoError`] that names the file and the line,
//!   never in a panic; memory is bounded by the size of the file, not by the counts it declares.
//!   (A glTF scene may show one mesh at many nodes and instances: memory is bounded by what is shown. A
//!   packed file is bounded by what it unpacks to, at most 256 times its size or 1 GiB.) [`ReadOptions::limits`] bounds
//!   it as well: what would take more is refused before the memory is taken.
//! * Of other files, only buffers that a glTF file names are read: regular files in its folder or below, unless the limits
//!   allow others. Material files of OBJ are never opened.
//! * OFF, PLY and VTP are written in f64, every bit kept; GLB in f32, relative to the mesh's centre where that is
//!   far from the origin. [`write_glb`] tells if that lost anything.
//! * Files are written to the side and renamed ([`write_atomically`](mser3d_fileio::write_atomically)):
//!   nobody sees half of one. The same data make the same bytes.
//!
//! # Limits
//! Compressed glTF (Draco, meshopt), binary OFF, polyhedra and prisms of VTK, VTK's arrays packed by LZ4 or LZMA, Gmsh's
//! version 1 and free-form surfaces in OBJ are not read: all are refused, or noted, by name. Units and the
//! direction of "up" are left as they are in the file.
//!
//! # Example
//! ```
//! use mser3d_meshio::{MeshFormat, ReadOptions, read_mesh_from, write_off};
//! use std::path::Path;
//!
//! // A pyramid on a square, with a vertex that nothing uses.
//! let text = b"v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 9 9 9\nv 1 1 3\n\
//!     f 4 3 2 1\nf 1 2 6\nf 2 3 6\nf 3 4 6\nf 4 1 6\n";
//! let read = read_mesh_from(MeshFormat::Obj, text, Path::new("pyramid.obj"), &ReadOptions::default())?;
//! assert_eq!(read.mesh.vertices()[5], [1.0, 1.0, 3.0]);
//! assert_eq!((read.mesh.triangles().len(), read.polygons), (6, 1));
//! assert_eq!(read.mesh.signed_volume(), 4.0);
//!
//! # let folder = std::env::temp_dir().join(format!("mser3d-meshio-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder).unwrap();
//! let path = folder.join("pyramid.off");
//! write_off(&path, &read.mesh)?;
//! assert_eq!(mser3d_meshio::read_mesh(&path, &ReadOptions::default())?.mesh, read.mesh);
//! # std::fs::remove_dir_all(&folder).unwrap();
//! # Ok::<(), mser3d_meshio::MeshIoError>(())
//! ```
//!
//! A figure of a glTF file in every frame of its first animation:
//! ```no_run
//! use mser3d_meshio::{ReadOptions, list_animations, read_mesh};
//! use std::path::Path;
//!
//! let path = Path::new("fox.glb");
//! let walk = &list_animations(path, &Default::default())?[0];
//! for time in walk.frame_times(24.0)? {
//!     let options = ReadOptions { animation: Some(walk.index.to_string()), time, ..Default::default() };
//!     println!("{time:.3} s: {}", read_mesh(path, &options)?.mesh.signed_volume());
//! }
//! # Ok::<(), mser3d_meshio::MeshIoError>(())
//! ```
#![warn(missing_docs)]

mod boundary;
mod budget;
mod cells;
mod error;
mod format;
mod gltf;
mod gmsh;
mod gzip;
mod medit;
mod obj;
mod off;
mod ply;
mod polygon;
mod read;
mod stl;
mod text;
mod vtk;
mod weld;
mod write;

pub use error::MeshIoError;
pub use format::MeshFormat;
pub use gltf::{AnimationInfo, list_animations};
pub use read::{LoadedMesh, ReadOptions, read_mesh, read_mesh_from};
pub use write::{
    Moment, VertexAttributes, VoxelField, VoxelValues, write_glb, write_moving_glb, write_off, write_ply,
    write_vti, write_vtp,
};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

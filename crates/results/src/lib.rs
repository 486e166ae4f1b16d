//! What mser3d finds, as a folder of files, as pictures and as a page.
//!
//! [`Results`] is the one type between [`mser3d::Features`] and whatever shows or compares them: the
//! command line, collections and the pictures of the documentation. It is written by [`Results::write`], read by
//! [`Results::load`], drawn by [`Results::sheet`], [`Results::page`] and their relatives, and given to
//! other programs by [`Results::export`]. [`Record`] is what `regions.json` says.
//!
//! [`ShapeFile`] is the other end: a mesh or mask file, read for the detector, and what a record says of it;
//! [`Inspection`] is all that is known of one before any work. [`msv`] does the same for maximally stable volumes of
//! grey values.
//!
//! # The folder
//! | file | what it holds |
//! |---|---|
//! | `regions.json` | [`Record`]: version, input, parameters, warnings, trees, and the numbers of each region |
//! | `features.npz` | the arrays below |
//! | `eigenfunctions.npz` | if asked for: the eigenpairs of each body ([`Eigenfunctions`]) |
//! | `signatures.npz` | if asked for: the signature of each element ([`mser3d::signatures`]) |
//! | `fields.vti` | if asked for: the first eigenfunctions and the signature of each voxel |
//! | `surface.ply` | the mesh; colour and innermost region per vertex (none for a solid given as voxels) |
//! | `volume.vti` | innermost region per voxel, and its part (volumes only) |
//! | `checksums.json` | [`Checksums`]: size and SHA-256 of all of these |
//!
//! | array in `features.npz` | type and shape | meaning |
//! |---|---|---|
//! | `vertex_region` | int32, vertices | innermost region of each vertex, -1 for none (not for masks) |
//! | `region_vertices`, `region_vertices_start` | uint32; int64, regions + 1 | vertices of region i: `region_vertices[start[i]:start[i+1]]` (not for masks) |
//! | `region_voxels`, `region_voxels_start` | as above | voxels of each region |
//! | `voxel_index` | uint32, voxels x 3 | place of each voxel in the grid, x fastest |
//! | `voxel_region` | int32, voxels | innermost region of each voxel, -1 for none |
//! | `vertex_part`, `voxel_part` | int32, vertices; int32, voxels | part of each, where parts were asked for; -1 for vertices of bodies that were not searched |
//! | `grid_affine` | float64, 4 x 4 | index to world: a voxel's centre is `grid_affine @ (i, j, k, 1)` |
//! | `eigenvalues`, `body1_eigenvalues`, ... | float64 | in length^-2; of the largest body, and of the others that were searched on their own |
//! | `region_descriptor` | float64, regions x q | rows in the order of `regions.json` |
//! | `region_twin` | int32, regions | mirror image of each region, -1 for none |
//! | `region_side` | float64, regions | on which side of its body each is, NaN where the body has no sides |
//! | `tree0_parent`, `tree0_altitude`, `tree0_volume`, ... | int32, float64, float64, nodes | a component tree, children first; -1 for a root |
//! | `tree0_entry`, ... | int32, voxels or vertices | the node in which each enters; -1 for those of other bodies |
//! | `file_vertex` | uint32, vertices of the file | the mesh's vertex (files that repeat vertices only) |
//!
//! ```
//! use mser3d::{Detector, Input, Parameters};
//! use mser3d_results::Results;
//! # use mser3d::shape::TriangleMesh;
//! # let corners = (0..8u32).map(|i| [f64::from(i & 1), f64::from(i >> 1 & 1), 3.0 * f64::from(i >> 2)]).collect();
//! # let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
//! # let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
//! # let mesh = TriangleMesh::new(corners, triangles)?;
//! # let mut parameters = Parameters::default();
//! # parameters.voxelize.pitch = mser3d::voxelize::Pitch::Voxels(1500);
//! # parameters.spectrum.eigenpairs = 20.into();
//! # let folder = std::env::temp_dir().join(format!("mser3d-results-{}", std::process::id()));
//! let features = Detector::new(parameters).detect(Input::Volume(&mesh))?;
//! let results = Results::new(&features, Some(&mesh), "bar.off")?;
//! results.write(&folder)?;
//!
//! let read = Results::load(&folder)?;
//! assert_eq!(read.record.regions.len(), features.regions.len());
//! let html = read.page("A bar", mser3d_results::Up::Y)?;
//! assert!(html.starts_with("<!DOCTYPE html>"));
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![warn(missing_docs)]

mod beside;
mod check;
mod checksums;
mod draw;
mod drawing;
mod eigenfunctions;
mod error;
mod export;
mod field_file;
mod fine_surface;
mod folder;
mod front;
mod inspect;
mod label_map;
mod landmarks;
mod load;
pub mod msv;
mod oriented_box;
mod page;
mod parts;
mod record;
mod results;
mod shape_file;
mod shape_format;
mod sides;
mod signatures;
mod tracks;
mod verify;
mod volume_file;
mod write;

pub use checksums::{Checksums, FileChecksum};
pub use draw::matched_colours;
pub use drawing::Drawing;
pub use eigenfunctions::Eigenfunctions;
pub use error::ResultsError;
pub use export::EXPORT_ENDINGS;
pub use field_file::{FieldFile, FieldRecord};
pub use folder::ResultsFolder;
pub use inspect::{Inspection, ValuesRecord};
pub use label_map::LabelMap;
pub use landmarks::write_landmarks;
pub use mser3d_viewer::{Background, Image, RegionPair, RenderOptions, Up};
pub use oriented_box::OrientedBox;
pub use page::matched_parts;
pub use record::{
    FORMAT, GridRecord, InputRecord, PartRecord, Record, RegionRecord, SearchedBodyRecord, SpectrumRecord,
    TreeRecord, VoxelizationRecord,
};
pub use results::{Results, TreeArrays};
pub use shape_file::{Contents, ShapeFile, ShapeOptions};
pub use shape_format::ShapeFormat;
pub use sides::{left_and_right, side_text, sidedness_certainty, sidedness_kind};
pub use tracks::{Identity, Sighting, Track, TrackParameters, TrackedFrame, TracksRecord};
pub use verify::{Finding, first_damage, verify, verify_matches};
pub use volume_file::{BodyRecord, SolidVolume, VolumeFile, VolumeRecord};
pub use write::Extra;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

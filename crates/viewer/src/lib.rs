//! Pictures of shapes and their regions, without display or GPU.
//!
//! * [`region_colours`], [`linked_colours`], [`sequential`]: one set of colours for every picture and
//!   page, chosen to stay apart for colour-blind eyes;
//! * [`Model`]: a [`TriangleMesh`](mser3d_shape::TriangleMesh), the faces of a
//!   [`VoxelGrid`](mser3d_shape::VoxelGrid), or a surface cut open over its voxels;
//! * [`render`]: panels of models into one [`Image`], by a z-buffer on the CPU with supersampling, smooth
//!   normals, ambient occlusion, and lines where shapes and regions end;
//! * [`page`](page()): one HTML file to turn, click, cut and compare shapes in a browser;
//! * [`gallery`](gallery()): one HTML file with pictures in rows.
//!
//! The same input gives the same bytes for any number of threads. Limits: orthographic views; one
//! colour per sample, so no transparency.
//!
//! Features: `serde` (names of views and axes for serde), `schema` (their JSON Schema).
//!
//! ```
//! use mser3d_shape::TriangleMesh;
//! use mser3d_viewer::{Colours, Model, Panel, RegionTraits, RenderOptions, region_colours, render};
//!
//! let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
//! let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])?;
//! let labels = [0, 0, 1, -1];
//! let regions = [0, 1].map(|r| RegionTraits { family: Some(r), ..RegionTraits::default() });
//! let colours = region_colours(&regions, &labels, &mesh.edge_graph());
//! let model = Model::from_mesh(&mesh, Colours::Regions { labels: &labels, colours: &colours })?;
//! let sheet = render(&Panel::around(&model), &RenderOptions { height: 120, ..Default::default() })?;
//! let mut png = Vec::new();
//! sheet.write_png(&mut png)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![warn(missing_docs)]

mod animation;
mod axes;
mod borders;
mod camera;
mod cut;
mod draw_panel;
mod error;
mod gallery;
mod image;
mod labels;
mod legend;
mod lighting;
mod model;
mod normals;
mod occlusion;
mod page;
mod palette;
mod raster;
mod region_colours;
mod render;
mod render_options;
mod rgb;
mod section;
mod sequence_page;
#[cfg(test)]
mod test_shapes;
mod text;
mod z_buffer;

pub use animation::{frame_milliseconds, write_animation};
pub use camera::{NamedView, Up, View};
pub use cut::Cut;
pub use error::ViewerError;
pub use gallery::{Gallery, GalleryPicture, GalleryRow, gallery};
pub use image::Image;
pub use legend::LegendEntry;
pub use model::{Colours, Model};
pub use mser3d_shape as shape;
pub use mser3d_shape::InvalidParameter;
pub use page::{PageData, PageGrey, PagePart, PageParts, PageRegion, PageShape, PageTree, RegionPair, page};
pub use palette::{Hue, MISTAKE, NO_REGION, PALETTE, sequential, sequential_colours};
pub use png;
pub use region_colours::{RegionTraits, label_colour, linked_colours, region_colours};
pub use render::{Panel, render, render_with_legend};
pub use render_options::{Background, RenderOptions};
pub use rgb::Rgb;
pub use section::voxel_surface;
pub use sequence_page::{SequenceFrame, SequencePage, SequenceTrack, TrackPoint};
pub use text::{text_width, write_text, write_text_with_halo};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

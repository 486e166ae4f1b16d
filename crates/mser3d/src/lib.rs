//! Stable volumetric regions of 3D shapes, from a solid to its features in one call.
//!
//! The reference implementation of R. Litman, A. Bronstein, M. Bronstein, *Stable volumetric features
//! in deformable shapes*, Computers & Graphics 36 (2012): a solid's heat diffusion, from the spectrum of
//! its voxel Laplacian, weighs the voxel graph; a component tree over that weight is searched for
//! maximally stable regions; each gets a scale-invariant heat descriptor. The regions stay the same
//! when the body moves, so they match across poses, scans and noise.
//!
//! * A [`Detector`] does it all, for the volume or the surface of a mesh, or for voxels: its fields are everything it
//!   can be told, its one method [`detect`](Detector::detect).
//! * Its stages can be called one by one and their results reused: [`DiscreteShape::volume`],
//!   [`DiscreteShape::surface`] or [`DiscreteShape::solid`] make what heat flows on,
//!   [`DiscreteShape::spectrum`] its eigenbasis, [`find_regions`] the regions for any number of weights,
//!   [`describe`] their descriptors, and left and right.
//! * Any other weight is a [`Field`]: a number or a vector for each element, from a function that
//!   [`Detector::with_weight`] takes.
//!
//! ```
//! use mser3d::{Detector, Input, Parameters};
//! use mser3d::shape::TriangleMesh;
//! use mser3d::voxelize::Pitch;
//!
//! // A thin box on a thick one, as one closed mesh would be read from a file.
//! # let quad = |a: u32, b, c, d| [[a, b, c], [a, c, d]];
//! # let corners = |x: f64, y: f64, z: [f64; 2]| -> Vec<[f64; 3]> { (0..8).map(|i| [
//! #     if i & 1 == 0 { -x } else { x }, if i & 2 == 0 { -y } else { y }, z[i >> 2]]).collect() };
//! # let faces = |o: u32| -> Vec<[u32; 3]> { [quad(0, 2, 3, 1), quad(4, 5, 7, 6), quad(0, 1, 5, 4),
//! #     quad(2, 6, 7, 3), quad(0, 4, 6, 2), quad(1, 3, 7, 5)].concat().iter().map(|t| t.map(|v| v + o)).collect() };
//! # let vertices = [corners(2., 2., [0., 4.]), corners(0.6, 0.6, [3.9, 9.])].concat();
//! # let triangles = [faces(0), faces(8)].concat();
//! let mesh = TriangleMesh::new(vertices, triangles)?;
//! let mut parameters = Parameters::default();
//! parameters.voxelize.pitch = Pitch::Voxels(4000);
//! parameters.spectrum.eigenpairs = 40.into();
//! let features = Detector::new(parameters).detect(Input::Volume(&mesh))?;
//! // The handle is a region: it is thin, so heat stays in it.
//! assert!(features.regions.iter().any(|region| region.centroid[2] > 5.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![warn(missing_docs)]

mod bodies;
mod carry;
mod course;
mod deadline;
mod describe;
mod detector;
mod discrete_shape;
mod error;
mod estimate;
mod features;
mod field;
mod input;
mod memory;
mod parameters;
mod parts;
mod positions;
mod progress;
mod regions;
mod reliability;
mod run_report;
mod shells;
mod sides;
mod sight;
mod solid;
mod surface_points;
mod warning;
mod weighing;
mod weight;
mod weld;

pub use bodies::{Bodies, MIN_BODY_ELEMENTS, MIN_BODY_FRACTIONS};
pub use deadline::{Deadline, DeadlinePassed};
pub use describe::{Described, describe, signatures};
pub use detector::{Detector, FieldSource, SpectrumSource};
pub use discrete_shape::{DiscreteShape, Elements};
pub use error::Error;
pub use estimate::{Estimate, StageSeconds};
pub use features::{Body, Features};
pub use field::{Field, LARGEST_WEIGHT};
pub use input::Input;
pub use memory::{available_memory, peak_memory, used_memory};
pub use mser3d_shape::Domain;
pub use parameters::{Descriptor, DescriptorKind, Parameters};
pub use parts::{Part, PartCount, PartParameters, Partition, partition};
pub use positions::Positions;
pub use progress::{NO_PROGRESS, Progress, ProgressFn, Stage};
pub use regions::{Region, RegionSet, Tree, find_regions, find_regions_of_field};
pub use reliability::ReliabilityParameters;
pub use run_report::{RunReport, StageReport};
pub use sides::{Sidedness, Sides};
pub use surface_points::SurfacePoints;
pub use warning::Warning;
pub use weight::Weight;

pub use mser3d_comptree as comptree;
pub use mser3d_descriptors as descriptors;
pub use mser3d_laplace as laplace;
pub use mser3d_shape as shape;
pub use mser3d_spectral as spectral;
pub use mser3d_voxelize as voxelize;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

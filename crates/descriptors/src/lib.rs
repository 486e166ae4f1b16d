//! Weights, signatures and matches from the eigenfunctions of a shape's Laplacian.
//!
//! From an [`Eigenbasis`](mser3d_shape::Eigenbasis), in a volume or on a surface alike:
//!
//! | what | function | paper |
//! |---|---|---|
//! | heat kernel of vertices and edges | [`auto_diffusivity`], [`heat_kernel`], [`inverse_heat_kernel`], [`diffusion_distance`] | section 4.3 |
//! | commute time | [`commute_time`], [`power_diffusivity`] | eq. 6 |
//! | vHKS, HKS | [`hks`] | section 5 |
//! | SI-vHKS, SI-HKS | [`si_hks`] | eq. 9 |
//! | left and right | [`chirality_of_solid`], [`chirality_of_surface`] | |
//! | descriptors of regions | [`region_descriptors`] | eq. 11 |
//! | bags of features | [`Vocabulary`] | section 5 |
//! | 3D integral invariants | [`integral_invariants`] | section 5 |
//! | matches between two shapes' regions | [`match_descriptors`] | section 6 |
//! | a map between two shapes, point by point | [`dense_map`] | |
//!
//! The paper is R. Litman, A. Bronstein, M. Bronstein, *Stable volumetric features in deformable shapes*,
//! Computers & Graphics 36 (2012).
//!
//! ```
//! use mser3d_descriptors::{SiHksParameters, TimeScale, auto_diffusivity, region_descriptors, si_hks};
//! use mser3d_shape::{Domain, Eigenbasis};
//!
//! // A rod of two voxels of volume 1/2: one constant mode and one of opposite signs.
//! let basis = Eigenbasis::new(Domain::Volume, vec![0.5; 2], vec![0.0, 4.0], vec![1., 1., 1., -1.])?;
//! let t = TimeScale::Relative(0.5).on(&basis)?;
//! let heat = auto_diffusivity(&basis, t)?;
//! assert!((heat[0] - (1.0 + (-4.0 * t).exp())).abs() < 1e-15);
//!
//! let regions = [[0u32]];
//! let params = SiHksParameters::default();
//! let rows = region_descriptors(&regions, basis.mass(), |voxels| si_hks(&basis, &params, Some(voxels)))?;
//! assert_eq!(rows.width(), 6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Times have units of length^2 ([`TimeScale`]). Results are the same, bit for bit, for any number of
//! threads.
//!
//! Features: `serde` (parameters and names of choices for serde), `schema` (their JSON Schema).
#![warn(missing_docs)]

mod assignment;
mod chirality;
mod commute;
mod consistency;
mod dense_map;
mod descriptor_table;
mod error;
mod heat;
mod hks;
mod integral_invariants;
mod kmeans;
mod matching;
mod regions;
mod si_hks;
mod spectral_sums;
mod time_scale;
mod vertex_subset;
mod vocabulary;

pub use assignment::assign;
pub use chirality::{Chirality, ChiralityParameters, chirality_of_solid, chirality_of_surface};
pub use commute::{ZERO_EIGENVALUE, commute_time, power_diffusivity, zero_modes};
pub use consistency::RegionCosines;
pub use dense_map::{DenseMapParameters, MapPoints, MapShape, dense_map};
pub use descriptor_table::Descriptors;
pub use error::DescriptorError;
pub use heat::{
    auto_diffusivities, auto_diffusivity, diffusion_distance, heat_kernel, heat_trace, inverse_heat_kernel,
};
pub use hks::{HksParameters, hks};
pub use integral_invariants::{IntegralInvariantParameters, integral_invariants};
pub use matching::{
    Candidate, DescriptorMatch, MatchParameters, MatchRule, match_descriptors, match_regions,
};
pub use mser3d_shape as shape;
pub use mser3d_shape::InvalidParameter;
pub use regions::{region_descriptors, region_means};
pub use si_hks::{SiHksParameters, si_hks};
pub use time_scale::TimeScale;
pub use vocabulary::{Vocabulary, VocabularyParameters};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

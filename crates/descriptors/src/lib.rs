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
//! | descriptors of regions | [`region_descriptors`] | eq. 11 |
//! | matches between two shapes' regions | [`match_descriptors`] | section 6 |
//!
//! The paper is R. Litman, A. Bronstein, M. Bronstein, *Stable volumetric features in deformable shapes*,
//! Computers & Graphics 36 (2012).
//!
//! Times have units of length^2 ([`TimeScale`]). Results are the same, bit for bit, for any number of threads.
#![warn(missing_docs)]

mod assignment;
mod commute;
mod error;
mod heat;
mod hks;
mod matching;
mod regions;
mod selection;
mod si_hks;
mod spectrum;
mod table;
mod time;

pub use assignment::assign;
pub use commute::{ZERO_EIGENVALUE, commute_time, power_diffusivity, zero_modes};
pub use error::DescriptorError;
pub use heat::{auto_diffusivity, diffusion_distance, heat_kernel, heat_trace, inverse_heat_kernel};
pub use hks::{HksParams, hks};
pub use matching::{Candidate, Match, MatchParams, MatchRule, match_descriptors};
pub use regions::region_descriptors;
pub use si_hks::{SiHksParams, si_hks};
pub use table::Descriptors;
pub use time::TimeScale;

//! Left and right: which regions are each other's mirror images, and which of them are on the same side.
//!
//! 1. `twins`: regions that are each other's nearest in descriptor space, apart from each other.
//! 2. `relative`: which members of the pairs lie on one side, from how heat flows between them.
//! 3. `evidence`: which side that is, from pseudo-scalar fields ([`mser3d_descriptors::chirality_of_solid`]); one vote of
//!    all pairs of the body, and one of each pair alone.

mod evidence;
mod relative;
mod twins;
mod vectors;

use mser3d_descriptors::{
    ChiralityParameters, DescriptorError, Descriptors, RegionCosines, chirality_of_solid,
    chirality_of_surface, region_means, zero_modes,
};
use mser3d_shape::{Domain, Eigenbasis};

use crate::{DiscreteShape, Elements, Error, Region};
pub(crate) use twins::LIKE_PLACE;
use vectors::{embed, product};

/// How long heat smooths what is compared, over the unit of time: its evidence is gathered over a limb and what is near.
const SMOOTHING: f64 = 0.1;

/// How long heat flows between regions when their places are compared, over the unit of time.
const NEARNESS: f64 = 0.3;

/// Whether a body has a left and a right.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Sidedness {
    /// No two of its regions are mirror images of each other.
    #[default]
    NoTwins,
    /// It has twins, but as far as voxels can tell it is the same front and back, or top and bottom. A rotation then
    /// exchanges them as well as a reflection, so that neither is the left one.
    Alike {
        /// How sure the sides would be, below 0.5.
        certainty: f64,
    },
    /// Left and right can be told.
    Sided {
        /// How sure they are, from 0.5 to 1.
        certainty: f64,
    },
}

impl Sidedness {
    /// How sure the sides are, 0 to 1: from 0.5 on they are told.
    pub fn certainty(self) -> f64 {
        match self {
            Self::NoTwins => 0.0,
            Self::Alike { certainty } | Self::Sided { certainty } => certainty,
        }
    }
}

/// Left and right of one body's regions.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Sides {
    /// For each region its mirror image, as a place in the list of regions.
    pub twins: Vec<Option<usize>>,
    /// Where each region lies: 1 on one side, -1 on the other, 0 in the middle. None where the body has no sides.
    ///
    /// Which side is positive is a convention that bodies of one kind share. Where it matters whether two bodies are
    /// alike enough for that, compare [`evidence`](Self::evidence).
    pub sides: Vec<Option<f64>>,
    /// Whether the body has sides.
    pub sidedness: Sidedness,
    /// A row for each region: `sqrt(1 - side^2)`, how far it is in the middle; then the direction of the body's evidence
    /// and that of its own pair's, both times `side`; all times the body's certainty. Without the first number the scalar
    /// product of two regions' rows is positive if they are on the same side of their bodies.
    /// [`crate::Descriptor::SidedSiHks`] has these numbers, weighed.
    pub evidence: Descriptors,
    /// How near the regions are to each other, by the heat that flows between them in 0.3 units of time.
    pub cosines: RegionCosines,
}

/// Finds left and right of the regions of one body.
///
/// `descriptors` are those of the regions without sides, SI-vHKS with the size ([`crate::Descriptor::SizedSiHks`]) at
/// `samples_per_octave`. `unit_time` is what relative times refer to ([`mser3d_shape::Eigenbasis::unit_time`]).
pub(crate) fn find_sides(
    shape: &DiscreteShape,
    basis: &Eigenbasis,
    regions: &[Region],
    descriptors: &Descriptors,
    samples_per_octave: f64,
    unit_time: f64,
) -> Result<Sides, Error> {
    let members: Vec<&[u32]> = regions.iter().map(|region| &region.elements[..]).collect();
    let means = region_means(basis, &members);
    let zero = zero_modes(basis);
    let cosines = cosines(&means, basis.eigenvalues(), zero, NEARNESS * unit_time)?;
    let pairs = twins::twins(regions, descriptors, &cosines, samples_per_octave);
    let mut twins = vec![None; regions.len()];
    for &[a, b] in &pairs {
        (twins[a], twins[b]) = (Some(b), Some(a));
    }
    let params = ChiralityParameters::default();
    let fields = match basis.domain() {
        Domain::Volume => params.fields_of_solid(),
        Domain::Surface => params.fields_of_surface(),
    };
    let width = 1 + 2 * fields;
    let none = |sidedness| -> Result<Sides, Error> {
        let evidence = Descriptors::new(width, vec![0.0; width * regions.len()])?;
        let (twins, cosines) = (twins.clone(), cosines.clone());
        Ok(Sides { twins, sides: vec![None; regions.len()], sidedness, evidence, cosines })
    };
    if pairs.is_empty() || zero >= basis.eigenvalues().len() {
        return none(Sidedness::NoTwins);
    }
    let chirality = match shape.elements() {
        Elements::Voxels { grid, .. } => chirality_of_solid(basis, grid, unit_time, &params)?,
        Elements::Vertices { mesh, .. } => chirality_of_surface(basis, mesh, unit_time, &params)?,
    };
    let places = relative::places(&pairs, &means, basis.eigenvalues(), zero);
    let smoothed: Vec<f64> = basis.eigenvalues().iter().map(|l| (-l * SMOOTHING * unit_time).exp()).collect();
    let found = evidence::gather(&chirality, regions, &pairs, &places, &means, &smoothed);
    let rows = (0..regions.len()).flat_map(|region| found.row(places.of_regions[region])).collect();
    let certainty = found.certainty;
    let sided = certainty >= 0.5;
    let side = |place: &relative::Place| sided.then_some(place.side * found.sign);
    Ok(Sides {
        twins,
        sides: places.of_regions.iter().map(side).collect(),
        sidedness: if sided { Sidedness::Sided { certainty } } else { Sidedness::Alike { certainty } },
        evidence: Descriptors::new(width, rows)?,
        cosines,
    })
}

/// The cosines of the heat that flows out of regions in a time: of the means of eigenfunctions, without the zero modes.
fn cosines(
    means: &[Vec<f64>],
    eigenvalues: &[f64],
    zero_modes: usize,
    time: f64,
) -> Result<RegionCosines, DescriptorError> {
    let weight = |(i, l): (usize, &f64)| if i < zero_modes { 0.0 } else { (-0.5 * time * l).exp() };
    let weights: Vec<f64> = eigenvalues.iter().enumerate().map(weight).collect();
    let vectors: Vec<Vec<f64>> = means.iter().map(|mean| embed(mean, &weights)).collect();
    let values = vectors.iter().flat_map(|a| vectors.iter().map(move |b| product(a, b))).collect();
    RegionCosines::new(means.len(), values)
}

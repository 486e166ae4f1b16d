//! Maximally stable volumes of grey values (Donoser and Bischof 2006), as VLFeat defines MSER.
use mser3d_shape::InvalidParameter;

use crate::stability::{Candidate, regions_of};
use crate::{ComponentTree, Polarity, Selection, SelectionReport, TreeError};

mser3d_shape::choice! {
    /// What maximally stable volumes have in common, and so which tree they are found in.
    pub enum Contrast("kind of region") {
        /// Dark regions on brighter ground (MSER+)
        #[default]
        Dark = "dark",
        /// Bright regions on darker ground (MSER-)
        Bright = "bright",
        /// Regions of like colour: vectors have no order, but distances
        Alike = "alike",
    }
}

impl Contrast {
    /// The polarity of the component tree that has such regions. Of [`Contrast::Alike`], the tree is over the distances
    /// of neighbours.
    pub fn polarity(self) -> Polarity {
        match self {
            Self::Dark | Self::Alike => Polarity::Sublevel,
            Self::Bright => Polarity::Superlevel,
        }
    }
}

/// VLFeat's parameters of MSER, by its names; for volumes as for images.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MsvParameters {
    /// Over how many grey values a region is compared with what it grows into. Default 5.
    pub delta: f64,
    /// Smallest area (volume) of a region as a fraction of all, 0 to 1. Default 0.
    pub min_area: f64,
    /// Largest area (volume) of a region as a fraction of all. Default 0.75.
    pub max_area: f64,
    /// Variation `(area at level + delta - area) / area` from which on a region is dropped as unstable.
    /// Default 0.25.
    pub max_variation: f64,
    /// A region is dropped if it differs by less than this from the nearest kept region around it, or from
    /// the root: `(outer area - area) / outer area`; 0 to 1. Default 0.2.
    pub min_diversity: f64,
    /// A region is compared with its parent only if the parent's grey value is at most this far away.
    /// Otherwise the region lasts a whole step unchanged, and is maximally stable. Default 1, for integers;
    /// infinite to compare always (`null` in JSON).
    #[cfg_attr(feature = "serde", serde(with = "infinite_as_null"))]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub step: f64,
}

impl Default for MsvParameters {
    fn default() -> Self {
        Self { delta: 5.0, min_area: 0.0, max_area: 0.75, max_variation: 0.25, min_diversity: 0.2, step: 1.0 }
    }
}

impl MsvParameters {
    /// Checks every range.
    ///
    /// # Errors
    /// [`TreeError::InvalidParameter`] for the first value out of its range.
    pub fn validate(&self) -> Result<(), TreeError> {
        let fraction = |x: f64| (0.0..=1.0).contains(&x);
        let checks = [
            (self.delta > 0.0 && self.delta.is_finite(), "delta", self.delta, "positive and finite"),
            (fraction(self.min_area), "min_area", self.min_area, "between 0 and 1"),
            (self.max_area >= 0.0, "max_area", self.max_area, "0 or more"),
            (self.max_variation >= 0.0, "max_variation", self.max_variation, "0 or more"),
            (fraction(self.min_diversity), "min_diversity", self.min_diversity, "between 0 and 1"),
            (self.step >= 0.0, "step", self.step, "0 or more"),
        ];
        match checks.into_iter().find(|check| !check.0) {
            Some((_, name, value, expected)) => Err(InvalidParameter::new(name, value, expected).into()),
            None => Ok(()),
        }
    }
}

/// JSON has no infinity.
#[cfg(feature = "serde")]
mod infinite_as_null {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
        value.is_finite().then_some(*value).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(from)?.unwrap_or(f64::INFINITY))
    }
}

/// The maximally stable volumes of a tree of grey values (Donoser and Bischof 2006), or the maximally
/// stable extremal regions of an image (Matas et al. 2002): dark regions with
/// [`Polarity::Sublevel`](crate::Polarity::Sublevel), bright ones with
/// [`Polarity::Superlevel`](crate::Polarity::Superlevel).
///
/// A region is maximally stable if its variation is smaller than its parent's and not larger than that
/// of any child, where these follow within a step. Roots never are. The stability of a
/// [`StableRegion`](crate::StableRegion) is `1 / variation`.
///
/// VLFeat works on u8 with 8 (26) neighbours; here the tree decides.
///
/// ```
/// use mser3d_comptree::{ComponentTree, MsvParameters, Polarity, maximally_stable_volumes};
/// use mser3d_comptree::shape::Connectivity;
///
/// // A dark square of 16 pixels on a bright ground.
/// let pixel = |i: usize| if (3..7).contains(&(i % 10)) && (3..7).contains(&(i / 10)) { 40u8 } else { 200 };
/// let image: Vec<u8> = (0..100).map(pixel).collect();
/// let tree = ComponentTree::from_grid([10, 10, 1], Connectivity::TwentySix, &image, 1.0, Polarity::Sublevel)?;
/// let regions = maximally_stable_volumes(&tree, &MsvParameters::default())?.regions;
/// assert_eq!((regions.len(), regions[0].volume, regions[0].altitude), (1, 16.0, 40.0));
/// # Ok::<(), mser3d_comptree::TreeError>(())
/// ```
///
/// # Errors
/// [`TreeError::InvalidParameter`] from [`MsvParameters::validate`].
pub fn maximally_stable_volumes(
    tree: &ComponentTree,
    parameters: &MsvParameters,
) -> Result<Selection, TreeError> {
    parameters.validate()?;
    let count = tree.len() as u32;
    let level = |node: u32| tree.polarity().orient(tree.altitude(node));
    let variation = variation(tree, parameters.delta);
    let mut stable: Vec<bool> = (0..count).map(|node| tree.parent(node).is_some()).collect();
    for node in 0..count {
        if let Some(parent) = tree.parent(node)
            && level(parent) <= level(node) + parameters.step
        {
            let loser = if variation[node as usize] < variation[parent as usize] { parent } else { node };
            stable[loser as usize] = false;
        }
    }
    let total = tree.total_volume();
    let (smallest, largest) = (parameters.min_area * total, parameters.max_area * total);
    let mut report = SelectionReport { nodes: tree.len(), ..Default::default() };
    let mut kept = Vec::new();
    // From the roots down, so that a region is compared with the nearest ancestor that is kept, or the root.
    let mut nearest: Vec<u32> = (0..count).collect();
    for node in (0..count).rev() {
        let Some(parent) = tree.parent(node) else { continue };
        let above_node = if stable[parent as usize] { parent } else { nearest[parent as usize] };
        nearest[node as usize] = above_node;
        if !stable[node as usize] {
            continue;
        }
        report.candidates += 1;
        let (volume, above) = (tree.volume(node), tree.volume(above_node));
        let variation = variation[node as usize];
        let removed = if variation >= parameters.max_variation {
            &mut report.unstable
        } else if volume > largest {
            &mut report.too_large
        } else if volume < smallest {
            &mut report.too_small
        } else if above - volume < parameters.min_diversity * above {
            &mut report.overlapping
        } else {
            kept.push(Candidate { node, stability: 1.0 / variation, merge: None });
            continue;
        };
        *removed += 1;
        stable[node as usize] = false;
    }
    report.kept = kept.len();
    Ok(Selection { regions: regions_of(tree, kept), report })
}

/// How much each node grows until `delta` further, relative to its volume.
fn variation(tree: &ComponentTree, delta: f64) -> Vec<f64> {
    let level = |node: u32| tree.polarity().orient(tree.altitude(node));
    // The largest ancestor within delta. A child's is at or below its parent's, so each search starts
    // where the last child's ended.
    let mut top: Vec<u32> = (0..tree.len() as u32).collect();
    let mut variation = Vec::with_capacity(tree.len());
    for node in 0..tree.len() as u32 {
        let mut at = top[node as usize];
        while let Some(next) = tree.parent(at).filter(|&next| level(next) <= level(node) + delta) {
            at = next;
        }
        if let Some(parent) = tree.parent(node) {
            // Only if the child reaches as far does it help its parent.
            let helps = at.max(parent);
            top[parent as usize] = top[parent as usize].max(helps);
        }
        let volume = tree.volume(node);
        variation.push(if volume > 0.0 { (tree.volume(at) - volume) / volume } else { f64::INFINITY });
    }
    variation
}

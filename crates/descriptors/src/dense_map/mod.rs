//! A map from one shape to another, point by point, from regions that are matched.

mod coordinates;
mod nearest;
mod points;
mod rotation;

use mser3d_shape::Eigenbasis;
use rayon::prelude::*;

use crate::DescriptorError;
use coordinates::{Points, anchors, functions_at};
use nearest::Neighbours;
pub use points::MapPoints;

/// A shape that is mapped to another, or that is mapped to.
#[derive(Clone, Copy, Debug)]
pub struct MapShape<'a> {
    /// Its eigenpairs.
    pub basis: &'a Eigenbasis,
    /// The elements of each of its regions.
    pub regions: &'a [Vec<u32>],
    /// The elements that are mapped, each once: those at the surface, for example ([`MapPoints`]).
    pub points: &'a [u32],
    /// How much each of them counts: its share of the area, in any unit.
    pub weights: &'a [f64],
}

/// Parameters of [`dense_map`]. Times are over the unit of time ([`Eigenbasis::unit_time`]).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DenseMapParameters {
    /// How long heat flows from a point to the regions. Default 0.005, 0.02, 0.1, 0.5.
    pub times: Vec<f64>,
    /// Times of the heat kernel signature. Default 0.005, 0.01, 0.02, 0.04, 0.08.
    pub signature_times: Vec<f64>,
    /// Weight of the place among the regions beside that of the eigenfunctions, 1. Default 4.
    pub places: f64,
    /// Weight of the heat kernel signature. Default 1.2.
    pub signatures: f64,
    /// Eigenfunctions of each round, ascending. A round takes as many as both shapes have. Default 20, 40, 60, 80, 100.
    pub rounds: Vec<usize>,
    /// Points of each shape that the rounds look at. Default 8000.
    pub samples: usize,
}

impl Default for DenseMapParameters {
    fn default() -> Self {
        Self {
            times: vec![0.005, 0.02, 0.1, 0.5],
            signature_times: vec![0.005, 0.01, 0.02, 0.04, 0.08],
            places: 4.0,
            signatures: 1.2,
            rounds: vec![20, 40, 60, 80, 100],
            samples: 8000,
        }
    }
}

impl DenseMapParameters {
    /// Whether all values are in range.
    ///
    /// # Errors
    /// [`DescriptorError::InvalidParameter`].
    pub fn validate(&self) -> Result<(), DescriptorError> {
        for (name, times) in [("times", &self.times), ("signature_times", &self.signature_times)] {
            if let Some(&time) = times.iter().find(|t| !(**t > 0.0 && t.is_finite())) {
                return Err(DescriptorError::parameter(name, time, "more than 0"));
            }
        }
        for (name, weight) in [("places", self.places), ("signatures", self.signatures)] {
            if !(weight >= 0.0 && weight.is_finite()) {
                return Err(DescriptorError::parameter(name, weight, "at least 0"));
            }
        }
        for (name, count) in [("rounds", self.rounds.iter().min()), ("samples", Some(&self.samples))] {
            if count == Some(&0) {
                return Err(DescriptorError::parameter(name, 0, "at least 1"));
            }
        }
        if self.times.is_empty() {
            return Err(DescriptorError::parameter("the number of times", 0, "at least 1"));
        }
        Ok(())
    }
}

/// Maps each point of `second` to one of `first`, as its place among the points there.
///
/// `pairs` names regions that are matched: of each pair first the region of `first`. A point has its place among them:
/// for each matched region the cosine of the angle between the heat that flows out of the point and out of the region
/// ([`crate::RegionCosines`]), at several times. Such coordinates are the same on both shapes, so the nearest point in
/// them is a first map. It is coarse, and is made finer in rounds, as in ZoomOut (Melzi et al. 2019): the maps both ways say which
/// rotation carries the eigenfunctions of one shape to those of the other, and the nearest point in more and more eigenfunctions,
/// beside the place among the regions and the heat kernel signature, is the next map. The places keep limbs from being exchanged or turned
/// about, which the eigenfunctions alone allow.
///
/// ```
/// use mser3d_descriptors::{DenseMapParameters, MapShape, dense_map};
/// use mser3d_shape::{Domain, Eigenbasis};
///
/// // A rod of two voxels, and the same rod with its ends exchanged.
/// let rod = |ends: [f64; 2]| {
///     let functions = vec![1.0, ends[0], 1.0, ends[1]];
///     Eigenbasis::new(Domain::Volume, vec![0.5; 2], vec![0.0, 4.0], functions)
/// };
/// let (rod, turned) = (rod([1.0, -1.0])?, rod([-1.0, 1.0])?);
/// let (points, weights) = ([0, 1], [1.0; 2]);
/// let (ends, others) = ([vec![0], vec![1]], [vec![1], vec![0]]);
/// let first = MapShape { basis: &rod, regions: &ends, points: &points, weights: &weights };
/// let second = MapShape { basis: &turned, regions: &others, points: &points, weights: &weights };
/// let map = dense_map(&first, &second, &[[0, 0], [1, 1]], &DenseMapParameters::default())?;
/// assert_eq!(map, [1, 0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Of points that are equally near the first counts. Cost, for n points, k eigenfunctions and c coordinates: about
/// n sqrt(n) c, and the memory of n c numbers of 4 bytes for each shape.
///
/// # Errors
/// [`DescriptorError::InvalidParameter`], also for no pairs; [`DescriptorError::IndexOutOfRange`],
/// [`DescriptorError::EmptyRegion`], [`DescriptorError::SizeMismatch`], [`DescriptorError::EmptyBasis`],
/// [`DescriptorError::OnlyZeroModes`].
pub fn dense_map(
    first: &MapShape,
    second: &MapShape,
    pairs: &[[usize; 2]],
    params: &DenseMapParameters,
) -> Result<Vec<u32>, DescriptorError> {
    params.validate()?;
    if pairs.is_empty() {
        return Err(DescriptorError::parameter("the number of matched regions", 0, "at least 1"));
    }
    let of = |side: usize| pairs.iter().map(|pair| pair[side]).collect::<Vec<_>>();
    let (mut to, mut from) = (anchors(first, &of(0), params)?, anchors(second, &of(1), params)?);
    if second.points.is_empty() {
        return Ok(Vec::new());
    }
    // Both in the same units: those of the first, where each kind of coordinate varies by its weight.
    for (columns, weight) in [(to.places(), params.places), (to.signatures(), params.signatures)] {
        let scale = to.points.factor(columns.clone(), first.weights, weight);
        to.points.scale(columns.clone(), scale);
        from.points.scale(columns, scale);
    }
    let (to, from) = (to.points, from.points);
    let samples = [first, second].map(|shape| spread(shape.weights, params.samples));
    let [to_samples, from_samples] = [(&to, &samples[0]), (&from, &samples[1])].map(|(p, s)| p.select(s));
    let mut maps = both_ways(to_samples.clone(), from_samples.clone());
    let available = first.basis.eigenvalues().len().min(second.basis.eigenvalues().len());
    let mut rounds: Vec<usize> = params.rounds.iter().map(|&count| count.min(available)).collect();
    rounds.sort_unstable();
    rounds.dedup();
    let mut last = None;
    for &count in &rounds {
        let [a, b] = [(first, &samples[0]), (second, &samples[1])]
            .map(|(shape, samples)| functions_at(shape, samples, count));
        let rotation = rotation::between(&b, &a, &maps, count);
        let a = to_f32(&a, count);
        let weights: Vec<f64> = samples[0].iter().map(|_| 1.0).collect();
        let scale = a.factor(0..count, &weights, 1.0);
        let b = to_f32(&rotation::apply(&b, &rotation, count), count);
        let [a, b] = [a, b].map(|mut points| {
            points.scale(0..count, scale);
            points
        });
        maps = both_ways(a.beside(&to_samples), b.beside(&from_samples));
        last = Some((count, rotation, scale));
    }
    let Some((count, rotation, scale)) = last else { return Ok(Neighbours::new(to).of(&from)) };
    let all = |shape: &MapShape| functions_at(shape, &(0..shape.points.len()).collect::<Vec<_>>(), count);
    let mut a = to_f32(&all(first), count);
    let mut b = to_f32(&rotation::apply(&all(second), &rotation, count), count);
    a.scale(0..count, scale);
    b.scale(0..count, scale);
    Ok(Neighbours::new(a.beside(&to)).of(&b.beside(&from)))
}

/// For each point of `from` the nearest of `to`, and for each of `to` the nearest of `from`.
fn both_ways(to: Points, from: Points) -> [Vec<u32>; 2] {
    let (to, from) = (Neighbours::new(to), Neighbours::new(from));
    [to.of(from.points()), from.of(to.points())]
}

fn to_f32(values: &[f64], width: usize) -> Points {
    Points::new(width, values.par_iter().map(|&x| x as f32).collect())
}

/// At most `count` points that are spread by weight: where the weights, summed up, pass equal steps.
fn spread(weights: &[f64], count: usize) -> Vec<usize> {
    let total: f64 = weights.iter().sum();
    if count >= weights.len() || total <= 0.0 {
        return (0..weights.len().min(count)).collect();
    }
    let (mut sum, mut steps) = (0.0, 0);
    let mut chosen = Vec::with_capacity(count);
    for (place, weight) in weights.iter().enumerate() {
        sum += weight;
        let passed = ((sum / total * count as f64) as usize).min(count);
        if passed > steps {
            chosen.push(place);
            steps = passed;
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_spread_by_weight() {
        assert_eq!(spread(&[1.0; 4], 9), [0, 1, 2, 3]);
        assert_eq!(spread(&[1.0; 6], 3), [1, 3, 5]);
        assert_eq!(spread(&[0.0, 0.0, 3.0, 1.0, 0.0], 2), [2, 3]);
        assert_eq!(spread(&[0.0; 3], 2), [0, 1]);
        assert!(spread(&[], 2).is_empty());
    }
}

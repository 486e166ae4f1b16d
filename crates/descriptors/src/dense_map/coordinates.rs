//! Coordinates of points that are the same on both shapes: where they are among the regions, and how heat leaves them.

use std::ops::Range;

use rayon::prelude::*;

use super::{DenseMapParameters, MapShape};
use crate::{DescriptorError, zero_modes};

/// The share of their mean square below which a variance is that of rounding to 32 bits.
const ROUNDING: f64 = 1e-12;

/// Points in a space of `width` dimensions, row by row.
#[derive(Clone, Debug)]
pub(super) struct Points {
    width: usize,
    values: Vec<f32>,
}

impl Points {
    pub fn new(width: usize, values: Vec<f32>) -> Self {
        Self { width, values }
    }

    pub fn len(&self) -> usize {
        self.values.len() / self.width
    }

    pub fn row(&self, point: usize) -> &[f32] {
        &self.values[point * self.width..][..self.width]
    }

    /// Some of the points.
    pub fn select(&self, places: &[usize]) -> Self {
        Self { values: places.iter().flat_map(|&p| self.row(p)).copied().collect(), ..*self }
    }

    /// The same points with the coordinates of others after their own.
    pub fn beside(&self, others: &Self) -> Self {
        let rows = (0..self.len()).flat_map(|p| [self.row(p), others.row(p)].concat());
        Self { width: self.width + others.width, values: rows.collect() }
    }

    /// The factor that makes the root of the mean square distance to the mean, in some of the coordinates, `weight`.
    /// 0 where they do not vary by more than rounding: then they say nothing.
    pub fn factor(&self, columns: Range<usize>, weights: &[f64], weight: f64) -> f32 {
        let total: f64 = weights.iter().sum();
        if total <= 0.0 {
            return 0.0;
        }
        let (mut variance, mut magnitude) = (0.0, 0.0);
        for column in columns {
            let values = self.values.iter().skip(column).step_by(self.width).map(|&x| f64::from(x));
            let (mut sum, mut squares) = (0.0, 0.0);
            for (x, w) in values.zip(weights) {
                sum += w * x;
                squares += w * x * x;
            }
            variance += (squares / total - (sum / total).powi(2)).max(0.0);
            magnitude += squares / total;
        }
        if variance > ROUNDING * magnitude { (weight / variance.sqrt()) as f32 } else { 0.0 }
    }

    pub fn scale(&mut self, columns: Range<usize>, factor: f32) {
        for row in self.values.chunks_exact_mut(self.width) {
            row[columns.clone()].iter_mut().for_each(|x| *x *= factor);
        }
    }
}

/// Coordinates by which the points of two shapes are compared.
pub(super) struct Anchors {
    pub points: Points,
    signatures: usize,
}

impl Anchors {
    /// The coordinates that say where a point is among the regions.
    pub fn places(&self) -> Range<usize> {
        0..self.points.width - self.signatures
    }

    /// The logarithms of the heat kernel signature.
    pub fn signatures(&self) -> Range<usize> {
        self.points.width - self.signatures..self.points.width
    }
}

/// For each point: at each time the cosines with these regions, then the logarithms of the heat kernel signature.
pub(super) fn anchors(
    shape: &MapShape,
    regions: &[usize],
    params: &DenseMapParameters,
) -> Result<Anchors, DescriptorError> {
    let MapShape { basis, points, weights, .. } = *shape;
    let (vertices, eigenpairs) = (basis.len(), basis.eigenvalues().len());
    if vertices == 0 || eigenpairs == 0 {
        return Err(DescriptorError::EmptyBasis { vertices, eigenpairs });
    }
    let zero = zero_modes(basis);
    if zero >= eigenpairs {
        return Err(DescriptorError::OnlyZeroModes { eigenpairs });
    }
    if weights.len() != points.len() {
        let (found, expected) = (weights.len(), points.len());
        return Err(DescriptorError::SizeMismatch { what: "weights of the points", found, expected });
    }
    let beyond = |index: &&u32| **index as usize >= vertices;
    if let Some((number, &index)) = points.iter().enumerate().find(|(_, index)| beyond(index)) {
        return Err(DescriptorError::IndexOutOfRange { element: "point", number, index, vertices });
    }
    let means = regions.iter().map(|&region| mean(shape, region)).collect::<Result<Vec<_>, _>>()?;
    let unit = basis.unit_time();
    let decay = |time: f64| basis.eigenvalues().iter().map(|l| (-l * time * unit).exp()).collect::<Vec<_>>();
    let flows: Vec<(Vec<f64>, Vec<Vec<f64>>)> = params
        .times
        .iter()
        .map(|time| {
            let mut weights = decay(0.5 * time);
            weights[..zero].fill(0.0);
            let of_regions = means.iter().map(|mean| direction(mean, &weights)).collect();
            (weights, of_regions)
        })
        .collect();
    let signatures: Vec<Vec<f64>> = params.signature_times.iter().map(|&time| decay(time)).collect();
    let measure = basis.measure();
    let of_point = |scratch: &mut Vec<f64>, &point: &u32| {
        let functions = basis.row(point as usize, 0..eigenpairs, scratch);
        let mut row = Vec::with_capacity(regions.len() * flows.len() + signatures.len());
        for (weights, of_regions) in &flows {
            let own = direction(functions, weights);
            row.extend(of_regions.iter().map(|region| product(&own, region) as f32));
        }
        for decay in &signatures {
            let heat: f64 = functions.iter().zip(decay).map(|(phi, d)| phi * phi * d).sum();
            row.push((heat * measure).max(f64::MIN_POSITIVE).ln() as f32);
        }
        row
    };
    let values: Vec<f32> = points.par_iter().map_init(Vec::new, of_point).flatten_iter().collect();
    let width = regions.len() * flows.len() + signatures.len();
    Ok(Anchors { points: Points::new(width, values), signatures: signatures.len() })
}

/// The first k eigenfunctions at some of the points, without a unit: their mean square over the shape is 1.
pub(super) fn functions_at(shape: &MapShape, places: &[usize], k: usize) -> Vec<f64> {
    let scale = shape.basis.measure().sqrt();
    let (mut values, mut scratch) = (Vec::with_capacity(places.len() * k), Vec::new());
    for &place in places {
        let functions = shape.basis.row(shape.points[place] as usize, 0..k, &mut scratch);
        values.extend(functions.iter().map(|x| x * scale));
    }
    values
}

/// The mean of each eigenfunction over a region.
fn mean(shape: &MapShape, region: usize) -> Result<Vec<f64>, DescriptorError> {
    let vertices = shape.basis.len();
    let Some(elements) = shape.regions.get(region) else {
        let (what, expected) = ("regions", region + 1);
        return Err(DescriptorError::SizeMismatch { what, found: shape.regions.len(), expected });
    };
    let mut sums = vec![0.0; shape.basis.eigenvalues().len()];
    let (mut total, mut scratch) = (0.0, Vec::new());
    for &index in elements {
        let Some(mass) = shape.basis.mass().get(index as usize) else {
            return Err(DescriptorError::IndexOutOfRange {
                element: "region",
                number: region,
                index,
                vertices,
            });
        };
        total += mass;
        let functions = shape.basis.row(index as usize, 0..sums.len(), &mut scratch);
        sums.iter_mut().zip(functions).for_each(|(sum, phi)| *sum += mass * phi);
    }
    if total <= 0.0 {
        return Err(DescriptorError::EmptyRegion { region });
    }
    sums.iter_mut().for_each(|sum| *sum /= total);
    Ok(sums)
}

/// A vector times weights, of length 1; the zero vector stays zero.
fn direction(vector: &[f64], weights: &[f64]) -> Vec<f64> {
    let mut own: Vec<f64> = vector.iter().zip(weights).map(|(x, w)| x * w).collect();
    let length = product(&own, &own).sqrt();
    if length > 0.0 {
        own.iter_mut().for_each(|x| *x /= length);
    }
    own
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_that_do_not_vary_count_nothing() {
        let points = Points::new(2, vec![0.1, 1.0, 0.1, 3.0, 0.1, 5.0]);
        assert_eq!(points.factor(0..1, &[1.0; 3], 1.0), 0.0);
        assert_eq!(points.factor(1..2, &[1.0, 0.0, 1.0], 6.0), 3.0);
        assert_eq!(points.factor(1..2, &[0.0; 3], 6.0), 0.0);
    }
}

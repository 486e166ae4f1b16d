//! What regions of one shape have to do with each other, and costs of matches that hold together.

use rayon::prelude::*;

use crate::DescriptorError;

/// For each two regions of a shape the cosine of the angle between the heat that flows out of them: 1 for the same place, 0 for
/// places far from each other, below 0 across the body.
///
/// Heat flows inside, so the cosines do not depend on the pose, nor on which eigenvectors stand for an eigenspace. What
/// a reflection of the body exchanges has equal ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RegionCosines {
    count: usize,
    values: Vec<f64>,
}

impl RegionCosines {
    /// Of `count` regions, row by row.
    ///
    /// # Errors
    /// [`DescriptorError::SizeMismatch`] unless there are `count` x `count` numbers, [`DescriptorError::NotFinite`].
    pub fn new(count: usize, values: Vec<f64>) -> Result<Self, DescriptorError> {
        let (found, expected) = (values.len(), count.saturating_mul(count));
        if found != expected {
            return Err(DescriptorError::SizeMismatch { what: "cosines of regions", found, expected });
        }
        match values.iter().position(|x| !x.is_finite()) {
            Some(at) => Err(DescriptorError::NotFinite { row: at / count }),
            None => Ok(Self { count, values }),
        }
    }

    /// The number of regions.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Those of one region with all regions.
    pub fn row(&self, region: usize) -> &[f64] {
        &self.values[region * self.count..][..self.count]
    }

    /// All of them, row by row.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

/// Rounds of the soft assignment. Over all sets of poses that were tried two do most of what ten do, and more do nothing.
const ROUNDS: usize = 10;

/// Adds to each distance what speaks against the pair in the other pairs.
///
/// `distances` holds a row for each query, a column for each reference. Every query is assigned to the references softly,
/// with weights `exp(-cost)`; a pair costs its distance, and `weight` times the mean over all other queries of the squared
/// difference of the cosines on both shapes, under those weights; and again with the costs that come out (graduated assignment
/// without its annealing; Gold and Rangarajan 1996). The unit of distance is the median distance to the nearest
/// reference.
pub(crate) fn consistent_costs(
    distances: &[f64],
    queries: &RegionCosines,
    references: &RegionCosines,
    weight: f64,
) -> Vec<f64> {
    let (rows, columns) = (queries.len(), references.len());
    if rows == 0 || columns == 0 {
        return Vec::new();
    }
    let mut nearest: Vec<f64> = distances.chunks_exact(columns).map(least).collect();
    nearest.sort_by(f64::total_cmp);
    let unit = nearest[rows / 2];
    if unit <= 0.0 {
        return distances.to_vec();
    }
    let mut costs = distances.to_vec();
    for _ in 0..ROUNDS {
        let assigned: Vec<f64> = costs.chunks_exact(columns).flat_map(|row| soft(row, unit)).collect();
        // The mean of (q - r)^2 over the queries, their partners being `assigned`, is in three terms.
        let share = |a: usize| (0..rows).map(|p| assigned[p * columns + a]).sum::<f64>() / rows as f64;
        let shares: Vec<f64> = (0..columns).map(share).collect();
        let squares =
            |row: &[f64], weights: &[f64]| row.iter().zip(weights).map(|(x, w)| x * x * w).sum::<f64>();
        let of_reference: Vec<f64> = (0..columns).map(|a| squares(references.row(a), &shares)).collect();
        let even = vec![1.0 / rows as f64; rows];
        let next = |query: usize| {
            let own = queries.row(query);
            let mut mean = vec![0.0; columns];
            for (cosine, assigned) in own.iter().zip(assigned.chunks_exact(columns)) {
                mean.iter_mut().zip(assigned).for_each(|(m, a)| *m += cosine * a / rows as f64);
            }
            let square = squares(own, &even);
            let cost = |a: usize| {
                let product: f64 = mean.iter().zip(references.row(a)).map(|(x, y)| x * y).sum();
                let misfit = (square - 2.0 * product + of_reference[a]).max(0.0);
                distances[query * columns + a] + weight * unit * misfit
            };
            (0..columns).map(cost).collect::<Vec<f64>>()
        };
        costs = (0..rows).into_par_iter().flat_map_iter(next).collect();
    }
    costs
}

/// Weights that sum to 1, and fall with the cost over the unit.
fn soft(costs: &[f64], unit: f64) -> Vec<f64> {
    let least = least(costs);
    let weights: Vec<f64> = costs.iter().map(|cost| (-(cost - least) / unit).exp()).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|w| w / sum).collect()
}

fn least(row: &[f64]) -> f64 {
    row.iter().copied().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cosines of places on a line.
    fn cosines(places: &[f64]) -> RegionCosines {
        let value = |a: f64| places.iter().map(move |b| (-(a - b).abs()).exp());
        RegionCosines::new(places.len(), places.iter().flat_map(|&a| value(a)).collect()).unwrap()
    }

    #[test]
    fn neighbours_carry_what_is_alike() {
        // Two hands with their arms; a hand alone does not tell which, and its distances say the wrong one.
        let both = cosines(&[0.0, 0.5, 3.0, 3.5]);
        let distances = [
            1.1, 9.0, 1.0, 9.0, //
            9.0, 0.5, 9.0, 2.0, //
            1.0, 9.0, 1.1, 9.0, //
            9.0, 2.0, 9.0, 0.5,
        ];
        let best = |costs: &[f64]| -> Vec<usize> {
            let row = |row: &[f64]| (0..4).min_by(|&a, &b| row[a].total_cmp(&row[b])).unwrap();
            costs.chunks_exact(4).map(row).collect()
        };
        assert_eq!(best(&distances), [2, 1, 0, 3]);
        assert_eq!(best(&consistent_costs(&distances, &both, &both, 30.0)), [0, 1, 2, 3]);
        assert_eq!(consistent_costs(&distances, &both, &both, 0.0), distances);
    }

    #[test]
    fn the_same_shape_keeps_its_distances() {
        let both = cosines(&[0.0, 1.0]);
        let distances = [0.0, 5.0, 5.0, 0.0];
        assert_eq!(consistent_costs(&distances, &both, &both, 30.0), distances);
        assert!(consistent_costs(&[], &RegionCosines::default(), &both, 30.0).is_empty());
    }

    #[test]
    fn misfit_is_the_mean_square_of_differences() {
        // One reference: the assignment is certain.
        let (queries, reference) = (cosines(&[0.0, 1.0]), cosines(&[0.0]));
        let costs = consistent_costs(&[2.0, 2.0], &queries, &reference, 1.0);
        let differ = 1.0 - (-1f64).exp();
        let expected = 2.0 + 2.0 * differ * differ / 2.0;
        assert!(costs.iter().all(|c| (c - expected).abs() < 1e-12), "{costs:?} {expected}");
    }
}

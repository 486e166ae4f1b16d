//! Vocabularies of typical descriptors: bags of features (section 5; Bronstein et al. 2011).
use crate::{DescriptorError, Descriptors, descriptor_table::squared_distance, kmeans};
use rayon::prelude::*;

/// Parameters of [`Vocabulary::train`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct VocabularyParameters {
    /// Number of words. Default 10; 6 to 12 serve for regions.
    pub words: usize,
    /// Softness of the assignment, in units of the descriptors. Default `None`: the median distance of a
    /// training descriptor to the nearest other one.
    pub sigma: Option<f64>,
    /// Most iterations of k-means. Default 100; it ends sooner when no descriptor changes its word.
    pub iterations: usize,
    /// Seed of the first words. Default 1.
    pub seed: u64,
}

impl Default for VocabularyParameters {
    fn default() -> Self {
        Self { words: 10, sigma: None, iterations: 100, seed: 1 }
    }
}

impl VocabularyParameters {
    /// Whether all values are in range.
    ///
    /// # Errors
    /// [`DescriptorError::InvalidParameter`].
    pub fn validate(&self) -> Result<(), DescriptorError> {
        if self.words == 0 {
            return Err(DescriptorError::parameter("words", 0, "at least 1"));
        }
        self.sigma.map_or(Ok(()), check_sigma)
    }
}

fn check_sigma(sigma: f64) -> Result<(), DescriptorError> {
    if sigma.is_finite() && sigma >= 0.0 {
        return Ok(());
    }
    Err(DescriptorError::parameter("sigma", sigma, "at least 0 and finite"))
}

/// Typical descriptors, the words of "bags of features" (Bronstein et al. 2011, "Shape Google").
///
/// A descriptor d becomes the shares of the words w in it,
/// `exp(-|d - w|^2 / (2 sigma^2))`, scaled to the sum 1. The mean of these over a region
/// ([`region_descriptors`](crate::region_descriptors)) is the region's bag of features.
///
/// ```
/// use mser3d_descriptors::{Descriptors, Vocabulary, VocabularyParameters};
///
/// let training = Descriptors::new(1, vec![0.0, 0.1, 0.2, 7.0, 7.1, 7.2])?;
/// let params = VocabularyParameters { words: 2, ..Default::default() };
/// let vocabulary = Vocabulary::train(&training, &params)?;
/// let bag = vocabulary.encode(&Descriptors::new(1, vec![6.9])?)?;
/// assert!(bag.row(0).contains(&1.0));
/// # Ok::<(), mser3d_descriptors::DescriptorError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Vocabulary {
    words: Descriptors,
    sigma: f64,
}

impl Vocabulary {
    /// A vocabulary of given words. With a sigma of zero each descriptor is its nearest word alone.
    ///
    /// # Errors
    /// [`DescriptorError::InvalidParameter`] for a sigma that is negative or not finite,
    /// [`DescriptorError::TooFewDescriptors`] without words.
    pub fn new(words: Descriptors, sigma: f64) -> Result<Self, DescriptorError> {
        check_sigma(sigma)?;
        if words.is_empty() {
            return Err(DescriptorError::TooFewDescriptors { needed: 1, found: 0 });
        }
        Ok(Self { words, sigma })
    }

    /// The words of training descriptors: their k-means clusters, seeded by k-means++.
    ///
    /// Cost: `descriptors x words` distances for each iteration, and a nearest neighbour for each descriptor.
    ///
    /// # Errors
    /// [`DescriptorError::InvalidParameter`]; [`DescriptorError::TooFewDescriptors`] when there are fewer different
    /// descriptors than words, or fewer than two to measure sigma by.
    pub fn train(training: &Descriptors, params: &VocabularyParameters) -> Result<Self, DescriptorError> {
        params.validate()?;
        let needed = params.words.max(if params.sigma.is_none() { 2 } else { 1 });
        if training.len() < needed {
            return Err(DescriptorError::TooFewDescriptors { needed, found: training.len() });
        }
        let words = kmeans::cluster(training, params.words, params.iterations, params.seed)?;
        let sigma = params.sigma.unwrap_or_else(|| median(nearest_distances(training)));
        Self::new(words, sigma)
    }

    /// The words.
    pub fn words(&self) -> &Descriptors {
        &self.words
    }

    /// Softness of the assignment, in units of the descriptors.
    pub fn sigma(&self) -> f64 {
        self.sigma
    }

    /// The shares of the words in each descriptor: a row of as many values as there are words, of sum 1.
    ///
    /// # Errors
    /// [`DescriptorError::SizeMismatch`] when descriptors and words differ in length.
    pub fn encode(&self, descriptors: &Descriptors) -> Result<Descriptors, DescriptorError> {
        self.words.check_width(descriptors)?;
        let mut shares = vec![0.0; descriptors.len() * self.words.len()];
        let rows = descriptors.values().par_chunks_exact(descriptors.width());
        shares.par_chunks_exact_mut(self.words.len()).zip(rows).with_min_len(256).for_each(
            |(shares, descriptor)| {
                for (share, word) in shares.iter_mut().zip(self.words.rows()) {
                    *share = squared_distance(descriptor, word);
                }
                // Against the nearest word, so that far from all of them the shares don't underflow.
                let least = shares.iter().copied().fold(f64::INFINITY, f64::min);
                for share in &mut *shares {
                    let excess = *share - least;
                    *share = if excess > 0.0 { (-0.5 * excess / self.sigma / self.sigma).exp() } else { 1.0 };
                }
                let total: f64 = shares.iter().sum();
                shares.iter_mut().for_each(|share| *share /= total);
            },
        );
        Descriptors::new(self.words.len(), shares)
    }
}

/// The distance of each row to the nearest other row, for at least two rows.
///
/// Rows are sorted along the coordinate of greatest extent; from each, both ways, until the next row is
/// farther in that coordinate alone than the nearest so far.
fn nearest_distances(rows: &Descriptors) -> Vec<f64> {
    let extent = |c: usize| {
        let values = rows.rows().map(|row| row[c]);
        values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
    };
    let widest = (0..rows.width()).rev().max_by(|&a, &b| extent(a).total_cmp(&extent(b))).unwrap_or_default();
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by(|&a, &b| rows.row(a)[widest].total_cmp(&rows.row(b)[widest]));
    let nearest = |place: usize| {
        let row = rows.row(order[place]);
        let mut best = f64::INFINITY;
        let mut visit = |other: usize| {
            let other = rows.row(order[other]);
            let gap = row[widest] - other[widest];
            let near = gap * gap < best;
            if near {
                best = best.min(squared_distance(row, other));
            }
            near
        };
        let _ = (place + 1..order.len()).all(&mut visit);
        let _ = (0..place).rev().all(&mut visit);
        best.sqrt()
    };
    (0..order.len()).into_par_iter().map(nearest).collect()
}

/// The upper median.
fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a quasi-random sequence around the corners of a triangle.
    fn clusters(per_cluster: usize) -> Descriptors {
        let noise = |i: usize, step: f64| (i as f64 * step).fract() - 0.5;
        let corners = [[0.0, 0.0], [10.0, 0.0], [0.0, 20.0]];
        let points = (0..3 * per_cluster).flat_map(|i| {
            let [x, y] = corners[i % 3];
            [x + noise(i, 0.618_034), y + noise(i, 0.414_214)]
        });
        Descriptors::new(2, points.collect()).unwrap()
    }

    #[test]
    fn words_are_the_means_of_separate_clusters() {
        let points = clusters(40);
        for seed in 0..20 {
            let params = VocabularyParameters { words: 3, seed, ..Default::default() };
            let vocabulary = Vocabulary::train(&points, &params).unwrap();
            let mut words: Vec<&[f64]> = vocabulary.words().rows().collect();
            words.sort_by(|a, b| (a[0] + a[1]).total_cmp(&(b[0] + b[1])));
            for (cluster, word) in words.iter().enumerate() {
                for c in 0..2 {
                    let mean = (0..40).map(|i| points.row(3 * i + cluster)[c]).sum::<f64>() / 40.0;
                    assert!((word[c] - mean).abs() < 1e-12);
                }
            }
            assert_eq!(vocabulary, Vocabulary::train(&points, &params).unwrap());
        }
    }

    #[test]
    fn sigma_is_the_median_of_the_nearest_distances() {
        let points = clusters(50);
        let mut naive: Vec<f64> = (0..points.len())
            .map(|i| {
                let others = (0..points.len()).filter(|&j| j != i);
                let squares = others.map(|j| squared_distance(points.row(i), points.row(j)));
                squares.fold(f64::INFINITY, f64::min).sqrt()
            })
            .collect();
        naive.sort_by(f64::total_cmp);
        let mut found = nearest_distances(&points);
        found.sort_by(f64::total_cmp);
        assert_eq!(found, naive);
        let params = VocabularyParameters { words: 3, ..Default::default() };
        assert_eq!(Vocabulary::train(&points, &params).unwrap().sigma(), naive[75]);
    }

    #[test]
    fn shares_follow_the_formula_sum_to_one_and_never_underflow() {
        let words = Descriptors::new(1, vec![0.0, 1.0, 3.0]).unwrap();
        let soft = Vocabulary::new(words.clone(), 0.5).unwrap();
        let bags = soft.encode(&Descriptors::new(1, vec![0.25, 1e6, -40.0]).unwrap()).unwrap();
        let weight = |w: f64| (-(0.25 - w) * (0.25 - w) / 0.5).exp();
        let total = weight(0.0) + weight(1.0) + weight(3.0);
        for (share, word) in bags.row(0).iter().zip([0.0, 1.0, 3.0]) {
            assert!((share - weight(word) / total).abs() < 1e-15);
        }
        assert_eq!(bags.row(1), [0.0, 0.0, 1.0]);
        assert!((bags.row(2).iter().sum::<f64>() - 1.0).abs() < 1e-15);

        let hard = Vocabulary::new(words, 0.0).unwrap();
        let bags = hard.encode(&Descriptors::new(1, vec![0.4, 2.0]).unwrap()).unwrap();
        assert_eq!(bags.row(0), [1.0, 0.0, 0.0]);
        assert_eq!(bags.row(1), [0.0, 0.5, 0.5]);
    }

    #[test]
    fn wrong_input_is_named() {
        let same = Descriptors::new(1, vec![2.0; 20]).unwrap();
        let error = Vocabulary::train(&same, &VocabularyParameters::default()).unwrap_err();
        assert_eq!(error, DescriptorError::TooFewDescriptors { needed: 10, found: 1 });
        let one = Descriptors::new(1, vec![2.0]).unwrap();
        let error =
            Vocabulary::train(&one, &VocabularyParameters { words: 1, ..Default::default() }).unwrap_err();
        assert_eq!(error, DescriptorError::TooFewDescriptors { needed: 2, found: 1 });
        assert!(VocabularyParameters { words: 0, ..Default::default() }.validate().is_err());
        assert!(Vocabulary::new(one.clone(), f64::NAN).is_err());
        let wide = Descriptors::new(2, vec![0.0, 1.0]).unwrap();
        assert!(Vocabulary::new(one, 1.0).unwrap().encode(&wide).is_err());
    }
}

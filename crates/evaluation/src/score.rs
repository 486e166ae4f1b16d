use crate::{Correspondence, DetectedRegions, EvaluationError, NullShape, Overlaps};

/// The share of values above a threshold; 0 when there are none, because a shape on which nothing
/// is found counts as a failure, not as missing.
///
/// Of [`Overlaps::best`](crate::Overlaps::best) this is the **repeatability**: the share of the
/// transformed shape's regions whose best overlap with a null region exceeds the threshold. Of
/// [`Overlaps::matched`](crate::Overlaps::matched) it is the **matching score**.
pub fn share_above(values: &[f64], threshold: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    values.iter().filter(|v| **v > threshold).count() as f64 / values.len() as f64
}

/// What a detector and a descriptor reached on one transformed shape: the overlaps from which the measures of Litman,
/// Bronstein & Bronstein (2012), section 6, are taken at any threshold.
///
/// ```
/// use mser3d_evaluation::Score;
/// let score = Score {
///     best: vec![0.9, 0.75, 0.2],
///     best_on_common_part: vec![0.9, 0.8, 0.2],
///     matched: vec![0.9, 0.0, 0.1],
/// };
/// assert_eq!(score.repeatability(0.7), 2.0 / 3.0);
/// assert_eq!(score.correspondences(0.7), 2);
/// assert_eq!(score.matching_score(0.7), 1.0 / 3.0);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Score {
    /// Each region's best overlap with a null region: [`Overlaps::best`].
    pub best: Vec<f64>,
    /// The same, judged by what is left of the null shape: [`Overlaps::on_common_part`].
    pub best_on_common_part: Vec<f64>,
    /// Each region's overlap with the null region of the nearest descriptor: [`Overlaps::matched`].
    pub matched: Vec<f64>,
}

impl Score {
    /// Scores what was found on a transformed shape against what was found on the null shape.
    /// Without descriptors nothing is matched.
    ///
    /// # Errors
    /// As [`Overlaps::new`] and [`Overlaps::matched`].
    pub fn new(
        null: &NullShape,
        on_null: &DetectedRegions,
        on_transformed: &DetectedRegions,
        correspondence: &Correspondence,
    ) -> Result<Self, EvaluationError> {
        let regions = (&on_null.regions, &on_transformed.regions);
        let overlaps = Overlaps::new(null, regions.0, regions.1, correspondence)?;
        let common = Overlaps::on_common_part(null, regions.0, regions.1, correspondence)?;
        let described = !on_null.descriptors.is_empty() && !on_transformed.descriptors.is_empty();
        let matched = if described {
            overlaps.matched(&on_null.descriptors, &on_transformed.descriptors)?
        } else {
            Vec::new()
        };
        Ok(Self { best: overlaps.best(), best_on_common_part: common.best(), matched })
    }

    /// The score of the first regions alone, as many as given, still against all regions of the null shape. A
    /// detector that finds few large regions has an easier task than one that also finds many small ones; this
    /// compares them where both list the largest first.
    pub fn of_first(&self, regions: usize) -> Self {
        let first = |values: &[f64]| values.iter().copied().take(regions).collect();
        Self {
            best: first(&self.best),
            best_on_common_part: first(&self.best_on_common_part),
            matched: first(&self.matched),
        }
    }

    /// Number of regions.
    pub fn regions(&self) -> usize {
        self.best.len()
    }

    /// Repeatability: the share of regions whose best overlap exceeds the threshold.
    pub fn repeatability(&self, threshold: f64) -> f64 {
        share_above(&self.best, threshold)
    }

    /// Repeatability, judged by what is left of the null shape.
    pub fn repeatability_on_common_part(&self, threshold: f64) -> f64 {
        share_above(&self.best_on_common_part, threshold)
    }

    /// Number of correspondences: regions whose best overlap exceeds the threshold.
    pub fn correspondences(&self, threshold: f64) -> usize {
        self.best.iter().filter(|v| **v > threshold).count()
    }

    /// Matching score: the share of regions whose overlap with the null region of the nearest descriptor exceeds the
    /// threshold.
    pub fn matching_score(&self, threshold: f64) -> f64 {
        share_above(&self.matched, threshold)
    }
}

use crate::{Detection, NullShape, Overlaps, ShapeName, ShrecError, Transfer};

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

/// What a detector and a descriptor reached on one transformed shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// The transformed shape.
    pub shape: ShapeName,
    /// Each region's best overlap: [`Overlaps::best`](crate::Overlaps::best).
    pub best: Vec<f64>,
    /// The same on the common part: [`Overlaps::on_common_part`](crate::Overlaps::on_common_part).
    pub best_common: Vec<f64>,
    /// Each region's overlap with its match: [`Overlaps::matched`](crate::Overlaps::matched).
    pub matched: Vec<f64>,
}

impl Score {
    /// Scores what was found on a transformed shape against what was found on the null shape.
    /// Without descriptors nothing is matched.
    ///
    /// # Errors
    /// As [`Overlaps::new`] and [`Overlaps::matched`].
    pub fn new(
        name: &ShapeName,
        null: &NullShape,
        on_null: &Detection,
        on_transformed: &Detection,
        transfer: &Transfer,
    ) -> Result<Self, ShrecError> {
        let overlaps = Overlaps::new(null, &on_null.regions, &on_transformed.regions, transfer)?;
        let common = Overlaps::on_common_part(null, &on_null.regions, &on_transformed.regions, transfer)?;
        let described = !on_null.descriptors.is_empty() && !on_transformed.descriptors.is_empty();
        let matched = if described {
            overlaps.matched(&on_null.descriptors, &on_transformed.descriptors)?
        } else {
            Vec::new()
        };
        Ok(Self { shape: name.clone(), best: overlaps.best(), best_common: common.best(), matched })
    }

    /// The score of the first regions alone, as many as given, still against all regions of the null shape. A
    /// detector that finds few large regions has an easier task than one that finds many small ones
    /// too; this compares them where both list the largest first.
    pub fn of_first(&self, regions: usize) -> Self {
        let first = |values: &[f64]| values.iter().copied().take(regions).collect();
        let (best, best_common, matched) =
            (first(&self.best), first(&self.best_common), first(&self.matched));
        Self { shape: self.shape.clone(), best, best_common, matched }
    }

    /// Number of regions.
    pub fn regions(&self) -> usize {
        self.best.len()
    }

    /// Share of regions that were found again.
    pub fn repeatability(&self, threshold: f64) -> f64 {
        share_above(&self.best, threshold)
    }

    /// Share of regions that were found again, judged by what is left of the null shape.
    pub fn repeatability_on_common_part(&self, threshold: f64) -> f64 {
        share_above(&self.best_common, threshold)
    }

    /// Number of regions that were found again.
    pub fn correspondences(&self, threshold: f64) -> usize {
        self.best.iter().filter(|v| **v > threshold).count()
    }

    /// Share of regions that were recognized by their descriptors.
    pub fn matching(&self, threshold: f64) -> f64 {
        share_above(&self.matched, threshold)
    }
}

/// The mean of a measure over those shapes that are wanted; `None` when there are none. Each shape
/// counts the same, however many regions it has.
///
/// ```
/// # use mser3d_shrec11::{mean_score, Score, ShapeName};
/// let score = |strength, best: Vec<f64>| {
///     let shape = ShapeName { null: 1, class: "noise".into(), strength };
///     Score { shape, best_common: best.clone(), best, matched: vec![] }
/// };
/// let scores = [score(1, vec![0.9, 0.9]), score(4, vec![])];
/// assert_eq!(mean_score(&scores, |s| s.strength <= 3, |s| s.repeatability(0.8)), Some(1.0));
/// assert_eq!(mean_score(&scores, |s| s.class == "noise", |s| s.repeatability(0.8)), Some(0.5));
/// assert_eq!(mean_score(&scores, |s| s.class == "holes", |s| s.repeatability(0.8)), None);
/// ```
pub fn mean_score(
    scores: &[Score],
    wanted: impl Fn(&ShapeName) -> bool,
    measure: impl Fn(&Score) -> f64,
) -> Option<f64> {
    let values = scores.iter().filter(|s| wanted(&s.shape)).map(measure);
    let (sum, count) = values.fold((0.0, 0), |(sum, n), value| (sum + value, n + 1));
    (count > 0).then(|| sum / f64::from(count))
}

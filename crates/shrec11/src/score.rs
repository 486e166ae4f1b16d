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
    /// The class of the transform, such as `"noise"`.
    pub class: String,
    /// Its strength, 1 to 5.
    pub strength: u32,
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
        Ok(Self {
            class: name.class.clone(),
            strength: name.strength,
            best: overlaps.best(),
            best_common: common.best(),
            matched,
        })
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

/// The mean of a measure over the shapes of a class (`None`: all) up to a strength; `None` without
/// such shapes. Each shape counts the same, however many regions it has.
///
/// ```
/// # use mser3d_shrec11::{mean_score, Score};
/// let score = |strength, best: Vec<f64>| {
///     Score { class: "noise".into(), strength, best_common: best.clone(), best, matched: vec![] }
/// };
/// let scores = [score(1, vec![0.9, 0.9]), score(4, vec![])];
/// assert_eq!(mean_score(&scores, Some("noise"), 3, |s| s.repeatability(0.8)), Some(1.0));
/// assert_eq!(mean_score(&scores, Some("noise"), 5, |s| s.repeatability(0.8)), Some(0.5));
/// assert_eq!(mean_score(&scores, Some("holes"), 5, |s| s.repeatability(0.8)), None);
/// ```
pub fn mean_score(
    scores: &[Score],
    class: Option<&str>,
    up_to_strength: u32,
    measure: impl Fn(&Score) -> f64,
) -> Option<f64> {
    let wanted = |s: &&Score| s.strength <= up_to_strength && class.is_none_or(|c| c == s.class);
    let (sum, count) = scores.iter().filter(wanted).fold((0.0, 0), |(sum, n), s| (sum + measure(s), n + 1));
    (count > 0).then(|| sum / f64::from(count))
}

use super::ShapeName;
use crate::Score;

/// The score on one transformed shape of a benchmark.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeScore {
    /// The transformed shape.
    pub shape: ShapeName,
    /// What was reached on it.
    pub score: Score,
}

/// The mean of a measure over those shapes that are wanted; `None` when there are none. Each shape
/// counts the same, however many regions it has.
///
/// ```
/// # use mser3d_evaluation::Score;
/// # use mser3d_evaluation::shrec::{ShapeName, ShapeScore, mean_score};
/// let score = |strength, best: Vec<f64>| ShapeScore {
///     shape: ShapeName { null: 1, class: "noise".into(), strength },
///     score: Score { best, ..Default::default() },
/// };
/// let scores = [score(1, vec![0.9, 0.9]), score(4, vec![])];
/// assert_eq!(mean_score(&scores, |s| s.strength <= 3, |s| s.repeatability(0.8)), Some(1.0));
/// assert_eq!(mean_score(&scores, |s| s.class == "noise", |s| s.repeatability(0.8)), Some(0.5));
/// assert_eq!(mean_score(&scores, |s| s.class == "holes", |s| s.repeatability(0.8)), None);
/// ```
pub fn mean_score(
    scores: &[ShapeScore],
    wanted: impl Fn(&ShapeName) -> bool,
    measure: impl Fn(&Score) -> f64,
) -> Option<f64> {
    let values = scores.iter().filter(|s| wanted(&s.shape)).map(|s| measure(&s.score));
    let (sum, count) = values.fold((0.0, 0), |(sum, n), value| (sum + value, n + 1));
    (count > 0).then(|| sum / f64::from(count))
}

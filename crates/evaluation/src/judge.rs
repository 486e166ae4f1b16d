use mser3d_shape::InvalidParameter;

use crate::{EvaluationError, Overlaps};

mser3d_shape::choice! {
    /// Whether a match is right.
    pub enum Verdict("verdict on a match") {
        /// The partner is the same part of the body
        Right = "right",
        /// It is the mirror image of that part: left and right are confused
        OtherSide = "other-side",
        /// It is another part
        #[default]
        Wrong = "wrong",
    }
}

/// The truth about one match.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct MatchTruth {
    /// Overlap with the partner by the ground-truth correspondence.
    pub overlap: f64,
    /// Overlap of the mirror image with the partner, where the symmetry is known.
    pub mirrored_overlap: Option<f64>,
    /// What follows from these.
    pub verdict: Verdict,
}

/// How many matches are right.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct PrecisionRecall {
    /// A match is right from this overlap on.
    pub threshold: f64,
    /// Right matches.
    pub right: usize,
    /// Matches with the mirror image.
    pub other_side: usize,
    /// Wrong matches.
    pub wrong: usize,
    /// Share of the matches that are right, up to left and right.
    pub precision: f64,
    /// The same share of all regions of the transformed shape, those without a partner included.
    pub recall: f64,
}

/// Matches, judged.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Judged {
    /// The truth about each match, in the order given.
    pub truths: Vec<MatchTruth>,
    /// How many are right.
    pub precision_recall: PrecisionRecall,
}

/// Says which matches are right. Each match is a region of the transformed shape and its partner on the null shape,
/// both numbered from 0.
///
/// `direct` are the overlaps by the direct map ([`Overlaps::direct`]), `mirrored` those by the mirrored map
/// ([`Overlaps::mirrored`]), where a symmetry is known. A match is [`Verdict::Right`] when its direct overlap reaches
/// the threshold, [`Verdict::OtherSide`] when only the mirrored one does.
///
/// # Errors
/// [`EvaluationError::InvalidParameter`] for a threshold outside (0, 1], [`EvaluationError::OutOfRange`] for a match
/// of a region that is not there, [`EvaluationError::SizeMismatch`] when the mirrored overlaps are of other regions.
///
/// ```
/// use mser3d_evaluation::shape::{IndexSet, TriangleMesh};
/// use mser3d_evaluation::{Correspondence, NullShape, Overlaps, Verdict, judge};
///
/// // Four corners, of which 0 and 1 mirror each other.
/// let corners = vec![[-1., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
/// let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])?;
/// let null = NullShape::new(mesh).with_symmetry(vec![1, 0, 2, 3])?;
/// let regions = [IndexSet::from_members(4, [0])?, IndexSet::from_members(4, [1])?];
///
/// let same_vertices = Correspondence::identity(4);
/// let direct = Overlaps::direct(&null, &regions, &regions, &same_vertices)?;
/// let mirrored = Overlaps::mirrored(&null, &regions, &regions, &same_vertices)?;
/// // Both regions of the transformed shape are matched with region 0.
/// let judged = judge(&[(0, 0), (1, 0)], &direct, mirrored.as_ref(), 0.8)?;
/// assert_eq!(judged.truths[0].verdict, Verdict::Right);
/// assert_eq!(judged.truths[1].verdict, Verdict::OtherSide);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn judge(
    matches: &[(usize, usize)],
    direct: &Overlaps,
    mirrored: Option<&Overlaps>,
    threshold: f64,
) -> Result<Judged, EvaluationError> {
    InvalidParameter::unless(
        threshold > 0.0 && threshold <= 1.0,
        "threshold",
        threshold,
        "above 0 and at most 1",
    )?;
    check(matches, direct, mirrored)?;
    let (mut right, mut other_side, mut wrong) = (0, 0, 0);
    let mut truths = Vec::with_capacity(matches.len());
    for &(region, partner) in matches {
        let overlap = direct.get(region, partner);
        let mirrored_overlap = mirrored.map(|overlaps| overlaps.get(region, partner));
        let (count, verdict) = if overlap >= threshold {
            (&mut right, Verdict::Right)
        } else if mirrored_overlap.is_some_and(|o| o >= threshold) {
            (&mut other_side, Verdict::OtherSide)
        } else {
            (&mut wrong, Verdict::Wrong)
        };
        *count += 1;
        truths.push(MatchTruth { overlap, mirrored_overlap, verdict });
    }
    let good = (right + other_side) as f64;
    let precision = good / matches.len().max(1) as f64;
    let recall = good / direct.transformed_regions().max(1) as f64;
    let precision_recall = PrecisionRecall { threshold, right, other_side, wrong, precision, recall };
    Ok(Judged { truths, precision_recall })
}

fn check(
    matches: &[(usize, usize)],
    direct: &Overlaps,
    mirrored: Option<&Overlaps>,
) -> Result<(), EvaluationError> {
    let [transformed, null] = [direct.transformed_regions(), direct.null_regions()];
    if let Some(mirrored) = mirrored {
        for (found, expected) in
            [(mirrored.transformed_regions(), transformed), (mirrored.null_regions(), null)]
        {
            if found != expected {
                return Err(EvaluationError::SizeMismatch { what: "mirrored regions", found, expected });
            }
        }
    }
    for (number, &(region, partner)) in matches.iter().enumerate() {
        for (index, count) in [(region, transformed), (partner, null)] {
            if index >= count {
                let index = index as u64;
                return Err(EvaluationError::OutOfRange { what: "match", number, index, count });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Correspondence, NullShape};
    use mser3d_shape::{IndexSet, TriangleMesh};

    #[test]
    fn matches_are_counted_and_bad_ones_refused() {
        let corners = vec![[-1., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
        let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]).unwrap();
        let null = NullShape::new(mesh).with_symmetry(vec![1, 0, 2, 3]).unwrap();
        let regions: Vec<IndexSet> = [0, 1, 2].map(|v| IndexSet::from_members(4, [v]).unwrap()).into();
        let identity = Correspondence::identity(4);
        let direct = Overlaps::direct(&null, &regions, &regions, &identity).unwrap();
        let mirrored = Overlaps::mirrored(&null, &regions, &regions, &identity).unwrap();
        let matches = [(0, 0), (1, 0)];
        let judged = judge(&[(0, 0), (1, 0), (2, 0)], &direct, mirrored.as_ref(), 0.8).unwrap();
        let counts = judged.precision_recall;
        assert_eq!((counts.right, counts.other_side, counts.wrong), (1, 1, 1));
        assert_eq!((counts.precision, counts.recall), (2.0 / 3.0, 2.0 / 3.0));
        // Two regions have no partner; without a symmetry the other side is simply wrong.
        let judged = judge(&matches[1..], &direct, None, 0.8).unwrap();
        assert_eq!(judged.truths[0].verdict, Verdict::Wrong);
        assert_eq!(judged.truths[0].mirrored_overlap, None);
        assert_eq!(judge(&matches[..1], &direct, None, 0.8).unwrap().precision_recall.recall, 1.0 / 3.0);
        assert_eq!(judge(&[], &direct, None, 0.8).unwrap().precision_recall.precision, 0.0);

        for threshold in [0.0, 1.1, f64::NAN] {
            assert!(judge(&matches, &direct, None, threshold).is_err());
        }
        assert!(judge(&[(3, 0)], &direct, None, 0.8).is_err());
        assert!(judge(&[(0, 3)], &direct, None, 0.8).is_err());
        let fewer = Overlaps::direct(&null, &regions[..2], &regions, &identity).unwrap();
        assert!(judge(&matches, &direct, Some(&fewer), 0.8).is_err());
    }
}

//! Matches of descriptors (section 6): nearest, mutual, one-to-one.
use crate::{DescriptorError, Descriptors, assign, descriptor_table::squared_distance};
use rayon::prelude::*;

mser3d_shape::choice! {
    /// How partners are chosen.
    pub enum MatchRule("matching rule") {
        /// Each query gets its nearest reference; several may share one
        ///
        /// The paper's rule.
        #[default]
        Nearest = "nearest",
        /// As nearest, but only where the query is also the nearest of its partner
        Mutual = "mutual",
        /// The one-to-one assignment with the least sum of distances
        ///
        /// By [`assign`].
        OneToOne = "one-to-one",
    }
}

/// Parameters of [`match_descriptors`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MatchParameters {
    /// How partners are chosen. Default: nearest.
    pub rule: MatchRule,
    /// Ratio test (Lowe 2004): drop matches whose distance is at least this times that to the nearest
    /// other reference, in (0, 1]. Default `None`: off. A symmetric shape has two good candidates for many
    /// regions, which this drops.
    pub max_ratio: Option<f64>,
    /// Drop matches of a greater distance, in units of the descriptors. Default `None`: off.
    pub max_distance: Option<f64>,
    /// A match is ambiguous when its distance is at least this times that to the nearest other reference,
    /// in (0, 1]. Default 0.8.
    pub ambiguity: f64,
}

impl Default for MatchParameters {
    fn default() -> Self {
        Self { rule: MatchRule::default(), max_ratio: None, max_distance: None, ambiguity: 0.8 }
    }
}

impl MatchParameters {
    /// Whether all values are in range.
    ///
    /// # Errors
    /// [`DescriptorError::InvalidParameter`].
    pub fn validate(&self) -> Result<(), DescriptorError> {
        for (name, ratio) in [("max_ratio", self.max_ratio), ("ambiguity", Some(self.ambiguity))] {
            if let Some(ratio) = ratio
                && !(ratio > 0.0 && ratio <= 1.0)
            {
                return Err(DescriptorError::parameter(name, ratio, "more than 0 and at most 1"));
            }
        }
        match self.max_distance {
            Some(d) if d.is_nan() || d < 0.0 => {
                Err(DescriptorError::parameter("max_distance", d, "at least 0"))
            }
            _ => Ok(()),
        }
    }
}

/// A reference descriptor and how far it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Its row among the references.
    pub reference: usize,
    /// Euclidean distance to the query.
    pub distance: f64,
}

/// A query with its partner.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DescriptorMatch {
    /// Row among the queries.
    pub query: usize,
    /// The partner.
    pub partner: Candidate,
    /// The nearest reference other than the partner; `None` if there is only one reference.
    pub rival: Option<Candidate>,
    /// Whether the rival is about as near ([`MatchParameters::ambiguity`]), as left and right are: intrinsic
    /// descriptors cannot tell symmetric parts apart.
    pub ambiguous: bool,
}

/// Matches the descriptors of one shape's regions to those of another by Euclidean distance, in the order
/// of the queries. Of equally near references the first counts.
///
/// ```
/// use mser3d_descriptors::{Descriptors, MatchParameters, match_descriptors};
///
/// let arms_and_head = Descriptors::new(1, vec![1.0, 1.1, 5.0])?;
/// let head_and_arm = Descriptors::new(1, vec![5.2, 1.04])?;
/// let matches = match_descriptors(&head_and_arm, &arms_and_head, &MatchParameters::default())?;
/// assert_eq!(matches[0].partner.reference, 2);
/// assert_eq!(matches[1].partner.reference, 0);
/// assert!(!matches[0].ambiguous);
/// let arm = matches[1].rival.map(|other| other.reference);
/// assert_eq!(arm, Some(1));
/// # Ok::<(), mser3d_descriptors::DescriptorError>(())
/// ```
///
/// Cost: one distance for each pair; the one-to-one rule also keeps them all, 8 bytes each.
///
/// # Errors
/// [`DescriptorError::InvalidParameter`], [`DescriptorError::SizeMismatch`] for descriptors of different length.
pub fn match_descriptors(
    queries: &Descriptors,
    references: &Descriptors,
    params: &MatchParameters,
) -> Result<Vec<DescriptorMatch>, DescriptorError> {
    params.validate()?;
    references.check_width(queries)?;
    let pairs: Vec<(usize, usize)> = match params.rule {
        MatchRule::Nearest => nearest(queries, references).into_iter().enumerate().collect(),
        MatchRule::Mutual => {
            let back = nearest(references, queries);
            let forth = nearest(queries, references).into_iter().enumerate();
            forth.filter(|&(query, reference)| back[reference] == query).collect()
        }
        MatchRule::OneToOne => {
            let distance = |q| references.rows().map(move |r| squared_distance(q, r).sqrt());
            let costs: Vec<f64> = queries.rows().flat_map(distance).collect();
            let partners = assign(&costs, queries.len(), references.len())?;
            partners.into_iter().enumerate().filter_map(|(query, r)| Some((query, r?))).collect()
        }
    };
    let matches = pairs.into_par_iter().map(|(query, reference)| {
        let candidate = |reference| Candidate {
            reference,
            distance: squared_distance(queries.row(query), references.row(reference)).sqrt(),
        };
        let partner = candidate(reference);
        let rival = nearest_but(queries.row(query), references, Some(reference)).map(candidate);
        let exceeds = |ratio: f64| rival.is_some_and(|rival| partner.distance >= ratio * rival.distance);
        let kept = params.max_distance.is_none_or(|most| partner.distance <= most)
            && params.max_ratio.is_none_or(|ratio| !exceeds(ratio));
        kept.then(|| DescriptorMatch { query, partner, rival, ambiguous: exceeds(params.ambiguity) })
    });
    Ok(matches.flatten_iter().collect())
}

/// The nearest reference of each query; empty if there are no references.
fn nearest(queries: &Descriptors, references: &Descriptors) -> Vec<usize> {
    let rows = queries.values().par_chunks_exact(queries.width());
    rows.filter_map(|query| nearest_but(query, references, None)).collect()
}

fn nearest_but(query: &[f64], references: &Descriptors, excluded: Option<usize>) -> Option<usize> {
    let mut best = None;
    for (number, row) in references.rows().enumerate() {
        let distance = squared_distance(query, row);
        if Some(number) != excluded && best.is_none_or(|(_, least)| distance < least) {
            best = Some((number, distance));
        }
    }
    best.map(|(number, _)| number)
}

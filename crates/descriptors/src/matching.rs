//! Matches of descriptors (section 6): nearest, mutual, one-to-one.
use crate::consistency::consistent_costs;
use crate::{DescriptorError, Descriptors, RegionCosines, assign, descriptor_table::squared_distance};
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

/// Parameters of [`match_descriptors`] and [`match_regions`].
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
    /// How much it counts in [`match_regions`] that regions which are near each other on one shape have partners that are near
    /// each other on the other. Default 30; with 0 each region is matched by its descriptor alone, as in the paper.
    pub consistency: f64,
}

impl Default for MatchParameters {
    fn default() -> Self {
        Self {
            rule: MatchRule::default(),
            max_ratio: None,
            max_distance: None,
            ambiguity: 0.8,
            consistency: 30.0,
        }
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
        if !(self.consistency >= 0.0 && self.consistency.is_finite()) {
            return Err(DescriptorError::parameter("consistency", self.consistency, "at least 0"));
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
    /// Euclidean distance to the query; in [`match_regions`] with what speaks against the pair in the other pairs.
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
    let distance = |q: usize, r: usize| squared_distance(queries.row(q), references.row(r)).sqrt();
    by_distance(queries.len(), references.len(), distance, params)
}

/// Matches the regions of one shape to those of another, by their descriptors and so that the matches hold
/// together: what is near each other on one shape has partners that are near each other on the other. Weak matches are
/// so carried by strong ones, a hand by its arm, and all of a body by what is sure of its sides.
///
/// ```
/// use mser3d_descriptors::{Descriptors, MatchParameters, RegionCosines, match_regions};
///
/// // Two hands at two arms. The hands have all but the same descriptor; the arms do not.
/// let cosines = RegionCosines::new(4, vec![
///     1.0, 0.8, 0.1, 0.1,
///     0.8, 1.0, 0.1, 0.1,
///     0.1, 0.1, 1.0, 0.8,
///     0.1, 0.1, 0.8, 1.0,
/// ])?;
/// let first = Descriptors::new(1, vec![1.00, 5.0, 1.03, 7.0])?;
/// let second = Descriptors::new(1, vec![1.02, 5.1, 1.01, 6.9])?;
/// let matches = match_regions((&second, &cosines), (&first, &cosines), &MatchParameters::default())?;
/// let partners: Vec<usize> = matches.iter().map(|m| m.partner.reference).collect();
/// assert_eq!(partners, [0, 1, 2, 3]);
/// # Ok::<(), mser3d_descriptors::DescriptorError>(())
/// ```
///
/// Cost: of q queries and r references 10 q r (q + r) multiplications, and 8 bytes for each pair.
///
/// # Errors
/// [`DescriptorError::InvalidParameter`], [`DescriptorError::SizeMismatch`] for descriptors of different length, or other
/// numbers of cosines than of regions.
pub fn match_regions(
    queries: (&Descriptors, &RegionCosines),
    references: (&Descriptors, &RegionCosines),
    params: &MatchParameters,
) -> Result<Vec<DescriptorMatch>, DescriptorError> {
    params.validate()?;
    references.0.check_width(queries.0)?;
    for (descriptors, cosines) in [queries, references] {
        let (found, expected) = (cosines.len(), descriptors.len());
        if found != expected {
            return Err(DescriptorError::SizeMismatch { what: "regions with cosines", found, expected });
        }
    }
    let columns = references.0.len();
    let distance = |q| references.0.rows().map(move |r| squared_distance(q, r).sqrt());
    let distances: Vec<f64> = queries.0.rows().flat_map(distance).collect();
    let costs = consistent_costs(&distances, queries.1, references.1, params.consistency);
    by_distance(queries.0.len(), columns, |q, r| costs[q * columns + r], params)
}

/// The matches by these distances.
fn by_distance(
    queries: usize,
    references: usize,
    distance: impl Fn(usize, usize) -> f64 + Sync,
    params: &MatchParameters,
) -> Result<Vec<DescriptorMatch>, DescriptorError> {
    let nearest = |query: usize| least(references, |r| distance(query, r), None);
    let pairs: Vec<(usize, usize)> = match params.rule {
        MatchRule::Nearest => (0..queries).into_par_iter().filter_map(|q| Some((q, nearest(q)?))).collect(),
        MatchRule::Mutual => {
            let mutual = |query: usize| {
                let reference = nearest(query)?;
                let back = least(queries, |q| distance(q, reference), None);
                (back == Some(query)).then_some((query, reference))
            };
            (0..queries).into_par_iter().filter_map(mutual).collect()
        }
        MatchRule::OneToOne => {
            let distance = &distance;
            let costs: Vec<f64> =
                (0..queries).flat_map(|q| (0..references).map(move |r| distance(q, r))).collect();
            let partners = assign(&costs, queries, references)?;
            partners.into_iter().enumerate().filter_map(|(query, r)| Some((query, r?))).collect()
        }
    };
    let matches = pairs.into_par_iter().map(|(query, reference)| {
        let candidate = |reference| Candidate { reference, distance: distance(query, reference) };
        let partner = candidate(reference);
        let rival = least(references, |r| distance(query, r), Some(reference)).map(candidate);
        let exceeds = |ratio: f64| rival.is_some_and(|rival| partner.distance >= ratio * rival.distance);
        let kept = params.max_distance.is_none_or(|most| partner.distance <= most)
            && params.max_ratio.is_none_or(|ratio| !exceeds(ratio));
        kept.then(|| DescriptorMatch { query, partner, rival, ambiguous: exceeds(params.ambiguity) })
    });
    Ok(matches.flatten_iter().collect())
}

/// The first of the least; none if there are none.
fn least(count: usize, distance: impl Fn(usize) -> f64, excluded: Option<usize>) -> Option<usize> {
    let mut best = None;
    for number in (0..count).filter(|&number| Some(number) != excluded) {
        let distance = distance(number);
        if best.is_none_or(|(_, least)| distance < least) {
            best = Some((number, distance));
        }
    }
    best.map(|(number, _)| number)
}

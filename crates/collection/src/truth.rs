use mser3d_results::Results;
use mser3d_shrec11::{NullShape, Overlaps, Transfer, VertexSet};
use serde::Serialize;

use crate::{CollectionError, Matching, Shape};

/// Whether a match is right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The partner is the same part of the body.
    Right,
    /// It is the mirror image of that part: left and right are confused.
    OtherSide,
    /// It is another part.
    Wrong,
}

impl Verdict {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::OtherSide => "other_side",
            Self::Wrong => "wrong",
        }
    }
}

/// How right a match is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Truth {
    /// Overlap with the partner, carried over vertex by vertex.
    pub overlap: f64,
    /// Overlap of the mirror image with the partner, where the symmetry is known.
    pub mirrored_overlap: Option<f64>,
    /// What follows from these.
    pub verdict: Verdict,
}

/// How many matches are right.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Precision {
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
    /// The same share of all regions of the second shape, those without a partner included.
    pub recall: f64,
}

/// Says which matches are right, for shapes in vertex correspondence: vertex i of one is vertex i of
/// the other. Overlaps are those of [`Overlaps`], by area on the first shape.
///
/// `mirror[v]` is the vertex that mirrors vertex v. A match whose mirrored overlap reaches the
/// threshold, and the direct one does not, is [`Verdict::OtherSide`].
///
/// # Errors
/// [`CollectionError::OtherVertices`], [`CollectionError::Truth`] for a symmetry of another shape,
/// [`CollectionError::BadParameter`] for a threshold outside (0, 1].
pub fn judge(
    matching: &mut Matching,
    first: &Shape,
    second: &Shape,
    mirror: Option<Vec<u32>>,
    threshold: f64,
) -> Result<(), CollectionError> {
    if !(threshold > 0.0 && threshold <= 1.0) {
        let (value, expected) = (threshold.to_string(), "above 0 and at most 1");
        return Err(CollectionError::BadParameter { name: "overlap", value, expected });
    }
    let counts = [first, second].map(|s| s.results.mesh.vertices().len());
    if counts[0] != counts[1] {
        return Err(CollectionError::OtherVertices {
            first: first.folder.clone(),
            first_vertices: counts[0],
            second: second.folder.clone(),
            second_vertices: counts[1],
        });
    }
    let sets = [regions(&first.results)?, regions(&second.results)?];
    let transfer = Transfer::identity(counts[0]);
    let null = NullShape::new(first.results.mesh.clone());
    let direct = Overlaps::new(&null, &sets[0], &sets[1], &transfer)?;
    // Overlaps with a symmetry are the better of both maps, so the mirrored overlap alone is that of
    // mirrored regions.
    let mirrored = match mirror {
        None => None,
        Some(mirror) => {
            let checked = NullShape::new(first.results.mesh.clone()).with_symmetry(mirror)?;
            let mirror = checked.mirror().unwrap_or_default();
            let image = |set: &VertexSet| VertexSet::from_fn(counts[0], |v| set.contains(mirror[v] as usize));
            let images: Vec<VertexSet> = sets[1].iter().map(image).collect();
            Some(Overlaps::new(&null, &sets[0], &images, &transfer)?)
        }
    };
    let mut precision =
        Precision { threshold, right: 0, other_side: 0, wrong: 0, precision: 0.0, recall: 0.0 };
    for m in &mut matching.matches {
        let pair = (m.region as usize, m.partner as usize);
        let overlap = direct.get(pair.0, pair.1);
        let mirrored_overlap = mirrored.as_ref().map(|overlaps| overlaps.get(pair.0, pair.1));
        let (count, verdict) = if overlap >= threshold {
            (&mut precision.right, Verdict::Right)
        } else if mirrored_overlap.is_some_and(|o| o >= threshold) {
            (&mut precision.other_side, Verdict::OtherSide)
        } else {
            (&mut precision.wrong, Verdict::Wrong)
        };
        *count += 1;
        m.truth = Some(Truth { overlap, mirrored_overlap, verdict });
    }
    let good = (precision.right + precision.other_side) as f64;
    precision.precision = good / (matching.matches.len().max(1)) as f64;
    precision.recall = good / second.descriptors.len().max(1) as f64;
    matching.precision = Some(precision);
    Ok(())
}

fn regions(results: &Results) -> Result<Vec<VertexSet>, CollectionError> {
    let count = results.mesh.vertices().len();
    let set = |members: &Vec<u32>| VertexSet::from_members(count, members.iter().map(|&v| v as usize));
    Ok(results.region_vertices.iter().map(set).collect::<Result<_, _>>()?)
}

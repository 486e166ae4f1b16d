use mser3d_evaluation::{Correspondence, NullShape, Overlaps, judge};
use mser3d_results::Results;
use mser3d_shape::IndexSet;

use crate::{CollectionError, DescribedResult, Matching};

/// Says which matches are right, for shapes in vertex correspondence: vertex i of one is vertex i of
/// the other. Overlaps are those of [`Overlaps`], by area on the first shape.
///
/// `mirror[v]` is the vertex that mirrors vertex v. A match whose mirrored overlap reaches the
/// threshold, and the direct one does not, is on the other side.
///
/// # Errors
/// [`CollectionError::OtherVertices`]; [`CollectionError::GroundTruth`] for a symmetry of another shape, or a threshold
/// outside (0, 1].
pub fn judge_matching(
    matching: &mut Matching,
    first: &DescribedResult,
    second: &DescribedResult,
    mirror: Option<Vec<u32>>,
    threshold: f64,
) -> Result<(), CollectionError> {
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
    let null = NullShape::new(first.results.mesh.clone());
    let null = match mirror {
        Some(mirror) => null.with_symmetry(mirror)?,
        None => null,
    };
    let same_vertices = Correspondence::identity(counts[0]);
    let direct = Overlaps::direct(&null, &sets[0], &sets[1], &same_vertices)?;
    let mirrored = Overlaps::mirrored(&null, &sets[0], &sets[1], &same_vertices)?;
    let pairs = matching.matches.iter().map(|m| (m.region as usize, m.partner as usize));
    let judged = judge(&pairs.collect::<Vec<_>>(), &direct, mirrored.as_ref(), threshold)?;
    matching.matches.iter_mut().zip(judged.truths).for_each(|(m, truth)| m.truth = Some(truth));
    matching.precision = Some(judged.precision_recall);
    Ok(())
}

fn regions(results: &Results) -> Result<Vec<IndexSet>, CollectionError> {
    let count = results.mesh.vertices().len();
    let set = |members: &Vec<u32>| IndexSet::from_members(count, members.iter().copied());
    let sets: Result<_, _> = results.region_vertices.iter().map(set).collect();
    Ok(sets.map_err(mser3d_results::ResultsError::from)?)
}

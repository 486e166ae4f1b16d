use mser3d::descriptors::{DenseMapParameters, MapPoints, MapShape, dense_map};
use mser3d_results::Eigenfunctions;

use crate::{CollectionError, DescribedResult, Matching};

/// Maps each vertex of `second` to a vertex of `first`, from their matched regions ([`dense_map`]). None for vertices that
/// belong to no body that was searched.
///
/// Vertices take the eigenfunctions of their nearest voxel, so those of one voxel are mapped alike: to the first vertex of a
/// voxel of the other shape. Of solids that were given as voxels, each voxel of `second` is mapped to one of `first`.
///
/// # Errors
/// [`CollectionError::Results`] for a result without eigenfunctions ([`mser3d_results::ResultsError::NoEigenfunctions`]),
/// [`CollectionError::NoMap`] where regions are of several bodies, where none are matched, or where only one of both has a mesh;
/// [`CollectionError::Descriptors`].
pub fn map_vertices(
    first: &DescribedResult,
    second: &DescribedResult,
    matching: &Matching,
    parameters: &DenseMapParameters,
) -> Result<Vec<Option<u32>>, CollectionError> {
    let fail = |reason: String| {
        let (first, second) = (first.folder.clone(), second.folder.clone());
        CollectionError::NoMap { first, second, reason }
    };
    if matching.matches.is_empty() {
        return Err(fail(
            "no regions are matched; allow more by a larger --max-distance or --max-ratio".into(),
        ));
    }
    if first.results.mesh_of_voxels != second.results.mesh_of_voxels {
        return Err(fail("only one of them has a mesh, and vertices are not mapped to voxels".into()));
    }
    for result in [first, second] {
        let bodies = result.results.record.bodies.len();
        if bodies != 1 {
            let folder = result.folder.display();
            let reason =
                format!("{folder} has {bodies} bodies searched apart; detect with --bodies largest or join");
            return Err(fail(reason));
        }
    }
    let (to, from) = (Mapped::load(first)?, Mapped::load(second)?);
    let pairs: Vec<[usize; 2]> =
        matching.matches.iter().map(|m| [m.partner as usize, m.region as usize]).collect();
    let map = dense_map(&to.shape(), &from.shape(), &pairs, parameters)?;
    Ok(from.points.vertices(&map, &to.points))
}

/// What is mapped of a result.
struct Mapped {
    body: Eigenfunctions,
    /// Of each region the rows of the eigenfunctions.
    regions: Vec<Vec<u32>>,
    points: MapPoints,
}

impl Mapped {
    /// Reads the eigenfunctions of a result of one body.
    fn load(result: &DescribedResult) -> Result<Self, CollectionError> {
        let results = &result.results;
        let mut bodies = Eigenfunctions::load(&result.folder, results)?;
        let body = bodies.swap_remove(0);
        let regions = (0..results.record.regions.len()).map(|r| body.rows_of_region(results, r)).collect();
        let points = match (results.mesh_of_voxels, &results.grid) {
            // Without a mesh every voxel is mapped.
            (true, Some(grid)) => {
                let mut row_of = vec![None; grid.len()];
                (0..).zip(&body.voxels).for_each(|(row, &voxel)| row_of[voxel as usize] = Some(row));
                MapPoints::new(&row_of, &vec![1.0; grid.len()])
            }
            _ => MapPoints::new(&body.row_of_vertex, &results.mesh.vertex_areas()),
        };
        Ok(Self { body, regions, points })
    }

    fn shape(&self) -> MapShape<'_> {
        MapShape {
            basis: &self.body.basis,
            regions: &self.regions,
            points: &self.points.elements,
            weights: &self.points.weights,
        }
    }
}

use mser3d_shape::IndexSet;

use crate::{Correspondence, EvaluationError, NullShape};

/// The overlap of each region of a transformed shape with each region of the null shape.
///
/// overlap(A, B) = area(A and B) / area(A or B), measured on the null shape (Litman, Bronstein & Bronstein 2012,
/// section 6). A is the image of a transformed region under the ground-truth [`Correspondence`], B a null region. A
/// vertex stands for a third of the area of its triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlaps {
    /// Row per transformed region, column per null region.
    values: Vec<f64>,
    null_regions: usize,
    transformed_regions: usize,
}

/// Which map from the transformed shape to the null shape counts.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Direct,
    Mirrored,
    Better,
}

impl Overlaps {
    /// All overlaps. Where the null shape has a symmetry, the better of the direct and the mirrored overlap counts,
    /// since an intrinsic detector cannot tell left from right.
    ///
    /// Cost: regions x regions x vertices / 64 words, and the vertices in them.
    ///
    /// # Errors
    /// [`EvaluationError::SizeMismatch`] when a region or the correspondence belongs to another shape.
    pub fn new(
        null: &NullShape,
        null_regions: &[IndexSet],
        transformed_regions: &[IndexSet],
        correspondence: &Correspondence,
    ) -> Result<Self, EvaluationError> {
        Self::compare(null, null_regions, transformed_regions, correspondence, Side::Better, false)
    }

    /// As [`new`](Self::new), but the null regions count only where the transformed shape has a
    /// counterpart ([`Correspondence::covered`]): for partial shapes and views, of which a whole region can
    /// never be found. The common part is what Mikolajczyk et al. (2005) compare regions of images on.
    /// It is kinder: a region of which only a corner is left is found if the corner is.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn on_common_part(
        null: &NullShape,
        null_regions: &[IndexSet],
        transformed_regions: &[IndexSet],
        correspondence: &Correspondence,
    ) -> Result<Self, EvaluationError> {
        Self::compare(null, null_regions, transformed_regions, correspondence, Side::Better, true)
    }

    /// As [`new`](Self::new), by the direct map alone: a region on the other side of the body overlaps nothing.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn direct(
        null: &NullShape,
        null_regions: &[IndexSet],
        transformed_regions: &[IndexSet],
        correspondence: &Correspondence,
    ) -> Result<Self, EvaluationError> {
        Self::compare(null, null_regions, transformed_regions, correspondence, Side::Direct, false)
    }

    /// As [`new`](Self::new), by the mirrored map alone; `None` where the null shape has no symmetry.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn mirrored(
        null: &NullShape,
        null_regions: &[IndexSet],
        transformed_regions: &[IndexSet],
        correspondence: &Correspondence,
    ) -> Result<Option<Self>, EvaluationError> {
        if null.mirror().is_none() {
            return Ok(None);
        }
        Self::compare(null, null_regions, transformed_regions, correspondence, Side::Mirrored, false)
            .map(Some)
    }

    fn compare(
        null: &NullShape,
        null_regions: &[IndexSet],
        transformed_regions: &[IndexSet],
        correspondence: &Correspondence,
        side: Side,
        common_part: bool,
    ) -> Result<Self, EvaluationError> {
        let areas = null.vertex_areas();
        let covered = correspondence.covered();
        for found in null_regions.iter().map(IndexSet::universe).chain([covered.universe()]) {
            if found != areas.len() {
                let what = "vertices of the shape that a null region is on";
                return Err(EvaluationError::SizeMismatch { what, found, expected: areas.len() });
            }
        }
        // Null regions as the direct and as the mirrored map see them.
        let visible = |covered: &IndexSet| -> Vec<IndexSet> {
            let seen = |r: &IndexSet| if common_part { r.intersection(covered) } else { r.clone() };
            null_regions.iter().map(seen).collect()
        };
        let targets = visible(&covered);
        let mirrored_targets =
            null.mirror_image(&covered).map(|covered| visible(&covered)).unwrap_or_default();
        let mut values = Vec::with_capacity(null_regions.len() * transformed_regions.len());
        for region in transformed_regions {
            let image = correspondence.carry(region)?;
            let mirrored = if side == Side::Direct { None } else { null.mirror_image(&image) };
            for (number, target) in targets.iter().enumerate() {
                let direct = if side == Side::Mirrored { 0.0 } else { image.overlap(target, areas) };
                let other = mirrored.as_ref().map_or(0.0, |m| m.overlap(&mirrored_targets[number], areas));
                values.push(direct.max(other));
            }
        }
        Ok(Self { values, null_regions: null_regions.len(), transformed_regions: transformed_regions.len() })
    }

    /// How many regions the null shape has.
    pub fn null_regions(&self) -> usize {
        self.null_regions
    }

    /// How many regions the transformed shape has.
    pub fn transformed_regions(&self) -> usize {
        self.transformed_regions
    }

    /// Overlap of a transformed region with a null region.
    ///
    /// # Panics
    /// When there is no such region.
    pub fn get(&self, transformed: usize, null: usize) -> f64 {
        assert!(null < self.null_regions, "null region {null} of {}", self.null_regions);
        self.values[transformed * self.null_regions + null]
    }

    /// Each transformed region's greatest overlap with a null region; 0 when there is none.
    pub fn best(&self) -> Vec<f64> {
        let row = |t| (0..self.null_regions).map(move |n| self.get(t, n));
        (0..self.transformed_regions).map(|t| row(t).fold(0.0, f64::max)).collect()
    }

    /// Each transformed region's overlap with the null region whose descriptor is nearest to its
    /// own in the L2 norm (of several, the first); 0 when there is no null region. Descriptors are
    /// rows of equal length, one per region.
    ///
    /// # Errors
    /// [`EvaluationError::SizeMismatch`] or [`EvaluationError::NotFinite`].
    pub fn matched(
        &self,
        null_descriptors: &[Vec<f64>],
        transformed_descriptors: &[Vec<f64>],
    ) -> Result<Vec<f64>, EvaluationError> {
        let length = transformed_descriptors.iter().chain(null_descriptors).next().map_or(0, Vec::len);
        let sides = [
            ("descriptors of null regions", null_descriptors, self.null_regions),
            ("descriptors of transformed regions", transformed_descriptors, self.transformed_regions),
        ];
        for (what, rows, expected) in sides {
            if rows.len() != expected {
                return Err(EvaluationError::SizeMismatch { what, found: rows.len(), expected });
            }
            for (number, row) in rows.iter().enumerate() {
                if row.len() != length {
                    let what = "numbers in a descriptor";
                    return Err(EvaluationError::SizeMismatch { what, found: row.len(), expected: length });
                }
                if row.iter().any(|x| !x.is_finite()) {
                    return Err(EvaluationError::NotFinite { what: "descriptor of region", number });
                }
            }
        }
        let nearest = |row: &Vec<f64>| {
            let distance =
                |other: &Vec<f64>| row.iter().zip(other).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
            let distances = null_descriptors.iter().map(distance).enumerate();
            distances.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(n, _)| n)
        };
        let matched = |(t, row)| nearest(row).map_or(0.0, |n| self.get(t, n));
        Ok(transformed_descriptors.iter().enumerate().map(matched).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mser3d_shape::TriangleMesh;

    /// Two unit right triangles side by side and one far away: vertex areas 1/6, 1/3, 1/6, 1/3, and
    /// three times 2/3 for the triangle of area 2.
    fn sheet() -> NullShape {
        let vertices = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [5.0, 0.0, 0.0],
            [7.0, 0.0, 0.0],
            [5.0, 2.0, 0.0],
        ];
        NullShape::new(TriangleMesh::new(vertices, vec![[0, 1, 3], [1, 2, 3], [4, 5, 6]]).unwrap())
    }

    fn sets(members: &[&[u32]]) -> Vec<IndexSet> {
        members.iter().map(|m| IndexSet::from_members(7, m.iter().copied()).unwrap()).collect()
    }

    #[test]
    fn overlaps_worked_out_by_hand() {
        let (null, transformed) = (sets(&[&[0, 1], &[4, 5, 6]]), sets(&[&[0, 1, 2], &[4, 5], &[3]]));
        let overlaps = Overlaps::new(&sheet(), &null, &transformed, &Correspondence::identity(7)).unwrap();
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a} {b}");
        close(overlaps.get(0, 0), (1.0 / 6.0 + 1.0 / 3.0) / (1.0 / 6.0 + 1.0 / 3.0 + 1.0 / 6.0)); // 3/4
        close(overlaps.get(1, 1), 2.0 / 3.0);
        assert_eq!((overlaps.get(0, 1), overlaps.get(2, 0)), (0.0, 0.0));
        assert_eq!(crate::share_above(&overlaps.best(), 0.7), 1.0 / 3.0);
        assert_eq!(crate::share_above(&overlaps.best(), 0.5), 2.0 / 3.0);

        // The first region's descriptor is nearest to the wrong null region.
        let (n, t) = (vec![vec![0.0], vec![10.0]], vec![vec![9.0], vec![8.0], vec![1.0]]);
        let matched = overlaps.matched(&n, &t).unwrap();
        assert_eq!(matched, [0.0, overlaps.get(1, 1), 0.0]);
        assert!(overlaps.matched(&n, &t[..2]).is_err());
    }

    #[test]
    fn the_mirror_image_counts_too() {
        let (null, transformed) = (sets(&[&[0]]), sets(&[&[2]]));
        let direct = Overlaps::new(&sheet(), &null, &transformed, &Correspondence::identity(7)).unwrap();
        assert_eq!(direct.best(), [0.0]);
        let sheet = sheet().with_symmetry(vec![2, 1, 0, 3, 4, 5, 6]).unwrap();
        let mirrored = Overlaps::new(&sheet, &null, &transformed, &Correspondence::identity(7)).unwrap();
        assert_eq!(mirrored.best(), [1.0]);
        let alone = |overlaps: Overlaps| overlaps.best();
        let identity = Correspondence::identity(7);
        assert_eq!(alone(Overlaps::direct(&sheet, &null, &transformed, &identity).unwrap()), [0.0]);
        let other_side = Overlaps::mirrored(&sheet, &null, &transformed, &identity).unwrap();
        assert_eq!(other_side.map(alone), Some(vec![1.0]));
        let without = NullShape::new(sheet.mesh().clone());
        assert_eq!(Overlaps::mirrored(&without, &null, &transformed, &identity).unwrap(), None);
        assert!(sheet.with_symmetry(vec![7; 7]).is_err());
    }

    #[test]
    fn on_the_common_part_a_missing_piece_is_not_missed() {
        // Of the sheet only the first triangle is left: vertices 0, 1 and 3.
        let null = sheet();
        let part = TriangleMesh::new([0, 1, 3].map(|v| null.mesh().vertices()[v]).to_vec(), vec![[0, 1, 2]]);
        let points = [0, 1, 2].map(|corner| Some(crate::SurfacePoint::corner(0, corner)));
        let correspondence = Correspondence::new(null.mesh(), &part.unwrap(), &points).unwrap();
        let left: Vec<usize> = correspondence.covered().members().collect();
        assert_eq!(left, [0, 1, 2, 3]); // vertex 2 is within an edge's length
        let (whole, found) = (sets(&[&[0, 1, 2, 3, 4, 5, 6]]), [IndexSet::from_fn(3, |_| true)]);
        let strict = Overlaps::new(&null, &whole, &found, &correspondence).unwrap();
        assert!((strict.get(0, 0) - 1.0 / 3.0).abs() < 1e-15); // area 1 of 3
        let common = Overlaps::on_common_part(&null, &whole, &found, &correspondence).unwrap();
        assert_eq!(common.get(0, 0), 1.0);
        let mirrored = null.with_symmetry((0..7).collect()).unwrap();
        assert_eq!(Overlaps::on_common_part(&mirrored, &whole, &found, &correspondence).unwrap(), common);
    }

    #[test]
    fn a_shape_without_regions_counts_as_zero() {
        let some = sets(&[&[0]]);
        let nothing_found = Overlaps::new(&sheet(), &some, &[], &Correspondence::identity(7)).unwrap();
        assert_eq!(crate::share_above(&nothing_found.best(), 0.0), 0.0);
        let nothing_to_find = Overlaps::new(&sheet(), &[], &some, &Correspondence::identity(7)).unwrap();
        assert_eq!(crate::share_above(&nothing_to_find.best(), 0.0), 0.0);
        assert_eq!(nothing_to_find.matched(&[], &[vec![1.0]]).unwrap(), [0.0]);
    }

    #[test]
    fn regions_of_another_shape_are_refused() {
        let other = [IndexSet::from_fn(6, |_| true)];
        let correspondence = Correspondence::identity(7);
        assert!(Overlaps::new(&sheet(), &other, &[], &correspondence).is_err());
        assert!(Overlaps::new(&sheet(), &[], &other, &correspondence).is_err());
    }
}

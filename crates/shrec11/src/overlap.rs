use mser3d_shape::TriangleMesh;

use crate::{ShrecError, Transfer, VertexSet};

/// The shape that all others are transforms of: where overlaps are measured.
#[derive(Clone, Debug)]
pub struct NullShape {
    mesh: TriangleMesh,
    vertex_areas: Vec<f64>,
    mirror: Option<Vec<u32>>,
}

impl NullShape {
    /// A null shape without a symmetry.
    pub fn new(mesh: TriangleMesh) -> Self {
        Self { vertex_areas: mesh.vertex_areas(), mesh, mirror: None }
    }

    /// The same shape with its left-right symmetry: `mirror[v]` is the vertex that mirrors vertex v.
    ///
    /// An intrinsic detector cannot tell left from right. With a symmetry, the better of the direct
    /// and the mirrored overlap counts.
    ///
    /// # Errors
    /// [`ShrecError::SizeMismatch`] or [`ShrecError::OutOfRange`].
    pub fn with_symmetry(mut self, mirror: Vec<u32>) -> Result<Self, ShrecError> {
        let count = self.vertex_areas.len();
        if mirror.len() != count {
            let (found, expected) = (mirror.len(), count);
            return Err(ShrecError::SizeMismatch { what: "entries of the symmetry map", found, expected });
        }
        if let Some(number) = mirror.iter().position(|&m| m as usize >= count) {
            let (what, index) = ("entry of the symmetry map", mirror[number].into());
            return Err(ShrecError::OutOfRange { what, number, index, count });
        }
        self.mirror = Some(mirror);
        Ok(self)
    }

    /// The surface.
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// The symmetry map, if there is one.
    pub fn mirror(&self) -> Option<&[u32]> {
        self.mirror.as_deref()
    }
}

/// The overlap of each region of a transformed shape with each region of the null shape.
///
/// overlap(A, B) = area(A and B) / area(A or B) on the null shape, where a vertex stands for a third
/// of the area of its triangles, and a transformed region is carried there by a [`Transfer`].
#[derive(Clone, Debug, PartialEq)]
pub struct Overlaps {
    /// Row per transformed region, column per null region.
    values: Vec<f64>,
    null_regions: usize,
    transformed_regions: usize,
}

impl Overlaps {
    /// All overlaps. Cost: regions x regions x vertices / 64 words, and the vertices in them.
    ///
    /// # Errors
    /// [`ShrecError::SizeMismatch`] when a region or the transfer belongs to another shape.
    pub fn new(
        null: &NullShape,
        null_regions: &[VertexSet],
        transformed_regions: &[VertexSet],
        transfer: &Transfer,
    ) -> Result<Self, ShrecError> {
        Self::compare(null, null_regions, transformed_regions, transfer, false)
    }

    /// As [`new`](Self::new), but the null regions count only where the transformed shape has a
    /// counterpart ([`Transfer::covered`]): for partial shapes and views, of which a whole region can
    /// never be found. The common part is what Mikolajczyk et al. (2005) compare regions of images on.
    /// It is kinder: a region of which only a corner is left is found if the corner is.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn on_common_part(
        null: &NullShape,
        null_regions: &[VertexSet],
        transformed_regions: &[VertexSet],
        transfer: &Transfer,
    ) -> Result<Self, ShrecError> {
        Self::compare(null, null_regions, transformed_regions, transfer, true)
    }

    fn compare(
        null: &NullShape,
        null_regions: &[VertexSet],
        transformed_regions: &[VertexSet],
        transfer: &Transfer,
        common_part: bool,
    ) -> Result<Self, ShrecError> {
        let vertices = null.vertex_areas.len();
        let covered = transfer.covered();
        let sizes = null_regions.iter().map(VertexSet::vertices).chain([covered.vertices()]);
        for found in sizes {
            if found != vertices {
                let what = "vertices of the shape that a null region is on";
                return Err(ShrecError::SizeMismatch { what, found, expected: vertices });
            }
        }
        let mirrored = |set: &VertexSet| {
            let mirror = null.mirror.as_ref()?;
            Some(VertexSet::from_fn(vertices, |v| set.contains(mirror[v] as usize)))
        };
        // Null regions as the direct and as the mirrored map see them.
        let visible = |covered: &VertexSet| -> Vec<VertexSet> {
            null_regions
                .iter()
                .map(|r| if common_part { r.intersection(covered) } else { r.clone() })
                .collect()
        };
        let targets = visible(&covered);
        let mirrored_targets = mirrored(&covered).map(|covered| visible(&covered)).unwrap_or_default();
        let mut values = Vec::with_capacity(null_regions.len() * transformed_regions.len());
        for region in transformed_regions {
            let direct = transfer.carry(region)?;
            let mirrored = mirrored(&direct);
            for (number, target) in targets.iter().enumerate() {
                let overlap = direct.overlap(target, &null.vertex_areas);
                let other = mirrored
                    .as_ref()
                    .map_or(0.0, |m| m.overlap(&mirrored_targets[number], &null.vertex_areas));
                values.push(overlap.max(other));
            }
        }
        Ok(Self { values, null_regions: null_regions.len(), transformed_regions: transformed_regions.len() })
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
    /// [`ShrecError::SizeMismatch`] or [`ShrecError::NotFinite`].
    pub fn matched(
        &self,
        null_descriptors: &[Vec<f64>],
        transformed_descriptors: &[Vec<f64>],
    ) -> Result<Vec<f64>, ShrecError> {
        let length = transformed_descriptors.iter().chain(null_descriptors).next().map_or(0, Vec::len);
        let sides = [
            ("descriptors of null regions", null_descriptors, self.null_regions),
            ("descriptors of transformed regions", transformed_descriptors, self.transformed_regions),
        ];
        for (what, rows, expected) in sides {
            if rows.len() != expected {
                return Err(ShrecError::SizeMismatch { what, found: rows.len(), expected });
            }
            for (number, row) in rows.iter().enumerate() {
                if row.len() != length {
                    let what = "numbers in a descriptor";
                    return Err(ShrecError::SizeMismatch { what, found: row.len(), expected: length });
                }
                if row.iter().any(|x| !x.is_finite()) {
                    return Err(ShrecError::NotFinite { what: "descriptor of region", number });
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

    fn sets(members: &[&[usize]]) -> Vec<VertexSet> {
        members.iter().map(|m| VertexSet::from_members(7, m.iter().copied()).unwrap()).collect()
    }

    #[test]
    fn overlaps_worked_out_by_hand() {
        let (null, transformed) = (sets(&[&[0, 1], &[4, 5, 6]]), sets(&[&[0, 1, 2], &[4, 5], &[3]]));
        let overlaps = Overlaps::new(&sheet(), &null, &transformed, &Transfer::identity(7)).unwrap();
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
        let direct = Overlaps::new(&sheet(), &null, &transformed, &Transfer::identity(7)).unwrap();
        assert_eq!(direct.best(), [0.0]);
        let sheet = sheet().with_symmetry(vec![2, 1, 0, 3, 4, 5, 6]).unwrap();
        let mirrored = Overlaps::new(&sheet, &null, &transformed, &Transfer::identity(7)).unwrap();
        assert_eq!(mirrored.best(), [1.0]);
        assert!(sheet.with_symmetry(vec![7; 7]).is_err());
    }

    #[test]
    fn on_the_common_part_a_missing_piece_is_not_missed() {
        // Of the sheet only the first triangle is left: vertices 0, 1 and 3.
        let null = sheet();
        let part = TriangleMesh::new([0, 1, 3].map(|v| null.mesh().vertices()[v]).to_vec(), vec![[0, 1, 2]]);
        let points = [0, 1, 2].map(|corner| Some(crate::SurfacePoint::corner(0, corner)));
        let transfer = Transfer::new(null.mesh(), &part.unwrap(), &points).unwrap();
        let left: Vec<usize> = transfer.covered().members().collect();
        assert_eq!(left, [0, 1, 2, 3]); // vertex 2 is within an edge's length
        let (whole, found) = (sets(&[&[0, 1, 2, 3, 4, 5, 6]]), [VertexSet::from_fn(3, |_| true)]);
        let strict = Overlaps::new(&null, &whole, &found, &transfer).unwrap();
        assert!((strict.get(0, 0) - 1.0 / 3.0).abs() < 1e-15); // area 1 of 3
        let common = Overlaps::on_common_part(&null, &whole, &found, &transfer).unwrap();
        assert_eq!(common.get(0, 0), 1.0);
        let mirrored = null.with_symmetry((0..7).collect()).unwrap();
        assert_eq!(Overlaps::on_common_part(&mirrored, &whole, &found, &transfer).unwrap(), common);
    }

    #[test]
    fn a_shape_without_regions_counts_as_zero() {
        let some = sets(&[&[0]]);
        let nothing_found = Overlaps::new(&sheet(), &some, &[], &Transfer::identity(7)).unwrap();
        assert_eq!(crate::share_above(&nothing_found.best(), 0.0), 0.0);
        let nothing_to_find = Overlaps::new(&sheet(), &[], &some, &Transfer::identity(7)).unwrap();
        assert_eq!(crate::share_above(&nothing_to_find.best(), 0.0), 0.0);
        assert_eq!(nothing_to_find.matched(&[], &[vec![1.0]]).unwrap(), [0.0]);
    }

    #[test]
    fn regions_of_another_shape_are_refused() {
        let other = [VertexSet::from_fn(6, |_| true)];
        let transfer = Transfer::identity(7);
        assert!(Overlaps::new(&sheet(), &other, &[], &transfer).is_err());
        assert!(Overlaps::new(&sheet(), &[], &other, &transfer).is_err());
    }
}

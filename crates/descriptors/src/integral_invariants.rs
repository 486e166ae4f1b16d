//! 3D integral invariants (section 5; Manay et al. 2006, Pottmann et al. 2009).
use crate::{DescriptorError, Descriptors, vertex_subset::VertexSubset};
use mser3d_shape::{BitGrid, VoxelGrid};
use rayon::prelude::*;

/// Parameters of [`integral_invariants`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct IntegralInvariantParameters {
    /// Radii of the balls, one a column, in units of [`IntegralInvariantParameters::unit`].
    /// Default 0.05, 0.1, 0.15, 0.2, 0.3 and 0.4: 2 to 14 voxels in a solid of 45,000.
    pub radii: Vec<f64>,
    /// What one unit of the radii is, in length. Default `None`: the cube root of the volume. Give all poses
    /// of a shape the same.
    pub unit: Option<f64>,
}

impl Default for IntegralInvariantParameters {
    fn default() -> Self {
        Self { radii: vec![0.05, 0.1, 0.15, 0.2, 0.3, 0.4], unit: None }
    }
}

impl IntegralInvariantParameters {
    /// Whether all values are in range.
    ///
    /// # Errors
    /// [`DescriptorError::InvalidParameter`].
    pub fn validate(&self) -> Result<(), DescriptorError> {
        if self.radii.is_empty() {
            return Err(DescriptorError::parameter("the number of radii", 0, "at least 1"));
        }
        if let Some(radius) = self.radii.iter().find(|r| !(r.is_finite() && **r > 0.0)) {
            return Err(DescriptorError::parameter("a radius", radius, "positive and finite"));
        }
        match self.unit {
            Some(unit) if !(unit.is_finite() && unit > 0.0) => {
                Err(DescriptorError::parameter("unit", unit, "positive and finite"))
            }
            _ => Ok(()),
        }
    }
}

/// The 3D integral invariants (Manay et al. 2006, Pottmann et al. 2009): which share of a ball around each
/// voxel lies in the solid, for several radii. 1 deep inside, about 1/2 under a flat face, less in limbs and
/// tips.
///
/// `voxels` lists the voxels to compute, one a row; `None` means all. A voxel counts as in the ball when its
/// centre is. Balls are Euclidean: unlike heat kernels, the invariants change when the shape bends or
/// when another part comes near.
///
/// Cost: two look-ups for each voxel and each row of voxels of each ball, about pi r^2 for a radius of r
/// voxels.
///
/// # Errors
/// [`DescriptorError::InvalidParameter`], also for a radius beyond the grid's diagonal,
/// [`DescriptorError::IndexOutOfRange`].
pub fn integral_invariants(
    grid: &VoxelGrid,
    params: &IntegralInvariantParameters,
    voxels: Option<&[u32]>,
) -> Result<Descriptors, DescriptorError> {
    params.validate()?;
    let subset = VertexSubset::new(grid.len(), voxels)?;
    let unit = params.unit.unwrap_or_else(|| grid.volume().cbrt());
    let (spacing, dims) = (grid.frame().spacing(), grid.frame().dims());
    let diagonal = (0..3).map(|a| (dims[a] as f64 * spacing[a]).powi(2)).sum::<f64>().sqrt();
    if let Some(radius) = params.radii.iter().map(|r| r * unit).find(|r| *r > diagonal) {
        let requirement = "at most the diagonal of the grid, in length: is the unit right?";
        return Err(DescriptorError::parameter("a radius", radius, requirement));
    }
    let balls: Vec<Ball> = params.radii.iter().map(|r| Ball::new(r * unit, spacing, dims)).collect();
    let counts = RowCounts::new(grid.occupancy());
    let places: Vec<[u32; 3]> = grid.voxels().collect();

    let mut values = vec![0.0; subset.len() * balls.len()];
    values.par_chunks_mut(balls.len()).with_min_len(64).enumerate().for_each(|(row, shares)| {
        let centre = places[subset.vertex(row)];
        for (share, ball) in shares.iter_mut().zip(&balls) {
            let inside: u64 = ball.rows.iter().map(|row| counts.inside(centre, row)).sum();
            *share = inside as f64 / ball.voxels;
        }
    });
    Descriptors::new(balls.len(), values)
}

/// The voxels of a ball as rows along x.
struct Ball {
    rows: Vec<BallRow>,
    /// How many voxels a whole ball has.
    voxels: f64,
}

/// Voxels from `-reach` to `reach` along x, at an offset along y and z.
struct BallRow {
    offset: [i64; 2],
    reach: i64,
}

impl Ball {
    /// Rows that lie outside any box of this size whatever the centre are counted, but not kept.
    fn new(radius: f64, spacing: [f64; 3], dims: [usize; 3]) -> Self {
        let reach = |left: f64, axis: usize| (left.max(0.0).sqrt() / spacing[axis]).floor() as i64;
        let (square, mut rows, mut voxels) = (radius * radius, Vec::new(), 0.0);
        let height = reach(square, 2);
        for z in -height..=height {
            let left = square - (z as f64 * spacing[2]).powi(2);
            let depth = reach(left, 1);
            for y in -depth..=depth {
                let reach = reach(left - (y as f64 * spacing[1]).powi(2), 0);
                voxels += 2.0 * reach as f64 + 1.0;
                if y.unsigned_abs() < dims[1] as u64 && z.unsigned_abs() < dims[2] as u64 {
                    rows.push(BallRow { offset: [y, z], reach });
                }
            }
        }
        Self { rows, voxels }
    }
}

/// Occupied voxels in any part of a row, from running counts.
struct RowCounts<'a> {
    occupancy: &'a BitGrid,
    /// Occupied voxels before each word, and in all.
    before: Vec<u64>,
}

impl<'a> RowCounts<'a> {
    fn new(occupancy: &'a BitGrid) -> Self {
        let mut before = Vec::with_capacity(occupancy.words().len() + 1);
        before.push(0);
        let mut total = 0;
        before.extend(occupancy.words().iter().map(|word| {
            total += u64::from(word.count_ones());
            total
        }));
        Self { occupancy, before }
    }

    /// How many voxels of this row of a ball around `centre` are inside the solid.
    #[inline]
    fn inside(&self, centre: [u32; 3], row: &BallRow) -> u64 {
        let [nx, ny, nz] = self.occupancy.dims().map(|d| d as i64);
        let (y, z) = (i64::from(centre[1]) + row.offset[0], i64::from(centre[2]) + row.offset[1]);
        if y < 0 || z < 0 || y >= ny || z >= nz {
            return 0;
        }
        let start = (z * ny + y) as usize * self.occupancy.row_words();
        let x = i64::from(centre[0]);
        self.up_to(start, (x + row.reach + 1).min(nx)) - self.up_to(start, (x - row.reach).max(0))
    }

    /// Occupied voxels before column x of the row whose first word is `start`.
    #[inline]
    fn up_to(&self, start: usize, x: i64) -> u64 {
        let (word, bit) = (start + x as usize / 64, x as u32 % 64);
        // At bit 0 no bits of this word count: it may lie beyond the last one.
        let part = if bit == 0 { 0 } else { self.occupancy.words()[word] & ((1 << bit) - 1) };
        self.before[word] + u64::from(part.count_ones())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mser3d_shape::Frame;

    fn solid(dims: [usize; 3], spacing: [f64; 3], keep: impl Fn(u32) -> bool) -> VoxelGrid {
        let frame = Frame::new(dims, [0.0; 3], spacing).unwrap();
        VoxelGrid::solid(frame, BitGrid::full(dims).unwrap()).unwrap().restrict(keep)
    }

    fn lengths(radii: &[f64]) -> IntegralInvariantParameters {
        IntegralInvariantParameters { radii: radii.to_vec(), unit: Some(1.0) }
    }

    #[test]
    fn counts_equal_those_of_brute_force() {
        for (dims, spacing) in [([70, 6, 5], [1.0, 1.0, 1.0]), ([64, 3, 4], [0.5, 1.0, 0.75])] {
            let grid = solid(dims, spacing, |v| v.wrapping_mul(2_654_435_761) % 7 < 4 && v % 11 != 0);
            let radii = [0.4, 1.0, 2.6, 9.9];
            let found = integral_invariants(&grid, &lengths(&radii), None).unwrap();
            let centres: Vec<[f64; 3]> = grid.voxels().map(|v| grid.frame().centre(v)).collect();
            for (number, centre) in centres.iter().enumerate().step_by(17) {
                for (column, r) in radii.iter().enumerate() {
                    let near = |other: &&[f64; 3]| {
                        (0..3).map(|a| (other[a] - centre[a]).powi(2)).sum::<f64>() <= r * r
                    };
                    let inside = centres.iter().filter(near).count() as f64;
                    let whole = Ball::new(*r, spacing, dims).voxels;
                    assert_eq!(found.row(number)[column], inside / whole);
                }
            }
        }
    }

    #[test]
    fn a_ball_has_its_volume() {
        let volume = 4.0 / 3.0 * std::f64::consts::PI * 20f64.powi(3);
        let ball = Ball::new(20.0, [1.0, 0.5, 2.0], [100; 3]);
        assert!((ball.voxels / volume - 1.0).abs() < 0.01);
        assert_eq!(Ball::new(1.0, [1.0; 3], [9; 3]).voxels, 7.0);
        assert_eq!(Ball::new(0.9, [1.0; 3], [9; 3]).voxels, 1.0);
    }

    #[test]
    fn the_share_is_one_inside_a_half_at_a_face_and_an_eighth_at_a_corner() {
        let grid = solid([31, 31, 31], [1.0; 3], |_| true);
        let places = [[15, 15, 15], [15, 15, 0], [0, 0, 0]];
        let voxels = places.map(|p| grid.index(p).unwrap());
        let shares = integral_invariants(&grid, &lengths(&[15.0]), Some(&voxels)).unwrap();
        assert_eq!(shares.row(0), [1.0]);
        // The centres lie half a voxel under the faces, which adds half a layer: 3/4 h / r of a half.
        assert!((shares.row(1)[0] - 0.5 * (1.0 + 0.75 / 15.0)).abs() < 0.01);
        assert!((shares.row(2)[0] - 0.125 * (1.0f64 + 0.75 / 15.0).powi(3)).abs() < 0.01);
    }

    #[test]
    fn a_scaled_copy_has_the_same_invariants() {
        let [small, large] = [1.0, 2.0].map(|h| solid([9, 7, 5], [h; 3], |v| v % 13 != 0));
        let params = IntegralInvariantParameters::default();
        assert_eq!(integral_invariants(&small, &params, None), integral_invariants(&large, &params, None));
    }

    #[test]
    fn wrong_parameters_are_named() {
        for radii in [vec![], vec![0.0], vec![0.1, f64::NAN]] {
            assert!(IntegralInvariantParameters { radii, unit: None }.validate().is_err());
        }
        let grid = solid([2, 2, 2], [1.0; 3], |_| true);
        assert!(integral_invariants(&grid, &lengths(&[1.0]), Some(&[8])).is_err());
        let error = integral_invariants(&grid, &lengths(&[3.0, 4.0]), None).unwrap_err();
        assert!(error.to_string().starts_with("a radius is 4: it must be at most the diagonal"), "{error}");
    }
}

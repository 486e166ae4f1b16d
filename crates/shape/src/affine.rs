use crate::ShapeError;
use crate::vector::{Vec3, cross, dot, norm};

/// The map from the voxels of a volume to the world: the *centre* of voxel (i, j, k) is at
/// `rows · (i, j, k, 1)`, in length. NIfTI, NRRD and VTK call it index to world.
///
/// Its columns are the steps from a voxel to the next along each axis of the array; they may be oblique and of
/// either hand.
///
/// ```
/// use mser3d_shape::Affine;
/// // Voxels of 2 x 2 x 3 mm. The first axis runs to the left, from x = 90.
/// let affine = Affine::new([[-2., 0., 0., 90.], [0., 2., 0., -126.], [0., 0., 3., -72.]])?;
/// assert_eq!(affine.position([1., 0., 1.]), [88., -126., -69.]);
/// assert_eq!(affine.spacing(), [2., 2., 3.]);
/// assert_eq!(affine.axis_codes(), "LAS");
/// # Ok::<(), mser3d_shape::ShapeError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Matrix", into = "Matrix")
)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "Matrix"))]
pub struct Affine {
    rows: [[f64; 4]; 3],
}

/// As files have it: 4 x 4, row by row, the last row 0 0 0 1.
type Matrix = [[f64; 4]; 4];

impl TryFrom<Matrix> for Affine {
    type Error = ShapeError;

    fn try_from(matrix: Matrix) -> Result<Self, ShapeError> {
        if matrix[3] != [0.0, 0.0, 0.0, 1.0] {
            return Err(ShapeError::BadAffine { reason: "its last row is not 0 0 0 1" });
        }
        Self::new([matrix[0], matrix[1], matrix[2]])
    }
}

impl From<Affine> for Matrix {
    fn from(affine: Affine) -> Self {
        let [x, y, z] = affine.rows;
        [x, y, z, [0.0, 0.0, 0.0, 1.0]]
    }
}

impl Default for Affine {
    /// Voxels of size 1 along the axes of space, the first with its centre at 0.
    fn default() -> Self {
        Self { rows: [[1., 0., 0., 0.], [0., 1., 0., 0.], [0., 0., 1., 0.]] }
    }
}

impl Affine {
    /// Least volume of the box of unit steps: below it, axes lie in a plane.
    const LEAST_DETERMINANT: f64 = 1e-6;

    /// The map with these first three rows.
    ///
    /// # Errors
    /// [`ShapeError::BadAffine`] for a number that is not finite, a step of no length, or axes in a plane.
    pub fn new(rows: [[f64; 4]; 3]) -> Result<Self, ShapeError> {
        let affine = Self { rows };
        let bad = |reason| Err(ShapeError::BadAffine { reason });
        if !rows.as_flattened().iter().all(|x| x.is_finite()) {
            return bad("it has a number that is NaN or infinite");
        }
        let spacing = affine.spacing();
        if !spacing.iter().all(|&h| h.is_normal()) {
            return bad("an axis has steps of no length");
        }
        let [x, y, z] = affine.directions();
        if dot(cross(x, y), z).abs() < Self::LEAST_DETERMINANT {
            return bad("its axes lie in a plane");
        }
        Ok(affine)
    }

    /// The map with these steps along each axis, and voxel (0, 0, 0) centred at `origin`.
    ///
    /// # Errors
    /// As [`Affine::new`].
    pub fn from_steps(origin: Vec3, steps: [Vec3; 3]) -> Result<Self, ShapeError> {
        Self::new(std::array::from_fn(|i| [steps[0][i], steps[1][i], steps[2][i], origin[i]]))
    }

    /// Voxels of these lengths along the axes of space, the first with its centre at `origin`.
    ///
    /// # Errors
    /// As [`Affine::new`].
    pub fn along_axes(origin: Vec3, spacing: [f64; 3]) -> Result<Self, ShapeError> {
        Self::from_steps(origin, [[spacing[0], 0., 0.], [0., spacing[1], 0.], [0., 0., spacing[2]]])
    }

    /// The map of a frame, whose steps are known to be sound.
    pub(crate) fn of_frame(rows: [[f64; 4]; 3]) -> Self {
        Self { rows }
    }

    /// The first three rows; the fourth is 0 0 0 1.
    pub fn rows(&self) -> [[f64; 4]; 3] {
        self.rows
    }

    /// All four rows.
    pub fn matrix(&self) -> [[f64; 4]; 4] {
        (*self).into()
    }

    /// The centre of voxel (0, 0, 0), in length.
    pub fn origin(&self) -> Vec3 {
        self.rows.map(|row| row[3])
    }

    /// The step from a voxel to the next along each axis, in length.
    pub fn steps(&self) -> [Vec3; 3] {
        std::array::from_fn(|axis| self.rows.map(|row| row[axis]))
    }

    /// The length of each step. Positive.
    pub fn spacing(&self) -> [f64; 3] {
        self.steps().map(norm)
    }

    /// The direction of each axis, of length 1.
    pub fn directions(&self) -> [Vec3; 3] {
        // Divided, so that a step along an axis of space gives exactly 1.
        self.steps().map(|step| step.map(|x| x / norm(step)))
    }

    /// A place in the world of a place in the array; (0, 0, 0) is the centre of the first voxel.
    #[inline]
    pub fn position(&self, index: Vec3) -> Vec3 {
        self.rows.map(|r| r[0] * index[0] + r[1] * index[1] + r[2] * index[2] + r[3])
    }

    /// The same voxels with voxel (0, 0, 0) centred elsewhere.
    #[must_use]
    pub fn with_origin(mut self, origin: Vec3) -> Self {
        (0..3).for_each(|i| self.rows[i][3] = origin[i]);
        self
    }

    /// The same axes with steps of other lengths, which are positive.
    ///
    /// # Errors
    /// As [`Affine::new`].
    pub fn with_spacing(self, spacing: [f64; 3]) -> Result<Self, ShapeError> {
        let directions = self.directions();
        Self::from_steps(self.origin(), std::array::from_fn(|a| directions[a].map(|x| x * spacing[a])))
    }

    /// Signed volume of a voxel, in length^3: negative for axes of the left hand.
    pub fn determinant(&self) -> f64 {
        let [x, y, z] = self.steps();
        dot(cross(x, y), z)
    }

    /// How far the axes are from right angles: the largest cosine between two of them.
    pub fn shear(&self) -> f64 {
        let [x, y, z] = self.directions();
        [dot(x, y), dot(y, z), dot(z, x)].into_iter().fold(0.0, |m, c| m.max(c.abs()))
    }

    /// Whether each axis runs along one of space, in either direction.
    pub fn is_along_axes(&self) -> bool {
        self.steps().iter().all(|step| step.iter().filter(|x| **x != 0.0).count() == 1)
    }

    /// The way each axis of the array mostly runs, where the world is right, anterior, superior (RAS+):
    /// nibabel's `aff2axcodes`, such as `LPS`.
    pub fn axis_codes(&self) -> String {
        let directions = self.directions();
        // The largest component decides first, so that each axis of space is named once.
        let mut codes = [' '; 3];
        let mut taken = [false; 3];
        for _ in 0..3 {
            let free = (0..3).filter(|&a| codes[a] == ' ').flat_map(|a| (0..3).map(move |w| (a, w)));
            let size = |&(a, w): &(usize, usize)| directions[a][w].abs();
            let best = free.filter(|&(_, w)| !taken[w]).min_by(|p, q| size(q).total_cmp(&size(p)));
            let Some((axis, world)) = best else { break };
            let forward = directions[axis][world] >= 0.0;
            codes[axis] = [['R', 'A', 'S'], ['L', 'P', 'I']][usize::from(!forward)][world];
            taken[world] = true;
        }
        codes.iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_codes_are_nibabels() {
        let turned = |steps| Affine::from_steps([0.0; 3], steps).unwrap().axis_codes();
        assert_eq!(turned([[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]]), "RAS");
        assert_eq!(turned([[-1., 0., 0.], [0., -1., 0.], [0., 0., 2.]]), "LPS");
        assert_eq!(turned([[0., 3., 0.], [0., 0., -1.], [-2., 0., 0.]]), "AIL");
        assert_eq!(turned([[0.8, 0.6, 0.], [-0.6, 0.8, 0.], [0., 0., 1.]]), "RAS");
        // Both of the first axes lean to x; the one that leans more has it.
        assert_eq!(turned([[0.8, 0.6, 0.], [0.9, -0.4, 0.], [0., 0., 1.]]), "ARS");
    }

    #[test]
    fn what_is_no_affine_is_refused() {
        for (steps, says) in [
            ([[0., 0., 0.], [0., 1., 0.], [0., 0., 1.]], "no length"),
            ([[1., 0., 0.], [1., 1e-9, 0.], [0., 0., 1.]], "plane"),
            ([[f64::NAN, 0., 0.], [0., 1., 0.], [0., 0., 1.]], "NaN"),
        ] {
            let error = Affine::from_steps([0.0; 3], steps).unwrap_err().to_string();
            assert!(error.contains(says), "{error}");
        }
        let projective = [[1., 0., 0., 0.], [0., 1., 0., 0.], [0., 0., 1., 0.], [0., 0., 1., 1.]];
        assert!(Affine::try_from(projective).is_err());
    }

    #[test]
    fn shear_and_hand() {
        let affine = Affine::new([[-2., 1., 0., 0.], [0., 2., 0., 0.], [0., 0., 1., 0.]]).unwrap();
        assert!((affine.shear() - 0.2f64.sqrt()).abs() < 1e-15);
        assert_eq!(affine.determinant(), -4.0);
        assert_eq!(affine.with_origin([1., 2., 3.]).position([0.0; 3]), [1., 2., 3.]);
    }
}

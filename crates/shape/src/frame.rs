use crate::vector::{Vec3, cross, dot, norm};
use crate::{Affine, ShapeError};

/// Where the voxels of a grid lie: voxel (i, j, k) has its centre at `origin + (i + 1/2) spacing[0] directions[0] +
/// (j + 1/2) spacing[1] directions[1] + (k + 1/2) spacing[2] directions[2]`.
///
/// The axes are at right angles, so that the Laplacian needs the spacing alone. They may be turned, and of either hand.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "FrameFields"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Frame {
    dims: [usize; 3],
    origin: [f64; 3],
    spacing: [f64; 3],
    directions: [[f64; 3]; 3],
}

/// A frame as it is read, before it is checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct FrameFields {
    dims: [usize; 3],
    origin: [f64; 3],
    spacing: [f64; 3],
    directions: [[f64; 3]; 3],
}

#[cfg(feature = "serde")]
impl TryFrom<FrameFields> for Frame {
    type Error = ShapeError;

    fn try_from(fields: FrameFields) -> Result<Self, ShapeError> {
        let FrameFields { dims, origin, spacing, directions } = fields;
        Self::new(dims, origin, spacing)?.turned(directions)
    }
}

const ALONG_AXES: [Vec3; 3] = [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];

impl Frame {
    /// The largest cosine between two axes that counts as a right angle: over a thousand voxels it moves a voxel by
    /// one. Headers in single precision are a thousand times closer.
    pub const RIGHT_ANGLE: f64 = 1e-3;

    /// `dims` voxels along x, y and z, the corner of voxel (0, 0, 0) at `origin`, voxels of size `spacing`.
    ///
    /// # Errors
    /// [`ShapeError::BadSpacing`] when a spacing or the origin is not finite, or a spacing not positive.
    pub fn new(dims: [usize; 3], origin: [f64; 3], spacing: [f64; 3]) -> Result<Self, ShapeError> {
        let good = spacing.iter().all(|h| h.is_finite() && *h > 0.0) && origin.iter().all(|x| x.is_finite());
        if !good {
            return Err(ShapeError::BadSpacing { spacing });
        }
        Ok(Self { dims, origin, spacing, directions: ALONG_AXES })
    }

    /// `dims` voxels as an affine map places them.
    ///
    /// # Errors
    /// [`ShapeError::Sheared`] when two axes are not at right angles.
    ///
    /// ```
    /// use mser3d_shape::{Affine, Frame};
    /// // The first axis runs to the left.
    /// let affine = Affine::new([[-2., 0., 0., 90.], [0., 2., 0., 0.], [0., 0., 2., 0.]])?;
    /// let frame = Frame::placed([10, 10, 10], &affine)?;
    /// assert_eq!(frame.centre([1, 0, 0]), [88.0, 0.0, 0.0]);
    /// assert_eq!(frame.affine(), affine);
    /// # Ok::<(), mser3d_shape::ShapeError>(())
    /// ```
    pub fn placed(dims: [usize; 3], affine: &Affine) -> Result<Self, ShapeError> {
        Self::new(dims, affine.position([-0.5; 3]), affine.spacing())?.turned(affine.directions())
    }

    /// The same corner and spacing with axes in these directions, of length 1.
    fn turned(self, directions: [Vec3; 3]) -> Result<Self, ShapeError> {
        let [x, y, z] = directions;
        let cosine = [dot(x, y), dot(y, z), dot(z, x)].into_iter().fold(0.0, |m: f64, c| m.max(c.abs()));
        let unit = directions.iter().all(|&d| (norm(d) - 1.0).abs() < 1e-6);
        if !unit || cosine.is_nan() || cosine > Self::RIGHT_ANGLE {
            return Err(ShapeError::Sheared { cosine });
        }
        Ok(Self { directions, ..self })
    }

    /// Voxels along the axes.
    pub fn dims(&self) -> [usize; 3] {
        self.dims
    }

    /// The outer corner of voxel (0, 0, 0).
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Size of a voxel along each axis.
    pub fn spacing(&self) -> [f64; 3] {
        self.spacing
    }

    /// The direction of each axis, of length 1.
    pub fn directions(&self) -> [[f64; 3]; 3] {
        self.directions
    }

    /// Whether the axes are x, y and z.
    pub fn is_along_axes(&self) -> bool {
        self.directions == ALONG_AXES
    }

    /// Whether the axes are of the left hand: the array is a mirror image of the world.
    pub fn is_left_handed(&self) -> bool {
        let [x, y, z] = self.directions;
        dot(cross(x, y), z) < 0.0
    }

    /// Index to world: the centre of voxel (i, j, k) is at its `position([i, j, k])`.
    pub fn affine(&self) -> Affine {
        let origin = self.position([0.5; 3]);
        let step = |a: usize, i: usize| self.directions[a][i] * self.spacing[a];
        Affine::of_frame(std::array::from_fn(|i| [step(0, i), step(1, i), step(2, i), origin[i]]))
    }

    /// Volume of a voxel, in length^3.
    pub fn voxel_volume(&self) -> f64 {
        self.spacing[0] * self.spacing[1] * self.spacing[2]
    }

    /// Centre of a voxel.
    #[inline]
    pub fn centre(&self, voxel: [u32; 3]) -> [f64; 3] {
        self.position(voxel.map(|i| f64::from(i) + 0.5))
    }

    /// A place in the world of one in units of voxels: voxel (i, j, k) spans from (i, j, k) to (i+1, j+1, k+1).
    #[inline]
    pub fn position(&self, voxels: [f64; 3]) -> [f64; 3] {
        let along: [f64; 3] = std::array::from_fn(|a| self.spacing[a] * voxels[a]);
        let [x, y, z] = self.directions;
        std::array::from_fn(|i| self.origin[i] + (x[i] * along[0] + y[i] * along[1] + z[i] * along[2]))
    }

    /// A place in units of voxels of one in the world: the inverse of [`Frame::position`].
    #[inline]
    pub fn locate(&self, point: [f64; 3]) -> [f64; 3] {
        let from: [f64; 3] = std::array::from_fn(|i| point[i] - self.origin[i]);
        // Nearly right angles are not quite right ones: Cramer's rule.
        let [x, y, z] = self.directions;
        let normals = [cross(y, z), cross(z, x), cross(x, y)];
        let volume = dot(x, normals[0]);
        std::array::from_fn(|a| dot(from, normals[a]) / volume / self.spacing[a])
    }

    /// The frame of a part of the box: `dims` voxels, of which this frame's voxel `low` is the first.
    pub fn part(&self, low: [u32; 3], dims: [usize; 3]) -> Self {
        Self { dims, origin: self.position(low.map(f64::from)), ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turned_frames_locate_what_they_place() {
        let (s, c) = 0.3f64.sin_cos();
        for steps in [
            [[0., 2., 0.], [0., 0., -3.], [1., 0., 0.]],
            [[2. * c, 2. * s, 0.], [-3. * s, 3. * c, 0.], [0., 0., -1.]],
        ] {
            let affine = Affine::from_steps([5., -6., 7.], steps).unwrap();
            let frame = Frame::placed([4, 5, 6], &affine).unwrap();
            assert_eq!(frame.is_left_handed(), affine.determinant() < 0.0);
            for voxel in [[0, 0, 0], [3, 1, 5]] {
                let (there, expected) = (frame.centre(voxel), affine.position(voxel.map(f64::from)));
                let back = frame.locate(there);
                for a in 0..3 {
                    assert!((there[a] - expected[a]).abs() < 1e-14, "{there:?} {expected:?}");
                    assert!((back[a] - f64::from(voxel[a]) - 0.5).abs() < 1e-14, "{back:?}");
                }
            }
        }
    }

    #[test]
    fn shear_is_refused() {
        let sheared = Affine::new([[1., 0.2, 0., 0.], [0., 1., 0., 0.], [0., 0., 1., 0.]]).unwrap();
        let error = Frame::placed([2, 2, 2], &sheared).unwrap_err();
        assert!(matches!(error, ShapeError::Sheared { cosine } if (cosine - 0.196).abs() < 1e-3), "{error}");
    }
}

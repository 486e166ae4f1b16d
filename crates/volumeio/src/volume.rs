use crate::{Samples, VolumeIoError};
use mser3d_shape::{BitGrid, Frame};

/// Where the voxels of a volume lie: the centre of voxel (i, j, k) is at
/// `origin + i spacing[0] directions[0] + j spacing[1] directions[1] + k spacing[2] directions[2]`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Placement {
    /// The *centre* of voxel (0, 0, 0), in length.
    pub origin: [f64; 3],
    /// Distance of neighbouring voxels along each axis of the grid, in length. Positive.
    pub spacing: [f64; 3],
    /// The direction of each axis of the grid, of length 1. In NIfTI and in NRRD files that name an
    /// anatomical space, x is right, y anterior and z superior.
    pub directions: [[f64; 3]; 3],
}

impl Default for Placement {
    /// Spacing 1 along the axes of space, from the origin.
    fn default() -> Self {
        let directions = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        Self { origin: [0.0; 3], spacing: [1.0; 3], directions }
    }
}

impl Placement {
    /// From the steps between neighbouring voxels along each axis; a step of length 0 or that is not
    /// finite becomes 1 along the axis.
    pub(crate) fn from_steps(origin: [f64; 3], steps: [[f64; 3]; 3]) -> Self {
        let mut placement = Self::default();
        for axis in 0..3 {
            let length = steps[axis].iter().map(|x| x * x).sum::<f64>().sqrt();
            if length.is_finite() && length > 0.0 {
                placement.spacing[axis] = length;
                placement.directions[axis] = steps[axis].map(|x| x / length);
            }
        }
        if origin.iter().all(|x| x.is_finite()) {
            placement.origin = origin;
        }
        placement
    }

    /// The step from a voxel to the next along each axis.
    pub fn steps(&self) -> [[f64; 3]; 3] {
        std::array::from_fn(|axis| self.directions[axis].map(|x| x * self.spacing[axis]))
    }

    /// The place of a point that is given in voxels: (0, 0, 0) is the centre of the first.
    pub fn position(&self, voxels: [f64; 3]) -> [f64; 3] {
        let steps = self.steps();
        std::array::from_fn(|i| {
            self.origin[i] + (0..3).map(|axis| voxels[axis] * steps[axis][i]).sum::<f64>()
        })
    }
}

/// A box of voxels, each with one number or several.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    dims: [usize; 3],
    channels: usize,
    placement: Placement,
    samples: Samples,
}

impl Volume {
    /// `dims` voxels along x, y and z, each with `channels` numbers: voxel (i, j, k) has those from
    /// `((k * dims[1] + j) * dims[0] + i) * channels` on. An image is a volume of one layer.
    ///
    /// # Errors
    /// [`VolumeIoError::InvalidVolume`] for another count of numbers, no voxels or channels, or a spacing
    /// that is not positive and finite.
    pub fn new(
        dims: [usize; 3],
        channels: usize,
        placement: Placement,
        samples: impl Into<Samples>,
    ) -> Result<Self, VolumeIoError> {
        let samples = samples.into();
        let bad = |reason| Err(VolumeIoError::InvalidVolume { reason });
        let [nx, ny, nz] = dims;
        match voxel_count(dims).and_then(|n| n.checked_mul(channels)) {
            Some(0) => {
                return bad(format!(
                    "a volume of {nx} x {ny} x {nz} voxels and {channels} channels is empty"
                ));
            }
            Some(count) if count == samples.len() => {}
            _ => {
                let count = samples.len();
                return bad(format!(
                    "{nx} x {ny} x {nz} voxels of {channels} channels do not fit {count} values"
                ));
            }
        }
        if !placement.spacing.iter().all(|h| h.is_finite() && *h > 0.0) {
            return bad(format!("the spacing {:?} is not positive and finite", placement.spacing));
        }
        Ok(Self { dims, channels, placement, samples })
    }

    /// A mask: 1 inside, 0 outside.
    ///
    /// # Errors
    /// As [`Volume::new`].
    pub fn from_mask(mask: &BitGrid, placement: Placement) -> Result<Self, VolumeIoError> {
        let dims = mask.dims();
        let mut values = vec![0u8; dims.iter().product()];
        for [i, j, k] in mask.ones() {
            values[(k as usize * dims[1] + j as usize) * dims[0] + i as usize] = 1;
        }
        Self::new(dims, 1, placement, values)
    }

    /// The voxels where any channel is not zero.
    ///
    /// # Errors
    /// [`VolumeIoError::InvalidVolume`] beyond 2^32 voxels along an axis.
    pub fn mask(&self) -> Result<BitGrid, VolumeIoError> {
        let mut mask =
            BitGrid::empty(self.dims).map_err(|e| VolumeIoError::InvalidVolume { reason: e.to_string() })?;
        for at in self.samples.nonzero() {
            let voxel = at / self.channels;
            let [nx, ny, _] = self.dims;
            mask.set([voxel % nx, voxel / nx % ny, voxel / (nx * ny)].map(|i| i as u32), true);
        }
        Ok(mask)
    }

    /// Voxels along x, y and z.
    pub fn dims(&self) -> [usize; 3] {
        self.dims
    }

    /// Samples of a voxel.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Where the voxels lie.
    pub fn placement(&self) -> &Placement {
        &self.placement
    }

    /// The numbers, x fastest, channels of a voxel side by side.
    pub fn samples(&self) -> &Samples {
        &self.samples
    }

    /// The grid along its own axes: spacing and first corner as placed, directions left out.
    ///
    /// # Errors
    /// [`VolumeIoError::InvalidVolume`] for a placement that is not finite.
    pub fn frame(&self) -> Result<Frame, VolumeIoError> {
        let Placement { origin, spacing, .. } = self.placement;
        let corner = std::array::from_fn(|a| origin[a] - spacing[a] / 2.0);
        Frame::new(self.dims, corner, spacing)
            .map_err(|e| VolumeIoError::InvalidVolume { reason: e.to_string() })
    }
}

pub(crate) fn voxel_count(dims: [usize; 3]) -> Option<usize> {
    dims[0].checked_mul(dims[1])?.checked_mul(dims[2])
}

/// Samples whose channels lie one volume after the other, in the order of a [`Volume`].
pub(crate) fn interleaved(samples: Samples, channels: usize) -> Samples {
    if channels < 2 {
        return samples;
    }
    let voxels = samples.len() / channels;
    samples.permuted(|i| i % channels * voxels + i / channels)
}

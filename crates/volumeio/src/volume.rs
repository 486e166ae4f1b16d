use crate::error::Fault;
use crate::{Affine, Samples, VolumeIoError};
use mser3d_fileio::ReadLimits;
use mser3d_shape::{BitGrid, Frame, ShapeError};

/// A box of voxels, each with one number or several, and where they lie.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    dims: [usize; 3],
    channels: usize,
    affine: Affine,
    samples: Samples,
}

impl Volume {
    /// `dims` voxels along x, y and z, each with `channels` numbers: voxel (i, j, k) has those from
    /// `((k * dims[1] + j) * dims[0] + i) * channels` on, and its centre at `affine.position([i, j, k])`. An
    /// image is a volume of one layer.
    ///
    /// # Errors
    /// [`VolumeIoError::InvalidVolume`] for another count of numbers, and for no voxels or channels.
    pub fn new(
        dims: [usize; 3],
        channels: usize,
        affine: Affine,
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
        Ok(Self { dims, channels, affine, samples })
    }

    /// A mask: 1 inside, 0 outside.
    ///
    /// # Errors
    /// As [`Volume::new`].
    pub fn from_mask(mask: &BitGrid, affine: Affine) -> Result<Self, VolumeIoError> {
        let dims = mask.dims();
        let mut values = vec![0u8; dims.iter().product()];
        for [i, j, k] in mask.ones() {
            values[(k as usize * dims[1] + j as usize) * dims[0] + i as usize] = 1;
        }
        Self::new(dims, 1, affine, values)
    }

    /// Voxels along x, y and z.
    pub fn dims(&self) -> [usize; 3] {
        self.dims
    }

    /// Samples of a voxel.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Where the voxels lie. Its axes may be sheared.
    pub fn affine(&self) -> &Affine {
        &self.affine
    }

    /// The same voxels in another place.
    #[must_use]
    pub fn with_affine(mut self, affine: Affine) -> Self {
        self.affine = affine;
        self
    }

    /// The numbers, x fastest, channels of a voxel side by side.
    pub fn samples(&self) -> &Samples {
        &self.samples
    }

    /// One of the channels.
    ///
    /// # Panics
    /// When there are no more than `channel` channels.
    #[must_use]
    pub fn channel(&self, channel: usize) -> Self {
        let channels = self.channels;
        assert!(channel < channels, "channel {channel} of {channels}");
        let samples = match channels {
            1 => self.samples.clone(),
            _ => self.samples.picked(self.samples.len() / channels, |i| i * channels + channel),
        };
        Self { channels: 1, samples, ..*self }
    }

    /// The grid that the voxels lie on.
    ///
    /// # Errors
    /// [`ShapeError::Sheared`] when two axes are not at right angles.
    pub fn frame(&self) -> Result<Frame, ShapeError> {
        Frame::placed(self.dims, &self.affine)
    }
}

/// How many numbers a volume has, if reading it is allowed. `bytes` are those that a number is kept in: while it is read, and
/// brought into order, there are two of each.
pub(crate) fn allowed_count(
    dims: [usize; 3],
    channels: usize,
    bytes: usize,
    limits: &ReadLimits,
) -> Result<usize, Fault> {
    limits.check_voxels(dims)?;
    let [nx, ny, nz] = dims;
    let declared = || format!("it declares {nx} x {ny} x {nz} voxels of {channels} x {bytes} bytes");
    let count = voxel_count(dims).and_then(|n| n.checked_mul(channels));
    let needed = count.map_or(u64::MAX, |count| (count as u64).saturating_mul(2 * bytes as u64));
    limits.check_memory(needed, declared)?;
    count.ok_or_else(|| Fault::invalid(format!("{}, which are more than any memory holds", declared())))
}

fn voxel_count(dims: [usize; 3]) -> Option<usize> {
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

//! The voxel centres, axis by axis, and where coordinates fall between them.

use mser3d_shape::Frame;

/// The centres of a frame's voxels, and the map to *grid units* in which centre i lies at i.
pub(crate) struct Lattice {
    pub dims: [usize; 3],
    /// The exact coordinates of the centres along each axis.
    pub centres: [Vec<f64>; 3],
    origin: [f64; 3],
    inverse: [f64; 3],
    /// Bound on the rounding error of [`Lattice::grid_units`], in grid units.
    pub tolerance: f64,
}

impl Lattice {
    /// `scale` is a power of two that every coordinate is multiplied with; `reach` bounds the
    /// scaled coordinates of the mesh.
    pub fn new(frame: &Frame, scale: f64, reach: f64) -> Self {
        let dims = frame.dims();
        let centres: [Vec<f64>; 3] = std::array::from_fn(|a| {
            let place = |i: usize| {
                let mut voxel = [0; 3];
                voxel[a] = i as u32;
                frame.centre(voxel)[a] * scale
            };
            (0..dims[a]).map(place).collect()
        });
        let origin = frame.origin().map(|x| x * scale);
        let spacing = frame.spacing().map(|h| h * scale);
        let tolerance = (0..3)
            .map(|a| {
                let far = origin[a].abs() + spacing[a] * (dims[a] as f64 + 1.0);
                4.0 * f64::EPSILON * (far.max(reach) / spacing[a] + 1.0)
            })
            .fold(0.0, f64::max);
        Self { dims, centres, origin, inverse: spacing.map(|h| 1.0 / h), tolerance }
    }

    /// A coordinate in grid units, up to `tolerance`.
    #[inline]
    pub fn grid_units(&self, axis: usize, x: f64) -> f64 {
        (x - self.origin[axis]) * self.inverse[axis] - 0.5
    }

    /// The first centre at or beyond x along an axis: exact, `dims[axis]` if there is none.
    #[inline]
    pub fn first_at_or_beyond(&self, axis: usize, x: f64) -> u32 {
        let centres = &self.centres[axis];
        let guess = self.grid_units(axis, x) + 1.0;
        let mut i = (guess.max(0.0) as usize).min(centres.len());
        while i > 0 && centres[i - 1] >= x {
            i -= 1;
        }
        while i < centres.len() && centres[i] < x {
            i += 1;
        }
        i as u32
    }

    /// The centre of a voxel.
    #[inline]
    pub fn centre(&self, voxel: [usize; 3]) -> [f64; 3] {
        std::array::from_fn(|a| self.centres[a][voxel[a]])
    }
}

//! The voxel centres, axis by axis, and where coordinates fall between them.

use crate::frame_around::rounded;
use mser3d_shape::Frame;
use rayon::prelude::*;

/// The centres of a frame's voxels, and the map to *grid units* in which centre i lies at i.
///
/// The centres are those of the frame up to the last two bits of its largest coordinate. They are computed
/// from the middle of the frame, so that the mirrored frame has the mirrored centres to the last bit.
pub(crate) struct CentreLattice {
    pub dims: [usize; 3],
    /// The exact coordinates of the centres along each axis.
    pub centres: [Vec<f64>; 3],
    middle: [f64; 3],
    inverse: [f64; 3],
    /// Bound on the rounding error of grid units.
    pub tolerance: f64,
}

/// A vertex on a lattice.
#[derive(Clone, Copy)]
pub(crate) struct PlacedVertex {
    /// In grid units, up to the lattice's tolerance.
    pub units: [f64; 3],
    /// The first centre at or beyond the vertex along each axis, exact; the number of centres if there is
    /// none.
    pub first: [u32; 3],
}

impl CentreLattice {
    /// `scale` is a power of two that every coordinate is multiplied with; `reach` bounds the
    /// scaled coordinates of the mesh.
    pub fn new(frame: &Frame, scale: f64, reach: f64) -> Self {
        let dims = frame.dims();
        let origin = frame.origin().map(|x| x * scale);
        let spacing = frame.spacing().map(|h| h * scale);
        let middle: [f64; 3] = std::array::from_fn(|a| {
            let extent = spacing[a] * dims[a] as f64;
            rounded(origin[a] + 0.5 * extent, origin[a].abs().max((origin[a] + extent).abs()), 0.0)
        });
        let centres: [Vec<f64>; 3] = std::array::from_fn(|a| {
            let place = |i: usize| middle[a] + 0.5 * spacing[a] * (2.0 * i as f64 + 1.0 - dims[a] as f64);
            (0..dims[a]).map(place).collect()
        });
        let tolerance = (0..3)
            .map(|a| {
                let far = origin[a].abs() + spacing[a] * (dims[a] as f64 + 1.0);
                8.0 * f64::EPSILON * (far.max(reach) / spacing[a] + 1.0)
            })
            .fold(0.0, f64::max);
        Self { dims, centres, middle, inverse: spacing.map(|h| 1.0 / h), tolerance }
    }

    /// All vertices on this lattice.
    pub fn place(&self, vertices: &[[f64; 3]]) -> Vec<PlacedVertex> {
        let place = |p: &[f64; 3]| {
            let units = std::array::from_fn(|a| {
                (p[a] - self.middle[a]) * self.inverse[a] + 0.5 * (self.dims[a] as f64 - 1.0)
            });
            PlacedVertex { units, first: std::array::from_fn(|a| self.first_at_or_beyond(a, p[a], units[a])) }
        };
        vertices.par_iter().with_min_len(1 << 12).map(place).collect()
    }

    #[inline]
    fn first_at_or_beyond(&self, axis: usize, x: f64, units: f64) -> u32 {
        let last = self.dims[axis] as u32;
        if let Some(i) = certain_ceiling(units, self.tolerance) {
            return i.min(last);
        }
        self.centres[axis].partition_point(|centre| *centre < x) as u32
    }

    /// The centre of a voxel.
    #[inline]
    pub fn centre(&self, voxel: [usize; 3]) -> [f64; 3] {
        std::array::from_fn(|a| self.centres[a][voxel[a]])
    }
}

/// The smallest integer beyond x, at least 0, if x is further than `error` from any integer.
#[inline]
pub(crate) fn certain_ceiling(x: f64, error: f64) -> Option<u32> {
    // Added to a number, it leaves the nearest integer in the low bits.
    const SHIFT: f64 = (3u64 << 51) as f64;
    let x = if x < -1.5 { -1.5 } else { x };
    let shifted = x + SHIFT;
    let beyond = x - (shifted - SHIFT);
    let nearest = shifted.to_bits() as i32;
    let certain = beyond.abs() > error && x < f64::from(1 << 30);
    certain.then_some((nearest + i32::from(beyond > 0.0)).max(0) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ceilings_are_given_only_when_certain() {
        assert_eq!(certain_ceiling(3.2, 0.1), Some(4));
        assert_eq!(certain_ceiling(3.95, 0.1), None);
        assert_eq!(certain_ceiling(4.05, 0.1), None);
        assert_eq!(certain_ceiling(-0.5, 0.1), Some(0));
        assert_eq!(certain_ceiling(-1.05, 0.1), None);
        assert_eq!(certain_ceiling(-7e9, 0.1), Some(0));
        assert_eq!(certain_ceiling(9e9, 0.1), None);
        assert_eq!(certain_ceiling(1.5, 0.5), None);
        assert_eq!(certain_ceiling(1.5, f64::NAN), None);
        assert_eq!(certain_ceiling(f64::NAN, 0.1), None);
    }

    #[test]
    fn a_mirrored_frame_has_mirrored_centres() {
        for (origin, h, n) in [(0.1f64, 0.7, 9), (-3.21, 0.1, 64), (1e3, 0.3333, 31), (-7.7, 1.1, 14)] {
            // As a frame around a mesh is made.
            let half = 0.5 * h * n as f64;
            let middle = rounded(origin + half, origin.abs() + 4.0 * half, 2.0);
            let lattice = |middle: f64| {
                let frame = Frame::new([n; 3], [middle - half; 3], [h; 3]).unwrap();
                CentreLattice::new(&frame, 1.0, 1.0)
            };
            let mirrored = lattice(-middle).centres[0].clone();
            assert!(lattice(middle).centres[0].iter().rev().map(|x| -x).eq(mirrored));
        }
    }

    #[test]
    fn vertices_fall_before_the_right_centre() {
        let frame = Frame::new([4, 4, 4], [0.1, 0.2, 0.3], [0.7; 3]).unwrap();
        let lattice = CentreLattice::new(&frame, 1.0, 3.0);
        for i in 0..4 {
            let centre = lattice.centre([i as usize; 3]);
            let near = frame.centre([i; 3]);
            assert!((0..3).all(|a| (centre[a] - near[a]).abs() < 2e-15));
            for (x, first) in
                [(centre, i), (centre.map(f64::next_up), i + 1), (centre.map(f64::next_down), i)]
            {
                assert_eq!(lattice.place(&[x])[0].first, [first; 3]);
            }
        }
        assert_eq!(lattice.place(&[[-9.0, 9.0, 9e300]])[0].first, [0, 4, 4]);
    }
}

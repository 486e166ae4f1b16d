//! Frames around a surface: where they lie, and which are too large or too fine.

use crate::error::VoxelizeError;
use crate::surface::Surface;
use mser3d_shape::Frame;

/// Empty space left around the mesh, in voxels. A whole number, so that the flat sides of a box lie
/// between centres, and a box of n pitches gets n voxels.
const MARGIN: f64 = 1.0;

/// The pitch that divides the longest side of the box around a mesh into n voxels.
pub(crate) fn resolution_pitch(surface: &Surface, n: usize) -> Option<f64> {
    let longest = surface.bounds.extent().into_iter().fold(0.0, f64::max);
    (longest > 0.0 && longest.is_finite()).then_some(longest / n as f64)
}

/// The frame around a mesh: corner at the lowest coordinates less one pitch, cubic voxels.
pub(crate) fn around(surface: &Surface, pitch: f64) -> Result<Frame, VoxelizeError> {
    around_within(surface, [pitch; 3], None, 1 << 32)
}

/// The frame of the given spacing, from the given origin or around the surface, of at most `limit` voxels.
pub(crate) fn around_within(
    surface: &Surface,
    spacing: [f64; 3],
    origin: Option<[f64; 3]>,
    limit: u64,
) -> Result<Frame, VoxelizeError> {
    let bounds = &surface.bounds;
    let origin = origin.unwrap_or_else(|| std::array::from_fn(|a| bounds.min[a] - MARGIN * spacing[a]));
    let dims: [f64; 3] = std::array::from_fn(|a| {
        ((bounds.max[a] - origin[a] + MARGIN * spacing[a]) / spacing[a]).ceil().max(1.0)
    });
    let voxels: f64 = dims.iter().product();
    if voxels.is_nan() || voxels > limit as f64 {
        // The box grows with the cube of the resolution, its margins do not.
        let pitch = spacing.into_iter().fold(f64::INFINITY, f64::min);
        let advice = pitch * (voxels / limit as f64).cbrt();
        return Err(VoxelizeError::TooLarge { pitch, voxels, limit, advice });
    }
    Ok(Frame::new(dims.map(|d| d as usize), origin, spacing)?)
}

/// Refuses frames that are too large, or finer than the coordinates' precision.
pub(crate) fn checked(frame: Frame, surface: &Surface, limit: u64) -> Result<Frame, VoxelizeError> {
    let voxels: f64 = frame.dims().iter().map(|&d| d as f64).product();
    let finest = frame.spacing().into_iter().fold(f64::INFINITY, f64::min);
    if voxels > limit as f64 {
        let advice = finest * (voxels / limit as f64).cbrt();
        return Err(VoxelizeError::TooLarge { pitch: finest, voxels, limit, advice });
    }
    let used = &surface.bounds;
    let reach = (0..3)
        .flat_map(|a| {
            [
                used.min[a],
                used.max[a],
                frame.origin()[a],
                frame.origin()[a] + frame.spacing()[a] * frame.dims()[a] as f64,
            ]
        })
        .fold(0.0f64, |m, x| m.max(x.abs()));
    if !reach.is_finite() || finest <= 64.0 * f64::EPSILON * reach {
        return Err(VoxelizeError::Imprecise { pitch: finest, reach });
    }
    Ok(frame)
}

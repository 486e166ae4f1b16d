//! Frames around a surface: where they lie, and which are too large or too fine.

use crate::error::VoxelizeError;
use crate::surface::Surface;
use mser3d_shape::Frame;

/// Voxels left empty on either side of the mesh.
const MARGIN: f64 = 1.0;

/// Numbers of voxels that are this close below a half are rounded down, so that the last bit of a pitch does
/// not decide.
const HALF: f64 = 1e-9;

/// The pitch that divides the longest side of the box around a mesh into n voxels.
pub(crate) fn resolution_pitch(surface: &Surface, n: usize) -> Option<f64> {
    let longest = surface.bounds.extent().into_iter().fold(0.0, f64::max);
    (longest > 0.0 && longest.is_finite()).then_some(longest / n as f64)
}

/// The frame of cubic voxels around a mesh.
pub(crate) fn around(surface: &Surface, pitch: f64) -> Result<Frame, VoxelizeError> {
    around_within(surface, [pitch; 3], None, 1 << 32)
}

/// The frame of the given spacing, from the given origin or around the surface, of at most `limit` voxels.
///
/// Around the surface it is centred on the middle of the bounding box. A box of r voxels across gets
/// round(r) of them, so that the flat sides of a box lie at least a quarter of a voxel from all centres.
/// Turning the mesh by quarter turns, or mirroring it, turns or mirrors the centres exactly.
pub(crate) fn around_within(
    surface: &Surface,
    spacing: [f64; 3],
    origin: Option<[f64; 3]>,
    limit: u64,
) -> Result<Frame, VoxelizeError> {
    let bounds = &surface.bounds;
    let reach = |a: usize| bounds.max[a] - origin.map_or(bounds.min[a], |origin| origin[a]);
    let dims_at = |spacing: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|a| match origin {
            Some(_) => ((reach(a) + MARGIN * spacing[a]) / spacing[a]).ceil().max(1.0),
            None => voxels_across(reach(a), spacing[a]) + 2.0 * MARGIN,
        })
    };
    let dims = dims_at(spacing);
    let voxels: f64 = dims.iter().product();
    if voxels.is_nan() || voxels > limit as f64 {
        let fits = |factor: [f64; 2]| {
            let coarser = spacing.map(|h| h * factor[0] * factor[1]);
            dims_at(coarser).iter().product::<f64>() <= limit as f64
        };
        // The box grows with the cube of the resolution, its margins do not. In logarithms, which do not overflow.
        let logs = (0..3).map(|a| (reach(a).max(0.0).ln() - spacing[a].ln()).max(0.0)).sum::<f64>();
        let half = ((logs - (limit as f64).ln()) / 6.0).max(0.0).exp();
        let mut factors = (0..400).map(|step| [half, half * 1.02f64.powi(step)]);
        let pitch = spacing.into_iter().fold(f64::INFINITY, f64::min);
        let advice = factors.find(|factor| fits(*factor));
        let advice = advice.map_or(f64::INFINITY, |factor| pitch * factor[0] * factor[1] * 1.001);
        return Err(VoxelizeError::TooLarge { pitch, voxels, limit, advice });
    }
    let origin = origin.unwrap_or_else(|| {
        std::array::from_fn(|a| {
            let half = spacing[a] * dims[a] * 0.5;
            let reach = bounds.min[a].abs().max(bounds.max[a].abs()) + 2.0 * half;
            rounded(0.5 * bounds.min[a] + 0.5 * bounds.max[a], reach, 2.0) - half
        })
    });
    Ok(Frame::new(dims.map(|d| d as usize), origin, spacing)?)
}

/// The number of voxels across an extent. None across a sheet of less than half a voxel: a layer of them would be more
/// than twice as thick, so the sheet lies between centres, and is too thin.
pub(crate) fn voxels_across(extent: f64, spacing: f64) -> f64 {
    (extent / spacing - HALF).round()
}

/// A coordinate rounded to its last few bits, as seen from `reach`: 50 bits are kept, less `spare`. Rounding
/// takes x and -x alike, and what was rounded with more spare bits stays as it is.
pub(crate) fn rounded(x: f64, reach: f64, spare: f64) -> f64 {
    let unit = (reach.log2().floor() - 50.0 + spare).exp2();
    if unit.is_normal() { (x / unit).round() * unit } else { x }
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

//! The grid around a mesh: how fine, how large, where.

use crate::coarse_estimate::{CoarseEstimate, Soup};
use crate::error::VoxelizeError;
use crate::inside_rule::InsideRule;
use crate::inside_test::InsideTest;
use crate::mesh_analysis::MeshAnalysis;
use crate::parameters::{Pitch, VoxelizeParameters};
use crate::surface::Surface;
use mser3d_shape::{Frame, TriangleMesh};

/// Empty space left around the mesh, in voxels. A whole number, so that the flat sides of a box lie
/// between centres, and a box of n pitches gets n voxels.
const MARGIN: f64 = 1.0;

/// The frame that the parameters ask for.
pub(crate) fn frame(
    mesh: &TriangleMesh,
    surface: &Surface,
    analysis: &MeshAnalysis,
    rule: InsideRule,
    inside_test: InsideTest,
    parameters: &VoxelizeParameters,
) -> Result<Frame, VoxelizeError> {
    let coarse = || {
        let (triangles, boundary_edges) = (mesh.triangles().len(), analysis.counts.boundary);
        CoarseEstimate::of(surface, rule, inside_test)
            .map_err(|Soup| VoxelizeError::Soup { triangles, boundary_edges })
    };
    // A soup is refused before it takes hours.
    let scattered = if surface.scattered() { Some(coarse()?) } else { None };
    if let Some(frame) = parameters.frame {
        return checked(frame, surface, parameters.max_box_voxels);
    }
    let no_volume = || VoxelizeError::NoVolume {
        triangles: mesh.triangles().len(),
        boundary_edges: analysis.counts.boundary,
    };
    let spacing = match parameters.pitch {
        Pitch::Spacing(spacing) => spacing,
        Pitch::Size(pitch) => [pitch; 3],
        Pitch::Resolution(n) => [resolution_pitch(surface, n).ok_or_else(no_volume)?; 3],
        Pitch::Voxels(n) => {
            let estimate = || match &scattered {
                Some(coarse) => Ok(coarse.as_ref().map(|coarse| coarse.volume)),
                None if rule == InsideRule::Parity => Ok(coarse()?.map(|coarse| coarse.volume)),
                None => Ok(Some(surface.volume())),
            };
            [counted_pitch(n, mesh, surface, analysis, estimate)?.ok_or_else(no_volume)?; 3]
        }
    };
    let limit = parameters.max_box_voxels;
    checked(around_within(surface, spacing, parameters.origin, limit)?, surface, limit)
}

/// The pitch at which about n voxels fill the volume: the mesh's own where it is closed, an estimate in
/// scaled units otherwise. `Ok(None)` if nothing is enclosed.
fn counted_pitch(
    n: usize,
    mesh: &TriangleMesh,
    surface: &Surface,
    analysis: &MeshAnalysis,
    estimate: impl FnOnce() -> Result<Option<f64>, VoxelizeError>,
) -> Result<Option<f64>, VoxelizeError> {
    let own = mesh.signed_volume().abs();
    let Some(longest) = resolution_pitch(surface, 1) else { return Ok(None) };
    let as_it_is = analysis.file.unbalanced == 0
        && !analysis.dropped_duplicates
        && [0, surface.shells.len()].contains(&surface.inverted);
    if as_it_is && own.is_normal() && own > LEAST_VOLUME * longest.powi(3) {
        return Ok(Some((own / n as f64).cbrt()));
    }
    // Scaled, so that no cube of a coordinate overflows.
    let enough = |volume: &f64| *volume > LEAST_VOLUME * (longest * surface.scale).powi(3);
    Ok(estimate()?.filter(enough).map(|volume| (volume / n as f64).cbrt() / surface.scale))
}

/// Volumes below this part of the longest side's cube are rounding errors.
const LEAST_VOLUME: f64 = 1e-12;

/// The pitch that divides the longest side of the box around a mesh into n voxels.
pub(crate) fn resolution_pitch(surface: &Surface, n: usize) -> Option<f64> {
    let longest = surface.bounds.extent().into_iter().fold(0.0, f64::max);
    (longest > 0.0 && longest.is_finite()).then_some(longest / n as f64)
}

/// The frame around a mesh: corner at the lowest coordinates less one pitch, cubic voxels.
pub(crate) fn around(surface: &Surface, pitch: f64) -> Result<Frame, VoxelizeError> {
    around_within(surface, [pitch; 3], None, 1 << 32)
}

fn around_within(
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
fn checked(frame: Frame, surface: &Surface, limit: u64) -> Result<Frame, VoxelizeError> {
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

/// Why no voxel is inside.
pub(crate) fn nothing_inside(
    mesh: &TriangleMesh,
    surface: &Surface,
    frame: &Frame,
    doubled: usize,
    parameters: &VoxelizeParameters,
) -> VoxelizeError {
    if doubled > 0 {
        return VoxelizeError::Doubled { voxels: doubled };
    }
    let pitch = frame.spacing().into_iter().fold(f64::INFINITY, f64::min);
    let volume = (surface.volume() / surface.scale.powi(3)).max(mesh.signed_volume().abs());
    let area = mesh.area();
    let longest = resolution_pitch(surface, 1).unwrap_or(0.0);
    if volume > LEAST_VOLUME * longest.powi(3) && area > 0.0 {
        let given = parameters.frame.is_some() || parameters.origin.is_some();
        if given && pitch < volume / area {
            return VoxelizeError::OutsideFrame;
        }
        // A plate of thickness d has volume over area d / 2.
        return VoxelizeError::Thin { pitch, advice: (volume / area).min(pitch / 2.0) };
    }
    VoxelizeError::NoVolume {
        triangles: mesh.triangles().len(),
        boundary_edges: crate::mesh_edges::EdgeCounts::of(&crate::mesh_edges::Edges::new(
            mesh.vertices().len(),
            mesh.triangles(),
            |_| true,
        ))
        .boundary,
    }
}

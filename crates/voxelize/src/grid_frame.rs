//! The grid that the parameters ask for, and the error where none of its voxels is inside.

use crate::cancel::Stop;
use crate::coarse_estimate::{CoarseEstimate, Soup, is_crowded};
use crate::error::VoxelizeError;
use crate::fitted_spacing::fitted_spacing;
use crate::frame_around::{around_within, checked, resolution_pitch};
use crate::inside_rule::InsideRule;
use crate::inside_test::InsideTest;
use crate::mesh_analysis::MeshAnalysis;
use crate::parameters::{Pitch, VoxelizeParameters};
use crate::surface::Surface;
use mser3d_shape::{Frame, TriangleMesh};

/// The frame that the parameters ask for.
pub(crate) fn frame(
    mesh: &TriangleMesh,
    surface: &Surface,
    analysis: &MeshAnalysis,
    rule: InsideRule,
    inside_test: InsideTest,
    parameters: &VoxelizeParameters,
    stop: &Stop,
) -> Result<Frame, VoxelizeError> {
    let coarse = || {
        let found = CoarseEstimate::of(surface, rule, inside_test, stop);
        stop.check()?;
        found.map_err(|Soup| soup(mesh, analysis))
    };
    // A soup is refused before it takes hours.
    if is_crowded(surface) {
        return Err(soup(mesh, analysis));
    }
    let scattered = if surface.scattered() { Some(coarse()?) } else { None };
    if let Some(frame) = parameters.frame {
        return checked(frame, surface, parameters.max_box_voxels);
    }
    let no_volume = || VoxelizeError::NoVolume {
        triangles: mesh.triangles().len(),
        boundary_edges: analysis.counts.boundary,
    };
    // Not where the user said where the grid lies.
    let cubes_or_fitted = |pitch: f64, keep_count: bool| {
        let fitted = if parameters.origin.is_some() || rule == InsideRule::Parity {
            None
        } else {
            fitted_spacing(surface, pitch, keep_count)
        };
        fitted.unwrap_or([pitch; 3])
    };
    let spacing = match parameters.pitch {
        Pitch::Spacing(spacing) => spacing,
        Pitch::Size(pitch) => [pitch; 3],
        Pitch::Resolution(n) => cubes_or_fitted(resolution_pitch(surface, n).ok_or_else(no_volume)?, false),
        Pitch::Voxels(n) => {
            let estimate = || match &scattered {
                Some(coarse) => Ok(coarse.as_ref().map(|coarse| coarse.volume)),
                None if rule == InsideRule::Parity => Ok(coarse()?.map(|coarse| coarse.volume)),
                None => Ok(Some(surface.volume())),
            };
            let pitch = counted_pitch(n, mesh, surface, analysis, estimate)?;
            cubes_or_fitted(pitch.ok_or_else(no_volume)?, true)
        }
    };
    let limit = parameters.max_box_voxels;
    checked(around_within(surface, spacing, parameters.origin, limit)?, surface, limit)
}

/// The refusal of triangles that bound nothing.
pub(crate) fn soup(mesh: &TriangleMesh, analysis: &MeshAnalysis) -> VoxelizeError {
    VoxelizeError::Soup {
        triangles: mesh.triangles().len(),
        boundary_edges: analysis.counts.boundary,
        non_manifold_edges: analysis.counts.non_manifold,
    }
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

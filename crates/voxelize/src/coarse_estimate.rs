//! What a coarse grid says about a surface, before a fine one is made.

use crate::cancel::Stop;
use crate::frame_around::{around, resolution_pitch};
use crate::inside_rule::InsideRule;
use crate::inside_test::InsideTest;
use crate::surface::Surface;
use crate::triangle_geometry::area_vector;
use crate::voxel_fill::{Solid, sweep};

/// Voxels along the longest side of the coarse grid.
const RESOLUTION: usize = 48;

/// The same where much of a surface is boundary: each voxel near it takes a sum over many triangles. (Where there may be no
/// inside at all, the doubt about it needs the finer grid.)
const RESOLUTION_OF_LOOSE: usize = 24;

/// Triangles that hang together badly and cross grid lines more often than this in each voxel are a soup: the surface
/// of a solid is crossed a few times by a whole line.
const CROWDED: f64 = 0.5;

/// Scattered triangles are a soup when there is doubt about more than this part of the voxels inside.
const DOUBTFUL: f64 = 0.5;

/// A surface on a coarse grid.
pub(crate) struct CoarseEstimate {
    /// Volume inside, in scaled units.
    pub volume: f64,
    /// The part of it that is covered more than once.
    pub overlap: f64,
}

/// Triangles that bound no solid. Winding numbers of a soup take all triangles for each voxel: hours on a
/// fine grid, for no answer.
pub(crate) struct Soup;

impl CoarseEstimate {
    /// `None` if nothing is enclosed.
    pub fn of(
        surface: &Surface,
        rule: InsideRule,
        inside_test: InsideTest,
        stop: &Stop,
    ) -> Result<Option<Self>, Soup> {
        let loose = surface.tangled() && !surface.scattered();
        let resolution = if loose { RESOLUTION_OF_LOOSE } else { RESOLUTION };
        let pitch = resolution_pitch(surface, resolution);
        let Some(frame) = pitch.and_then(|pitch| around(surface, pitch).ok()) else {
            return Ok(None);
        };
        let pitch = frame.spacing()[0] * surface.scale;
        if is_crowded(surface) {
            return Err(Soup);
        }
        let solid = sweep(surface, &frame, rule, inside_test, stop);
        let Ok(Solid { occupancy, doubled, ambiguous, .. }) = solid else { return Ok(None) };
        let inside = occupancy.count_ones() as f64;
        if inside == 0.0 {
            return Ok(None);
        }
        if surface.scattered() && ambiguous as f64 > DOUBTFUL * inside {
            return Err(Soup);
        }
        Ok(Some(Self { volume: inside * pitch.powi(3), overlap: doubled as f64 / inside }))
    }
}

/// Whether a surface full of boundaries fills its box so densely that it is a soup.
pub(crate) fn is_crowded(surface: &Surface) -> bool {
    let pitch = resolution_pitch(surface, RESOLUTION).map_or(0.0, |pitch| pitch * surface.scale);
    surface.tangled() && pitch > 0.0 && crossings_per_voxel(surface, pitch) > CROWDED
}

/// How often the surface crosses a grid line within a voxel of the box around it, on average.
fn crossings_per_voxel(surface: &Surface, pitch: f64) -> f64 {
    let mut seen = 0.0;
    for t in 0..surface.caps {
        seen += area_vector(&surface.corners(t)).into_iter().map(f64::abs).sum::<f64>();
    }
    let voxels: f64 = surface.bounds.extent().iter().map(|x| x * surface.scale / pitch + 1.0).product();
    seen / (3.0 * pitch * pitch * voxels)
}

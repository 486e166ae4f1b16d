//! Spacings that fit the flat sides of a thin body.
//!
//! A side perpendicular to an axis lies somewhere between two layers of centres, and the solid ends half-way
//! between them. For a plate 2.6 voxels thick that is 15 % of its volume, however fine the grid is along the
//! plate. Slopes and curved sides have no such error: theirs cancels from line to line.

use crate::frame_around::voxels_across;
use crate::surface::Surface;
use crate::triangle_geometry::area_vector;
use std::collections::HashMap;

/// Errors of the volume up to this part of it are left as they are.
pub(crate) const NOTABLE_ERROR: f64 = 0.03;
/// A voxel's side may become longer or shorter by this factor.
const STRETCH: f64 = 1.5;
/// A voxel's longest side may be longer than its shortest by this factor.
const MOST_STRETCH: f64 = 3.0;
/// The error of the volume that a voxel twice as long as it should be is worth.
const CUBES: f64 = 0.04;

/// Sides this close to the middle between two ends of voxels, in voxels, run through the centres.
const TIE: f64 = 1e-6;

/// The same of half or twice as many voxels as were asked for.
const COUNT: f64 = 0.1;

/// The sides of a closed surface that are perpendicular to an axis.
struct FlatSides {
    /// The extent of the surface along the axis.
    extent: f64,
    /// Distance from the lowest coordinate, and area over the volume: positive where the side faces upwards.
    sides: Vec<(f64, f64)>,
}

impl FlatSides {
    fn of(surface: &Surface, axis: usize) -> Self {
        let low = surface.bounds.min[axis] * surface.scale;
        let mut areas: HashMap<u64, f64> = HashMap::new();
        for t in 0..surface.caps {
            let corners = surface.corners(t);
            let x = corners[0][axis];
            if corners[1][axis] == x && corners[2][axis] == x {
                *areas.entry((x - low).to_bits()).or_default() += area_vector(&corners)[axis];
            }
        }
        let volume = surface.volume();
        let mut sides: Vec<(f64, f64)> =
            areas.into_iter().map(|(x, area)| (f64::from_bits(x), area / volume)).collect();
        sides.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { extent: (surface.bounds.max[axis] - surface.bounds.min[axis]) * surface.scale, sides }
    }

    /// By how much the solid is too large, over its volume, on a centred grid with n voxels across; and by how
    /// much it may be wrong either way where sides run through a layer of centres.
    fn error(&self, n: f64, spacing: f64) -> (f64, f64) {
        let first = 0.5 * (self.extent - n * spacing);
        let (mut error, mut doubt) = (0.0, 0.0);
        for &(x, area) in &self.sides {
            let place = (x - first) / spacing;
            let end = place.round();
            if (place - end).abs() > 0.5 - TIE {
                doubt += 0.5 * spacing * area.abs();
            } else {
                error += area * (end.clamp(0.0, n) - place) * spacing;
            }
        }
        (error, doubt)
    }

    /// The number of voxels across, about r, that gives the right volume with voxels that are nearly cubes.
    fn fit(&self, r: f64) -> f64 {
        let cost = |n: f64| {
            let (error, doubt) = self.error(n, self.extent / n);
            // What depends on the side that a tie falls to is worth avoiding; rounding errors decide nothing.
            let cost = error.abs() + 10.0 * doubt + CUBES * (n / r).log2().abs();
            (cost * 1e9).round()
        };
        let range = (r / STRETCH).ceil().max(1.0) as u64..=(r * STRETCH).floor().max(1.0) as u64;
        range.map(|n| n as f64).min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(1.0)
    }
}

/// The spacing to use in place of cubes of the given pitch, where cubes give a wrong volume and others a
/// better one. With `keep_count` the voxels' volume stays about that of the cubes.
pub(crate) fn fitted_spacing(surface: &Surface, pitch: f64, keep_count: bool) -> Option<[f64; 3]> {
    if !surface.closed() || surface.volume() <= 0.0 {
        return None;
    }
    let pitch = pitch * surface.scale;
    let flat: [FlatSides; 3] = std::array::from_fn(|axis| FlatSides::of(surface, axis));
    let total = |spacing: [f64; 3]| {
        let of = |a: usize| flat[a].error(voxels_across(flat[a].extent, spacing[a]), spacing[a]);
        let (error, doubt) = (0..3).map(of).fold((0.0, 0.0), |sum: (f64, f64), e| (sum.0 + e.0, sum.1 + e.1));
        error.abs() + doubt
    };
    let cubes = total([pitch; 3]);
    if cubes.is_nan() || cubes <= NOTABLE_ERROR {
        return None;
    }
    // The axes with the greatest errors first; those alike together, so that no order of the axes matters.
    let mut order: Vec<(f64, usize)> = (0..3)
        .map(|a| {
            let (error, doubt) = flat[a].error(voxels_across(flat[a].extent, pitch), pitch);
            (error.abs() + doubt, a)
        })
        .collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let longest = flat.iter().fold(0.0, |longest: f64, f| longest.max(f.extent));
    let fitted = |start: f64| {
        let mut spacing = [start; 3];
        let (mut aim, mut left) = (start, 3.0);
        for group in order.chunk_by(|a, b| a.0 - b.0 < 1e-6) {
            let mut cell = f64::powf(aim, left);
            for &(_, a) in group {
                if flat[a].extent > 0.0 {
                    // A resolution is that of the longest side.
                    let kept = !keep_count && flat[a].extent >= longest * (1.0 - 1e-9);
                    let r = flat[a].extent / aim;
                    spacing[a] = flat[a].extent / if kept { r.round().max(1.0) } else { flat[a].fit(r) };
                }
                cell /= spacing[a];
            }
            left -= group.len() as f64;
            if keep_count && left > 0.0 {
                aim = cell.powf(1.0 / left);
            }
        }
        spacing
    };
    // Somewhat larger or smaller voxels may come nearer to the count.
    let starts: &[f64] = if keep_count { &[1.0, 0.97, 1.03, 0.93, 1.07, 0.88, 1.12] } else { &[1.0] };
    let cost = |spacing: &[f64; 3]| {
        let count = (spacing.iter().product::<f64>() / pitch.powi(3)).log2().abs();
        ((total(*spacing) + if keep_count { COUNT * count } else { 0.0 }) * 1e9).round()
    };
    let spacing = starts.iter().map(|s| fitted(pitch * s)).min_by(|a, b| cost(a).total_cmp(&cost(b)))?;
    // Sheets much thinner than a voxel stay what they are: too thin. The Laplacian of flat voxels is badly conditioned.
    let [low, high] = [f64::min, f64::max].map(|of| spacing.iter().copied().reduce(of).unwrap_or(pitch));
    let nearly_cubes = high <= MOST_STRETCH * low;
    (nearly_cubes && total(spacing) < 0.5 * cubes).then(|| spacing.map(|h| h / surface.scale))
}

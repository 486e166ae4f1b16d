//! Transforms that move every vertex smoothly.

use mser3d_shape::TriangleMesh;
use mser3d_shape::vector::{Vec3, add, dot, scale, sub};

use super::holes::SurfaceSampler;
use super::random::Random;
use super::transformed::Transformed;
use crate::EvaluationError;

/// A map of space to itself; see [`space_map`](super::space_map).
pub type SpaceMap = Box<dyn Fn(Vec3) -> Vec3 + Send + Sync>;

/// The null shape's vertices mapped.
pub(super) fn mapped(null: &TriangleMesh, map: &SpaceMap) -> Result<Transformed, EvaluationError> {
    Transformed::moved(null, null.vertices().iter().map(|&p| map(p)).collect())
}

/// The linear map I + `size` R. R has Frobenius norm 1, so no direction shrinks by more than `size`.
pub(super) fn affine(size: f64, random: &mut Random) -> SpaceMap {
    let entries: Vec<f64> = (0..9).map(|_| random.normal()).collect();
    let frobenius = entries.iter().map(|x| x * x).sum::<f64>().sqrt();
    let rows: [Vec3; 3] = std::array::from_fn(|a| {
        std::array::from_fn(|b| f64::from(a == b) + size * entries[3 * a + b] / frobenius)
    });
    Box::new(move |p| rows.map(|row| dot(row, p)))
}

/// Everything scaled by one factor.
pub(super) fn scaling(factor: f64) -> SpaceMap {
    Box::new(move |p| scale(p, factor))
}

/// Regions about six random vertices, in turn grown and shrunk: within `radius` of a centre c,
/// p -> c + (p - c) (1 + a (1 - |p - c|^2 / radius^2)^2). For -1 < a < 1.25 nothing folds over.
pub(super) fn localscale(null: &TriangleMesh, strength: f64, radius: f64, random: &mut Random) -> SpaceMap {
    let places = SurfaceSampler::new(null);
    let mut balls: Vec<(Vec3, f64)> = Vec::new();
    let through = move |balls: &[(Vec3, f64)], p: Vec3| {
        balls.iter().fold(p, |p, &(centre, amount)| {
            let away = sub(p, centre);
            let fade = (1.0 - dot(away, away) / (radius * radius)).max(0.0);
            add(p, scale(away, amount * fade * fade))
        })
    };
    for n in 0..6 {
        let centre = through(&balls, null.vertices()[places.vertex(random) as usize]);
        balls.push((centre, strength * if n % 2 == 0 { 0.1 } else { -0.08 }));
    }
    Box::new(move |p| through(&balls, p))
}

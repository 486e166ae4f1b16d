//! Transforms that move every vertex smoothly.

use mser3d_shape::TriangleMesh;

use super::Transformed;
use super::holes::SurfaceSampler;
use crate::ShrecError;
use crate::random::Random;
use crate::vector::{add, dot, scale, sub};

/// The linear map I + `size` R. R has Frobenius norm 1, so no direction shrinks by more than `size`.
pub(super) fn affine(null: &TriangleMesh, size: f64, random: &mut Random) -> Result<Transformed, ShrecError> {
    let entries: Vec<f64> = (0..9).map(|_| random.normal()).collect();
    let frobenius = entries.iter().map(|x| x * x).sum::<f64>().sqrt();
    let row = |a: usize, p: [f64; 3]| {
        (0..3).map(|b| (f64::from(a == b) + size * entries[3 * a + b] / frobenius) * p[b]).sum()
    };
    Transformed::moved(null, null.vertices().iter().map(|&p| [row(0, p), row(1, p), row(2, p)]).collect())
}

/// Everything scaled by one factor.
pub(super) fn scaling(null: &TriangleMesh, factor: f64) -> Result<Transformed, ShrecError> {
    Transformed::moved(null, null.vertices().iter().map(|&p| scale(p, factor)).collect())
}

/// Regions about six random vertices, in turn grown and shrunk: within `radius` of a centre c,
/// p -> c + (p - c) (1 + a (1 - |p - c|^2 / radius^2)^2). For -1 < a < 1.25 nothing folds over.
pub(super) fn localscale(
    null: &TriangleMesh,
    strength: f64,
    radius: f64,
    random: &mut Random,
) -> Result<Transformed, ShrecError> {
    let places = SurfaceSampler::new(null);
    let mut vertices = null.vertices().to_vec();
    for n in 0..6 {
        let centre = vertices[places.vertex(random) as usize];
        let amount = strength * if n % 2 == 0 { 0.1 } else { -0.08 };
        for p in &mut vertices {
            let away = sub(*p, centre);
            let fade = (1.0 - dot(away, away) / (radius * radius)).max(0.0);
            *p = add(*p, scale(away, amount * fade * fade));
        }
    }
    Transformed::moved(null, vertices)
}

//! Regions as vectors over the eigenfunctions.

/// The diffusion vector of a region: the means of the eigenfunctions times these weights, of length 1. The scalar product
/// of two is the cosine of the angle between the heat that flows out of them.
pub(super) fn embed(mean: &[f64], weights: &[f64]) -> Vec<f64> {
    let mut vector: Vec<f64> = mean.iter().zip(weights).map(|(x, w)| x * w).collect();
    normalize(&mut vector);
    vector
}

/// Scales a vector to length 1; the zero vector stays zero.
pub(super) fn normalize(vector: &mut [f64]) {
    let length = product(vector, vector).sqrt();
    if length > 0.0 {
        vector.iter_mut().for_each(|x| *x /= length);
    }
}

pub(super) fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

//! Regions as vectors over the eigenfunctions.

use mser3d_shape::Eigenbasis;
use rayon::prelude::*;

use crate::Region;

/// The mean of each eigenfunction over each region, k numbers a region.
pub(super) fn region_means(basis: &Eigenbasis, regions: &[Region]) -> Vec<Vec<f64>> {
    let mean = |region: &Region| {
        let mut sums = vec![0.0; basis.eigenvalues().len()];
        let mut total = 0.0;
        for &element in &region.elements {
            let m = basis.mass()[element as usize];
            total += m;
            sums.iter_mut().zip(basis.at(element as usize)).for_each(|(sum, phi)| *sum += m * phi);
        }
        sums.iter_mut().for_each(|sum| *sum /= total);
        sums
    };
    regions.par_iter().map(mean).collect()
}

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

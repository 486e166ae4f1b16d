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

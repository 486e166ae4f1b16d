//! Seeded k-means: k-means++ (Arthur & Vassilvitskii 2007), then Lloyd's iteration.

use crate::{DescriptorError, Descriptors, descriptor_table::squared_distance};
use mser3d_shape::SplitMix64;
use rayon::prelude::*;

/// The centres of `k` clusters. The same seed gives the same bits.
pub(crate) fn cluster(
    points: &Descriptors,
    k: usize,
    iterations: usize,
    seed: u64,
) -> Result<Descriptors, DescriptorError> {
    let width = points.width();
    let mut centres = spread(points, k, seed)?;
    let mut owners = Vec::new();
    for _ in 0..iterations {
        let nearer: Vec<usize> =
            points.values().par_chunks_exact(width).map(|p| nearest(p, &centres, width)).collect();
        if nearer == owners {
            break;
        }
        owners = nearer;
        let (mut sums, mut counts) = (vec![0.0; k * width], vec![0usize; k]);
        for (point, &owner) in points.rows().zip(&owners) {
            counts[owner] += 1;
            for (sum, x) in sums[owner * width..][..width].iter_mut().zip(point) {
                *sum += x;
            }
        }
        // A cluster that lost all its points stays where it is.
        for owner in (0..k).filter(|&c| counts[c] > 0) {
            for i in owner * width..(owner + 1) * width {
                centres[i] = sums[i] / counts[owner] as f64;
            }
        }
    }
    Descriptors::new(width, centres)
}

/// The number of the nearest centre; the first of equally near ones.
fn nearest(point: &[f64], centres: &[f64], width: usize) -> usize {
    let mut best = (0, f64::INFINITY);
    for (number, centre) in centres.chunks_exact(width).enumerate() {
        let distance = squared_distance(point, centre);
        if distance < best.1 {
            best = (number, distance);
        }
    }
    best.0
}

/// First centres far from each other: each point is taken with a probability proportional to its squared
/// distance from those taken before.
fn spread(points: &Descriptors, k: usize, seed: u64) -> Result<Vec<f64>, DescriptorError> {
    let mut random = SplitMix64::new(seed);
    let mut distances = vec![1.0; points.len()];
    let mut centres = Vec::with_capacity(k * points.width());
    for found in 0..k {
        let total: f64 = distances.iter().sum();
        let mut left = random.uniform() * total;
        let mut chosen = None;
        for (number, &distance) in distances.iter().enumerate().filter(|(_, d)| **d > 0.0) {
            chosen = Some(number);
            left -= distance;
            if left < 0.0 {
                break;
            }
        }
        let Some(chosen) = chosen else {
            return Err(DescriptorError::TooFewDescriptors { needed: k, found });
        };
        let centre = points.row(chosen);
        centres.extend_from_slice(centre);
        for (distance, point) in distances.iter_mut().zip(points.rows()) {
            let new = squared_distance(point, centre);
            *distance = if found == 0 { new } else { distance.min(new) };
        }
    }
    Ok(centres)
}

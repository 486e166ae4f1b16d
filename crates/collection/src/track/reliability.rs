use mser3d_results::Sighting;

/// Replaces the reliability of each sighting, which few copies of one frame gave, by that of all copies of the frames up to
/// so many before and after it: the mean of the logarithms of the odds. Reliability is a logistic function of the mean
/// overlap with copies, so this is what the copies together would have given.
pub(super) fn pooled(sightings: &mut [Sighting], frames: usize) {
    let odds: Vec<(usize, Option<f64>)> = sightings
        .iter()
        .map(|s| (s.frame, s.reliability.map(|r| (r / (1.0 - r)).ln()).filter(|x| x.is_finite())))
        .collect();
    for sighting in sightings {
        let near = odds.iter().filter(|(frame, _)| frame.abs_diff(sighting.frame) <= frames);
        let near: Vec<f64> = near.filter_map(|(_, odds)| *odds).collect();
        if sighting.reliability.is_some() && !near.is_empty() {
            let mean = near.iter().sum::<f64>() / near.len() as f64;
            sighting.reliability = Some(1.0 / (1.0 + (-mean).exp()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_copies_of_near_frames_count_and_those_of_far_ones_do_not() {
        let chance = |x: f64| 1.0 / (1.0 + (-x).exp());
        let sighting = |(frame, odds): (usize, Option<f64>)| Sighting {
            frame,
            region: 0,
            overlap: None,
            likeness: None,
            reliability: odds.map(chance),
            volume: 1.0,
            volume_fraction: 0.1,
            centroid: [0.0; 3],
        };
        let mut sightings: Vec<Sighting> =
            [(0, Some(1.0)), (1, Some(2.0)), (2, None), (9, Some(4.0))].map(sighting).into();
        pooled(&mut sightings, 3);
        let found: Vec<Option<f64>> = sightings.iter().map(|s| s.reliability).collect();
        for (found, expected) in found.iter().zip([Some(1.5), Some(1.5), None, Some(4.0)]) {
            assert_eq!(found.is_some(), expected.is_some());
            assert!((found.unwrap_or(0.0) - expected.map_or(0.0, chance)).abs() < 1e-12);
        }
    }
}

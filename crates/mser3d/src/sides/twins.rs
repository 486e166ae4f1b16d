//! Which regions are each other's mirror images.

use mser3d_descriptors::{Descriptors, RegionCosines};

use crate::Region;

/// The smallest ratio of the volumes of twins.
const LIKE_VOLUME: f64 = 2.0 / 3.0;

/// The largest distance of the descriptors of twins, in octaves of the time axis: limbs in a heavily different pose.
const LIKE_DISTANCE: f64 = 0.5;

/// Where a third region is no farther than this beyond the twin, in octaves, there are more than two alike: the arms of a
/// star, not a left and a right one. The pieces that voxels make of equal parts differ by less.
const EQUAL_DISTANCE: f64 = 0.75 / 16.0;

/// Twins lie alike towards what has no twin: the largest root mean square difference of their cosines.
pub(crate) const LIKE_PLACE: f64 = 0.3;

/// The pairs of regions that are each other's mirror images, the first member of each before the second, in ascending order.
///
/// A region is in at most one pair: with the one that is nearest in descriptor space of all that are apart from it and of
/// like volume, if it is the nearest of that one too. Left and right forelegs may be less alike than those and the hind
/// legs. So both must also lie alike towards the regions that have no partner in question, such as head and
/// trunk, by the cosines.
pub(super) fn twins(
    regions: &[Region],
    descriptors: &Descriptors,
    cosines: &RegionCosines,
    samples_per_octave: f64,
) -> Vec<[usize; 2]> {
    let count = regions.len();
    let mut distances = vec![None; count * count];
    for a in 0..count {
        for b in a + 1..count {
            let squares = descriptors.row(a).iter().zip(descriptors.row(b)).map(|(x, y)| (x - y) * (x - y));
            let apart = squares.sum::<f64>().sqrt() / samples_per_octave;
            let (small, large) =
                (regions[a].volume.min(regions[b].volume), regions[a].volume.max(regions[b].volume));
            if apart <= LIKE_DISTANCE && small >= LIKE_VOLUME * large && disjoint(&regions[a], &regions[b]) {
                distances[a * count + b] = Some(apart);
                distances[b * count + a] = Some(apart);
            }
        }
    }
    let alone =
        |a: usize, distances: &[Option<f64>]| distances[a * count..][..count].iter().all(Option::is_none);
    let middle: Vec<usize> = (0..count).filter(|&a| alone(a, &distances)).collect();
    let volume: f64 = middle.iter().map(|&m| regions[m].volume).sum();
    for a in 0..count {
        for b in a + 1..count {
            let square = |&m: &usize| {
                let differ = cosines.row(a)[m] - cosines.row(b)[m];
                regions[m].volume * differ * differ
            };
            let differ = (middle.iter().map(square).sum::<f64>() / volume.max(f64::MIN_POSITIVE)).sqrt();
            if differ > LIKE_PLACE {
                distances[a * count + b] = None;
                distances[b * count + a] = None;
            }
        }
    }
    pairs(count, |a, b| distances[a * count + b], |a, b| disjoint(&regions[a], &regions[b]))
}

/// Mutual nearest ones of which no third is as near. `distance` is none of two that cannot be twins.
fn pairs(
    count: usize,
    distance: impl Fn(usize, usize) -> Option<f64>,
    disjoint: impl Fn(usize, usize) -> bool,
) -> Vec<[usize; 2]> {
    let nearest = |a: usize| {
        let others = (0..count).filter_map(|b| Some((distance(a, b)?, b)));
        others.min_by(|x, y| x.0.total_cmp(&y.0)).map(|(_, b)| b)
    };
    let nearest: Vec<Option<usize>> = (0..count).map(nearest).collect();
    let mutual = (0..count).filter_map(|a| {
        let b = nearest[a]?;
        (a < b && nearest[b] == Some(a)).then_some([a, b])
    });
    mutual
        .filter(|&[a, b]| {
            let limit = distance(a, b).unwrap_or(0.0) + EQUAL_DISTANCE;
            let equal = |third: usize| match (distance(a, third), distance(b, third)) {
                (Some(x), Some(y)) => x.max(y) < limit && disjoint(a, third) && disjoint(b, third),
                _ => false,
            };
            !(0..count).any(|third| third != a && third != b && equal(third))
        })
        .collect()
}

/// Whether two regions have no element in common; both lists ascend.
fn disjoint(a: &Region, b: &Region) -> bool {
    let (mut a, mut b) = (a.elements.iter().peekable(), b.elements.iter().peekable());
    while let (Some(x), Some(y)) = (a.peek(), b.peek()) {
        match x.cmp(y) {
            std::cmp::Ordering::Less => a.next(),
            std::cmp::Ordering::Greater => b.next(),
            std::cmp::Ordering::Equal => return false,
        };
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pairs of regions that are described by one number each; all are apart.
    fn of(rows: &[f64]) -> Vec<[usize; 2]> {
        let distance = |a: usize, b: usize| {
            let apart = (rows[a] - rows[b]).abs();
            (a != b && apart <= LIKE_DISTANCE).then_some(apart)
        };
        pairs(rows.len(), distance, |_, _| true)
    }

    #[test]
    fn the_nearest_of_each_other_are_twins() {
        // The third is nearest to the second, whose nearest is the first.
        assert_eq!(of(&[0.0, 0.1, 0.25, 5.0, 5.2]), [[0, 1], [3, 4]]);
        assert_eq!(of(&[0.0, 0.6]), [[0usize; 2]; 0]);
    }

    #[test]
    fn three_equal_ones_are_no_twins() {
        assert_eq!(of(&[0.0, 0.01, 0.02, 2.0, 2.0]), [[3, 4]]);
    }
}

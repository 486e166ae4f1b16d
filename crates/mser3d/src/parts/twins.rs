//! Regions that are each other's mirror image, or equal in number, such as both arms, or the arms of a star.

use std::collections::BTreeSet;

/// The smallest ratio of the volumes of twins.
const LIKE_VOLUME: f64 = 2.0 / 3.0;

/// The largest distance of twins: the root mean square of the difference of the logarithms of what describes them.
const LIKE_DISTANCE: f64 = 0.1;

/// The distance up to which regions are equal but for their voxels.
const SAME_DISTANCE: f64 = 0.02;

/// Whether regions of these volumes can be twins.
pub(super) fn like_volume(a: f64, b: f64) -> bool {
    a.min(b) >= LIKE_VOLUME * a.max(b)
}

/// Puts regions that are alike into groups, each region into exactly one; most are alone. Groups and their members ascend.
///
/// `distance` says how differently two regions are described; none of two that cannot be twins, such as nested ones. It is
/// asked only of regions of like volume.
///
/// Two regions are twins if they are of like volume and description, and each other's nearest among such regions. So are more
/// than two that differ no more than voxels make equal ones differ.
pub(super) fn twin_groups(
    volumes: &[f64],
    distance: impl Fn(usize, usize) -> Option<f64>,
) -> Vec<Vec<usize>> {
    let count = volumes.len();
    let mut pairs: Vec<(f64, [usize; 2])> = Vec::new();
    for a in 0..count {
        let others = (a + 1..count).filter(|&b| like_volume(volumes[a], volumes[b]));
        let found = others.filter_map(|b| Some((distance(a, b)?, [a, b])));
        pairs.extend(found.filter(|(apart, _)| *apart <= LIKE_DISTANCE));
    }
    let alike: BTreeSet<[usize; 2]> = pairs.iter().map(|(_, pair)| *pair).collect();
    let mut nearest = vec![f64::INFINITY; count];
    for (apart, pair) in &pairs {
        pair.iter().for_each(|&member| nearest[member] = apart.min(nearest[member]));
    }
    pairs.retain(|(apart, [a, b])| *apart <= SAME_DISTANCE || *apart == nearest[*a] && *apart == nearest[*b]);
    pairs.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    // Each group grows by the nearest pair between it and another, if all of both are alike.
    let mut group: Vec<usize> = (0..count).collect();
    let members = |group: &[usize], g: usize| (0..count).filter(|&m| group[m] == g).collect::<Vec<_>>();
    for (_, [a, b]) in pairs {
        let (first, second) = (members(&group, group[a]), members(&group, group[b]));
        let all_alike =
            || first.iter().all(|&x| second.iter().all(|&y| alike.contains(&[x.min(y), x.max(y)])));
        if group[a] != group[b] && all_alike() {
            let (to, from) = (group[a].min(group[b]), group[a].max(group[b]));
            group.iter_mut().filter(|g| **g == from).for_each(|g| *g = to);
        }
    }
    (0..count).map(|g| members(&group, g)).filter(|m| !m.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Groups of regions that are described by one number each.
    fn groups(rows: &[f64], volumes: &[f64]) -> Vec<Vec<usize>> {
        twin_groups(volumes, |a, b| Some((rows[a] - rows[b]).abs()))
    }

    #[test]
    fn nearest_ones_of_like_volume_are_twins() {
        let found = groups(&[0.0, 0.5, 0.03, 0.56, 0.1, 0.0], &[1.0, 1.0, 0.9, 1.0, 1.0, 0.5]);
        // The fifth is near the third, whose nearest is the first; the last is too small.
        assert_eq!(found, [vec![0, 2], vec![1, 3], vec![4], vec![5]]);
        assert_eq!(groups(&[0.0, 0.2], &[1.0; 2]), [[0], [1]], "too far apart");
    }

    #[test]
    fn equal_ones_are_one_group_however_many() {
        assert_eq!(groups(&[0.0, 1e-9, -1e-9, 0.5, 1e-3, 0.0], &[1.0; 6]), [vec![0, 1, 2, 4, 5], vec![3]]);
    }

    #[test]
    fn what_cannot_be_twins_is_in_no_group_together() {
        // The first contains the second.
        let distance = |a: usize, b: usize| (a != 0 || b != 1).then_some(0.0);
        assert_eq!(twin_groups(&[1.0; 3], distance), [vec![0, 2], vec![1]]);
    }
}

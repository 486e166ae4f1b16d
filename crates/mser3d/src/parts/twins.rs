//! Regions that are each other's mirror image, or equal in number, such as both arms, or the arms of a star.

/// The smallest ratio of the volumes of twins.
const LIKE_VOLUME: f64 = 2.0 / 3.0;

/// The largest distance of twins: the root mean square of the difference of log heat kernels.
const LIKE_DISTANCE: f64 = 0.1;

/// The distance up to which regions are equal but for their voxels.
const SAME_DISTANCE: f64 = 0.02;

/// Puts regions that are alike into groups, each region into exactly one; most are alone. Groups and their members ascend.
///
/// `rows` describe the regions: the logarithms of their mean heat kernels at some times. `may` says of two regions whether
/// they can be twins at all, such as disjoint ones.
///
/// Two regions are twins if they are of like volume and description, and each other's nearest among such regions. So are more
/// than two that differ no more than voxels make equal ones differ.
pub(super) fn twin_groups(
    rows: &[Vec<f64>],
    volumes: &[f64],
    may: impl Fn(usize, usize) -> bool,
) -> Vec<Vec<usize>> {
    let count = rows.len();
    let distance = |a: usize, b: usize| {
        let squares = rows[a].iter().zip(&rows[b]).map(|(x, y)| (x - y).powi(2)).sum::<f64>();
        (squares / rows[a].len() as f64).sqrt()
    };
    let like = |a: usize, b: usize| {
        let (small, large) = (volumes[a].min(volumes[b]), volumes[a].max(volumes[b]));
        a != b && small >= LIKE_VOLUME * large && may(a, b) && distance(a, b) <= LIKE_DISTANCE
    };
    let mut nearest = vec![f64::INFINITY; count];
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for a in 0..count {
        for b in (a + 1..count).filter(|&b| like(a, b)) {
            let d = distance(a, b);
            nearest[a] = nearest[a].min(d);
            nearest[b] = nearest[b].min(d);
            pairs.push((d, a, b));
        }
    }
    pairs.retain(|&(d, a, b)| d <= SAME_DISTANCE || d == nearest[a] && d == nearest[b]);
    pairs.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
    // Each group grows by the nearest pair between it and another, if all of both are alike.
    let mut group: Vec<usize> = (0..count).collect();
    let members = |group: &[usize], g: usize| (0..count).filter(|&m| group[m] == g).collect::<Vec<_>>();
    for (_, a, b) in pairs {
        let (first, second) = (members(&group, group[a]), members(&group, group[b]));
        if group[a] != group[b] && first.iter().all(|&x| second.iter().all(|&y| like(x, y))) {
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
        let rows: Vec<Vec<f64>> = rows.iter().map(|&x| vec![x]).collect();
        twin_groups(&rows, volumes, |_, _| true)
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
        let rows = vec![vec![0.0]; 3];
        // The first contains the second.
        let may = |a: usize, b: usize| a.min(b) != 0 || a.max(b) != 1;
        assert_eq!(twin_groups(&rows, &[1.0; 3], may), [vec![0, 2], vec![1]]);
    }
}

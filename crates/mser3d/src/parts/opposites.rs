//! Twins of bodies that have sides: mirror images are on opposite sides.

use super::twins::like_volume;
use crate::sides::LIKE_PLACE;

/// From here on a part is on one side of its body, not in the middle.
const ASIDE: f64 = 0.5;

/// Corrects the twins of the parts of one body by their sides, each from -1 to 1. Two parts alone with each other are no twins if they are on one
/// side, or lie otherwise towards what is in the middle: a foreleg and a hind leg. Two without twins on opposite sides are, if they
/// lie alike and are of like volume, and each other's nearest among such parts: legs that a pose has made unlike.
///
/// `place` says how differently two parts lie towards others: the root mean square difference of their cosines.
pub(super) fn pair_by_sides(
    twins: &mut [Vec<usize>],
    sides: &[Option<f64>],
    volumes: &[f64],
    place: impl Fn(usize, usize, &[usize]) -> Option<f64>,
    distance: impl Fn(usize, usize) -> Option<f64>,
) {
    let aside = |part: usize| sides[part].filter(|side| side.abs() >= ASIDE);
    let middle: Vec<usize> = (0..twins.len())
        .filter(|&part| twins[part].is_empty() && sides[part].is_some() && aside(part).is_none())
        .collect();
    let lie_alike = |a: usize, b: usize| place(a, b, &middle).is_none_or(|differ| differ <= LIKE_PLACE);
    for a in 0..twins.len() {
        if let [b] = twins[a][..] {
            let one_side = aside(a).zip(aside(b)).is_some_and(|(p, q)| p * q > 0.0);
            if one_side || !lie_alike(a, b) {
                twins[a].clear();
                twins[b].clear();
            }
        }
    }
    let candidate = |a: usize, b: usize| {
        let opposite = aside(a)? * aside(b)? < 0.0;
        let like = like_volume(volumes[a], volumes[b]);
        let free = twins[a].is_empty() && twins[b].is_empty();
        (opposite && like && free && lie_alike(a, b)).then(|| distance(a, b))?
    };
    let nearest = |a: usize| {
        let others = (0..sides.len()).filter_map(|b| Some((candidate(a, b)?, b)));
        others.min_by(|x, y| x.0.total_cmp(&y.0)).map(|(_, b)| b)
    };
    let nearest: Vec<Option<usize>> = (0..sides.len()).map(nearest).collect();
    for a in 0..sides.len() {
        if let Some(b) = nearest[a].filter(|&b| nearest[b] == Some(a)) {
            twins[a] = vec![b];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parts that are described by one number each.
    fn paired(mut twins: Vec<Vec<usize>>, sides: &[f64], volumes: &[f64], rows: &[f64]) -> Vec<Vec<usize>> {
        let sides: Vec<Option<f64>> = sides.iter().map(|side| Some(*side)).collect();
        pair_by_sides(&mut twins, &sides, volumes, |_, _, _| None, |a, b| Some((rows[a] - rows[b]).abs()));
        twins
    }

    #[test]
    fn legs_of_one_side_are_no_twins_and_those_of_two_are() {
        // Left hind leg, right hind leg, left foreleg, right foreleg, head. A pose has made the left legs alike.
        let twins = vec![vec![2], vec![], vec![0], vec![], vec![]];
        let found = paired(
            twins,
            &[-1.0, 0.9, -1.0, 0.9, 0.1],
            &[3.0, 3.0, 2.5, 2.4, 3.0],
            &[0.5, 0.7, 0.2, 0.1, 0.5],
        );
        assert_eq!(found, [vec![1], vec![0], vec![3], vec![2], vec![]]);
    }

    #[test]
    fn legs_that_lie_otherwise_towards_the_head_are_no_twins() {
        // Left hind leg and right foreleg are alike, the others too; the head is in the middle.
        let towards_head = [-0.9, -0.8, 0.7, 0.8, 1.0];
        let place = |a: usize, b: usize, middle: &[usize]| {
            assert_eq!(middle, [4]);
            Some(f64::abs(towards_head[a] - towards_head[b]))
        };
        let sides = [-1.0, 0.9, -1.0, 0.9, 0.1].map(Some);
        let rows = [0.5_f64, 0.1, 0.1, 0.5, 0.5];
        for paired in [vec![vec![3], vec![2], vec![1], vec![0], vec![]], vec![vec![]; 5]] {
            let mut twins = paired;
            pair_by_sides(&mut twins, &sides, &[1.0; 5], place, |a, b| Some((rows[a] - rows[b]).abs()));
            assert_eq!(twins, [vec![1], vec![0], vec![3], vec![2], vec![]]);
        }
    }

    #[test]
    fn what_is_in_the_middle_or_of_unlike_volume_stays_alone() {
        let found = paired(vec![vec![]; 3], &[-1.0, 0.9, 0.3], &[3.0, 1.9, 3.0], &[0.0; 3]);
        assert_eq!(found, vec![Vec::<usize>::new(); 3]);
    }

    #[test]
    fn the_arms_of_a_star_stay_together_and_twins_too() {
        let star = vec![vec![1, 2], vec![0, 2], vec![0, 1]];
        assert_eq!(paired(star.clone(), &[-1.0, -1.0, 1.0], &[1.0; 3], &[0.0; 3]), star);
        let pair = vec![vec![1], vec![0], vec![]];
        assert_eq!(paired(pair.clone(), &[-1.0, 1.0, 1.0], &[1.0; 3], &[0.2, 0.0, 0.2]), pair);
    }
}

//! Which members of twins are on the same side of the body.

use super::vectors::{embed, normalize, product};

/// A region's place between the sides.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// 1 on the side of the first members of the pairs whose sign is positive, -1 on the other, 0 in the middle.
    pub side: f64,
    /// The pair that it belongs to, or that tells its side best.
    pub pair: usize,
}

pub(super) struct Places {
    /// For each pair 1 or -1: members are exchanged where it is negative, so that the first ones are on one side.
    pub signs: Vec<f64>,
    pub of_regions: Vec<Place>,
}

/// On which side each region lies, up to one exchange of both sides.
///
/// The difference of twins' region means is a function that the body's reflection turns into its negative. On such
/// functions Green's function `sum_i phi_i(u) phi_i(v) / lambda_i` (without the zero modes) is that of half the body with
/// the plane of symmetry held at zero, and so is nowhere negative between points of one side. Hence two pairs are put
/// so that the product of their differences in it is positive. What is the same for all pairs at once is found by a spanning
/// tree of the surest couplings, and then by exchanging single pairs as long as the sum of all couplings rises.
///
/// A region without a twin is on a side as far as it is nearer to one member of some pair than to the other.
pub(super) fn places(
    pairs: &[[usize; 2]],
    means: &[Vec<f64>],
    eigenvalues: &[f64],
    zero_modes: usize,
) -> Places {
    let weights: Vec<f64> = eigenvalues
        .iter()
        .enumerate()
        .map(|(i, l)| if i < zero_modes { 0.0 } else { 1.0 / l.sqrt() })
        .collect();
    let difference = |&[a, b]: &[usize; 2]| {
        let mut odd: Vec<f64> =
            means[a].iter().zip(&means[b]).zip(&weights).map(|((x, y), w)| (x - y) * w).collect();
        normalize(&mut odd);
        odd
    };
    let odd: Vec<Vec<f64>> = pairs.iter().map(difference).collect();
    let signs = synchronize(pairs.len(), |p, q| product(&odd[p], &odd[q]));
    let place = |mean: &Vec<f64>| {
        let vector = embed(mean, &weights);
        let cosines = odd.iter().zip(&signs).map(|(odd, sign)| sign * product(odd, &vector));
        let best = cosines.enumerate().max_by(|x, y| x.1.abs().total_cmp(&y.1.abs()));
        // One member alone is half of what both differ by: at 45 degrees to it.
        best.map_or(Place { side: 0.0, pair: 0 }, |(pair, cosine)| Place {
            side: (std::f64::consts::SQRT_2 * cosine).clamp(-1.0, 1.0),
            pair,
        })
    };
    let mut of_regions: Vec<Place> = means.iter().map(place).collect();
    for (pair, (&[a, b], &side)) in pairs.iter().zip(&signs).enumerate() {
        of_regions[a] = Place { side, pair };
        of_regions[b] = Place { side: -side, pair };
    }
    Places { signs, of_regions }
}

/// A sign for each of `count`, such that the sum of `sign(p) sign(q) coupling(p, q)` is large.
fn synchronize(count: usize, coupling: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let mut signs = vec![0.0; count];
    if let Some(first) = signs.first_mut() {
        *first = 1.0;
    }
    for _ in 1..count {
        let reached = (0..count).filter(|&p| signs[p] != 0.0);
        let links = reached.flat_map(|p| (0..count).filter(|&q| signs[q] == 0.0).map(move |q| [p, q]));
        let surest =
            links.map(|[p, q]| (coupling(p, q), [p, q])).max_by(|x, y| x.0.abs().total_cmp(&y.0.abs()));
        if let Some((value, [p, q])) = surest {
            signs[q] = if value < 0.0 { -signs[p] } else { signs[p] };
        }
    }
    // Each exchange raises the sum, so this ends; the bound is for rounding.
    for _ in 0..count * count {
        let loss = |p: usize| {
            let sum: f64 = (0..count).filter(|&q| q != p).map(|q| signs[q] * coupling(p, q)).sum();
            signs[p] * sum
        };
        let worst = (0..count).map(|p| (loss(p), p)).min_by(|x, y| x.0.total_cmp(&y.0));
        match worst {
            Some((loss, p)) if loss < -1e-12 => signs[p] = -signs[p],
            _ => break,
        }
    }
    signs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_follow_the_couplings() {
        let truth = [1.0, -1.0, -1.0, 1.0, -1.0];
        let strength = |p: usize, q: usize| 1e-4 * (1 + (p * q) % 3) as f64;
        assert_eq!(synchronize(5, |p, q| truth[p] * truth[q] * strength(p, q)), truth);
    }

    #[test]
    fn one_wrong_coupling_is_outvoted() {
        // The strongest one lies.
        let coupling = |p: usize, q: usize| if [p, q] == [0, 1] || [p, q] == [1, 0] { -1.0 } else { 0.6 };
        let signs = synchronize(4, coupling);
        assert!(signs.iter().all(|s| *s == signs[0]), "{signs:?}");
        assert_eq!(synchronize(0, coupling), [0.0; 0]);
    }
}

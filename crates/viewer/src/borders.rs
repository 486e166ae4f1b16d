//! Borders of regions that run smoothly over a surface, though labels change from vertex to vertex.

use mser3d_shape::Graph;
use mser3d_shape::vector::{Vec3, norm, sub};

/// How many regions a vertex can be near to.
const NEAR: usize = 4;
/// What one step of averaging over neighbours adds to the variance along an axis, in squared edges: of six neighbours and itself.
const VARIANCE: f64 = 3.0 / 7.0;
/// The longest that averaging goes on.
const MOST_STEPS: usize = 60;

/// How much of each vertex belongs to which colour: the largest few shares, by falling share. A share of zero says nothing.
pub(crate) type Shares = [(u32, f32); NEAR];

/// All of a vertex has one colour.
pub(crate) fn whole(paint: u32) -> Shares {
    let mut shares = [(paint, 0.0); NEAR];
    shares[0].1 = 1.0;
    shares
}

/// The share of each colour around each vertex, averaged over a length (a standard deviation): like heat that has flowed from each region along
/// the edges. Each place of a triangle takes the colour that has most there, so a border runs where two are equal. A colour
/// that would be nowhere any more keeps the vertices it had.
pub(crate) fn smoothed(points: &[Vec3], edges: &Graph, paint: &[u32], length: f64) -> Vec<Shares> {
    let edge = |[a, b]: [u32; 2]| norm(sub(points[a as usize], points[b as usize]));
    let mean_edge = edges.edges().map(edge).sum::<f64>() / edges.edge_count() as f64;
    let steps = (length / mean_edge).powi(2) / VARIANCE;
    let steps = if steps.is_finite() { (steps.ceil() as usize).min(MOST_STEPS) } else { 0 };
    // Along long edges less flows, so that a step goes equally far everywhere.
    let flow = |a: u32, b: u32| (mean_edge / edge([a, b])).powi(2).min(1.0) as f32;
    let mut shares: Vec<Shares> = paint.iter().map(|&paint| whole(paint)).collect();
    for _ in 0..steps {
        let next = |v: u32| {
            let (own, around) = (shares[v as usize], edges.neighbours(v));
            if own[0].1 == 1.0 && around.iter().all(|w| shares[*w as usize][0] == own[0]) {
                return own;
            }
            let flows = around.iter().map(|&w| (flow(v, w), &shares[w as usize]));
            let stays = 1.0 + flows.clone().map(|(flow, _)| 1.0 - flow).sum::<f32>();
            mean(flows.chain([(stays, &own)]))
        };
        shares = (0..paint.len() as u32).map(next).collect();
    }
    keep_small(&mut shares, paint);
    shares
}

/// The weighted mean of some vertices.
fn mean<'a>(of: impl Iterator<Item = (f32, &'a Shares)>) -> Shares {
    let mut sums: Vec<(u32, f32)> = Vec::with_capacity(2 * NEAR);
    for (weight, shares) in of {
        for &(paint, share) in shares.iter().filter(|(_, share)| *share > 0.0) {
            match sums.iter_mut().find(|(known, _)| *known == paint) {
                Some((_, sum)) => *sum += weight * share,
                None => sums.push((paint, weight * share)),
            }
        }
    }
    sums.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    sums.truncate(NEAR);
    let total: f32 = sums.iter().map(|(_, share)| share).sum();
    let mut mean = [(sums[0].0, 0.0); NEAR];
    mean.iter_mut().zip(&sums).for_each(|(to, (paint, sum))| *to = (*paint, sum / total));
    mean
}

/// Gives back to each colour that has the most nowhere any more the vertices that it had.
fn keep_small(shares: &mut [Shares], paint: &[u32]) {
    let count = paint.iter().max().map_or(0, |most| *most as usize + 1);
    let mut seen = vec![false; count];
    shares.iter().for_each(|share| seen[share[0].0 as usize] = true);
    for (share, &paint) in shares.iter_mut().zip(paint) {
        if !seen[paint as usize] {
            *share = whole(paint);
        }
    }
}

/// The colour that has the most at a place of a triangle, of equal ones the first.
pub(crate) fn prevailing(corners: [&Shares; 3], weights: [f64; 3]) -> u32 {
    let [a, b, c] = corners.map(|shares| shares[0]);
    if a.0 == b.0 && b.0 == c.0 && a.1.min(b.1).min(c.1) > 0.5 {
        return a.0;
    }
    let total = |paint: u32| -> f64 {
        let of_corner = |shares: &Shares| -> f64 {
            shares.iter().filter(|(own, _)| *own == paint).map(|(_, share)| f64::from(*share)).sum()
        };
        (0..3).map(|i| weights[i] * of_corner(corners[i])).sum()
    };
    let mut best = (f64::NEG_INFINITY, 0);
    for (paint, share) in corners.into_iter().flatten() {
        if *share > 0.0 {
            let here = (total(*paint), *paint);
            if here.0 > best.0 || (here.0 == best.0 && here.1 < best.1) {
                best = here;
            }
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plate of `n` x `n` squares of side 1, divided by one diagonal.
    fn plate(n: u32) -> (Vec<Vec3>, Graph) {
        let points = (0..=n).flat_map(|y| (0..=n).map(move |x| [f64::from(x), f64::from(y), 0.0])).collect();
        let corner = |x: u32, y: u32| y * (n + 1) + x;
        let square = |x: u32, y: u32| {
            let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
            [[a, b], [b, c], [c, d], [d, a], [a, c]]
        };
        let edges: Vec<[u32; 2]> = (0..n).flat_map(|y| (0..n).flat_map(move |x| square(x, y))).collect();
        let count = (n + 1) * (n + 1);
        (points, Graph::from_edges(count as usize, &edges).unwrap())
    }

    /// Where the border between colours 0 and 1 crosses each row of a plate whose lower half has colour 0.
    fn crossings(shares: &[Shares], n: u32) -> Vec<f64> {
        let of_first = |x: u32, y: u32| -> f64 {
            let own = shares[(y * (n + 1) + x) as usize];
            own.iter().filter(|(paint, _)| *paint == 0).map(|(_, share)| f64::from(*share)).sum()
        };
        (0..=n)
            .map(|y| {
                let x = (0..n).find(|&x| of_first(x, y) > 0.5 && of_first(x + 1, y) <= 0.5).unwrap();
                let [a, b] = [of_first(x, y), of_first(x + 1, y)];
                f64::from(x) + (a - 0.5) / (a - b)
            })
            .collect()
    }

    #[test]
    fn a_jagged_border_becomes_straight_and_stays_where_it_is() {
        let n = 40;
        let (points, edges) = plate(n);
        // The border is at 20.5, and a step to either side of it by turns of three rows.
        let paint: Vec<u32> =
            points.iter().map(|p| u32::from(p[0] > if p[1] % 6.0 < 3.0 { 19.5 } else { 21.5 })).collect();
        let rough = crossings(&smoothed(&points, &edges, &paint, 0.0), n);
        let smooth = crossings(&smoothed(&points, &edges, &paint, 2.0), n);
        let spread = |list: &[f64]| {
            let inner = &list[10..31];
            let mean = inner.iter().sum::<f64>() / inner.len() as f64;
            (mean, inner.iter().map(|x| (x - mean).abs()).fold(0.0, f64::max))
        };
        assert!(spread(&rough).1 > 0.9);
        let (mean, most) = spread(&smooth);
        assert!((mean - 20.5).abs() < 0.1 && most < 0.25, "{mean} {most}");
    }

    #[test]
    fn a_single_vertex_keeps_its_colour() {
        let (points, edges) = plate(10);
        let paint: Vec<u32> = points.iter().map(|p| u32::from(*p == [5.0, 5.0, 0.0])).collect();
        let shares = smoothed(&points, &edges, &paint, 2.0);
        let won: Vec<usize> = (0..points.len()).filter(|&v| shares[v][0].0 == 1).collect();
        assert_eq!(won, [60]);
    }

    #[test]
    fn the_colour_with_the_most_prevails() {
        let [a, b] = [whole(3), whole(7)];
        assert_eq!(prevailing([&a, &b, &b], [0.6, 0.2, 0.2]), 3);
        assert_eq!(prevailing([&a, &b, &b], [0.4, 0.2, 0.4]), 7);
        let mut split = whole(3);
        (split[0].1, split[1]) = (0.6, (7, 0.4));
        // .5 * .6 + .5 * 0 against .5 * .4 + .5 * 1.
        assert_eq!(prevailing([&split, &b, &b], [0.5, 0.25, 0.25]), 7);
    }
}

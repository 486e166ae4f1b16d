//! The nearest of many points, exactly, in coordinates that are many but lie near a surface.

use rayon::prelude::*;

use super::coordinates::Points;

/// Points in groups around some of them. By the triangle inequality most groups are too far to be looked at.
pub(super) struct Neighbours {
    points: Points,
    /// A group for each centre.
    groups: Vec<Group>,
}

struct Group {
    centre: usize,
    /// The farthest member's distance.
    radius: f32,
    /// Ascending.
    members: Vec<u32>,
}

/// What rounding may take from a bound, over the distances that it is made of.
const SLACK: f32 = 1e-5;

impl Neighbours {
    pub fn new(points: Points) -> Self {
        let count = points.len();
        let centres = (count as f64).sqrt().ceil() as usize;
        let mut groups: Vec<Group> = (0..centres)
            .map(|group| Group { centre: group * count / centres, radius: 0.0, members: Vec::new() })
            .collect();
        let nearest = |place: usize| {
            let distance = |group: &Group| square(points.row(place), points.row(group.centre));
            let mut best = (0, f32::INFINITY);
            for (number, group) in groups.iter().enumerate() {
                let d = distance(group);
                if d < best.1 {
                    best = (number, d);
                }
            }
            best
        };
        let found: Vec<(usize, f32)> = (0..count).into_par_iter().map(nearest).collect();
        for (place, (group, square)) in found.into_iter().enumerate() {
            groups[group].members.push(place as u32);
            groups[group].radius = groups[group].radius.max(square.sqrt());
        }
        Self { points, groups }
    }

    pub fn points(&self) -> &Points {
        &self.points
    }

    /// The point nearest to each query; of equally near ones the first. 0 where there are no points.
    pub fn of(&self, queries: &Points) -> Vec<u32> {
        (0..queries.len()).into_par_iter().map(|query| self.nearest(queries.row(query))).collect()
    }

    fn nearest(&self, query: &[f32]) -> u32 {
        let bound = |group: &Group| {
            let d = square(query, self.points.row(group.centre)).sqrt();
            d - group.radius - SLACK * (d + group.radius)
        };
        let mut order: Vec<(f32, &Group)> = self.groups.iter().map(|group| (bound(group), group)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best = (f32::INFINITY, 0);
        for (bound, group) in order {
            if bound > 0.0 && bound * bound > best.0 {
                break;
            }
            for &member in &group.members {
                let d = square(query, self.points.row(member as usize));
                if d < best.0 || d == best.0 && member < best.1 {
                    best = (d, member);
                }
            }
        }
        best.1
    }
}

/// The square of the distance: eight sums beside each other, so that a processor can take several numbers at a time.
fn square(a: &[f32], b: &[f32]) -> f32 {
    let (a, rest_a) = a.as_chunks::<8>();
    let (b, rest_b) = b.as_chunks::<8>();
    let mut sums = [0f32; 8];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..8 {
            let d = a[lane] - b[lane];
            sums[lane] += d * d;
        }
    }
    let rest: f32 = rest_a.iter().zip(rest_b).map(|(a, b)| (a - b) * (a - b)).sum();
    sums.iter().sum::<f32>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use mser3d_shape::SplitMix64;

    #[test]
    fn the_nearest_is_that_of_all() {
        let mut random = SplitMix64::new(1);
        for (count, width) in [(1, 1), (50, 3), (700, 19)] {
            let mut points = |n: usize| {
                // On a curve, with some noise; every value twice.
                let row = |random: &mut SplitMix64| {
                    let t = random.uniform() * 6.0;
                    (0..width).map(|i| ((t * (i + 1) as f64).sin() + 0.1 * random.uniform()) as f32).collect()
                };
                let rows: Vec<Vec<f32>> = (0..n).map(|_| row(&mut random)).collect();
                Points::new(width, rows.iter().chain(&rows).flatten().copied().collect())
            };
            let (points, queries) = (points(count), points(100));
            let found = Neighbours::new(points.clone()).of(&queries);
            for (query, &place) in found.iter().enumerate() {
                let distance = |p: usize| square(queries.row(query), points.row(p));
                let least = (0..points.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
                assert_eq!(Some(place as usize), least, "{count} points of {width} numbers");
            }
        }
    }
}

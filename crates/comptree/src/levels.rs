/// Weights that are equal up to rounding become one level, the lowest of them.
///
/// Two parts that are mirror images of each other have the same weights in theory. Computed, they differ in the last
/// digits, and a tree built over those would join one part before the other, by chance: the merge of both with what
/// lies between is one merge. Sorted weights whose neighbours differ by less than `relative` times their size are one
/// level. Infinite weights stay what they are. Time: O(n log n).
///
/// ```
/// let mut weights = [2.0, 1.0, 1.0 + 1e-12, 3.0, f64::INFINITY];
/// mser3d_comptree::join_levels(&mut weights, 1e-9);
/// assert_eq!(weights, [2.0, 1.0, 1.0, 3.0, f64::INFINITY]);
/// ```
pub fn join_levels(weights: &mut [f64], relative: f64) {
    let mut order: Vec<u32> = (0..weights.len() as u32).collect();
    order.sort_unstable_by(|&a, &b| weights[a as usize].total_cmp(&weights[b as usize]).then(a.cmp(&b)));
    let (mut level, mut last) = (f64::NAN, f64::NAN);
    for &place in &order {
        let weight = weights[place as usize];
        let size = weight.abs().max(last.abs());
        if !(size.is_finite() && weight - last <= relative * size) {
            level = weight;
        }
        last = weight;
        weights[place as usize] = level;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_in_order_are_joined_whatever_their_sign() {
        let mut weights = [-1.0, 5.0, -1.0 - 1e-12, 0.0, f64::NEG_INFINITY, 5.0 - 1e-12, -0.0];
        join_levels(&mut weights, 1e-9);
        let low = 5.0 - 1e-12;
        assert_eq!(weights, [-1.0 - 1e-12, low, -1.0 - 1e-12, 0.0, f64::NEG_INFINITY, low, 0.0]);
        let mut apart = [1.0, 1.0 + 1e-6, 1.0 - 1e-6];
        join_levels(&mut apart, 1e-9);
        assert_eq!(apart, [1.0, 1.0 + 1e-6, 1.0 - 1e-6]);
    }
}

/// Weights that are equal up to rounding become one level, the lowest of them.
///
/// Two parts that are mirror images of each other have the same weights in theory. Computed, they differ in the last
/// digits, and a tree built over those would join one part before the other, by chance: the merge of both with what
/// lies between is one merge. Sorted weights whose neighbours differ by less than `relative` times their size are one
/// level. Infinite weights stay what they are. Time: O(n).
///
/// ```
/// let mut weights = [2.0, 1.0, 1.0 + 1e-12, 3.0, f64::INFINITY];
/// mser3d_comptree::join_levels(&mut weights, 1e-9);
/// assert_eq!(weights, [2.0, 1.0, 1.0, 3.0, f64::INFINITY]);
/// ```
pub fn join_levels(weights: &mut [f64], relative: f64) {
    let (mut level, mut last) = (f64::NAN, f64::NAN);
    for Keyed { key, place } in sorted(weights) {
        let weight = weight_of(key);
        let size = weight.abs().max(last.abs());
        if !(size.is_finite() && weight - last <= relative * size) {
            level = weight;
        }
        last = weight;
        weights[place as usize] = level;
    }
}

/// A weight as a number that has its order, and where it is.
#[derive(Clone, Copy, Default)]
struct Keyed {
    key: u64,
    place: u32,
}

/// The order of [`f64::total_cmp`] as that of integers: the bits of positive numbers ascend, those of negative ones descend.
fn key_of(weight: f64) -> u64 {
    let bits = weight.to_bits();
    bits ^ if bits >> 63 == 1 { u64::MAX } else { 1 << 63 }
}

fn weight_of(key: u64) -> f64 {
    f64::from_bits(key ^ if key >> 63 == 1 { 1 << 63 } else { u64::MAX })
}

/// Ascending weights. Digit by digit from the last, which takes half as long as a sort that compares, or less, as digits that
/// all weights share cost nothing.
fn sorted(weights: &[f64]) -> Vec<Keyed> {
    const BITS: u32 = 11;
    const DIGITS: usize = u64::BITS.div_ceil(BITS) as usize;
    let digit = |key: u64, number: usize| (key >> (number as u32 * BITS)) as usize & ((1 << BITS) - 1);
    let mut entries: Vec<Keyed> =
        weights.iter().zip(0..).map(|(&weight, place)| Keyed { key: key_of(weight), place }).collect();
    let mut counts = vec![[0u32; 1 << BITS]; DIGITS];
    for &Keyed { key, .. } in &entries {
        counts.iter_mut().enumerate().for_each(|(number, counts)| counts[digit(key, number)] += 1);
    }
    let mut other = vec![Keyed::default(); entries.len()];
    for (number, next) in counts.iter_mut().enumerate() {
        if next.iter().any(|&count| count as usize == entries.len()) {
            continue;
        }
        let mut sum = 0;
        next.iter_mut().for_each(|next| sum += std::mem::replace(next, sum));
        for entry in &entries {
            let at = &mut next[digit(entry.key, number)];
            other[*at as usize] = *entry;
            *at += 1;
        }
        std::mem::swap(&mut entries, &mut other);
    }
    entries
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

    #[test]
    fn weights_are_sorted_as_by_comparison() {
        let special = [0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY, f64::MIN_POSITIVE, -f64::MAX, f64::NAN];
        let mut random = mser3d_shape::SplitMix64::new(3);
        let mut number = || (random.uniform() - 0.5) * 10f64.powf(30.0 * random.uniform() - 15.0);
        for count in [0, 1, 2, 5000] {
            let weights: Vec<f64> = special.into_iter().chain((0..count).map(|_| number())).collect();
            let mut expected = weights.clone();
            expected.sort_by(f64::total_cmp);
            let found = sorted(&weights);
            let bits = |weight: f64| weight.to_bits();
            assert!(found.iter().map(|e| bits(weight_of(e.key))).eq(expected.iter().map(|&w| bits(w))));
            assert!(found.iter().all(|e| bits(weights[e.place as usize]) == bits(weight_of(e.key))));
        }
    }
}

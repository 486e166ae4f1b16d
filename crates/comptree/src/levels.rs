use std::ops::RangeInclusive;

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
    for keys in ranges(weights) {
        // What has become a level before is below the range.
        for Keyed { key, place } in sorted(weights, keys) {
            let weight = weight_of(key);
            let size = weight.abs().max(last.abs());
            if !(size.is_finite() && weight - last <= relative * size) {
                level = weight;
            }
            last = weight;
            weights[place as usize] = level;
        }
    }
}

/// Weights up to which all are sorted at once: of more, so many or an eighth of them.
const AT_ONCE: usize = 1 << 20;

/// Ranges of keys, ascending, that hold few weights each, as far as their first bits tell them apart.
fn ranges(weights: &[f64]) -> Vec<RangeInclusive<u64>> {
    const SHIFT: u32 = 48;
    if weights.len() <= AT_ONCE {
        return vec![0..=u64::MAX];
    }
    let mut counts = vec![0usize; 1 << (u64::BITS - SHIFT)];
    weights.iter().for_each(|&weight| counts[(key_of(weight) >> SHIFT) as usize] += 1);
    let most = AT_ONCE.max(weights.len() / 8);
    let (mut ranges, mut first, mut held) = (Vec::new(), 0u64, 0);
    for (bin, &count) in (0u64..).zip(&counts) {
        if held > 0 && held + count > most {
            ranges.push(first << SHIFT..=(bin << SHIFT) - 1);
            (first, held) = (bin, 0);
        }
        held += count;
    }
    ranges.push(first << SHIFT..=u64::MAX);
    ranges
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

/// Ascending weights of a range. Digit by digit from the last, which takes half as long as a sort that compares, or less, as digits that
/// all weights share cost nothing.
fn sorted(weights: &[f64], keys: RangeInclusive<u64>) -> Vec<Keyed> {
    const BITS: u32 = 11;
    const DIGITS: usize = u64::BITS.div_ceil(BITS) as usize;
    let digit = |key: u64, number: usize| (key >> (number as u32 * BITS)) as usize & ((1 << BITS) - 1);
    let keyed = weights.iter().zip(0..).map(|(&weight, place)| Keyed { key: key_of(weight), place });
    let in_range = keyed.filter(|entry| keys.contains(&entry.key));
    let all = weights.len() <= AT_ONCE;
    let count = if all { weights.len() } else { in_range.clone().count() };
    let mut entries = Vec::with_capacity(count);
    entries.extend(in_range);
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
    fn many_weights_are_joined_as_few_are() {
        let mut random = mser3d_shape::SplitMix64::new(5);
        let mut weights: Vec<f64> =
            (0..AT_ONCE + 1000).map(|i| if i % 5 == 0 { -1.0 } else { 1.0 } * random.uniform()).collect();
        let ranges = ranges(&weights);
        assert!(ranges.len() > 1 && ranges[0].start() == &0 && ranges[ranges.len() - 1].end() == &u64::MAX);
        assert!(ranges.windows(2).all(|pair| pair[0].end() + 1 == *pair[1].start()));
        let mut expected: Vec<(f64, usize)> = weights.iter().copied().zip(0..).collect();
        expected.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut level, mut last) = (f64::NAN, f64::NAN);
        for (weight, _) in &mut expected {
            if last.is_nan() || *weight - last > 1e-7 * weight.abs().max(last.abs()) {
                level = *weight;
            }
            last = *weight;
            *weight = level;
        }
        join_levels(&mut weights, 1e-7);
        assert!(expected.iter().all(|&(level, place)| weights[place] == level));
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
            let found = sorted(&weights, 0..=u64::MAX);
            let bits = |weight: f64| weight.to_bits();
            assert!(found.iter().map(|e| bits(weight_of(e.key))).eq(expected.iter().map(|&w| bits(w))));
            assert!(found.iter().all(|e| bits(weights[e.place as usize]) == bits(weight_of(e.key))));
        }
    }
}

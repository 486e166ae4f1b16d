/// SplitMix64 (Steele, Lea & Flood 2014): a few lines, and the same numbers everywhere and for ever, which
/// starting vectors, seeds of clusters and synthetic benchmarks need.
///
/// ```
/// use mser3d_shape::SplitMix64;
/// // The published test vector of the generator for seed 0.
/// assert_eq!(SplitMix64::new(0).next_u64(), 0xe220_a839_7b1d_cdaf);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SplitMix64(u64);

impl SplitMix64 {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 random bits.
    #[inline]
    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        Self::mix(self.0)
    }

    /// Uniform on [0, 1): a multiple of 2^-53.
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// The generator's output function: mixes the bits of a number, so that near numbers end up far apart.
    #[inline]
    pub fn mix(mut z: u64) -> u64 {
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stream_is_splitmix64() {
        let mut random = SplitMix64::new(0);
        assert_eq!([random.next_u64(), random.next_u64()], [0xe220_a839_7b1d_cdaf, 0x6e78_9e6a_a1b9_65f4]);
    }

    #[test]
    fn uniform_numbers_fill_the_unit_interval() {
        let mut random = SplitMix64::new(7);
        let sample: Vec<f64> = (0..10_000).map(|_| random.uniform()).collect();
        assert!(sample.iter().all(|x| (0.0..1.0).contains(x)));
        assert!((sample.iter().sum::<f64>() / 1e4 - 0.5).abs() < 0.01);
    }
}

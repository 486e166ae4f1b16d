use mser3d_shape::SplitMix64;

/// Random numbers of the kinds that transforms need, over [`SplitMix64`]: the same everywhere and for ever, as a
/// benchmark must be.
#[derive(Clone, Debug)]
pub(super) struct Random(SplitMix64);

impl Random {
    /// An independent stream for each tuple of numbers.
    pub fn new(seed: &[u64]) -> Self {
        let mut stream = SplitMix64::new(0);
        for &s in seed {
            stream = SplitMix64::new(stream.next_u64() ^ s);
        }
        stream.next_u64();
        Self(stream)
    }

    /// Uniform on [0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.0.uniform()
    }

    /// Uniform on [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Uniform on 0..count; 0 for a count of 0. The bias, count / 2^64, is nothing.
    pub fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.0.next_u64()) * count as u128) >> 64) as usize
    }

    /// Of mean 0 and variance 1, very nearly normal: the sum of twelve uniform numbers less 6, which
    /// needs no logarithm or cosine of a platform's library.
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> [f64; 3] {
        loop {
            let p = [self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0)];
            let square: f64 = p.iter().map(|x| x * x).sum();
            if (1e-4..=1.0).contains(&square) {
                return p.map(|x| x / square.sqrt());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_and_ranges() {
        let mut random = Random::new(&[1, 2]);
        let n = 20_000;
        let sample: Vec<f64> = (0..n).map(|_| random.normal()).collect();
        let mean = sample.iter().sum::<f64>() / f64::from(n);
        let variance = sample.iter().map(|x| x * x).sum::<f64>() / f64::from(n);
        assert!(mean.abs() < 0.03 && (variance - 1.0).abs() < 0.05, "{mean} {variance}");
        assert!((0..1000).all(|_| random.below(7) < 7));
        assert_ne!(Random::new(&[1, 2]).uniform(), Random::new(&[2, 1]).uniform());
    }
}

//! Fields that trees are built of.

use std::error::Error;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use mser3d::shape::SplitMix64;

/// A field on a box, x fastest.
pub struct Field {
    pub name: &'static str,
    pub dims: [usize; 3],
    kind: Kind,
}

enum Kind {
    /// Waves in twelve directions with a little noise on them.
    Smooth,
    /// The same without the noise, in a hundred steps: ties.
    Grey,
    /// White noise.
    Noise,
}

/// All fields, small ones first.
pub const FIELDS: [Field; 5] = [
    Field { name: "smooth-45K", dims: [36, 36, 35], kind: Kind::Smooth },
    Field { name: "smooth-1M", dims: [100, 100, 100], kind: Kind::Smooth },
    Field { name: "grey-1M", dims: [100, 100, 100], kind: Kind::Grey },
    Field { name: "noise-1M", dims: [100, 100, 100], kind: Kind::Noise },
    Field { name: "smooth-10M", dims: [224, 223, 200], kind: Kind::Smooth },
];

impl Field {
    pub fn len(&self) -> usize {
        self.dims.iter().product()
    }

    pub fn values(&self) -> Vec<f64> {
        let mut random = SplitMix64::new(1);
        let waves: Vec<[f64; 4]> = (0..12)
            .map(|_| {
                std::array::from_fn(|i| {
                    if i < 3 { 38.0 * random.uniform() - 19.0 } else { TAU * random.uniform() }
                })
            })
            .collect();
        let at =
            |v: usize| [v % self.dims[0], v / self.dims[0] % self.dims[1], v / self.dims[0] / self.dims[1]];
        let smooth = |v: usize| -> f64 {
            let [x, y, z] = std::array::from_fn(|i| at(v)[i] as f64 / self.dims[i] as f64);
            waves.iter().map(|[a, b, c, phase]| (a * x + b * y + c * z + phase).sin()).sum()
        };
        let value = |v: usize| match self.kind {
            Kind::Smooth => smooth(v) + 0.007 * (random.uniform() - 0.5),
            Kind::Grey => (smooth(v) * 8.0).round(),
            Kind::Noise => random.uniform(),
        };
        (0..self.len()).map(value).collect()
    }

    /// Little-endian.
    pub fn write(&self, path: &Path) -> Result<(), Box<dyn Error>> {
        Ok(fs::write(path, self.values().into_iter().flat_map(f64::to_le_bytes).collect::<Vec<u8>>())?)
    }
}

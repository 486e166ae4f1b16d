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
    pub numbers: Numbers,
    kind: Kind,
}

/// The type of a field's numbers.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Numbers {
    /// As they are.
    F64,
    /// All bits from the least value to the greatest.
    U16,
    /// The same.
    U8,
}

impl Numbers {
    /// As NumPy calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::F64 => "f8",
            Self::U16 => "u2",
            Self::U8 => "u1",
        }
    }

    pub fn of_name(name: &str) -> Option<Self> {
        [Self::F64, Self::U16, Self::U8].into_iter().find(|numbers| numbers.name() == name)
    }
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
pub const FIELDS: [Field; 7] = [
    Field { name: "smooth-45K", dims: [36, 36, 35], numbers: Numbers::F64, kind: Kind::Smooth },
    Field { name: "smooth-1M", dims: [100, 100, 100], numbers: Numbers::F64, kind: Kind::Smooth },
    Field { name: "grey-1M", dims: [100, 100, 100], numbers: Numbers::F64, kind: Kind::Grey },
    Field { name: "noise-1M", dims: [100, 100, 100], numbers: Numbers::F64, kind: Kind::Noise },
    Field { name: "smooth-10M", dims: [224, 223, 200], numbers: Numbers::F64, kind: Kind::Smooth },
    Field { name: "smooth-10M-u16", dims: [224, 223, 200], numbers: Numbers::U16, kind: Kind::Smooth },
    Field { name: "smooth-10M-u8", dims: [224, 223, 200], numbers: Numbers::U8, kind: Kind::Smooth },
];

impl Field {
    pub fn len(&self) -> usize {
        self.dims.iter().product()
    }

    /// What trees of it are compared.
    pub fn weights(&self) -> &'static [&'static str] {
        if self.numbers == Numbers::F64 { &["vertex", "edge"] } else { &["vertex"] }
    }

    fn values(&self) -> Vec<f64> {
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
        let values = self.values();
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let step = |value: f64, steps: f64| ((value - least) / (most - least) * steps).round();
        let bytes: Vec<u8> = match self.numbers {
            Numbers::F64 => values.into_iter().flat_map(f64::to_le_bytes).collect(),
            Numbers::U16 => {
                values.into_iter().flat_map(|x| (step(x, f64::from(u16::MAX)) as u16).to_le_bytes()).collect()
            }
            Numbers::U8 => values.into_iter().map(|x| step(x, f64::from(u8::MAX)) as u8).collect(),
        };
        Ok(fs::write(path, bytes)?)
    }
}

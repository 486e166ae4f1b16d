//! Colours of regions and of scalar fields.

use crate::Rgb;

/// A hue in three tones: what is alike on both sides of a body has one hue, and its tone says on which side it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hue {
    /// Of the side whose sign is positive.
    pub light: Rgb,
    /// Of the middle, and where sides are not known.
    pub middle: Rgb,
    /// Of the side whose sign is negative.
    pub dark: Rgb,
}

impl Hue {
    const fn new(light: u32, middle: u32, dark: u32) -> Self {
        Self { light: Rgb::hex(light), middle: Rgb::hex(middle), dark: Rgb::hex(dark) }
    }

    /// The tone for a side from -1 to 1: light from 0.5 on, dark down from -0.5.
    pub fn tone(self, side: Option<f64>) -> Rgb {
        match side {
            Some(side) if side >= 0.5 => self.light,
            Some(side) if side <= -0.5 => self.dark,
            _ => self.middle,
        }
    }

    /// The three tones.
    pub fn tones(self) -> [Rgb; 3] {
        [self.middle, self.light, self.dark]
    }

    /// How far the hues are apart: the smallest [`Rgb::distance`] of their tones.
    pub fn distance(self, other: Self) -> f64 {
        let apart = |p: Rgb| other.tones().map(|q| p.distance(q)).into_iter().fold(f64::INFINITY, f64::min);
        self.tones().map(apart).into_iter().fold(f64::INFINITY, f64::min)
    }
}

/// Eight hues that colour-blind viewers can tell apart, also under shading: lavender, rust, lime, magenta,
/// indigo, teal, sand and steel blue.
///
/// They were found by a search that makes the tones of the first hues as different as can be, then those of more:
/// of two hues any tones are at least 0.05 apart by [`Rgb::distance`].
pub const PALETTE: [Hue; 8] = [
    Hue::new(0xCCB0FD, 0xB98CFE, 0xA36DED),
    Hue::new(0xC24C05, 0x9D3D06, 0x7C2D01),
    Hue::new(0xB0F75A, 0x97DD39, 0x7EC202),
    Hue::new(0xAD3E99, 0x922381, 0x760367),
    Hue::new(0x575CE3, 0x4442C7, 0x3326AC),
    Hue::new(0x169781, 0x097C6A, 0x056253),
    Hue::new(0xCBBD7A, 0xB1A362, 0x998B4A),
    Hue::new(0x5D9EDA, 0x4485C0, 0x2B6DA6),
];

/// The colour of what belongs to no region.
pub const NO_REGION: Rgb = Rgb::hex(0xCFCFCF);

/// The colour of a match that is wrong.
pub const MISTAKE: Rgb = Rgb::hex(0x1A1A1A);

/// A sequential colour map for a scalar: dark blue at 0, green, light yellow at 1.
///
/// Lightness and the blue-yellow axis rise linearly in Oklab, so equal steps look equal, also in grey
/// print and to red-green-blind eyes; the green in the middle only helps the others. Values outside
/// 0 to 1 are clipped, NaN gives [`NO_REGION`].
pub fn sequential(value: f64) -> Rgb {
    if value.is_nan() {
        return NO_REGION;
    }
    let t = value.clamp(0.0, 1.0);
    let green = -0.085 * (std::f64::consts::PI * t).sin() - 0.03 * t;
    Rgb::from_oklab([0.30 + 0.63 * t, green, -0.13 + 0.26 * t])
}

/// The values mapped by [`sequential`] from their smallest to their largest; NaN gives [`NO_REGION`].
pub fn sequential_colours(values: &[f64]) -> Vec<Rgb> {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let low = finite().fold(f64::INFINITY, f64::min);
    let high = finite().fold(f64::NEG_INFINITY, f64::max);
    let width = if high > low { high - low } else { 1.0 };
    values.iter().map(|v| sequential((v - low) / width)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hues_are_told_apart_by_colour_blind_eyes_in_any_tone() {
        for (i, p) in PALETTE.iter().enumerate() {
            for q in &PALETTE[..i] {
                assert!(p.distance(*q) > 0.05, "{p:?} {q:?}: {}", p.distance(*q));
            }
            for plain in [NO_REGION, Rgb::WHITE, MISTAKE] {
                assert!(p.tones().iter().all(|tone| tone.distance(plain) > 0.1), "{p:?} {plain}");
            }
            assert!(p.light.distance(p.dark) > 0.1, "{p:?}: {}", p.light.distance(p.dark));
            assert!(p.light.oklab()[0] > p.middle.oklab()[0] && p.middle.oklab()[0] > p.dark.oklab()[0]);
        }
    }

    #[test]
    fn the_tone_is_that_of_the_side() {
        let hue = PALETTE[2];
        let tones = [Some(1.0), Some(0.2), None, Some(-0.5), Some(f64::NAN)].map(|side| hue.tone(side));
        assert_eq!(tones, [hue.light, hue.middle, hue.middle, hue.dark, hue.middle]);
    }

    #[test]
    fn the_sequential_map_gets_lighter_in_equal_steps() {
        let lightness: Vec<f64> = (0..=20).map(|i| sequential(f64::from(i) / 20.0).oklab()[0]).collect();
        for w in lightness.windows(2) {
            assert!((w[1] - w[0] - 0.0315).abs() < 0.008, "{w:?}");
        }
        assert_eq!(sequential(f64::NAN), NO_REGION);
        assert_eq!(sequential_colours(&[3.0, 5.0]), [sequential(0.0), sequential(1.0)]);
        assert_eq!(sequential_colours(&[4.0, 4.0]), [sequential(0.0); 2]);
    }
}

use std::fmt;

/// A colour as sRGB bytes (IEC 61966-2-1), red first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Rgb(pub [u8; 3]);

impl Rgb {
    /// White.
    pub const WHITE: Self = Self([255; 3]);

    /// The colour `0xRRGGBB`.
    pub const fn hex(code: u32) -> Self {
        Self([(code >> 16) as u8, (code >> 8) as u8, code as u8])
    }

    /// Linear light, 0 to 1: what adds up when colours are mixed, blurred or lit.
    pub fn linear(self) -> [f32; 3] {
        self.0.map(|byte| {
            let c = f32::from(byte) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        })
    }

    /// The nearest colour to an amount of linear light; values outside 0 to 1 are clipped.
    pub fn from_linear(light: [f32; 3]) -> Self {
        Self(light.map(|l| {
            let l = l.clamp(0.0, 1.0);
            let c = if l <= 0.003_130_8 { 12.92 * l } else { 1.055 * l.powf(1.0 / 2.4) - 0.055 };
            (c * 255.0 + 0.5) as u8
        }))
    }

    /// Coordinates in Oklab (Ottosson 2020), where Euclidean distance is about proportional to the
    /// difference people see: lightness 0 to 1, green to red, blue to yellow.
    pub fn oklab(self) -> [f64; 3] {
        linear_to_oklab(self.linear().map(f64::from))
    }

    /// The colour at these Oklab coordinates, clipped to what a screen can show.
    pub fn from_oklab([l, a, b]: [f64; 3]) -> Self {
        let cone = [
            l + 0.396_337_777_4 * a + 0.215_803_757_3 * b,
            l - 0.105_561_345_8 * a - 0.063_854_172_8 * b,
            l - 0.089_484_177_5 * a - 1.291_485_548_0 * b,
        ]
        .map(|x| x * x * x);
        let light = apply(&OKLAB_CONES_TO_LINEAR, cone);
        Self::from_linear(light.map(|x| x as f32))
    }

    /// How different two colours look to the people who tell them apart least: the smallest Oklab
    /// distance over normal, protanopic and deuteranopic vision.
    ///
    /// 0.02 is just noticeable; 0.07 is clear in small areas.
    ///
    /// ```
    /// # use mser3d_viewer::Rgb;
    /// let (red, green) = (Rgb::hex(0xB03030), Rgb::hex(0x5A7A20));
    /// let (blue, yellow) = (Rgb::hex(0x3040B0), Rgb::hex(0xE0D040));
    /// assert!(red.distance(green) < 0.3 * blue.distance(yellow));
    /// ```
    pub fn distance(self, other: Self) -> f64 {
        let seen = |colour: Self, vision: &[[f64; 3]; 3]| {
            linear_to_oklab(apply(vision, colour.linear().map(f64::from)).map(|x| x.clamp(0.0, 1.0)))
        };
        let apart = |vision: &[[f64; 3]; 3]| {
            let (p, q) = (seen(self, vision), seen(other, vision));
            (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt()
        };
        [&NORMAL, &PROTANOPIA, &DEUTERANOPIA].map(apart).into_iter().fold(f64::INFINITY, f64::min)
    }

    /// This colour mixed with another in linear light: 0 gives this one, 1 the other.
    pub fn mix(self, other: Self, share: f32) -> Self {
        let (p, q) = (self.linear(), other.linear());
        Self::from_linear(std::array::from_fn(|i| p[i] + share * (q[i] - p[i])))
    }
}

impl fmt::Display for Rgb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}

type Matrix = [[f64; 3]; 3];

fn apply(matrix: &Matrix, v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn linear_to_oklab(light: [f64; 3]) -> [f64; 3] {
    let cones = apply(&LINEAR_TO_OKLAB_CONES, light).map(f64::cbrt);
    apply(&CONES_TO_OKLAB, cones)
}

const NORMAL: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

// What is left of linear light without one kind of cone (Machado, Oliveira, Fernandes 2009, severity 1).
const PROTANOPIA: Matrix =
    [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]];
const DEUTERANOPIA: Matrix =
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]];

const LINEAR_TO_OKLAB_CONES: Matrix = [
    [0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9],
    [0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6],
    [0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5],
];
const CONES_TO_OKLAB: Matrix = [
    [0.210_454_255_3, 0.793_617_785_0, -0.004_072_046_8],
    [1.977_998_495_1, -2.428_592_205_0, 0.450_593_709_9],
    [0.025_904_037_1, 0.782_771_766_2, -0.808_675_766_0],
];
const OKLAB_CONES_TO_LINEAR: Matrix = [
    [4.076_741_662_1, -3.307_711_591_3, 0.230_969_929_2],
    [-1.268_438_004_6, 2.609_757_401_1, -0.341_319_396_5],
    [-0.004_196_086_3, -0.703_418_614_7, 1.707_614_701_0],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_grey_and_some_colours_survive_linear_light_and_oklab() {
        let colours = (0..=255u8).map(|g| Rgb([g; 3])).chain([0x0072B2, 0xE69F00, 0x882255].map(Rgb::hex));
        for colour in colours {
            assert_eq!(Rgb::from_linear(colour.linear()), colour);
            assert_eq!(Rgb::from_oklab(colour.oklab()), colour);
        }
    }

    #[test]
    fn white_is_lightness_one_without_hue() {
        let [l, a, b] = Rgb::WHITE.oklab();
        assert!((l - 1.0).abs() < 1e-6 && a.abs() < 1e-6 && b.abs() < 1e-6);
    }

    #[test]
    fn half_the_light_of_white_is_not_half_its_byte() {
        assert_eq!(Rgb::WHITE.mix(Rgb([0; 3]), 0.5), Rgb([188; 3]));
    }
}

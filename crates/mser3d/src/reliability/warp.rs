use std::f64::consts::TAU;

use mser3d_shape::vector::{Vec3, add, dot, norm, scale, sub};
use mser3d_shape::{BoundingBox, SplitMix64};

/// Waves that are added.
const WAVES: usize = 6;

/// The wavelengths over the diagonal of the shape's box, from and to; evenly in logarithm between them.
const WAVELENGTHS: [f64; 2] = [0.15, 0.6];

/// A smooth random deformation: `u(p) = sum of a_i sin(k_i p + s_i)` is added to each place p.
#[derive(Clone, Debug)]
pub(super) struct Warp {
    waves: [Wave; WAVES],
}

#[derive(Clone, Copy, Debug)]
struct Wave {
    /// 2 pi over the wavelength, in the direction of the wave, length^-1.
    wave_vector: Vec3,
    /// How far it moves, and whereto, [L].
    amplitude: Vec3,
    phase: f64,
}

impl Warp {
    /// The deformation of a number, for what lies in a box. Each wave moves by `amplitude` times the box's diagonal.
    pub fn new(bounds: &BoundingBox, amplitude: f64, number: u64) -> Self {
        let mut random = SplitMix64::new(SplitMix64::mix(number));
        let diagonal = bounds.diagonal();
        let [shortest, longest] = WAVELENGTHS;
        let wave = |_| {
            let wavelength = diagonal * shortest * (longest / shortest).powf(random.uniform());
            let wave_vector = scale(direction(&mut random), TAU / wavelength);
            let amplitude = scale(direction(&mut random), amplitude * diagonal);
            Wave { wave_vector, amplitude, phase: TAU * random.uniform() }
        };
        Self { waves: std::array::from_fn(wave) }
    }

    /// Where a place comes to.
    pub fn apply(&self, place: Vec3) -> Vec3 {
        self.waves.iter().fold(place, |moved, wave| {
            let height = (dot(wave.wave_vector, place) + wave.phase).sin();
            add(moved, scale(wave.amplitude, height))
        })
    }

    /// What is moved to a place: the inverse, by ten steps of `p = place - u(p)`. Where the deformation is steep they don't
    /// settle, and the result is near what comes there.
    pub fn origin_of(&self, place: Vec3) -> Vec3 {
        (0..10).fold(place, |origin, _| {
            let moved = sub(self.apply(origin), origin);
            sub(place, moved)
        })
    }

    /// The farthest that anything moves.
    pub fn reach(&self) -> f64 {
        self.waves.iter().map(|wave| norm(wave.amplitude)).sum()
    }
}

/// A random direction: a point in the ball, from the cube around it, put on the sphere.
fn direction(random: &mut SplitMix64) -> Vec3 {
    loop {
        let point: Vec3 = std::array::from_fn(|_| 2.0 * random.uniform() - 1.0);
        let length = norm(point);
        if (1e-3..=1.0).contains(&length) {
            return scale(point, 1.0 / length);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warps_are_smooth_bounded_and_the_same_for_the_same_number() {
        let bounds = BoundingBox { min: [0.0; 3], max: [2.0, 3.0, 6.0] };
        let warp = Warp::new(&bounds, 0.02, 5);
        let place = [0.3, 1.0, 2.0];
        assert_eq!(warp.apply(place), Warp::new(&bounds, 0.02, 5).apply(place));
        assert_ne!(warp.apply(place), Warp::new(&bounds, 0.02, 6).apply(place));
        assert!((warp.reach() - 6.0 * 0.02 * 7.0).abs() < 1e-12);
        let step = 1e-6;
        for i in 0..100 {
            let p = [f64::from(i) * 0.02, f64::from(i % 10) * 0.3, f64::from(i % 7)];
            let moved = |p| add(warp.apply(p), scale(p, -1.0));
            assert!(norm(moved(p)) <= warp.reach());
            let change = norm(add(moved([p[0] + step, p[1], p[2]]), scale(moved(p), -1.0)));
            assert!(change <= step * 6.0 * 0.02 * TAU / 0.15);
        }
    }
}
